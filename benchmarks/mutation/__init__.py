"""Changed signs and factors in the solver's core, one at a time, and whether a test notices."""
