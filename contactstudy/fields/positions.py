"""Where a field is evaluated: the tensor product of any x, y and z inside a body."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.units import numbers_in_si
from contactstudy.bodies.models import Body
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

FARTHEST = 1e4
"""Distance over the size of load and body up to which fields are computed: the work grows with it along y."""

Positions = Sequence[float] | npt.ArrayLike
Labels = tuple[FloatArray, FloatArray]


class FieldPositions(NamedTuple):
    """Checked positions, metres.

    Attributes
    ----------
    x, y, z : array
        Where to evaluate.
    label_x, label_y : array
        Coordinates of the result: the pressure's own, unrounded, where no others were given.
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    label_x: FloatArray
    label_y: FloatArray

    @property
    def axes(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The three axes."""
        return self.x, self.y, self.z

    def dataset(self, fields: Mapping[str, FloatArray]) -> xr.Dataset:
        """Label fields (x, y, z)."""
        return xr.Dataset(
            {name: (("x", "y", "z"), values) for name, values in fields.items()},
            coords={"x": self.label_x, "y": self.label_y, "z": self.z},
        )


def field_positions(
    body: Body, grid: Grid, x: Positions | None, y: Positions | None, z: Positions, own: Labels | None = None
) -> FieldPositions:
    """Positions of a field in a body.

    Parameters
    ----------
    body : Body
        The body.
    grid : Grid
        Cells of the load.
    x, y : sequence of float or None
        Positions, metres; None: the cell centres.
    z : sequence of float
        Depths, metres.
    own : pair of array, optional
        Labels of the cell centres, where they differ from the grid's by rounding.

    Raises
    ------
    InvalidInputError
        If a position lies outside the body, or the grid does not fit it.
    """
    body.check_span(grid)
    at_x = _inside_body(body, grid.x if x is None else checks.coordinates("x", numbers_in_si("x", x, "m")), grid)
    at_y = grid.y if y is None else checks.coordinates("y", numbers_in_si("y", y, "m"))
    at_z = checks.coordinates("z", numbers_in_si("z", z, "m"))
    if (at_z < 0).any():
        raise InvalidInputError("z", float(at_z.min()), "not negative (metres below the top)")
    low, high = body.extent
    size = max(grid.x_range[1] - grid.x_range[0], grid.y_range[1] - grid.y_range[0])
    size = max(size, high - low) if np.isfinite([low, high]).all() else size
    for name, values in (("x", at_x), ("y", at_y), ("z", at_z)):
        farthest = float(values[np.abs(values).argmax()])
        if abs(farthest) > FARTHEST * size:
            raise InvalidInputError(
                name, farthest, f"within {FARTHEST:g} times the size of load and body, {FARTHEST * size:g} m"
            )
    own_x, own_y = own or (grid.x, grid.y)
    return FieldPositions(at_x, at_y, at_z, own_x if x is None else at_x, own_y if y is None else at_y)


def _inside_body(body: Body, x: FloatArray, grid: Grid) -> FloatArray:
    """Positions of which those within rounding of an end lie on it; raise for any outside."""
    low, high = body.extent
    rounding = 1e-9 * grid.dx
    outside = (x < low - rounding) | (x > high + rounding)
    if outside.any():
        raise InvalidInputError("x", float(x[outside][0]), f"inside the body, {low:g} to {high:g} m")
    return np.where(x < low + rounding, low, np.where(x > high - rounding, high, x))
