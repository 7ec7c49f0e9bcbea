"""Tractions of a contact under Coulomb friction: after a shift, or in steady rolling."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.case.motion import Rolling, Shift
from contactstudy.checks import BoolArray, FloatArray
from contactstudy.contact.compliance import TangentialInverse, contact_cells
from contactstudy.contact.coulomb import CoulombProblem, CoulombSolution, Guess, law_violation, solve_coulomb
from contactstudy.contact.fastsim import Pair, flexibilities, strip_tractions
from contactstudy.contact.leading_edge import RollingCells
from contactstudy.errors import InvalidInputError, WindowError
from contactstudy.kernels.load import Load

TANGENTIAL = (Load.ALONG_X, Load.ALONG_Y)
"""Directions of tractions and slip, in the order of every array of two components."""

ALMOST_SLIDING = 1 - 1e-9
"""Part of the largest force up to which a force can be prescribed: at all of it the rigid slip has no value."""


NESTED_CELLS = 600
"""Cells of a contact from which on it is first solved on coarser ones. Speed."""

COARSE_TOLERANCE = 1e-3
"""Tolerance of a solution that serves as a guess. Speed."""

STICKING = 0.999
"""Largest part of its bound that a guess gives a cell that sticks. Speed."""


@runtime_checkable
class RelativeOperator(Protocol):
    """Displacements of the surfaces relative to each other."""

    def displaced(self, loads: Mapping[Load, FloatArray], directions: Sequence[Load]) -> dict[Load, FloatArray]:
        """Displacements (m) in some directions under loads on the first body (Pa)."""
        ...

    @property
    def coarse(self) -> object:
        """The operator on cells of twice the size, roughly; it may be of another kind."""
        ...


class Surfaces(NamedTuple):
    """What is rubbed on what.

    Attributes
    ----------
    operator : RelativeOperator
        Displacements relative to each other.
    grid : Grid
        Cells.
    materials : list of Material
        Of the elastic bodies.
    middle : float
        Position x about which spin and moment are taken, metres.
    """

    operator: RelativeOperator
    grid: Grid
    materials: list[Material]
    middle: float


@dataclass(frozen=True, eq=False)
class Tractions:
    """Tractions on the body, and the slip of the roller against it.

    Attributes
    ----------
    traction : array (2, x, y)
        Along x and y, Pa.
    slip : array (2, x, y)
        Along x and y: per distance rolled, or metres in a shift; 0 outside the contact.
    sticks : bool array (x, y)
        Cells of the contact that stick.
    rigid : mapping of str to float
        Amplitudes of the rigid slip: "x", "y" and, in rolling, "spin".
    force_x, force_y, moment_z : float
        Resultants on the body, N and N m.
    work : float
        Frictional work: per distance rolled, J/m, or of the shift, J.
    bound_error, slip_error, force_error : float
        Certificate, recomputed: traction above the bound, over the largest bound; slip where cells stick, and slip
        across or against the traction elsewhere, over the rigid slip; error of prescribed resultants, over the largest.
    steps, applications : int
        Steps of Newton's method and applications of the operator.
    converged : bool
        Whether the tolerance was reached.
    """

    traction: FloatArray
    slip: FloatArray
    sticks: BoolArray
    rigid: Mapping[str, float]
    force_x: float
    force_y: float
    moment_z: float
    work: float
    bound_error: float
    slip_error: float
    force_error: float
    steps: int
    applications: int
    converged: bool


def tractions_of(
    motion: Shift | Rolling,
    surfaces: Surfaces,
    pressure: FloatArray,
    friction: FloatArray,
    *,
    tolerance: float,
    max_steps: int,
    before: Mapping[Load, FloatArray] | None = None,
) -> Tractions:
    """Tractions under a given pressure.

    Parameters
    ----------
    motion : Shift or Rolling
        What is prescribed.
    surfaces : Surfaces
        Bodies and cells.
    pressure, friction : array (x, y)
        Pressure, Pa, and coefficient of friction.
    tolerance : float
        Violation of Coulomb's law at which the iteration stops.
    max_steps : int
        Bound on the steps of Newton's method.
    before : mapping of Load to array (x, y), optional
        Pressure and tractions from which a shift begins; default: none.

    Raises
    ------
    InvalidInputError
        If a prescribed force is as large as full sliding's, or the cells are not uniform.
    WindowError
        If rolling needs cells ahead of the contact that the grid does not have.
    """
    grid = surfaces.grid
    if not grid.uniform:
        raise InvalidInputError("grid", "columns of different widths", "uniform cells for a motion with stick and slip")
    bound = friction * pressure
    rolling = isinstance(motion, Rolling)
    if rolling and pressure[:, -2:].any():
        raise WindowError(
            "the contact reaches the last two cells along +y, and rolling takes the slip from the two cells ahead: "
            "widen the window along y"
        )
    cells = RollingCells.of(pressure, bound) if rolling else _all_cells(bound)
    weights = grid.cell_area * _rigid_weights(surfaces, grid)
    modes = motion.modes
    _check_forces(motion, bound, grid)
    if not cells.unknown.size:
        return _frictionless(motion, grid)
    if isinstance(motion, Rolling) and motion.model == "fastsim":
        return _of_strips(motion, surfaces, bound, weights)
    bent = surfaces.operator.displaced({Load.NORMAL: pressure}, TANGENTIAL)
    if before is not None:
        for direction, each in surfaces.operator.displaced(before, TANGENTIAL).items():
            bent[direction] = bent[direction] - each

    def relative(displaced: Mapping[Load, FloatArray]) -> FloatArray:
        """Slip (2, unknown) that displacements add."""
        if rolling:
            return np.stack([cells.change(displaced[each], grid.dy) for each in TANGENTIAL])
        return np.stack([-displaced[each][tuple(cells.unknown)] for each in TANGENTIAL])

    def relief(traction: FloatArray) -> FloatArray:
        on_grid = cells.on_grid(traction, grid.shape)
        return -relative(surfaces.operator.displaced(dict(zip(TANGENTIAL, on_grid, strict=True)), TANGENTIAL))

    names = ("x", "y", "spin") if rolling else ("x", "y")
    along = {name: _rigid_slip(name, surfaces, cells) for name in names}
    rigid = relative(bent) + sum(
        (_amplitude(motion, name) * along[name] for name in names if name not in modes), np.zeros((2, 1))
    )
    works = np.array([cells.gathered(weights[names.index(name)]) for name in modes])
    own = bound[tuple(cells.unknown)]
    problem = CoulombProblem(
        relief=relief,
        inverse=TangentialInverse(surfaces.materials, cells.unknown, (grid.dx, grid.dy), rolling=rolling),
        bound=own,
        rigid=rigid,
        modes=np.array([along[name] for name in modes]).reshape(len(modes), *rigid.shape),
        works=works.reshape(len(modes), *rigid.shape),
        resultants=np.array([_resultant(motion, name) for name in modes]),
        tolerance=tolerance,
        max_steps=max_steps,
    )
    start = _from_coarser(motion, surfaces, pressure, bound, cells, max_steps=max_steps, before=before)
    return _completed(problem, solve_coulomb(problem, start), motion, cells, weights, grid)


def _from_coarser(
    motion: Shift | Rolling,
    surfaces: Surfaces,
    pressure: FloatArray,
    bound: FloatArray,
    cells: RollingCells,
    *,
    max_steps: int,
    before: Mapping[Load, FloatArray] | None,
) -> Guess | None:
    """Guess from cells of twice the size; None on few cells, or if they cannot be joined."""
    grid = surfaces.grid
    if cells.unknown.shape[1] < NESTED_CELLS or grid.cells_x % 2 or grid.cells_y % 2:
        return None
    operator = surfaces.operator.coarse
    coarse = grid.coarsened()
    if not isinstance(operator, RelativeOperator):
        return None

    def joined(values: FloatArray) -> FloatArray:
        return np.asarray(values.reshape(coarse.cells_x, 2, coarse.cells_y, 2).mean(axis=(1, 3)))

    pressed, bounded = joined(pressure), joined(bound)
    if pressed[:, -2:].any():
        return None
    friction = bounded / np.where(pressed > 0, pressed, 1.0)
    earlier = None if before is None else {load: joined(values) for load, values in before.items()}
    found = tractions_of(
        motion,
        surfaces._replace(operator=operator, grid=coarse),
        pressed,
        friction,
        tolerance=COARSE_TOLERANCE,
        max_steps=max_steps,
        before=earlier,
    )
    part = found.traction / np.where(bounded > 0, bounded, 1.0)
    row, column = cells.unknown
    # Cells that slip have all of their bound; inside the stick zone the part is interpolated.
    own = part[:, row // 2, column // 2]
    smooth = _between_cells(part)[:, row, column]
    sticks = found.sticks[row // 2, column // 2]
    size = np.hypot(*smooth)
    limited = smooth * np.minimum(1.0, STICKING / np.where(size > 0, size, 1.0))
    return Guess(
        np.where(sticks, limited, own) * bound[row, column], np.array([found.rigid[name] for name in motion.modes])
    )


def _between_cells(values: FloatArray) -> FloatArray:
    """Values (component, x, y) on cells of half the size, linear between the centres."""
    for axis in (1, 2):
        first, last = np.take(values, [0], axis=axis), np.take(values, [-1], axis=axis)
        padded = np.concatenate([first, values, last], axis=axis)
        count = values.shape[axis]
        middle, low, high = (np.take(padded, np.arange(start, start + count), axis=axis) for start in (1, 0, 2))
        halves = np.stack([0.75 * middle + 0.25 * low, 0.75 * middle + 0.25 * high], axis=axis + 1)
        shape = list(values.shape)
        shape[axis] *= 2
        values = halves.reshape(shape)
    return values


def _completed(
    problem: CoulombProblem,
    found: CoulombSolution,
    motion: Shift | Rolling,
    cells: RollingCells,
    weights: FloatArray,
    grid: Grid,
) -> Tractions:
    """Resultants and certificate of a solution, recomputed from its tractions."""
    modes = motion.modes
    slip_on_cells = problem.slip(found.traction, found.amplitudes)
    scale = max(float(np.hypot(*(problem.rigid + np.tensordot(found.amplitudes, problem.modes, axes=1))).max()), 1e-300)
    bound_error, slip_error = law_violation(found.traction, slip_on_cells, problem.bound, found.sticks, scale)
    traction = cells.on_grid(found.traction, grid.shape)
    slip, sticks = np.zeros_like(traction), np.zeros(grid.shape, bool)
    slip[:, cells.unknown[0], cells.unknown[1]] = np.where(found.sticks, 0.0, slip_on_cells)
    sticks[tuple(cells.unknown)] = found.sticks
    for row, column, to in zip(*cells.tied, cells.to, strict=True):
        slip[:, row, column], sticks[row, column] = slip[:, row, column - 1], found.sticks[to]
    resultants = (weights * traction).sum(axis=(1, 2, 3))
    wanted = dict(zip(modes, problem.resultants, strict=True))
    whole = np.abs(weights).sum(axis=1)
    largest = (whole * np.hypot(*traction)).sum(axis=(1, 2))
    errors = [
        abs(resultants[number] - wanted[name]) / max(largest[number], 1e-300)
        for number, name in enumerate(("x", "y", "spin"))
        if name in wanted
    ]
    unknown = dict(zip(modes, found.amplitudes.tolist(), strict=True))
    names = ("x", "y", "spin") if isinstance(motion, Rolling) else ("x", "y")
    return Tractions(
        traction=traction,
        slip=slip,
        sticks=sticks,
        rigid={name: unknown.get(name, _amplitude(motion, name)) for name in names},
        force_x=float(resultants[0]),
        force_y=float(resultants[1]),
        moment_z=float(resultants[2]),
        work=float((traction * slip).sum() * grid.cell_area),
        bound_error=bound_error,
        slip_error=slip_error,
        force_error=float(max(errors, default=0.0)),
        steps=found.steps,
        applications=found.applications,
        converged=found.converged,
    )


def _of_strips(motion: Rolling, surfaces: Surfaces, bound: FloatArray, weights: FloatArray) -> Tractions:
    """Tractions of FASTSIM's strips."""
    grid = surfaces.grid
    rows, columns = np.flatnonzero(bound.any(axis=1)), np.flatnonzero(bound.any(axis=0))
    widths = 0.5 * rows.size * grid.dx, 0.5 * columns.size * grid.dy
    names = ("x", "y", "spin")
    rigid = {name: _amplitude(motion, name) for name in names}
    soft = flexibilities(widths, Pair.of(surfaces.materials))
    turning = rigid["spin"] / soft["spin"]
    growth = np.zeros((2, *grid.shape))
    growth[0] = rigid["x"] / soft["x"] - turning * grid.y
    growth[1] = rigid["y"] / soft["y"] + turning * (grid.x - surfaces.middle)[:, None]
    traction, lost = strip_tractions(bound, growth, grid.dy)
    slip = np.array([soft["x"], soft["y"]])[:, None, None] * lost
    force_x, force_y, moment = (weights * traction).sum(axis=(1, 2, 3)).tolist()
    return Tractions(
        traction=traction,
        slip=slip,
        sticks=(bound > 0) & ~lost.any(axis=0),
        rigid=rigid,
        force_x=force_x,
        force_y=force_y,
        moment_z=moment,
        work=float((traction * slip).sum() * grid.cell_area),
        bound_error=0.0,
        slip_error=0.0,
        force_error=0.0,
        steps=0,
        applications=0,
        converged=True,
    )


