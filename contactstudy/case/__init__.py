"""One case: roller, body, load and friction, the cells that suit it, and rough surfaces."""

from typing import TYPE_CHECKING

from contactstudy.case import roughness
from contactstudy.case.case import Case
from contactstudy.case.gridding import choose_grid
from contactstudy.case.roller import Roller
from contactstudy.near_names import suggesting

__all__ = ["Case", "Roller", "choose_grid", "roughness"]

if not TYPE_CHECKING:  # to a type checker, a module with __getattr__ has every name
    __getattr__ = suggesting(__name__, __all__)
