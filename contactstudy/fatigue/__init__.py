"""Fatigue of a raceway that rollers pass: measures of the stress history of every material point, and relative life.

The field along y at one (x, z) is the history of the material point, together with the unloaded state before
and after; the window along y must hold the extremes, see :func:`window_remainder`. The orthogonal shear range
is :func:`contactstudy.stress.orthogonal_shear_range`.
"""

from contactstudy.fatigue.criteria import FatigueLimits, crossland, dang_van, findley
from contactstudy.fatigue.history import window_remainder
from contactstudy.fatigue.life import LifeExponents, ioannides_harris, lundberg_palmgren, relative_life
from contactstudy.fatigue.shakedown import shakedown, shakedown_in_plane, shakedown_limit

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
