"""Contact of a body with a rigid shape or a second body: pressure and gap, with their certificate."""

from __future__ import annotations

import warnings

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.cells import labelled_cells
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe
from contactstudy.bodies.counterbody import Counterbody
from contactstudy.bodies.models import Body
from contactstudy.cache import BoundedCache, digest
from contactstudy.checks import FloatArray
from contactstudy.contact.conjugate_gradients import ContactIterate, Resultants
from contactstudy.contact.pair import PairOperator
from contactstudy.contact.problem import ContactOperator, ContactProblem, solve_coupled, solve_normal
from contactstudy.errors import ConvergenceWarning, InvalidInputError, WindowError
from contactstudy.fields.surface import REFERENCE_LENGTHS, surface_operator
from contactstudy.threads import one_blas_thread

# A gap counts as open when it exceeds this many tolerances of the displacement's variation.
OPEN_TOLERANCES = 10.0

_CONTACTS: BoundedCache[ContactIterate] = BoundedCache(2**26, lambda iterate: iterate.pressure.nbytes)


def solve_contact(
    body: Body,
    gap: xr.DataArray,
    load: float | None = None,
    friction: float = 0.0,
    coupled: bool = False,
    *,
    approach: float | None = None,
    load_position: float | None = None,
    counterbody: Counterbody | None = None,
    tolerance: float = 1e-6,
    max_iterations: int = 500,
) -> xr.Dataset:
    """Press a rigid shape, or a second elastic body, on a body.

    Parameters
    ----------
    body : Body
        The elastic body.
    gap : DataArray (x, y)
        Initial gap at the cell centres of a uniform grid, metres: 0 at first touch, infinite where there is nothing
        to touch. On a finite-length space the cells span the body from end to end; elsewhere they must leave room
        around the contact.
    load : float, optional
        Normal load, N. Either this or `approach` is given.
    friction : float
        Coefficient ``f``; the shear traction on the body is ``f`` times the pressure along +y.
    coupled : bool
        Whether the friction also displaces the surfaces normally, which changes pressure and contact (it cannot when
        Poisson's ratio is 1/2, nor between half-spaces of one material).
    approach : float, optional
        How far the shape is pressed down from first touch, metres, relative to the reference of `displacement_z`.
    load_position : float, optional
        Position x on which the load acts, metres: the shape tilts until the pressure balances it. Default: the shape
        keeps its inclination, whatever moment that takes.
    counterbody : Counterbody, optional
        Second elastic body, of which `gap` is the shape. Default: the shape is rigid.
    tolerance : float
        Bound on the violation of the gap conditions, over the variation of the displacement, and on the last change
        of the pressure, over its sum.
    max_iterations : int
        Bound on the iterations.

    Returns
    -------
    Dataset
        `pressure`, `shear_traction`, `gap`, `displacement_z` (of `body`) (x, y); `load`, `approach` (where the load
        acts, or at ``x = 0``), `tilt`, `load_position` of the resultant, `iterations`, `converged`; and the
        certificate, recomputed from the pressure alone: `load_error`, `penetration_error`, `open_pressure_error`.

    Raises
    ------
    InvalidInputError
        If an argument is of the wrong kind or out of range, or the grid does not fit a body.
    WindowError
        If the contact reaches an edge of the grid where the body goes on.

    Warns
    -----
    ConvergenceWarning
        If the iteration stopped before its tolerance; `converged` is then False.

    Notes
    -----
    A finite-length body has no absolute displacement, nor an absolute tilt: an eccentric load tilts it by an amount
    that grows like the logarithm of the distance from which it is seen. `approach` and `tilt` are those of the shape
    relative to the top at the distance along y stated in their attribute `reference`.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from contactstudy import HalfSpace, Material
    >>> centres = np.linspace(-1.5, 1.5, 65)
    >>> gap = xr.DataArray(
    ...     0.5 * (centres[:, None] ** 2 + centres**2), coords={"x": centres, "y": centres}, dims=("x", "y")
    ... )
    >>> contact = solve_contact(HalfSpace(material=Material(0.75, 0.5)), gap, load=4 / 3)
    >>> bool(contact.converged), round(float(contact.pressure.max()), 2)
    (True, 0.64)
    """
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    clearance, grid = labelled_cells("gap", gap, infinite=True)
    if not np.isfinite(clearance).any():
        raise InvalidInputError("gap", "infinite everywhere", "finite where the shape can touch the body")
    resultants, lowered = _prescribed(clearance, grid, load, approach, load_position)
    friction = checks.finite("friction", friction)
    checks.instance("coupled", coupled, (bool, np.bool_), "True or False")
    tolerance = checks.positive("tolerance", tolerance)
    max_iterations = checks.count("max_iterations", max_iterations)
    bends = bool(coupled) and friction != 0
    with one_blas_thread():
        if counterbody is None:
            own = surface_operator(body, grid, tangential=bends)
            operator: ContactOperator = own
        else:
            checks.instance("counterbody", counterbody, Counterbody, "a Counterbody")
            pair = PairOperator(body, counterbody, grid, tangential=bends)
            operator, own = pair, pair.body
        problem = ContactProblem(grid, clearance - lowered, resultants, friction, tolerance, max_iterations)
        # Friction that does not bend the surface does not change the pressure: one contact serves all of a sweep.
        prescribed = (load, approach, load_position, friction if bends else 0.0, tolerance, max_iterations)
        key = (body, counterbody, grid, digest(clearance), prescribed)
        solve = solve_coupled if bends else solve_normal
        iterate = _CONTACTS.get(key, lambda: solve(operator, problem))
        pressure = iterate.pressure.copy()
        traction = friction * pressure
        displacement = own(pressure, traction if bends else None)
        approached = displacement if counterbody is None else operator(pressure, traction if bends else None)
    _check_window(body, pressure, np.isfinite(clearance))
    if not iterate.converged:
        warnings.warn(
            f"the contact iteration stopped after {iterate.applications} operator applications without reaching "
            f"tolerance = {tolerance:g}; raise max_iterations (now {max_iterations}) or coarsen the grid",
            ConvergenceWarning,
            stacklevel=2,
        )
    touching = pressure > 0
    height = clearance + approached
    tilt = iterate.motion[1] if load_position is not None else 0.0
    if resultants.lever is not None:
        height = height - tilt * resultants.lever
    total = pressure.sum()
    sunk = float((pressure * np.where(touching, height, 0.0)).sum() / total) if approach is None else lowered
    opening = height - sunk
    variation = float(np.ptp(approached))
    violation = max(float(np.abs(opening[touching]).max()), float(-opening.min()))
    at_open_gap = pressure[opening > OPEN_TOLERANCES * tolerance * variation]
    carried = float(total * grid.cell_area)
    scalars: dict[str, float | int | bool] = {
        "load": carried if load is None else float(load),
        "approach": sunk,
        "tilt": tilt,
        "load_position": float((pressure * grid.x[:, None]).sum() / total),
        "iterations": iterate.applications,
        "converged": iterate.converged,
        "load_error": 0.0 if load is None else carried / load - 1,
        "penetration_error": violation / variation,
        "open_pressure_error": float(at_open_gap.max(initial=0.0) / pressure.max()),
    }
    fields = {
        "pressure": pressure,
        "shear_traction": traction,
        "gap": np.where(np.isfinite(opening), opening, np.inf),
        "displacement_z": displacement,
    }
    result = xr.Dataset(
        {name: (("x", "y"), values) for name, values in fields.items()} | scalars,
        coords={"x": gap["x"].values, "y": gap["y"].values},
    )
    if np.isfinite(own.reference):
        result["displacement_z"].attrs["reference_distance"] = own.reference
        result["displacement_z"].attrs["reference"] = "zero at |y| = reference_distance (m) on the top"
    reference = _reference(body, counterbody)
    for name in ("approach", "tilt"):
        result[name].attrs["reference"] = reference
    return describe(result, "contact of a shape with an elastic body")


