"""Tractions of a contact under Coulomb friction: after a shift, or in steady rolling."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from contactstudy.case.motion import Rolling, Shift
from contactstudy.checks import FloatArray
from contactstudy.contact.compliance import contact_cells, tangential_inverse
from contactstudy.contact.continuation import solve_continued
from contactstudy.contact.coulomb import Guess
from contactstudy.contact.coulomb_law import CoulombProblem, CoulombSolution, law_violation
from contactstudy.contact.leading_edge import RollingCells, taken_together
from contactstudy.contact.nested import Coarser, guess_from, guess_of, joined
from contactstudy.contact.rubbed import RelativeOperator, Surfaces, amplitude, check_forces, motions_of, resultant
from contactstudy.contact.tractions import Tractions, no_tractions, tractions_of_strips
from contactstudy.kernels.load import Load

TANGENTIAL = (Load.ALONG_X, Load.ALONG_Y)
"""Directions of tractions and slip, in the order of every array of two components."""

NESTED_CELLS = 600
"""Cells of a contact from which on it is first solved on coarser ones. Speed."""

COARSE_TOLERANCE = 1e-3
"""Tolerance of a solution that serves as a guess. Speed."""


ROUGH_TOLERANCE = 1e-3
"""Tolerance of the solution that tells which columns slide. Speed."""


def tractions_of(
    motion: Shift | Rolling,
    surfaces: Surfaces,
    pressure: FloatArray,
    friction: FloatArray,
    *,
    tolerance: float,
    max_steps: int,
    before: Mapping[Load, FloatArray] | None = None,
    coarser: Coarser | None = None,
    last: Tractions | None = None,
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
    coarser : Coarser, optional
        Solution on coarser cells, to begin from. Default: on many uniform cells one is found first.
    last : Tractions, optional
        Tractions under almost the same pressure, to begin from; the columns in which they do not stick slide.

    Raises
    ------
    InvalidInputError
        If a prescribed force is as large as full sliding's.
    """
    grid = surfaces.grid
    bound = friction * pressure
    rolling = isinstance(motion, Rolling)
    together = taken_together(grid.x, grid.widths, grid.dy)
    cells = RollingCells.of(pressure, bound, together) if rolling else _all_cells(bound)
    check_forces(motion, bound, surfaces.weights)
    if not cells.unknown.size:
        return no_tractions(motion, surfaces)
    if isinstance(motion, Rolling) and motion.model == "fastsim":
        return tractions_of_strips(motion, surfaces, bound)
    bent = surfaces.operator.displaced({Load.NORMAL: pressure}, TANGENTIAL)
    if before is not None:
        for direction, each in surfaces.operator.displaced(before, TANGENTIAL).items():
            bent[direction] = bent[direction] - each

    def solved(cells: RollingCells, tolerance: float, start: Guess | None) -> Tractions:
        problem = _problem(motion, surfaces, bound, cells, bent, tolerance=tolerance, max_steps=max_steps)
        found = _completed(problem, solve_continued(problem, start), motion, cells, surfaces)
        return replace(found, work=_rolling_work(found, surfaces, bent)) if rolling else found

    steps = applications = 0
    if last is None or not rolling:
        if coarser is None:
            coarser = _solved_on_coarser(motion, surfaces, pressure, bound, cells, max_steps=max_steps, before=before)
        start = None if coarser is None else guess_from(coarser, cells, bound, motion.modes)
        last = solved(cells, max(tolerance, ROUGH_TOLERANCE) if rolling else tolerance, start)
        if not rolling or not last.converged:
            return last
        steps, applications = last.steps, last.applications
    slides = np.asarray(bound.any(axis=1) & ~last.sticks.any(axis=1))
    cells = RollingCells.of(pressure, bound, together, slides)
    found = solved(cells, tolerance, guess_of(last, cells, bound, motion.modes))
    return replace(found, steps=steps + found.steps, applications=applications + found.applications)


