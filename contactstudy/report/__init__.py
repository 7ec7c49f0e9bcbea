"""One HTML file of a result or of a study, for a reader without Python.

It holds everything that it shows: no script, no font and no picture is fetched from anywhere.
"""

from typing import TYPE_CHECKING

from contactstudy.near_names import suggesting
from contactstudy.report.document import html, write

__all__ = ["html", "write"]

if not TYPE_CHECKING:  # to a type checker, a module with __getattr__ has every name
    __getattr__ = suggesting(__name__, __all__)
