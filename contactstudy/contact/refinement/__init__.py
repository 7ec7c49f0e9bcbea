"""Columns of cells that follow the pressure to a stated accuracy, and the law of singular ends."""