def _problem(
    motion: Shift | Rolling,
    surfaces: Surfaces,
    bound: FloatArray,
    cells: RollingCells,
    bent: Mapping[Load, FloatArray],
    *,
    tolerance: float,
    max_steps: int,
) -> CoulombProblem:
    """Coulomb's law on the cells, with what pressure and earlier tractions displace."""
    grid, rolling = surfaces.grid, isinstance(motion, Rolling)

    def relative(displaced: Mapping[Load, FloatArray]) -> FloatArray:
        """Slip (2, unknown) that displacements add."""
        if rolling:
            return np.stack([cells.change(displaced[each], grid.dy) for each in TANGENTIAL])
        return np.stack([-displaced[each][tuple(cells.unknown)] for each in TANGENTIAL])

    def relief(traction: FloatArray) -> FloatArray:
        on_grid = cells.on_grid(traction, grid.shape)
        return -relative(surfaces.operator.displaced(dict(zip(TANGENTIAL, on_grid, strict=True)), TANGENTIAL))

    names, modes, weights = motions_of(motion), motion.modes, surfaces.weights
    along = {name: surfaces.rigid_slip(name, cells) for name in names}
    rigid = relative(bent) + sum(
        (amplitude(motion, name) * along[name] for name in names if name not in modes), np.zeros((2, 1))
    )
    works = np.array([cells.gathered(weights[names.index(name)]) for name in modes])
    return CoulombProblem(
        relief=relief,
        inverse=tangential_inverse(surfaces.materials, cells.unknown, grid, rolling=rolling),
        bound=bound[tuple(cells.unknown)],
        rigid=rigid,
        modes=np.array([along[name] for name in modes]).reshape(len(modes), *rigid.shape),
        works=works.reshape(len(modes), *rigid.shape),
        resultants=np.array([resultant(motion, name) for name in modes]),
        shares=np.broadcast_to(grid.weights, grid.shape)[tuple(cells.unknown)],
        tolerance=tolerance,
        max_steps=max_steps,
        symmetric=not rolling,
    )


def _solved_on_coarser(
    motion: Shift | Rolling,
    surfaces: Surfaces,
    pressure: FloatArray,
    bound: FloatArray,
    cells: RollingCells,
    *,
    max_steps: int,
    before: Mapping[Load, FloatArray] | None,
) -> Coarser | None:
    """Solve on cells of twice the size; None on few or graded cells, or if they cannot be joined."""
    grid = surfaces.grid
    if cells.unknown.shape[1] < NESTED_CELLS or grid.cells_x % 2 or grid.cells_y % 2 or not grid.uniform:
        return None
    operator = surfaces.operator.coarse
    if not isinstance(operator, RelativeOperator):
        return None
    pressed, bounded = joined(pressure), joined(bound)
    coarse = grid.coarsened()
    found = tractions_of(
        motion,
        surfaces._replace(operator=operator, grid=coarse),
        pressed,
        bounded / np.where(pressed > 0, pressed, 1.0),
        tolerance=COARSE_TOLERANCE,
        max_steps=max_steps,
        before=None if before is None else {load: joined(values) for load, values in before.items()},
    )
    return Coarser(coarse, bounded, found)


def _completed(
    problem: CoulombProblem,
    found: CoulombSolution,
    motion: Shift | Rolling,
    cells: RollingCells,
    surfaces: Surfaces,
) -> Tractions:
    """Resultants and certificate of a solution, recomputed from its tractions."""
    modes, grid, weights = motion.modes, surfaces.grid, surfaces.weights
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
    return Tractions(
        traction=traction,
        slip=slip,
        sticks=sticks,
        rigid={name: unknown.get(name, amplitude(motion, name)) for name in motions_of(motion)},
        force_x=float(resultants[0]),
        force_y=float(resultants[1]),
        moment_z=float(resultants[2]),
        work=float((traction * slip * surfaces.areas).sum()),
        bound_error=bound_error,
        slip_error=slip_error,
        force_error=float(max(errors, default=0.0)),
        steps=found.steps,
        applications=found.applications,
        converged=found.converged,
    )


def _rolling_work(found: Tractions, surfaces: Surfaces, bent: Mapping[Load, FloatArray]) -> float:
    """Frictional work per distance: what tractions do on their own displacements cancels by reciprocity.

    Nothing moves ahead of the contact and behind it, so of ``sum q s`` the rigid slip and the pressure's displacement
    are left: more accurate than the sum over cells of which some begin to slip.
    """
    rigid = found.rigid
    work = rigid["x"] * found.force_x + rigid["y"] * found.force_y + rigid["spin"] * found.moment_z
    moved = np.stack([np.gradient(bent[each], surfaces.grid.dy, axis=1) for each in TANGENTIAL])
    return work + float((found.traction * moved * surfaces.areas).sum())


def _all_cells(bound: FloatArray) -> RollingCells:
    """Cells of a contact that is shifted: all those that carry a traction are unknown."""
    unknown = contact_cells(bound > 0)
    none = np.zeros((2, 0), dtype=np.int64)
    return RollingCells(unknown, np.zeros(unknown.shape[1]), none, none[0], np.zeros(0))
