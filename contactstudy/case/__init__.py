"""One case: roller, body, load and friction, the cells that suit it, and rough surfaces."""

from contactstudy.case import roughness
from contactstudy.case.case import Case
from contactstudy.case.gridding import choose_grid
from contactstudy.case.roller import Roller

__all__ = ["Case", "Roller", "choose_grid", "roughness"]
