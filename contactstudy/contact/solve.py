"""Contact of a body with a rigid shape or a second body, from labelled gap to labelled result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from numbers import Real

import numpy as np
import xarray as xr
from scipy.sparse.linalg import LinearOperator

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import cell_coordinates, describe, in_si, labelled_cells, without_error
from contactstudy.bodies.models import Body, Counterbody
from contactstudy.cache import ArrayKey
from contactstudy.case.motion import MOTIONS_TEXT, Friction, Motion, Shift, Sliding, check_friction, evaluate_friction
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.contact import Contact, Settings, Shape, contact_of
from contactstudy.contact.normal.prescribed_loads import PrescribedLoad
from contactstudy.contact.rolling.frictional_contact import frictional_contact
from contactstudy.contact.rolling.tractions import FrictionRequest
from contactstudy.errors import InvalidInputError
from contactstudy.fields.loads import prescribed_loads
from contactstudy.kernels.load import Load

FULL_SLIDING = Sliding()  # the default motion


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactSettings:
    """Settings of :func:`solve_contact`.

    Parameters
    ----------
    coupled : bool
        Physics: whether the friction also displaces the surfaces normally, which changes pressure and contact, except
        at a Poisson's ratio of 1/2 and between half-spaces of one material.
    load_position : float, optional
        Physics: position x of the load, metres; the shape tilts until the pressure balances the load. Default: the
        shape keeps its inclination.
    after : Dataset, optional
        Physics: result of the preceding step on the same cells; a `Shift` starts from the pressure and tractions of
        this result instead of from rest.
    tolerance : float
        Tolerance: bound on the violation of the gap conditions, over the variation of the displacement, and on the last
        change of the pressure, over its sum.
    max_iterations : int
        Speed: bound on the iterations.

    Raises
    ------
    InvalidInputError
        If a value is of the wrong kind or out of range.

    Examples
    --------
    >>> ContactSettings(coupled=True).tolerance
    1e-06
    """

    coupled: bool = False
    load_position: float | None = None
    after: xr.Dataset | None = None
    tolerance: float = 1e-6
    max_iterations: int = 500

    def __post_init__(self) -> None:
        checks.instance("coupled", self.coupled, (bool, np.bool_), "True or False")
        checks.store(self, tolerance=checks.positive("tolerance", self.tolerance))
        checks.store(self, max_iterations=checks.count("max_iterations", self.max_iterations))


DEFAULTS = ContactSettings()  # the default settings


def solve_contact(
    body: Body,
    gap: xr.DataArray,
    *,
    load: float | None = None,
    friction: Friction | xr.DataArray = 0.0,
    approach: float | Sequence[float] | None = None,
    counterbody: Counterbody | None = None,
    surface: LinearOperator | None = None,
    motion: Motion = FULL_SLIDING,
    settings: ContactSettings = DEFAULTS,
) -> xr.Dataset:
    """Press a rigid shape, or a second elastic body, on a body.

    Parameters
    ----------
    body : Body
        The elastic body.
    gap : DataArray (x, y)
        Initial gap at the cell centres of a uniform grid, metres: 0 at first touch, infinite outside
        the shape. On a finite-length space the cells span the body from end to end; elsewhere they must leave room
        around the contact.
    load : float, optional
        Normal load, N; either `load` or `approach`.
    friction : float or DataArray (x)
        Coefficient ``f``, a number or values along x, interpolated linearly: in full sliding the shear
        traction on the body is ``f`` times the pressure along +y; in any other motion this product bounds the traction.
    approach : float or sequence of float, optional
        Displacement of the shape from first touch, metres, relative to the reference of `displacement_z`. With
        several, the result has a dimension `approach`.
    counterbody : Counterbody, optional
        Second elastic body, whose shape is `gap`. Default: the shape is rigid.
    surface : LinearOperator, optional
        Symmetric positive operator from a pressure (x, y) in Pa to the displacement of the surfaces towards each other
        in metres, both raveled, instead of the body's: a coating, a measured compliance, sums of
        `contactstudy.operators.surface_displacement`. `body` then determines the window, the preconditioner and
        the reference of the approach. Full sliding, uncoupled and without `counterbody`.
    motion : Sliding, Shift or Rolling
        Motion of the shape against the body. Default: full sliding.
    settings : ContactSettings
        Coupled friction, position of the load, history, tolerance and bound of the iteration.

    Returns
    -------
    Dataset
        `pressure`, `traction_y`, `gap`, `displacement_z` (of `body`) (x, y); `normal_load`, `approach` (where the load
        acts, or at ``x = 0``), `tilt`, and their `reference_depth` (of a counterbody `roller_reference_depth`);
        `load_position` of the resultant, `iterations`, `converged`; and the certificate, recomputed from the pressure
        alone: `load_error`, `penetration_error`, `open_pressure_error`. With stick and slip, instead of `traction_y`:
        `traction_x`, `traction_y`, `slip_x`, `slip_y`, `stick` (x, y); `force_x`, `force_y`, `moment_z` on the body
        about the middle of the shape; `longitudinal_creepage`, `lateral_creepage`, `spin`, or `shift_x`, `shift_y`;
        `friction_work`; and the certificate of the tractions, `bound_error`, `slip_error` and `force_error`.

    Raises
    ------
    InvalidInputError
        If an argument is of the wrong kind or out of range, or the grid does not fit a body.
    WindowError
        If the contact reaches an edge of the grid inside the body.

    Warns
    -----
    ConvergenceWarning
        If the iteration stopped before its tolerance; `converged` is then False.

    Notes
    -----
    The displacement of a body between two free ends grows with the logarithm of the distance. `approach`, `tilt` and
    `displacement_z` refer to a material line of each body along x, below the load at the depth
    ``body.reference_depth``: the approach to the line's point below the load, the tilt to its least-squares slope.

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
    arguments = dict(locals())
    if not isinstance(approach, (Real, str, type(None))):
        if isinstance(settings, ContactSettings) and settings.after is not None:
            raise InvalidInputError(
                "after", "a result", "omitted with several approaches: solve a history step by step"
            )
        approaches = checks.coordinates("approach", approach, "metres").tolist()
        results = [solve_contact(**arguments | {"approach": step}).set_coords("approach") for step in approaches]
        return xr.concat(results, "approach", data_vars="all", coords="minimal", compat="override", join="exact")
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    if counterbody is not None:
        checks.instance("counterbody", counterbody, Counterbody, "a Counterbody")
    gap = in_si("gap", gap, "m")
    initial_gap, grid = labelled_cells("gap", gap, extent=body.extent, infinite=True)
    if not np.isfinite(initial_gap).any():
        raise InvalidInputError("gap", "infinite everywhere", "finite where the shape can touch the body")
    # Only columns with a finite gap are checked: columns beyond the shape may be as narrow as the face.
    grid.check_growth(np.asarray(np.isfinite(initial_gap).any(axis=1)))
    checks.instance("settings", settings, ContactSettings, "a ContactSettings")
    coupled, previous_step = bool(settings.coupled), settings.after
    checks.instance("motion", motion, Motion, MOTIONS_TEXT)
    cell_friction = evaluate_friction(check_friction(friction, motion, coupled=coupled), grid.x)
    if surface is not None:
        checks.instance("surface", surface, LinearOperator, "a scipy.sparse.linalg.LinearOperator")
        cell_count = grid.cells_x * grid.cells_y
        if surface.shape != (cell_count, cell_count):
            raise InvalidInputError("surface.shape", surface.shape, f"{(cell_count, cell_count)}, the cells of the gap")
        if counterbody is not None:
            raise InvalidInputError("counterbody", counterbody, "None with surface, the compliance of both bodies")
        if coupled or not isinstance(motion, Sliding):
            raise InvalidInputError("motion, coupled", (motion, coupled), "full sliding, uncoupled, with surface")
    shape = Shape(
        body=body,
        grid=grid,
        gap=ArrayKey(initial_gap),
        prescribed=PrescribedLoad(load, settings.load_position, approach).check(initial_gap, grid),
        counterbody=counterbody,
        # Without coupling the pressure does not depend on the friction: all cases of a sweep share one contact.
        coupled_friction=cell_friction
        if coupled and isinstance(motion, Sliding) and isinstance(cell_friction, float)
        else 0.0,
        surface=surface,
    )
    iteration_settings = Settings(settings.tolerance, settings.max_iterations)
    x, y = gap["x"].values, gap["y"].values
    if isinstance(motion, Sliding):
        contact = contact_of(shape, iteration_settings)
        contact.warn_unless_converged()
        return contact_dataset(contact, cell_friction, x=x, y=y)
    start = None if previous_step is None else _read_start_loads(previous_step, motion, grid, body)
    shape_columns = np.flatnonzero(np.isfinite(initial_gap).any(axis=1))
    middle = 0.5 * float(grid.x_edges[shape_columns[0]] + grid.x_edges[shape_columns[-1] + 1])
    request = FrictionRequest(motion=motion, friction=cell_friction, reference_x=middle, coupled=coupled, start=start)
    friction_contact = frictional_contact(shape, iteration_settings, request)
    friction_contact.warn_unless_converged()
    return friction_contact.with_tractions(contact_dataset(friction_contact.contact, cell_friction, x=x, y=y))


