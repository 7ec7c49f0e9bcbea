"""Profiles that minimise a measure in the worst of several loads and tilts, with errors."""

from contactstudy.design.search import best_profile
from contactstudy.errors import BoundWarning

__all__ = ["BoundWarning", "best_profile"]
