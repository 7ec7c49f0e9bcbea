"""The whole case: contact, then stresses, in one Dataset."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.discretisation import discretisation_error
from contactstudy.arrays.cells import labelled_cells
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe
from contactstudy.case.case import Case
from contactstudy.case.gridding import choose_grid, first_that_holds, widening_grids
from contactstudy.case.roughness import heights_on
from contactstudy.contact.solve import solve_contact
from contactstudy.errors import InvalidInputError, WindowError
from contactstudy.fields.positions import Positions
from contactstudy.fields.stress import end_traction_residual, stress_field

DEPTHS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0, 5.0)
"""Default depths of the stresses, over the Hertz half-width."""

LEAST_CELLS = 8
"""Along each axis, for an estimate of the discretisation error."""

LEAST_CONTACT = 1.0
"""Length over the Hertz half-width that a tilted roller has to touch on, if it touches at its end."""

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
    roughness: xr.DataArray | None = None,
    error_estimate: bool = False,
    tolerance: float = 1e-6,
) -> xr.Dataset:
    """Solve a case: the contact, then the stresses in the body.

    Parameters
    ----------
    case : Case
        Body, roller, load and friction.
    grid : Grid, optional
        Cells of pressure and gap; default: chosen from the case by `choose_grid`, wider where the contact asks for it.
    x, y : sequence of float, optional
        Positions of the stresses, metres; default: the cell centres.
    z : sequence of float, optional
        Depths of the stresses, metres; default: from 0 to 5 Hertz half-widths.
    stresses : bool
        Whether to compute the stresses at all.
    roughness : DataArray (x, y), optional
        Heights of the surfaces in metres, positive out of them, as from `contactstudy.roughness`: they are taken off
        the gap, interpolated linearly to the cell centres, which they must cover, if they lie on other cells.
    error_estimate : bool
        Whether to solve the contact on half the cells as well, and state peak and end pressure and half-width with
        their discretisation error, see `contactstudy.analysis.discretisation.discretisation_error`.
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
        If the grid does not fit the body, a position lies outside it, the roughness does not cover the grid, or
        a tilted roller touches within one Hertz half-width of its end only.
    WindowError
        If the contact reaches the edge of the grid given, or of the widest one that is tried.

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
        grid, gap, result = _with_room(case, roughness, tolerance)
    else:
        checks.instance("grid", grid, Grid, "a Grid")
        gap = _initial_gap(case, grid, roughness)
        result = _contact(case, gap, tolerance)
    if error_estimate:
        if min(grid.shape) < LEAST_CELLS:
            raise InvalidInputError("grid", grid.shape, f"at least {LEAST_CELLS} cells each way for an error estimate")
        if roughness is not None:
            raise InvalidInputError("error_estimate", True, "False with roughness, which other cells would not resolve")
        coarse = _contact(case, _initial_gap(case, grid.coarsened(), None), tolerance)
        result = result.assign(discretisation_error(result, coarse).data_vars)
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


def _with_room(case: Case, roughness: xr.DataArray | None, tolerance: float) -> tuple[Grid, xr.DataArray, xr.Dataset]:
    """Grid, initial gap and contact of a case on the first of some wider and wider windows that holds it.

    Rough surfaces are known where they were measured or made: their window is the first.
    """

    def within(grid: Grid) -> tuple[Grid, xr.DataArray, xr.Dataset]:
        gap = _initial_gap(case, grid, roughness)
        return grid, gap, _contact(case, gap, tolerance)

    return first_that_holds(widening_grids(case) if roughness is None else [choose_grid(case)], within)


def _initial_gap(case: Case, grid: Grid, roughness: xr.DataArray | None) -> xr.DataArray:
    """Gap of a case before deformation, less the heights of its rough surfaces."""
    clearance = case.gap(grid)
    if not np.isfinite(clearance).any():
        raise InvalidInputError(
            "grid",
            grid.shape,
            f"such that a cell's centre lies under the roller, which faces the body over {case.contact_length:.3g} m",
            "move the roller by end_distance, or take more cells along x",
        )
    if roughness is not None:
        clearance = clearance - heights_on(grid, roughness)
    return xr.DataArray(clearance, coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))


