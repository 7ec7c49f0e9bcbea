"""Stresses in the body of a case, their largest value, and what they leave on its free ends."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from contactstudy.analysis.largest import settled_peak
from contactstudy.arrays.grid import Grid
from contactstudy.case.case import Case
from contactstudy.checks import FloatArray
from contactstudy.fields.loads import TopLoad
from contactstudy.fields.positions import Positions, field_positions
from contactstudy.fields.stress import contact_stresses, end_traction_residual
from contactstudy.kernels.load import Load

DEPTHS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0, 5.0)
"""Default depths of the stresses, over the Hertz half-width."""

RESIDUAL_DEPTHS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
"""Depths at which `end_traction_residual` looks at the ends, over the Hertz half-width."""

RESIDUAL_POSITIONS = (-1.1, -0.9, -0.5, 0.0, 0.5, 0.9, 1.1)
"""Positions along y, likewise."""

RESIDUAL_COVERS = (
    f"the largest at depths from {RESIDUAL_DEPTHS[0]} a to {RESIDUAL_DEPTHS[-1]} a and |y| up to "
    f"{RESIDUAL_POSITIONS[-1]} a; nearer to the top of a loaded end more is left, about 1e-4 at 0.01 a, 1e-3 at 0.004 a"
)
"""What it says and what it does not."""


def with_stresses(
    result: xr.Dataset,
    case: Case,
    grid: Grid,
    loads: Mapping[Load, TopLoad],
    x: Positions | None,
    y: Positions | None,
    z: Positions | None,
) -> xr.Dataset:
    """Add stresses, the largest von Mises stress wherever they are looked at, and what is left on the free ends."""
    depths = case.hertz_half_width * np.array(DEPTHS) if z is None else z
    positions = field_positions(case.body, grid, x, y, depths)
    field, residual, largest = contact_stresses(case.body, loads, grid, positions, *_places_on_ends(case))
    if x is not None or y is not None:
        field = field.rename({"x": "x_field", "y": "y_field"})
    result = result.assign_coords(field.coords).assign(field.data_vars)
    return _with_residual(result.assign(settled_peak(result, *largest).data_vars), residual)


def without_stresses(result: xr.Dataset, case: Case, grid: Grid, loads: Mapping[Load, TopLoad]) -> xr.Dataset:
    """Add what is left on the free ends, and no stresses."""
    return _with_residual(result, end_traction_residual(case.body, loads, grid, *_places_on_ends(case)))


def _places_on_ends(case: Case) -> list[FloatArray]:
    """Positions along y, and depths, at which the free ends are looked at."""
    return [case.hertz_half_width * np.array(places) for places in (RESIDUAL_POSITIONS, RESIDUAL_DEPTHS)]


def _with_residual(result: xr.Dataset, residual: float) -> xr.Dataset:
    """Add the largest traction that is left on the free ends."""
    found = result.assign(end_traction_residual=residual)
    found["end_traction_residual"].attrs["comment"] = RESIDUAL_COVERS
    return found
