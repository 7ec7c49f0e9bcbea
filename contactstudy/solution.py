"""The whole case: contact, then stresses, in one Dataset."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.case import Case, choose_grid
from contactstudy.contact import solve_contact
from contactstudy.dataset import describe
from contactstudy.errors import InvalidInputError
from contactstudy.grid import Grid
from contactstudy.positions import Positions
from contactstudy.stress import end_traction_residual, stress_field

DEPTHS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0, 5.0)
"""Default depths of the stresses, over the Hertz half-width."""

RESIDUAL_DEPTHS = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
RESIDUAL_POSITIONS = (0.0, 0.5, 0.9, 1.1)


def solve(
    case: Case,
    grid: Grid | None = None,
    *,
    x: Positions | None = None,
    y: Positions | None = None,
    z: Positions | None = None,
    stresses: bool = True,
    tolerance: float = 1e-6,
) -> xr.Dataset:
    """Solve a case: the contact, then the stresses in the body.

    Parameters
    ----------
    case : Case
        Body, roller, load and friction.
    grid : Grid, optional
        Cells of pressure and gap; default: chosen from the case by `choose_grid`.
    x, y : sequence of float, optional
        Positions of the stresses, metres; default: the cell centres.
    z : sequence of float, optional
        Depths of the stresses, metres; default: from 0 to 5 Hertz half-widths.
    stresses : bool
        Whether to compute the stresses at all.
    tolerance : float
        Tolerance of the contact, see `solve_contact`.

    Returns
    -------
    Dataset
        Everything that `solve_contact` and `stress_field` return, with `hertz_half_width`, `hertz_max_pressure` and
        `end_traction_residual`. Stresses at positions of their own have the dimensions ``(x_field, y_field, z)``
        instead of ``(x, y, z)``.

    Raises
    ------
    InvalidInputError
        If the grid does not fit the body or a position lies outside it.
    WindowError
        If the contact reaches the grid's edge.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller
    >>> body = FiniteLengthSpace(length=0.5e-3, material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.5e-3), max_pressure=1.5e9)
    >>> result = solve(case, stresses=False)
    >>> bool(result.converged), round(float(result.pressure.max() / result.hertz_max_pressure), 3)
    (True, 1.024)
    """
    checks.instance("case", case, Case, "a Case")
    if grid is None:
        grid = choose_grid(case)
    checks.instance("grid", grid, Grid, "a Grid")
    clearance = case.gap(grid)
    if not np.isfinite(clearance).any():
        raise InvalidInputError("grid", grid, "a grid with cells under the roller")
    gap = xr.DataArray(clearance, coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    result = solve_contact(case.body, gap, case.normal_load, case.friction, case.coupled, tolerance=tolerance)
    half_width = case.hertz_half_width
    result["initial_gap"] = gap
    result["hertz_half_width"] = half_width
    result["hertz_max_pressure"] = case.hertz_max_pressure
    pressure = result["pressure"].values
    result["end_traction_residual"] = end_traction_residual(
        case.body,
        pressure,
        case.friction,
        grid,
        half_width * np.array(RESIDUAL_POSITIONS),
        half_width * np.array(RESIDUAL_DEPTHS),
    )
    if stresses:
        depths = half_width * np.array(DEPTHS) if z is None else z
        field = stress_field(case.body, result["pressure"], case.friction, x, y, depths)
        if x is not None or y is not None:
            field = field.rename({"x": "x_field", "y": "y_field"})
        result = result.assign_coords(field.coords).assign(field.data_vars)
    return describe(result, "roller on an elastic body: contact and stresses")
