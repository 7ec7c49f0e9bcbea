"""Fatigue of a raceway that rollers pass: measures of the stress history of every material point, and relative life.

The field along y at one (x, z) is the history of the material point there, together with the unloaded state before
and after; the window along y must hold the extremes, see :func:`window_remainder`. The orthogonal shear range itself
is :func:`contactstudy.orthogonal_shear_range`.
"""

from contactstudy.fatigue.critical_plane import findley
from contactstudy.fatigue.history import window_remainder
from contactstudy.fatigue.in_plane import shakedown_in_plane
from contactstudy.fatigue.invariant_criteria import crossland, dang_van
from contactstudy.fatigue.life import LifeExponents, relative_life
from contactstudy.fatigue.limits import FatigueLimits
from contactstudy.fatigue.risk import ioannides_harris, lundberg_palmgren
from contactstudy.fatigue.shakedown import shakedown, shakedown_limit
from contactstudy.near_names import suggest

__all__ = [
    "FatigueLimits",
    "LifeExponents",
    "crossland",
    "dang_van",
    "findley",
    "ioannides_harris",
    "lundberg_palmgren",
    "relative_life",
    "shakedown",
    "shakedown_in_plane",
    "shakedown_limit",
    "window_remainder",
]

suggest(__name__, __all__)
