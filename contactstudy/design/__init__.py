"""Profiles that are best by a measure, in the worst of several loads and tilts, and how well that is known.

================  ==========================================
best_profile.py   the optimum with its errors, as a Dataset
evaluations.py    designs that were looked at
search.py         the optimum, and how flat it is
================  ==========================================
"""

from contactstudy.design.best_profile import best_profile
from contactstudy.errors import BoundWarning
from contactstudy.near_names import suggest

__all__ = ["BoundWarning", "best_profile"]

suggest(__name__, __all__)
