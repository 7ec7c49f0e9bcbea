"""Arrays and their labels: the grid of cells, the table of variables, stress invariants, measured columns."""
