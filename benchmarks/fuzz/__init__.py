"""Random cases: their parameters, their properties, and a command for long runs."""
