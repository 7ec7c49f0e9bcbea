"""Different profiles on the two halves of one roller."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy import checks
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import Profile, Shape, checked_drop, local_radius

STEP = 1e-10
"""Largest step between the two halves at mid-length, metres: about one atom. Accuracy."""


@dataclass(frozen=True, repr=False)
class Halves(Shape):
    """One profile left and another right of mid-length.

    Each half is what it would be on a roller with that profile at both ends, so lengths in it are those of the whole
    roller.

    Parameters
    ----------
    left, right : Profile
        Profiles for ``x < 0`` and ``x >= 0``. They must meet at mid-length to 1e-10 m.

    Raises
    ------
    InvalidInputError
        If one is not a profile, or (on use) the halves do not meet.

    Examples
    --------
    >>> from contactstudy.profiles import Cylinder, FullCrown
    >>> profile = Halves(left=Cylinder(), right=FullCrown(crown_radius=1.25))
    >>> (1e6 * profile.drop(np.array([-5e-3, 0.0, 5e-3]), length=10e-3)).round(3).tolist()
    [0.0, 0.0, 10.0]
    """

    left: Profile
    right: Profile

    def __post_init__(self) -> None:
        """Check the profiles."""
        for name in ("left", "right"):
            checks.instance(name, getattr(self, name), Profile, "a profile from contactstudy.profiles")

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        middle = np.zeros(1)
        at_left, at_right = (float(checked_drop(half, middle, length)[0]) for half in (self.left, self.right))
        if abs(at_left - at_right) > STEP:
            raise InvalidInputError(
                "left, right", (at_left, at_right), "equal drops at mid-length (metres), so that the halves meet"
            )
        x = np.asarray(x)
        return np.asarray(np.where(x < 0, *(checked_drop(half, x, length) for half in (self.left, self.right))))

    def local_radius(self, x: FloatArray, length: float, radius: float | FloatArray) -> FloatArray:
        """Radius across the roller (m) of each half."""
        left, right = (local_radius(half, x, length, radius) for half in (self.left, self.right))
        return np.asarray(np.where(np.asarray(x) < 0, left, right))