def _contact(case: Case, gap: xr.DataArray, tolerance: float) -> xr.Dataset:
    """Contact of a case with a given gap."""
    try:
        result = solve_contact(
            case.body,
            gap,
            case.normal_load,
            case.friction,
            case.coupled,
            load_position=case.load_position,
            counterbody=case.counterbody,
            tolerance=tolerance,
        )
    except WindowError as error:
        advice = f"{error}; choose_grid(case, window=..., margin=...) makes a wider one"
        if not case.tilt and case.load_position is None:
            raise WindowError(advice) from error
        raise WindowError(f"{_inclination(case)}, and so deep at the roller's end that {advice}") from error
    _check_on_its_length(case, gap, result)
    result["tilt"] = result["tilt"].copy(data=result["tilt"] + case.tilt)
    result["tilt"].attrs["centre"] = "the roller's mid-length" if case.load_position is None else "load_position"
    return result


def _inclination(case: Case) -> str:
    """Name what inclines the roller of a case, for messages."""
    if case.load_position is not None:
        return f"load_position = {case.load_position:g} m"
    return f"tilt = {case.tilt:g} rad"


def _check_on_its_length(case: Case, gap: xr.DataArray, result: xr.Dataset) -> None:
    """Raise if a tilted roller has left its length and stands on its end."""
    if not case.tilt and case.load_position is None:
        return
    facing = np.flatnonzero(np.isfinite(gap.values).any(axis=1))
    touching = np.flatnonzero(result["pressure"].values.any(axis=1))
    at_end = touching[0] == facing[0] or touching[-1] == facing[-1]
    length = touching.size * case.contact_length / facing.size
    if at_end and length < LEAST_CONTACT * case.hertz_half_width < case.contact_length:
        name = "tilt" if case.load_position is None else "load_position"
        raise InvalidInputError(
            name,
            getattr(case, name),
            f"such that the contact reaches further from the roller's end than {LEAST_CONTACT:g} half-width a, "
            f"{case.hertz_half_width:.3g} m, not {length:.3g} m",
            "tilt the roller less or load it nearer to its middle",
        )


def roller_stress(
    case: Case,
    pressure: xr.DataArray,
    x: Positions | None = None,
    y: Positions | None = None,
    z: Positions = (0.0,),
) -> xr.Dataset:
    """Stresses in an elastic roller.

    Parameters
    ----------
    case : Case
        The case; its roller has a material.
    pressure : DataArray (x, y)
        Contact pressure on the body's cells, Pa, as in the result of `solve`.
    x, y : sequence of float, optional
        Positions, metres: x from the roller's own end I, y as on the body; default: the roller's cell centres.
    z : sequence of float
        Depths into the roller, metres, not negative.

    Returns
    -------
    Dataset
        As from `stress_field`. The traction on the roller is opposite to that on the body.

    Raises
    ------
    InvalidInputError
        If the roller is rigid, or an argument is of the wrong kind or outside the roller.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller
    >>> steel = Material(210e9, 0.3)
    >>> body = FiniteLengthSpace(length=0.5e-3, material=steel)
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.5e-3, material=steel), max_pressure=1.5e9)
    >>> result = solve(case, y=[0.0], z=[5e-5])
    >>> inside = roller_stress(case, result.pressure, y=[0.0], z=[5e-5])  # two equal bodies carry equal stresses
    >>> bool(np.allclose(inside.von_mises.values, result.von_mises.values, rtol=1e-6))
    True
    """
    checks.instance("case", case, Case, "a Case")
    if case.counterbody is None:
        raise InvalidInputError("case.roller.material", None, "a Material: a rigid roller has no stresses")
    values, grid = labelled_cells("pressure", pressure)
    own = case.counterbody.own_grid(grid)
    carried = xr.DataArray(case.counterbody.load_on(grid, values), coords={"x": own.x, "y": own.y}, dims=("x", "y"))
    return stress_field(case.counterbody.body, carried, -case.friction, x, y, z)
