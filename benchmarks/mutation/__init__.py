"""Single changes of signs and factors in the solver's core, each with the test that fails."""
