"""Random cases: what is drawn, what has to hold of each, and a long run of them by command."""
