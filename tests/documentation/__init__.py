"""README.md, the pages in docs and the notebooks in studies, run as tests of the system tier."""