def _read_start_loads(after: xr.Dataset, motion: Motion, grid: Grid, body: Body) -> dict[Load, FloatArray]:
    """Pressure and tractions of the preceding step, on the same cells."""
    checks.instance("after", after, xr.Dataset, "a result of solve_contact")
    if not isinstance(motion, Shift):
        raise InvalidInputError("motion", motion, "a Shift(...) with after: rolling is steady")
    missing = [name for name in ("pressure", "traction_x", "traction_y") if name not in after]
    if missing:
        raise InvalidInputError("after", f"without {missing[0]}", "a result with stick and slip")
    previous_loads = prescribed_loads(body, after["pressure"], 0.0, after["traction_x"], after["traction_y"])
    centres = (previous_loads.grid.x, previous_loads.grid.y), (grid.x, grid.y)
    if previous_loads.grid.shape != grid.shape or not all(map(np.allclose, *centres)):
        raise InvalidInputError("after", f"on {previous_loads.grid.shape} cells", "on the cells of the gap")
    return {load: top.values for load, top in previous_loads.loads.items()}


def contact_dataset(contact: Contact, friction: float | FloatArray, *, x: FloatArray, y: FloatArray) -> xr.Dataset:
    """Label a contact; `x` and `y` are the labels of the cell centres."""
    shape = contact.shape
    # The cache may share the contact: results are copies.
    fields = {
        "pressure": contact.pressure.copy(),
        "traction_y": friction * contact.pressure,
        "gap": contact.gap.copy(),
        "displacement_z": contact.displacement.copy(),
    }
    scalars: dict[str, float | int | bool] = {
        "normal_load": contact.carried_load if shape.prescribed.load is None else shape.prescribed.load,
        "approach": contact.approach,
        "tilt": contact.tilt,
        "load_position": contact.load_position,
        "iterations": contact.iterations,
        "converged": contact.converged,
        **reference_depths(shape.body, shape.counterbody),
        **asdict(contact.certificate),
    }
    result = xr.Dataset(
        {name: (("x", "y"), values) for name, values in fields.items()} | scalars,
        coords={"x": x, "y": y} | cell_coordinates(shape.grid),
    )
    result["displacement_z"].attrs["reference"] = "material line at reference_depth (m) below the load"
    prescribed = {"approach": shape.prescribed.approach, "load_position": shape.prescribed.load_position}
    result = without_error(result, *(name for name, value in prescribed.items() if value is None))
    return describe(result, "contact of a shape with an elastic body")


def reference_depths(body: Body, counterbody: Counterbody | None) -> dict[str, float]:
    """Depths of the material lines to which approach and tilt refer, by variable; infinite far away."""
    depths = {"reference_depth": body.depth}
    return depths if counterbody is None else depths | {"roller_reference_depth": counterbody.body.depth}