def _frictionless(motion: Shift | Rolling, grid: Grid) -> Tractions:
    """Tractions where the friction is 0 everywhere: none, and the slip of rigid surfaces is of no interest."""
    none = np.zeros((2, *grid.shape))
    names = ("x", "y", "spin") if isinstance(motion, Rolling) else ("x", "y")
    rigid = {name: _amplitude(motion, name) for name in names}
    sticks = np.zeros(grid.shape, bool)
    return Tractions(none, none.copy(), sticks, rigid, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0, 0, converged=True)


def _all_cells(bound: FloatArray) -> RollingCells:
    """Cells of a contact that is shifted: all those that carry a traction are unknown."""
    unknown = contact_cells(bound > 0)
    none = np.zeros((2, 0), dtype=np.int64)
    return RollingCells(unknown, np.zeros(unknown.shape[1]), none, none[0], np.zeros(0))


def _rigid_weights(surfaces: Surfaces, grid: Grid) -> FloatArray:
    """Weights of force along x, force along y and moment about z: array (3, 2, x, y)."""
    weights = np.zeros((3, 2, *grid.shape))
    weights[0, 0] = weights[1, 1] = 1.0
    weights[2, 0], weights[2, 1] = -grid.y, (grid.x - surfaces.middle)[:, None]
    return weights


