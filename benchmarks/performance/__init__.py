"""Speed of the package and of published contact codes: `python -m benchmarks.performance`."""
