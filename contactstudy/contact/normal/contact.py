"""Solve a contact in arrays without labels: from bodies, cells, gap and load to pressure and certificate."""

from __future__ import annotations

import warnings
from dataclasses import asdict, dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.sparse.linalg import LinearOperator

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.models import Body, Counterbody
from contactstudy.cache import ArrayKey, cached
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.prescribed_loads import LineMotions, PrescribedLoad, RigidMotion, line_motion
from contactstudy.contact.normal.problem import ContactIterate, ContactOperator, ContactProblem, solve_problem
from contactstudy.contact.normal.two_bodies import PairOperator, PrescribedSurface
from contactstudy.errors import ConvergenceWarning, WindowError
from contactstudy.fields.surface import SurfaceOperator, surface_operator
from contactstudy.kernels.load import Load
from contactstudy.threads import one_blas_thread

CONVERGED_TOLERANCES = 10.0  # largest violation of a converged contact over the tolerance: the last step is unchecked
OPEN_TOLERANCES = 10.0  # least gap that counts as open, over the tolerance times the displacement's variation
MAX_ROUNDS = 20  # rounds after which a prescribed tilt or approach is not reached. Speed.
INNER_TOLERANCE = 1e-3  # tolerance of the contact over the error of the motion of the reference lines. Speed.
SYMMETRY_ROUNDING = 1e-10  # rounding of a symmetric gap over the largest, of a body's middle over the window. Accuracy.


@dataclass(frozen=True)
class Certificate:
    """Violations of the contact's conditions."""

    load_error: float  # pressure's resultant minus the load, over the load; 0 under a prescribed approach
    penetration_error: float  # largest gap under pressure or overlap, over the variation of the displacement
    open_pressure_error: float  # largest pressure where the gap is open, over the peak pressure
    load_position_error: float  # distance of the resultant from `load_position`, over the length of the contact

    def holds(self, tolerance: float) -> bool:
        """Whether every violation is within a multiple of the iteration's tolerance."""
        bound = CONVERGED_TOLERANCES * tolerance
        return all(abs(violation) <= bound for violation in asdict(self).values())


class Shape(NamedTuple):
    """Contact to solve: bodies, cells, gap and load."""

    body: Body  # the elastic body
    grid: Grid
    gap: ArrayKey  # (x, y): initial gap, metres; infinite outside the shape
    prescribed: PrescribedLoad  # load or approach
    counterbody: Counterbody | None = None  # second elastic body; None: the shape is rigid
    coupled_friction: float = 0.0  # friction that displaces the surfaces normally
    surface: LinearOperator | None = None  # from pressure to displacement of the surfaces; replaces the body's operator

    @property
    def directions(self) -> tuple[Load, ...]:
        """Loads that displace the surfaces normally."""
        return (Load.NORMAL, Load.ALONG_Y) if self.coupled_friction else (Load.NORMAL,)

    def reflections(self) -> list[int]:
        """Axes along which a reflection changes neither bodies nor gap nor load."""
        if self.surface is not None:
            return []
        low, high = self.grid.x_range
        rounding, position = SYMMETRY_ROUNDING * (high - low), self.prescribed.load_position
        centres = [0.5 * sum(self.body.extent)]
        if self.counterbody is not None:
            centres.append(self.counterbody.start + 0.5 * sum(self.counterbody.body.extent))
        if position is not None:
            centres.append(position)
        even_x = self.grid.is_symmetric and all(
            np.isnan(centre) or abs(centre - 0.5 * (low + high)) < rounding for centre in centres
        )
        gap = np.where(np.isfinite(self.gap.values), self.gap.values, -1.0)
        return [
            axis
            for axis, even in enumerate((even_x, not self.coupled_friction))
            if even and np.abs(gap - np.flip(gap, axis)).max() <= SYMMETRY_ROUNDING * gap.max()
        ]

    def find_resultant(self, pressure: FloatArray) -> float:
        """Position x of a pressure's resultant, metres."""
        forces = (self.grid.weights * pressure).sum(axis=1)
        return float(forces @ self.grid.x / max(forces.sum(), np.finfo(float).tiny))

    def line_motions(self, pressure: FloatArray, position: float) -> LineMotions:
        """Motions of the reference lines under a pressure; `level` is taken below a position x."""
        grid, counterbody, loads = self.grid, self.counterbody, self.loads(pressure)
        first = line_motion(self.body, grid, loads, position)
        if counterbody is None:
            return LineMotions(first, first)
        reaction = {
            load: (1 if load is Load.NORMAL else -1) * counterbody.transfer_load(grid, cells)
            for load, cells in loads.items()
        }
        start = counterbody.start
        second = line_motion(counterbody.body, counterbody.grid_on_body(grid), reaction, position - start)
        total = RigidMotion(first.level + second.level - second.tilt * start, first.tilt + second.tilt)
        return LineMotions(first, total)

    def loads(self, pressure: FloatArray) -> dict[Load, FloatArray]:
        """Map a pressure and its coupled friction to loads."""
        values = {Load.NORMAL: pressure, Load.ALONG_Y: self.coupled_friction * pressure}
        return {load: values[load] for load in self.directions}