def _rigid_slip(name: str, surfaces: Surfaces, cells: RollingCells) -> FloatArray:
    """Slip (2, unknown) of a rigid motion of unit amplitude, where the slip is taken."""
    grid, (row, column) = surfaces.grid, cells.unknown
    slip = np.zeros((2, row.size))
    if name == "spin":
        slip[0], slip[1] = -(grid.y[column] + cells.place * grid.dy), grid.x[row] - surfaces.middle
    else:
        slip["xy".index(name)] = 1.0
    return slip


def _amplitude(motion: Shift | Rolling, name: str) -> float:
    """Prescribed amplitude of a rigid motion; 0 where its force is prescribed."""
    names = {"x": "x", "y": "y"}
    if isinstance(motion, Rolling):
        names = {"x": "lateral_creepage", "y": "longitudinal_creepage", "spin": "spin"}
    return getattr(motion, names[name]) or 0.0


def _resultant(motion: Shift | Rolling, name: str) -> float:
    """Prescribed force or moment."""
    return float(getattr(motion, {"x": "force_x", "y": "force_y", "spin": "moment_z"}[name]))


def _check_forces(motion: Shift | Rolling, bound: FloatArray, grid: Grid) -> None:
    """Raise if the forces that are prescribed exceed those of full sliding."""
    largest = float(bound.sum() * grid.cell_area)
    force = np.array([motion.force_x or 0.0, motion.force_y or 0.0])
    if motion.modes and np.hypot(*force) >= ALMOST_SLIDING * largest:
        raise InvalidInputError(
            "force_x, force_y",
            tuple(force.tolist()),
            f"together less than full sliding's {largest:.6g} N",
            "full sliding is the motion Sliding()",
        )
