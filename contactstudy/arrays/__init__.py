"""Arrays and their labels: the grid of cells, the table of variables, peaks, and texts of numbers."""
