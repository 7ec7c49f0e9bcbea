"""Rolling-sliding contact of a roller on an elastic body with free end faces."""

from contactstudy.bodies import FiniteLengthSpace, HalfSpace
from contactstudy.case import Case, choose_grid
from contactstudy.grid import Grid
from contactstudy.material import Material
from contactstudy.roller import Roller
