"""A contact in plain arrays: what is pressed on what, and the pressure that follows."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.counterbody import Counterbody
from contactstudy.bodies.models import Body
from contactstudy.cache import ArrayKey, kept
from contactstudy.caller import warn
from contactstudy.checks import FloatArray
from contactstudy.contact.certificate import Certificate, certify
from contactstudy.contact.conjugate_gradients import ContactIterate
from contactstudy.contact.pair import PairOperator
from contactstudy.contact.prescribed import Prescribed
from contactstudy.contact.problem import ContactOperator, ContactProblem, solve_coupled, solve_normal
from contactstudy.errors import ConvergenceWarning, WindowError
from contactstudy.fields.surface import OperatorRequest, SurfaceOperator, surface_operator
from contactstudy.kernels.load import Load
from contactstudy.threads import one_blas_thread


class Shape(NamedTuple):
    """What is pressed on what: the contact to solve.

    Attributes
    ----------
    body : Body
        The elastic body.
    grid : Grid
        Cells.
    gap : ArrayKey of array (x, y)
        Initial gap, metres; infinite where there is nothing to touch.
    prescribed : Prescribed
        Load or approach.
    counterbody : Counterbody or None
        Second elastic body; None: the shape is rigid.
    coupled_friction : float
        Coefficient of the friction that displaces the surfaces normally; 0 where none does.
    """

    body: Body
    grid: Grid
    gap: ArrayKey
    prescribed: Prescribed
    counterbody: Counterbody | None = None
    coupled_friction: float = 0.0

    @property
    def directions(self) -> tuple[Load, ...]:
        """Loads that displace the surfaces normally."""
        return (Load.NORMAL, Load.ALONG_Y) if self.coupled_friction else (Load.NORMAL,)

    def loads(self, pressure: FloatArray) -> dict[Load, FloatArray]:
        """Return what a pressure, with its friction, loads the body by."""
        values = {Load.NORMAL: pressure, Load.ALONG_Y: self.coupled_friction * pressure}
        return {load: values[load] for load in self.directions}


class Settings(NamedTuple):
    """When the iteration stops."""

    tolerance: float = 1e-6
    max_iterations: int = 500


@dataclass(frozen=True, eq=False)
class Contact:
    """A contact that has been solved.

    Attributes
    ----------
    shape : Shape
        What was pressed on what.
    settings : Settings
        When the iteration stopped.
    pressure, gap, displacement : array (x, y)
        Pressure, Pa; gap after deformation and displacement of the body's top, metres.
    approach, tilt : float
        Rigid motion of the shape: where the load acts, or at ``x = 0``, metres, and radians.
    iterations : int
        Applications of the operator.
    converged : bool
        Whether the tolerance was reached.
    reference : float
        Distance along y at which `displacement` is zero, metres; infinite if it is absolute.
    certificate : Certificate
        Violations of the conditions.
    """

    shape: Shape
    settings: Settings
    pressure: FloatArray
    gap: FloatArray
    displacement: FloatArray
    approach: float
    tilt: float
    iterations: int
    converged: bool
    reference: float
    certificate: Certificate

    @property
    def carried(self) -> float:
        """Resultant of the pressure, N."""
        grid = self.shape.grid
        return float((grid.weights * self.pressure).sum() * grid.cell_area)

    @property
    def load_position(self) -> float:
        """Position x of the pressure's resultant, metres."""
        grid = self.shape.grid
        forces = grid.weights * self.pressure
        return float((forces * grid.x[:, None]).sum() / forces.sum())

    def warn_unless_converged(self) -> None:
        """Say by how much the contact misses its conditions, if it did not converge."""
        if self.converged:
            return
        violations = ", ".join(f"{name} = {value:.2g}" for name, value in asdict(self.certificate).items() if value)
        tolerance, most = self.settings
        warn(
            f"the contact iteration stopped after {self.iterations} operator applications without reaching "
            f"tolerance = {tolerance:g} ({violations}); raise max_iterations (now {most}) or coarsen the grid",
            ConvergenceWarning,
        )


def contact_of(shape: Shape, settings: Settings) -> Contact:
    """Solve a contact whose parts are checked.

    Raises
    ------
    WindowError
        If the contact reaches an edge of the grid where the body goes on.
    """
    grid, clearance = shape.grid, shape.gap.values
    with one_blas_thread():
        iterate = _iterate(_ContactRequest(shape, settings))
        pressure = iterate.pressure.copy()
        loads, own = shape.loads(pressure), _body_operator(shape)
        displacement = own(loads)
        approached = displacement if shape.counterbody is None else contact_operator(shape)(loads)
    check_window(shape.body, pressure)
    prescribed = shape.prescribed
    height = clearance + approached
    tilt = 0.0
    if prescribed.load_position is not None:
        tilt = iterate.motion[1] / prescribed.largest_arm(grid)
        height = height - tilt * (grid.x[:, None] - prescribed.load_position)
    touching, forces = pressure > 0, grid.weights * pressure
    total = forces.sum()
    sunk = prescribed.lowered
    if prescribed.approach is None:
        sunk = float((forces * np.where(touching, height, 0.0)).sum() / total)
    opening = height - sunk
    certificate = certify(
        pressure,
        opening,
        approached,
        carried=float(total * grid.cell_area),
        load=prescribed.load,
        off_position=_off_position(prescribed, grid, pressure),
        tolerance=settings.tolerance,
    )
    return Contact(
        shape,
        settings,
        pressure,
        np.where(np.isfinite(opening), opening, np.inf),
        displacement,
        sunk,
        tilt,
        iterate.applications,
        iterate.converged and certificate.holds(settings.tolerance),
        own.reference,
        certificate,
    )


def _off_position(prescribed: Prescribed, grid: Grid, pressure: FloatArray) -> float:
    """Distance of the resultant from its prescribed position, over the length of the contact."""
    if prescribed.load_position is None:
        return 0.0
    line = (grid.weights * pressure).sum(axis=1)
    touching = np.flatnonzero(line)
    edges = grid.x_edges
    length = edges[touching[-1] + 1] - edges[touching[0]]
    return abs(float((line * (grid.x - prescribed.load_position)).sum() / line.sum())) / float(length)


class _ContactRequest(NamedTuple):
    """What decides a contact."""

    shape: Shape
    settings: Settings


@kept("contacts", lambda iterate: iterate.pressure.nbytes)
def _iterate(request: _ContactRequest) -> ContactIterate:
    """Pressure of a contact."""
    shape, settings = request
    problem = ContactProblem(
        shape.grid,
        shape.gap.values - shape.prescribed.lowered,
        shape.prescribed.resultants(shape.grid),
        shape.coupled_friction,
        settings.tolerance,
        settings.max_iterations,
    )
    solve = solve_coupled if shape.coupled_friction else solve_normal
    return solve(contact_operator(shape), problem)


def contact_operator(shape: Shape) -> ContactOperator:
    """Operator from the loads on the body to how far the surfaces move apart."""
    if shape.counterbody is None:
        return _body_operator(shape)
    return PairOperator.of(shape.body, shape.counterbody, shape.grid, shape.directions)


def _body_operator(shape: Shape) -> SurfaceOperator:
    """Operator of the body alone."""
    return surface_operator(OperatorRequest(shape.body, shape.grid, shape.directions))


def check_window(body: Body, pressure: FloatArray) -> None:
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