class Settings(NamedTuple):
    """Tolerance and bound of the iteration."""

    tolerance: float = 1e-6
    max_iterations: int = 500


@dataclass(frozen=True, kw_only=True, eq=False)
class Contact:
    """Solution of a contact."""

    shape: Shape  # bodies, cells, gap and load
    settings: Settings  # tolerance and bound of the iteration
    pressure: FloatArray  # (x, y), Pa
    gap: FloatArray  # (x, y): gap after deformation, metres
    displacement: FloatArray  # (x, y): displacement of the body's top relative to its reference line, metres
    approach: float  # relative to the reference lines, where the load acts, or at ``x = 0``, metres
    tilt: float  # relative to the reference lines, radians
    iterations: int  # applications of the operator
    converged: bool  # whether the tolerance was reached
    motions: LineMotions  # motions of the reference lines
    certificate: Certificate  # violations of the conditions

    @property
    def carried_load(self) -> float:
        """Resultant of the pressure, N."""
        grid = self.shape.grid
        return float((grid.weights * self.pressure).sum() * grid.cell_area)

    @property
    def load_position(self) -> float:
        """Position x of the pressure's resultant, metres."""
        return self.shape.find_resultant(self.pressure)

    def warn_unless_converged(self) -> None:
        """Warn with the violations of the conditions, if the iteration did not converge."""
        if self.converged:
            return
        violations = ", ".join(f"{name} = {value:.2g}" for name, value in asdict(self.certificate).items() if value)
        tolerance, bound = self.settings
        warnings.warn(
            f"the contact iteration stopped after {self.iterations} operator applications without reaching "
            f"tolerance = {tolerance:g} ({violations}); raise max_iterations (now {bound}) or coarsen the grid",
            ConvergenceWarning,
            stacklevel=2,
        )


def contact_of(shape: Shape, settings: Settings, start: ArrayKey | None = None) -> Contact:
    """Solve a contact, optionally from a first guess of the pressure."""
    grid, clearance = shape.grid, shape.gap.values
    with one_blas_thread():
        iterate, motions = _iterate(shape, settings, start)
        # The solution of a symmetric problem is symmetric: the mean of the iterate and its mirror image replaces the
        # iterate. Fields of symmetric loads need half of the wavenumbers.
        pressure = iterate.pressure.copy()
        for axis in shape.reflections():
            pressure = 0.5 * (pressure + np.flip(pressure, axis))
        loads = shape.loads(pressure)
        displacement = _body_operator(shape)(loads)
        relative = displacement if shape.counterbody is None else contact_operator(shape)(loads)
    check_window(shape.body, pressure)
    prescribed = shape.prescribed
    height = clearance + relative - motions.total.height(grid.x)
    tilt = 0.0
    if prescribed.load_position is not None:
        tilt = iterate.motion[1] / prescribed.max_arm(grid) - motions.total.tilt
        height = height - tilt * (grid.x[:, None] - prescribed.load_position)
    approach = prescribed.lowering
    if prescribed.approach is None:
        forces = grid.weights * pressure
        approach = float((forces * np.where(pressure > 0, height, 0.0)).sum() / forces.sum())
    opening = height - approach  # eq. (33)
    certificate = certify(shape, pressure, opening, relative, settings.tolerance)
    return Contact(
        shape=shape,
        settings=settings,
        pressure=pressure,
        gap=np.where(np.isfinite(opening), opening, np.inf),
        displacement=displacement - motions.body.height(grid.x),
        approach=approach,
        tilt=tilt,
        iterations=iterate.applications,
        converged=iterate.converged and certificate.holds(settings.tolerance),
        motions=motions,
        certificate=certificate,
    )


