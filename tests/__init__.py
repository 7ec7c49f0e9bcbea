"""The tests and their reference values."""
