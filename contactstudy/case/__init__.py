"""One case: roller, body, load and friction, and the cells that suit it."""

from contactstudy.case.case import Case
from contactstudy.case.gridding import choose_grid
from contactstudy.case.roller import Roller

__all__ = ["Case", "Roller", "choose_grid"]