def certify(
    shape: Shape, pressure: FloatArray, opening: FloatArray, displacement: FloatArray, tolerance: float
) -> Certificate:
    """Return the violations of the contact's conditions."""
    grid, prescribed, forces = shape.grid, shape.prescribed, (shape.grid.weights * pressure).sum(axis=1)
    variation = float(np.ptp(displacement))
    violation = max(float(np.abs(opening[pressure > 0]).max()), float(-opening.min()))  # eq. (34)
    open_pressure = pressure[opening > OPEN_TOLERANCES * tolerance * variation]
    position_error = 0.0
    if prescribed.load_position is not None:
        loaded_columns = np.flatnonzero(forces)
        length = grid.x_edges[loaded_columns[-1] + 1] - grid.x_edges[loaded_columns[0]]
        position_error = abs(float((forces * (grid.x - prescribed.load_position)).sum() / forces.sum())) / float(length)
    carried_load = float((grid.weights * pressure).sum() * grid.cell_area)
    return Certificate(
        load_error=0.0 if prescribed.load is None else carried_load / prescribed.load - 1,
        penetration_error=violation / variation,
        open_pressure_error=float(open_pressure.max(initial=0.0) / pressure.max()),
        load_position_error=position_error,
    )


@cached("contacts")
def _iterate(shape: Shape, settings: Settings, start: ArrayKey | None) -> tuple[ContactIterate, LineMotions]:
    """Solve for the pressure of a contact and the motions of the reference lines."""
    return iterate_contact(shape, contact_operator(shape), settings, None if start is None else start.values)


def iterate_contact(
    shape: Shape, operator: ContactOperator, settings: Settings, start: FloatArray | None
) -> tuple[ContactIterate, LineMotions]:
    """Solve a contact whose approach or tilt is prescribed relative to the reference lines of the bodies."""
    # The operator is symmetric only relative to the body far away: a fixed-point iteration with Aitken's relaxation
    # adds the motion of the reference lines to the gap.
    grid, prescribed, tolerance = shape.grid, shape.prescribed, settings.tolerance
    bodies = [shape.body] if shape.counterbody is None else [shape.body, shape.counterbody.body]
    finite = any(np.isfinite(body.depth) for body in bodies)
    tilts = prescribed.load_position is None and 0 not in shape.reflections()
    fixed = (finite and prescribed.approach is not None, finite and tilts)
    low, high = grid.x_range
    weights = np.array([1.0, high - low])
    trial, previous = np.zeros(2), np.zeros(2)
    relaxation, applications = 1.0, 0
    guess, error = start, 1.0 if any(fixed) else 0.0
    for round_index in range(MAX_ROUNDS):
        inner_tolerance = max(tolerance, INNER_TOLERANCE * error)
        problem = ContactProblem(
            grid=grid,
            gap=shape.gap.values - prescribed.lowering - RigidMotion(*trial).height(grid.x),
            resultants=prescribed.resultants(grid),
            friction=shape.coupled_friction,
            tolerance=inner_tolerance,
            max_iterations=settings.max_iterations,
        )
        iterate = solve_problem(operator, problem, guess)
        applications += iterate.applications
        guess = iterate.pressure
        motions = shape.line_motions(guess, shape.find_resultant(guess))
        motion = np.array(motions.total)
        residual = np.where(fixed, motion - trial, 0.0)
        motion_norm = float(np.linalg.norm(weights * motion))
        error = float(np.linalg.norm(weights * residual)) / motion_norm if motion_norm else 0.0
        if max(error, inner_tolerance) <= tolerance:
            return replace(iterate, applications=applications), motions
        change = weights * (residual - previous)
        if round_index and change.any():
            relaxation *= -float(weights * previous @ change) / float(change @ change)
        trial, previous = trial + relaxation * residual, residual
    return replace(iterate, applications=applications, converged=False), motions


def contact_operator(shape: Shape) -> ContactOperator:
    """Operator from the loads on the body to the relative displacement of the surfaces."""
    if shape.counterbody is None:
        return _body_operator(shape)
    return PairOperator.of(shape.body, shape.counterbody, shape.grid, shape.directions)


def _body_operator(shape: Shape) -> SurfaceOperator | PrescribedSurface:
    """Operator of the body alone."""
    operator = surface_operator(shape.body, shape.grid, shape.directions)
    return operator if shape.surface is None else PrescribedSurface(shape.surface, operator)


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
                f"the contact reaches the grid's edge {name} (pressure {values.max():.3g} Pa): the window is too "
                f"narrow for the load; widen it along {name[0]} or lower the load"
            )
