"""Studies under faults: trials, their number and outcome, as a table."""
