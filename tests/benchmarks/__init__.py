"""Speed of the package beside that of published contact codes: `python -m tests.benchmarks`."""
