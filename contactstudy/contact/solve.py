"""Contact of a body with a rigid shape or a second body, from labelled gap to labelled result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from numbers import Real

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.cells import cell_coordinates, labelled_cells
from contactstudy.arrays.units import in_si
from contactstudy.arrays.variables import describe, without_error
from contactstudy.bodies.counterbody import Counterbody
from contactstudy.bodies.models import Body
from contactstudy.cache import ArrayKey
from contactstudy.case.friction import Friction, check_coupled, checked_friction, on_columns
from contactstudy.case.motion import KINDS, MOTIONS, Motion, Shift, Sliding
from contactstudy.checks import FloatArray
from contactstudy.contact.contact import Contact, Settings, Shape, contact_of
from contactstudy.contact.frictional import frictional_contact, labelled
from contactstudy.contact.prescribed import Prescribed
from contactstudy.errors import InvalidInputError
from contactstudy.fields.part import REFERENCE_LENGTHS
from contactstudy.fields.prescribed import prescribed_loads
from contactstudy.fields.surface import displacement_reference
from contactstudy.interrupts import BriefInterrupt
from contactstudy.kernels.load import Load

FULL_SLIDING = Sliding()
"""The default motion."""


def solve_contact(
    body: Body,
    gap: xr.DataArray,
    load: float | None = None,
    friction: Friction | xr.DataArray = 0.0,
    coupled: bool = False,
    *,
    approach: float | Sequence[float] | None = None,
    load_position: float | None = None,
    counterbody: Counterbody | None = None,
    motion: Motion = FULL_SLIDING,
    after: xr.Dataset | None = None,
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
    friction : float or DataArray (x)
        Coefficient ``f``, a number or values at positions along x with lines between: in full sliding the shear
        traction on the body is ``f`` times the pressure along +y; in any other motion that is the bound on it.
    coupled : bool
        Whether the friction also displaces the surfaces normally, which changes pressure and contact (it cannot when
        Poisson's ratio is 1/2, nor between half-spaces of one material).
    approach : float or sequence of float, optional
        How far the shape is pressed down from first touch, metres, relative to the reference of `displacement_z`. With
        several, the result has a dimension `approach`.
    load_position : float, optional
        Position x on which the load acts, metres: the shape tilts until the pressure balances it. Default: the shape
        keeps its inclination, whatever moment that takes.
    counterbody : Counterbody, optional
        Second elastic body, of which `gap` is the shape. Default: the shape is rigid.
    motion : Sliding, Shift or Rolling
        How the shape moves against the body. Default: full sliding.
    after : Dataset, optional
        Result of the step before, on the same cells: a `Shift` then goes on from its pressure and tractions instead of
        from rest. Loads and shifts of a history are solved one after the other.
    tolerance : float
        Bound on the violation of the gap conditions, over the variation of the displacement, and on the last change
        of the pressure, over its sum.
    max_iterations : int
        Bound on the iterations.

    Returns
    -------
    Dataset
        `pressure`, `traction_y`, `gap`, `displacement_z` (of `body`) (x, y); `normal_load`, `approach` (where the load
        acts, or at ``x = 0``), `tilt`, `load_position` of the resultant, `iterations`, `converged`; and the
        certificate, recomputed from the pressure alone: `load_error`, `penetration_error`, `open_pressure_error`. With
        stick and slip, instead of `traction_y`: `traction_x`, `traction_y`, `slip_x`, `slip_y`, `stick` (x, y);
        `force_x`, `force_y`, `moment_z` on the body about the middle of the shape; `longitudinal_creepage`,
        `lateral_creepage`, `spin`, or `shift_x`, `shift_y`; `friction_work`; and the certificate of the tractions,
        `bound_error`, `slip_error` and `force_error`.

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
    if not isinstance(approach, (Real, str, type(None))):
        if after is not None:
            raise InvalidInputError("after", "a result", "left out with several approaches, which are no history")
        steps = checks.coordinates("approach", approach, "metres").tolist()
        each = partial(
            solve_contact,
            body,
            gap,
            load,
            friction,
            coupled,
            load_position=load_position,
            counterbody=counterbody,
            motion=motion,
            tolerance=tolerance,
            max_iterations=max_iterations,
        )
        results = [each(approach=step).set_coords("approach") for step in steps]
        return xr.concat(results, "approach", data_vars="all", coords="minimal", compat="override", join="exact")
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    if counterbody is not None:
        checks.instance("counterbody", counterbody, Counterbody, "a Counterbody")
    gap = in_si("gap", gap, "m")
    clearance, grid = labelled_cells("gap", gap, extent=body.extent, infinite=True)
    if not np.isfinite(clearance).any():
        raise InvalidInputError("gap", "infinite everywhere", "finite where the shape can touch the body")
    # Where nothing can be pressed, cells may be as narrow as the room that is left to an end.
    grid.check_growth(np.asarray(np.isfinite(clearance).any(axis=1)))
    checks.instance("coupled", coupled, (bool, np.bool_), "True or False")
    checks.instance("motion", motion, KINDS, MOTIONS)
    coefficient = checked_friction(friction)
    check_coupled(coefficient, motion, coupled=bool(coupled))
    on_cells = on_columns(coefficient, grid.x)
    shape = Shape(
        body,
        grid,
        ArrayKey(clearance),
        Prescribed(load, load_position, approach).checked(clearance, grid),
        counterbody,
        # Friction that does not bend the surface does not change the pressure: one contact serves all of a sweep.
        on_cells if coupled and isinstance(motion, Sliding) and isinstance(on_cells, float) else 0.0,
    )
    settings = Settings(checks.positive("tolerance", tolerance), checks.count("max_iterations", max_iterations))
    x, y = gap["x"].values, gap["y"].values
    with BriefInterrupt():
        if isinstance(motion, Sliding):
            contact = contact_of(shape, settings)
            contact.warn_unless_converged()
            return contact_dataset(contact, on_cells, x=x, y=y)
        before = None if after is None else _before(after, motion, gap, body)
        facing = np.flatnonzero(np.isfinite(clearance).any(axis=1))
        middle = 0.5 * float(grid.x_edges[facing[0]] + grid.x_edges[facing[-1] + 1])
        found = frictional_contact(shape, settings, motion, on_cells, middle, coupled=bool(coupled), before=before)
        found.warn_unless_converged()
        return labelled(contact_dataset(found.contact, on_cells, x=x, y=y), found)


def _before(after: xr.Dataset, motion: Motion, gap: xr.DataArray, body: Body) -> dict[Load, FloatArray]:
    """Pressure and tractions of the step before, checked."""
    checks.instance("after", after, xr.Dataset, "a result of solve_contact")
    if not isinstance(motion, Shift):
        raise InvalidInputError("motion", motion, "a Shift(...) with after: rolling is steady, it has no step before")
    names = {"pressure": Load.NORMAL, "traction_x": Load.ALONG_X, "traction_y": Load.ALONG_Y}
    missing = [name for name in names if name not in after]
    if missing:
        raise InvalidInputError("after", f"without {missing[0]}", "a result with stick and slip")
    grid = labelled_cells("gap", gap, extent=body.extent, infinite=True)[1]
    given = prescribed_loads(body, after["pressure"], 0.0, after["traction_x"], after["traction_y"])
    if given.grid.shape != grid.shape or not np.allclose(given.grid.x, grid.x) or not np.allclose(given.grid.y, grid.y):
        raise InvalidInputError("after", f"on {given.grid.shape} cells", "on the cells of the gap")
    return {load: top.values for load, top in given.loads.items()}


def contact_dataset(contact: Contact, friction: float | FloatArray, *, x: FloatArray, y: FloatArray) -> xr.Dataset:
    """Label a contact; `x` and `y` are the cell centres as the caller wrote them."""
    shape = contact.shape
    # The contact may be kept for other cases: what the caller does to a result must not change it.
    fields = {
        "pressure": contact.pressure.copy(),
        "traction_y": friction * contact.pressure,
        "gap": contact.gap.copy(),
        "displacement_z": contact.displacement.copy(),
    }
    scalars: dict[str, float | int | bool] = {
        "normal_load": contact.carried if shape.prescribed.load is None else shape.prescribed.load,
        "approach": contact.approach,
        "tilt": contact.tilt,
        "load_position": contact.load_position,
        "iterations": contact.iterations,
        "converged": contact.converged,
        **asdict(contact.certificate),
    }
    result = xr.Dataset(
        {name: (("x", "y"), values) for name, values in fields.items()} | scalars,
        coords={"x": x, "y": y} | cell_coordinates(shape.grid),
    )
    result["displacement_z"].attrs |= displacement_reference(contact.reference)
    for name in ("approach", "tilt"):
        result[name].attrs["reference"] = motion_reference(shape.body, shape.counterbody)
    prescribed = {"approach": shape.prescribed.approach, "load_position": shape.prescribed.load_position}
    result = without_error(result, *(name for name, value in prescribed.items() if value is None))
    return describe(result, "contact of a shape with an elastic body")


def motion_reference(body: Body, counterbody: Counterbody | None) -> str:
    """Say what approach and tilt are relative to."""
    tops = {"body": body} if counterbody is None else {"body": body, "counterbody": counterbody.body}
    places = [
        f"{name} at |y| = {REFERENCE_LENGTHS * (each.extent[1] - each.extent[0]):g} m"
        if np.isfinite(each.extent).all()
        else f"{name} far away"
        for name, each in tops.items()
    ]
    return f"undeformed top: {', '.join(places)}"
