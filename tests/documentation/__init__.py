"""README.md, the pages in docs and the notebooks in studies as tests of the system tier."""