def _reference(body: Body, counterbody: Counterbody | None) -> str:
    """Say what approach and tilt are relative to."""
    tops = {"body": body} if counterbody is None else {"body": body, "counterbody": counterbody.body}
    places = [
        f"{name} at |y| = {REFERENCE_LENGTHS * (each.extent[1] - each.extent[0]):g} m"
        if np.isfinite(each.extent).all()
        else f"{name} far away"
        for name, each in tops.items()
    ]
    return f"undeformed top: {', '.join(places)}"


def _prescribed(
    clearance: FloatArray, grid: Grid, load: float | None, approach: float | None, load_position: float | None
) -> tuple[Resultants, float]:
    """Return what is prescribed of the pressure, and how far the shape is lowered before the iteration, metres."""
    if (load is None) == (approach is None):
        raise InvalidInputError("load, approach", (load, approach), "exactly one of the two, the other None")
    if approach is not None:
        lowered = checks.finite("approach", approach, "metres")
        if load_position is not None:
            raise InvalidInputError(
                "load_position", load_position, "None where the approach is prescribed", "prescribe the load instead"
            )
        if lowered <= clearance.min():
            raise InvalidInputError("approach", lowered, f"more than the least gap, {clearance.min():g} m")
        return Resultants(None), lowered
    total = checks.positive("load", load, "N") / grid.cell_area
    if load_position is None:
        return Resultants(total), 0.0
    at = checks.finite("load_position", load_position, "metres")
    columns = grid.x[np.isfinite(clearance).any(axis=1)]
    if not columns[0] < at < columns[-1]:
        raise InvalidInputError(
            "load_position",
            at,
            f"under the shape, between {columns[0]:g} and {columns[-1]:g} m, for it to balance there",
        )
    return Resultants(total, grid.x[:, None] - at), 0.0


def _check_window(body: Body, pressure: FloatArray, possible: np.ndarray) -> None:
    """Raise if the contact reaches an edge of the grid that is not an end of the body."""
    low, high = body.extent
    edges = {"y_min": pressure[:, 0], "y_max": pressure[:, -1]}
    if np.isinf(low):
        edges["x_min"] = pressure[0]
    if np.isinf(high):
        edges["x_max"] = pressure[-1]
    for name, values in edges.items():
        if values.any():
            raise WindowError(
                f"the contact reaches the grid's edge {name} (pressure {values.max():.3g} Pa there): the window is too "
                f"narrow for the load; widen it along {name[0]} or lower the load"
            )
