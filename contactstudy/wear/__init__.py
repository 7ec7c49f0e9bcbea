"""Wear of a roller's profile by Archard's law, on frictional work."""

from contactstudy.wear.profile import worn_profile
from contactstudy.wear.wear_in import wear_in

__all__ = ["wear_in", "worn_profile"]
