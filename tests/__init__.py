"""The tests and the references they compare with."""
