"""One case: roller, body, load and friction, the cells that suit it, and rough surfaces."""

from contactstudy.case import roughness
from contactstudy.case.case import Case
from contactstudy.case.gridding import choose_grid
from contactstudy.case.roller import Roller
from contactstudy.near_names import suggest

__all__ = ["Case", "Roller", "choose_grid", "roughness"]

suggest(__name__, __all__)
