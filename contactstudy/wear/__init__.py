"""Wear of a roller's profile by Archard's law, on frictional work.

================  ==============================================================
wear_in.py        a profile over the distance slid or rolled
steps.py          steps as long as their estimated error allows
worn_contact.py   the contact of a worn profile, with the wear of a step in it
profile.py        worn profiles, to be contacted again
================  ==============================================================
"""

from contactstudy.near_names import suggest
from contactstudy.wear.profile import worn_profile
from contactstudy.wear.wear_in import wear_in

__all__ = ["wear_in", "worn_profile"]

suggest(__name__, __all__)
