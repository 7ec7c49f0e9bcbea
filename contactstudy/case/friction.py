"""Coefficient of friction: a number, or values along the roller's axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.units import in_si
from contactstudy.case.motion import Motion, Sliding
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError


@dataclass(frozen=True)
class AxialFriction:
    """Friction that varies along the axis: linear between positions, constant beyond the first and the last.

    Parameters
    ----------
    x : tuple of float
        Increasing positions, metres.
    values : tuple of float
        Coefficient there.

    Examples
    --------
    >>> friction = AxialFriction((0.0, 1e-3), (-0.1, 0.1))
    >>> friction.at(np.array([0.25e-3, 2e-3])).ravel().tolist()
    [-0.05, 0.1]
    """

    x: tuple[float, ...]
    values: tuple[float, ...]

    def at(self, x: FloatArray) -> FloatArray:
        """Coefficient at positions `x`: array (x, 1)."""
        return np.asarray(np.interp(x, self.x, self.values))[:, None]

    @property
    def least(self) -> float:
        """Smallest coefficient."""
        return min(self.values)


Friction = float | AxialFriction
"""What a case keeps."""


def checked_friction(friction: object) -> Friction:
    """Return a number or an `AxialFriction` from a number or a DataArray along x.

    Raises
    ------
    InvalidInputError
        If it is neither, or its positions do not increase.
    """
    if isinstance(friction, AxialFriction):
        return friction
    if not isinstance(friction, xr.DataArray) or not friction.dims:
        return checks.finite("friction", friction)
    if friction.dims != ("x",) or "x" not in friction.coords:
        raise InvalidInputError("friction.dims", friction.dims, "('x',) with the coordinate x, metres, or a number")
    friction = in_si("friction", friction, "1")
    x = checks.coordinates("friction.x", friction["x"].values)
    values = checks.coordinates("friction", friction.values, "1")
    if (np.diff(x) <= 0).any():
        raise InvalidInputError("friction.x", x.tolist(), "increasing (metres)")
    return AxialFriction(tuple(x.tolist()), tuple(values.tolist()))


def on_columns(friction: Friction, x: FloatArray) -> float | FloatArray:
    """Coefficient on columns of cells at `x`: a number or an array (x, 1)."""
    return friction.at(x) if isinstance(friction, AxialFriction) else friction


def check_coupled(friction: Friction, motion: Motion, *, coupled: bool) -> None:
    """Raise if a motion cannot have this friction, or if it cannot displace the surface normally."""
    least = friction.least if isinstance(friction, AxialFriction) else friction
    if not isinstance(motion, Sliding):
        if least < 0:
            allowed = "not below zero with stick and slip: the slip turns the traction round"
            raise InvalidInputError("friction", least, allowed)
    elif coupled and isinstance(friction, AxialFriction):
        raise InvalidInputError("coupled", True, "False in full sliding with friction that varies along the axis")
