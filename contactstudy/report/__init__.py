"""One HTML file of a result or of a study, for a reader without Python.

It holds everything that it shows: no script, no font and no picture is fetched from anywhere.
"""

from contactstudy.near_names import suggest
from contactstudy.report.document import html, write

__all__ = ["html", "write"]

suggest(__name__, __all__)
