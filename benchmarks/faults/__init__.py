"""Studies under faults: what is tried, how often, and what held, as a table made by command."""
