"""Random cases: their parameters, their properties, and long runs by command."""
