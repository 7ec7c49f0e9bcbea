"""What many passes leave behind."""

from contactstudy.passes.profile import worn_profile
from contactstudy.passes.wear import wear_in

__all__ = ["wear_in", "worn_profile"]
