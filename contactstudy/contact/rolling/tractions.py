"""Tractions of a contact under Coulomb friction: after a shift, or in steady rolling.

In rolling the derivative of the displacement along y is of second order at any offset b from a cell's centre:

    du/dy (y + b dy) = [(b - 3/2) u_0 + (2 - 2 b) u_1 + (b - 1/2) u_2] / dy,

from a cell and the two cells ahead. The offsets of docs/explanation/rolling.md are fitted to Carter's solution.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import fft

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.case.motion import RESULTANTS, Rolling, Shift
from contactstudy.checks import Array, BoolArray, ComplexArray, FloatArray, IntArray
from contactstudy.contact.normal.contact import Settings
from contactstudy.contact.normal.problem import cell_means, halve_cells
from contactstudy.contact.normal.two_bodies import PairOperator
from contactstudy.contact.rolling.coulomb import (
    CoulombProblem,
    CoulombSolution,
    Guess,
    law_violation,
    solve_with_continuation,
)
from contactstudy.contact.rolling.fastsim import solve_strips
from contactstudy.contact.rolling.surfaces import TANGENTIAL, LeadingEdges, Surfaces, Tractions, check_forces
from contactstudy.kernels.load import Load, Response
from contactstudy.kernels.strips import ColumnsRequest, surface_kernel

MIN_LEADING_LENGTH = 0.72  # least fraction c in the contact of a leading cell with an unknown traction. Accuracy.
EDGE_OFFSET = -0.84  # position b of the slip less the fraction c. Accuracy.
DEPENDENT_OFFSET, SLIPPING_OFFSET = 0.475, 1 / 3  # position b with a dependent or slipping leading cell. Accuracy.
MIN_CELLS = 6  # least number of cells along y with which the pressure determines the edge. Accuracy.
LEADING_LENGTH_RANGE = (0.25, 1.4)  # range of c, from a nearly unloaded cell to a fraction of the next. Accuracy.


@dataclass(frozen=True, kw_only=True, eq=False)
class RollingCells:
    """Cells of a contact in steady rolling along +y."""

    bound: FloatArray  # (x, y): bound on the traction, Pa
    is_unknown: BoolArray  # (x, y): cells with an unknown traction
    offset: FloatArray  # (unknown): position of the slip in each cell, in cells ahead of the centre
    ratio: FloatArray  # (x, y): traction over that of `source`: 1 in unknown cells, 0 in cells without traction

    @cached_property
    def unknown(self) -> IntArray:
        """Row and column of the cells with unknown tractions: array (2, unknown)."""
        return np.argwhere(self.is_unknown).T

    @cached_property
    def source(self) -> IntArray:
        """Index of the unknown cell that each cell follows, (x, y): itself, or the cell behind a dependent cell."""
        return np.asarray(np.maximum(np.cumsum(self.is_unknown).reshape(self.is_unknown.shape) - 1, 0))

    @classmethod
    def of(
        cls,
        pressure: FloatArray,
        bound: FloatArray,
        weights: FloatArray | None = None,
        leading: LeadingEdges | None = None,
    ) -> RollingCells:
        """Cells of a contact under `pressure` (x, y), with the bound on the traction."""
        slips_at_edge, edge_pressure = (np.zeros(pressure.shape[0], bool), pressure) if leading is None else leading
        loaded: BoolArray = (pressure > 0) & (bound > 0)
        leading_cells = np.argwhere(loaded & ~np.pad(loaded, ((0, 0), (0, 1)))[:, 1:])
        offset = np.full(pressure.shape, EDGE_OFFSET + 1.0)
        is_unknown, ratio = loaded.copy(), loaded.astype(np.float64)
        for row, last_column in leading_cells:
            unloaded_columns = np.flatnonzero(~loaded[row, : last_column + 1])
            first_column = int(unloaded_columns[-1]) + 1 if unloaded_columns.size else 0
            if slips_at_edge[row]:
                offset[row, first_column : last_column + 1] = SLIPPING_OFFSET
                continue
            if last_column + 1 - first_column < MIN_CELLS:
                continue
            leading_length = _inside_length(edge_pressure[row, first_column : last_column + 1])
            if leading_length >= MIN_LEADING_LENGTH:
                offset[row, first_column : last_column + 1] = EDGE_OFFSET + leading_length  # eq. (44a)
            else:
                offset[row, first_column : last_column + 1] = DEPENDENT_OFFSET
                is_unknown[row, last_column] = False
                ratio[row, last_column] = bound[row, last_column] / bound[row, last_column - 1]
        if weights is not None:
            weight = weights @ loaded
            offset = weights @ (loaded * offset) / np.where(weight > 0, weight, 1.0)
        return cls(bound=bound, is_unknown=is_unknown, offset=offset[is_unknown], ratio=ratio)

    @property
    def limits(self) -> FloatArray:
        """Bounds of the unknown cells, Pa: array (unknown)."""
        return np.asarray(self.bound[self.is_unknown])

    def on_grid(self, values: Array) -> Array:
        """Values (..., x, y) on all cells from values (..., unknown); a dependent cell has the value of its source."""
        return np.where(self.ratio > 0, np.take(values, self.source, axis=-1), values.dtype.type(0))

    def gather(self, weights: FloatArray) -> FloatArray:
        """Weights (resultant, unknown) of the unknown tractions, from weights (resultant, x, y) of all cells."""
        loaded, count = self.ratio > 0, self.offset.size
        return np.array([np.bincount(self.source[loaded], (self.ratio * weight)[loaded], count) for weight in weights])

    def derivative(self, displacement: FloatArray, dy: float) -> FloatArray:
        """Return the derivative (unknown) along y of a displacement (x, y), constant beyond the last cell."""
        row, column = self.unknown
        b, last = self.offset, displacement.shape[1] - 1
        u0, u1, u2 = (displacement[row, np.minimum(column + step, last)] for step in (0, 1, 2))
        return np.asarray(((b - 1.5) * u0 + (2 - 2 * b) * u1 + (b - 0.5) * u2) / dy)


def averaging_weights(x: FloatArray, widths: FloatArray, dy: float) -> FloatArray | None:
    """Weights (column, column) of all columns in each column's offset of the slip; None if columns are far apart."""
    # At different offsets the slips of columns within a cell's length would differ by more than their tractions.
    proximity = np.maximum(1 - np.abs(x[:, None] - x) / dy, 0.0)
    return proximity * widths if np.count_nonzero(proximity) > x.size else None


def _inside_length(pressure: FloatArray) -> float:
    """Distance, in cells, from the inner border of the last cell to the contact's edge."""
    # A parabola through the squared pressures of the third to fifth last cells locates the edge, which affects the
    # last two. The contact may reach into the next cell, although this cell has no pressure.
    square_2, square_1, square_0 = pressure[-5:-2] ** 2  # at 2, 1 and 0 cells behind the third last
    bend, slope = 0.5 * (square_2 - 2 * square_1 + square_0), 0.5 * (square_2 - 4 * square_1 + 3 * square_0)
    # square_0 + slope s + bend s**2 = 0, s ahead of the third last centre
    discriminant = slope**2 - 4 * bend * square_0
    if discriminant < 0 or slope >= 0:
        return 1.0
    distance = 2 * square_0 / (np.sqrt(discriminant) - slope)
    # 1.5 cells lie between the third last centre and the inner border of the last cell.
    return float(np.clip(distance - 1.5, *LEADING_LENGTH_RANGE))


NESTED_CELLS = 600  # least number of cells of a contact that is first solved on coarser cells. Speed.
COARSE_TOLERANCE = 1e-3  # tolerance on coarser cells, and of the solution that determines the sliding columns. Speed.
MAX_STICKING_RATIO = 0.999  # largest traction of a sticking cell in a guess, over its bound. Speed.


@dataclass(frozen=True, eq=False, kw_only=True)
class FrictionRequest:
    """Friction and motion of a contact."""

    motion: Shift | Rolling  # motion of the shape against the body
    friction: float | FloatArray  # broadcasts to (x, y): coefficient of friction, not negative
    reference_x: float  # position x to which spin and moment refer, metres
    coupled: bool  # whether the tractions also displace the surfaces normally and so change the pressure
    start: Mapping[Load, FloatArray] | None = None  # (x, y): pressure and tractions at the start of a shift; default: 0
    coarse: Tractions | None = None
    """Guess on half as many cells along y, and along x half as many or the same; default: on many uniform cells the
    guess is computed first."""
    max_steps: int | None = None  # bound on the Newton steps; default: the bound on the iterations


def solve_tractions(
    request: FrictionRequest, settings: Settings, surfaces: Surfaces, pressure: FloatArray, previous: Tractions | None
) -> Tractions:
    """Tractions under a pressure; `previous` is a guess under a similar pressure with leading edges to retain."""
    grid, motion = surfaces.grid, request.motion
    bound = np.asarray(request.friction * pressure)
    is_rolling = isinstance(motion, Rolling)
    weights = averaging_weights(grid.x, grid.widths, grid.dy)
    if is_rolling:
        cells = RollingCells.of(pressure, bound, weights)
    else:
        loaded = bound > 0
        cells = RollingCells(
            bound=bound, is_unknown=loaded, offset=np.zeros(np.count_nonzero(loaded)), ratio=loaded.astype(np.float64)
        )
    check_forces(motion, bound, surfaces.weights)
    if not cells.offset.size:
        zero = np.zeros((2, *grid.shape))
        sticks = np.zeros(grid.shape, bool)
        return Tractions.of(surfaces, motion.amplitudes, bound=bound, traction=zero, slip=zero, sticks=sticks)
    if isinstance(motion, Rolling) and motion.model == "fastsim":
        return solve_strips(motion, surfaces, bound)
    displacements = surfaces.operator.compute_displacements({Load.NORMAL: pressure}, TANGENTIAL)
    if request.start is not None:
        for direction, start_displacement in surfaces.operator.compute_displacements(request.start, TANGENTIAL).items():
            displacements[direction] = displacements[direction] - start_displacement

    def solve(cells: RollingCells, tolerance: float, guess: Guess | None) -> Tractions:
        problem = _coulomb_problem(motion, surfaces, cells, displacements)
        max_steps = settings.max_iterations if request.max_steps is None else request.max_steps
        problem = replace(problem, tolerance=tolerance, max_steps=max_steps)
        solution = solve_with_continuation(problem, guess)
        return _complete_tractions(problem, solution, motion, cells, surfaces)

    steps = 0
    if previous is None or previous.leading is None:
        coarse = request.coarse
        if coarse is None and cells.offset.size >= NESTED_CELLS:
            coarse = _solve_coarse(request, settings, surfaces, pressure, bound)
        guess = None if coarse is None else guess_from_coarse(coarse, cells, motion.modes)
        previous = solve(cells, max(settings.tolerance, COARSE_TOLERANCE) if is_rolling else settings.tolerance, guess)
        if not is_rolling:
            return previous
        if not previous.converged:
            return _average_slip(previous, surfaces, displacements)
        steps = previous.steps
    # Slipping edges determined anew for each pressure of a coupled contact would alternate.
    leading_edges = previous.leading or LeadingEdges(find_slipping_edges(previous.sticks, bound > 0), pressure)
    cells = RollingCells.of(pressure, bound, weights, leading_edges)
    tractions = solve(cells, settings.tolerance, guess_from_last(previous, cells, motion.modes))
    averaged = _average_slip(tractions, surfaces, displacements)
    return replace(averaged, steps=steps + tractions.steps, leading=leading_edges)


def find_slipping_edges(sticks: BoolArray, loaded: BoolArray) -> BoolArray:
    """Whether the leading cell of each column slips (x)."""
    # The traction begins as a square root at a sticking edge, which eq. (44a) corrects; it equals its bound otherwise.
    last_columns = loaded.shape[1] - 1 - loaded[:, ::-1].argmax(axis=1)
    return np.asarray(~sticks[np.arange(last_columns.size), last_columns])


def _coulomb_problem(
    motion: Shift | Rolling, surfaces: Surfaces, cells: RollingCells, load_displacements: Mapping[Load, FloatArray]
) -> CoulombProblem:
    """Coulomb's law on the cells, with the displacements under the pressure and the tractions at the start."""
    grid, is_rolling = surfaces.grid, isinstance(motion, Rolling)

    def elastic_slip(displacements: Mapping[Load, FloatArray]) -> FloatArray:
        """Slip (2, unknown) due to displacements."""
        if is_rolling:
            return np.stack([cells.derivative(displacements[direction], grid.dy) for direction in TANGENTIAL])
        return np.stack([-displacements[direction][cells.is_unknown] for direction in TANGENTIAL])

    def apply_compliance(traction: FloatArray) -> FloatArray:
        loads = dict(zip(TANGENTIAL, cells.ratio * cells.on_grid(traction), strict=True))
        return -elastic_slip(surfaces.operator.compute_displacements(loads, TANGENTIAL))

    amplitudes, modes, weights = motion.amplitudes, motion.modes, surfaces.weights
    rows, columns = cells.unknown
    x, y = grid.x[rows], grid.y[columns] + cells.offset * grid.dy
    unit_slips = {name: surfaces.rigid_slip(name, x, y) for name in amplitudes}
    prescribed_slip = elastic_slip(load_displacements) + sum(
        (amplitude * unit_slips[name] for name, amplitude in amplitudes.items() if name not in modes), np.zeros((2, 1))
    )  # eq. (44)
    mode_weights = np.array([cells.gather(weights[list(amplitudes).index(name)]) for name in modes])
    return CoulombProblem(
        apply_compliance=apply_compliance,
        inverse=tangential_inverse(surfaces.materials, cells.unknown, grid, rolling=is_rolling),
        bound=cells.limits,
        prescribed_slip=prescribed_slip,
        modes=np.array([unit_slips[name] for name in modes]).reshape(len(modes), *prescribed_slip.shape),
        resultant_weights=mode_weights.reshape(len(modes), *prescribed_slip.shape),
        resultants=np.array(list(motion.resultants.values())),
        relative_areas=np.broadcast_to(grid.weights, grid.shape)[cells.is_unknown],
        symmetric=not is_rolling,
    )


def _solve_coarse(
    request: FrictionRequest, settings: Settings, surfaces: Surfaces, pressure: FloatArray, bound: FloatArray
) -> Tractions | None:
    """Solve on cells of twice the size; None on graded cells, or if the cells cannot be paired."""
    grid = surfaces.grid
    operator = surfaces.operator
    if grid.cells_x % 2 or grid.cells_y % 2 or not grid.uniform:
        return None
    if isinstance(operator, PairOperator) and not operator.has_paired_cells:
        return None
    coarse_pressure, coarse_bound = cell_means(pressure), cell_means(bound)
    start = request.start
    coarse = replace(
        request,
        friction=coarse_bound / np.where(coarse_pressure > 0, coarse_pressure, 1.0),
        start=None if start is None else {load: cell_means(values) for load, values in start.items()},
    )
    surfaces = surfaces._replace(operator=operator.coarse, grid=grid.coarsened())
    settings = settings._replace(tolerance=COARSE_TOLERANCE)
    # The friction times the pressure equals the mean of the bound up to rounding.
    return replace(solve_tractions(coarse, settings, surfaces, coarse_pressure, None), bound=coarse_bound)


def _complete_tractions(
    problem: CoulombProblem, solution: CoulombSolution, motion: Shift | Rolling, cells: RollingCells, surfaces: Surfaces
) -> Tractions:
    """Tractions of a solution, with resultants and certificate recomputed from the tractions."""
    scale = problem.slip_scale(solution.amplitudes)
    bound_error, slip_error = law_violation(solution.traction, solution.slip, problem.bound, solution.sticks, scale)
    traction = cells.ratio * cells.on_grid(solution.traction)
    slip, sticks = cells.on_grid(np.where(solution.sticks, 0.0, solution.slip)), cells.on_grid(solution.sticks)
    amplitudes = motion.amplitudes | dict(zip(motion.modes, solution.amplitudes.tolist(), strict=True))
    tractions = Tractions.of(surfaces, amplitudes, bound=cells.bound, traction=traction, slip=slip, sticks=sticks)
    max_resultants = (np.abs(surfaces.weights).sum(axis=1) * np.hypot(*traction)).sum(axis=(1, 2)).tolist()
    errors = [
        abs(tractions.resultants[name] - motion.resultants[mode]) / max(size, 1e-300)
        for (mode, name), size in zip(RESULTANTS.items(), max_resultants, strict=True)
        if mode in motion.modes
    ]
    return replace(
        tractions,
        bound_error=bound_error,
        slip_error=slip_error,
        force_error=max(errors, default=0.0),
        steps=solution.steps,
        converged=solution.converged,
    )


def _average_slip(tractions: Tractions, surfaces: Surfaces, displacements: Mapping[Load, FloatArray]) -> Tractions:
    """Tractions of rolling with the frictional work per distance, and the mean slip of each slipping cell."""
    # Means over cells are central differences, whose work equals the work of the rigid slip by reciprocity. The slip is
    # scaled to this work (without slip the work is an error of the differences). A cell in which slip begins counts
    # as sticking; a cell next to a cell without pressure retains its slip.
    grid, traction = surfaces.grid, tractions.traction
    loads = dict(zip(TANGENTIAL, traction, strict=True))
    response = surfaces.operator.compute_displacements(loads, TANGENTIAL)
    displacement = np.stack([displacements[direction] + response[direction] for direction in TANGENTIAL])
    mean_slip = np.gradient(displacement, grid.dy, axis=2)  # eq. (44)
    for name, amplitude in tractions.amplitudes.items():
        mean_slip += amplitude * surfaces.rigid_slip(name, grid.x[:, None], grid.y)
    work = float((traction * mean_slip * surfaces.areas).sum())
    traction_size = np.hypot(*traction)
    direction = traction / np.where(traction_size > 0, traction_size, 1.0)
    is_loaded = np.pad(traction_size > 0, ((0, 0), (1, 1)))
    slip_along_traction = (mean_slip * direction).sum(axis=0)
    slips_inside = is_loaded[:, :-2] & is_loaded[:, 2:] & ~tractions.sticks & (slip_along_traction > 0)
    slip = np.where(slips_inside, slip_along_traction * direction, tractions.slip)
    cells_work = float((traction * slip * surfaces.areas).sum())
    scale = work / cells_work if min(work, cells_work) > 0 else 1.0
    return replace(tractions, slip=slip * scale, work=cells_work * scale)


def guess_from_coarse(coarse: Tractions, cells: RollingCells, modes: tuple[str, ...]) -> Guess:
    """Guess on finer cells from coarse tractions."""
    row, column = cells.unknown
    factor = cells.bound.shape[0] // coarse.bound.shape[0]
    fraction = coarse.traction / np.where(coarse.bound > 0, coarse.bound, 1.0)
    # Slipping cells carry their bound; inside the stick zone the traction over the bound is interpolated.
    parent_cells = row // factor, column // 2
    fine_fraction = halve_cells(fraction, 2)
    if factor == 2:
        fine_fraction = halve_cells(fine_fraction, 1)
    interpolated = fine_fraction[:, row, column]
    size = np.hypot(*interpolated)
    limited = interpolated * np.minimum(1.0, MAX_STICKING_RATIO / np.where(size > 0, size, 1.0))
    sticks = coarse.sticks[parent_cells]
    traction = np.where(sticks, limited, fraction[:, parent_cells[0], parent_cells[1]]) * cells.limits
    return Guess(traction, np.array([coarse.amplitudes[name] for name in modes]))


def guess_from_last(previous: Tractions, cells: RollingCells, modes: tuple[str, ...]) -> Guess:
    """Guess from previous tractions on the same cells under a similar bound."""
    traction, limit = previous.traction[:, cells.is_unknown], cells.limits
    size = np.hypot(*traction)
    limited = np.where(previous.sticks[cells.is_unknown], np.minimum(size, MAX_STICKING_RATIO * limit), limit)
    amplitudes = np.array([previous.amplitudes[name] for name in modes])
    return Guess(traction * (limited / np.where(size > 0, size, 1.0)), amplitudes)


# Preconditioners: the half-space's tangential compliance, inverted wavenumber by wavenumber. On uniform cells the
# transform runs along both axes; on graded cells along y alone, with one matrix along x for each wavenumber.


class TangentialInverse:
    """Inverse of the tangential compliance, or of its reversed derivative along y, on uniform cells."""

    def __init__(self, materials: list[Material], cells: IntArray, cell: tuple[float, float], *, rolling: bool) -> None:
        first_cell = cells.min(axis=1)
        self._cells, self._root = tuple(cells - first_cell[:, None]), _leading_root(cells, rolling=rolling)
        window_size = cells.max(axis=1) - first_cell + 1
        self._shape = tuple(fft.next_fast_len(int(2 * count), real=True) for count in window_size)
        x, y = (step * np.arange(count // 2 + 1.0) for count, step in zip(self._shape, cell, strict=True))
        kernels = _compliances(materials, lambda response, poisson: surface_kernel(response, poisson, x, y, cell))
        xx, xy, yy = (_spectrum(*response, self._shape) for response in zip(kernels, COMPONENTS, strict=True))
        if rolling:
            derivative = _derivative(self._shape[1], cell[1])
            xx, xy, yy = derivative * xx, derivative * xy, derivative * yy
        determinant = xx * yy - xy * xy
        # Single precision suffices for a preconditioner. Speed.
        entries = (yy / determinant, -xy / determinant, xx / determinant)
        self._inverse = tuple(entry.astype(np.complex64) for entry in entries)

    def __call__(self, slip: FloatArray) -> FloatArray:
        """Approximate tractions (2, cell) that relieve a slip (2, cell)."""
        slip = slip / self._root
        scale = float(np.abs(slip).max()) or 1.0
        spectra = []
        for component in slip:
            padded_slip = np.zeros(self._shape, np.float32)
            padded_slip[self._cells] = component / scale
            spectra.append(fft.rfft2(padded_slip))
        xx, xy, yy = self._inverse
        solution = (xx * spectra[0] + xy * spectra[1], xy * spectra[0] + yy * spectra[1])
        tractions = np.stack([fft.irfft2(spectrum, self._shape)[self._cells] for spectrum in solution]).astype(
            np.float64
        )
        return scale * self._root * tractions


class ColumnsInverse:
    """Inverse of the tangential compliance, or of its reversed derivative along y, on cells of any width."""

    # After a transform along y, with components along y times i, the compliance is a real matrix per wavenumber.

    def __init__(self, materials: list[Material], cells: IntArray, grid: Grid, *, rolling: bool) -> None:
        (first_x, first_y), (last_x, last_y) = cells.min(axis=1), cells.max(axis=1)
        self._cells, self._root = tuple(cells - np.array([[first_x], [first_y]])), _leading_root(cells, rolling=rolling)
        edges, count = grid.x_edges[first_x : last_x + 2], int(last_y - first_y + 1)
        self._rows, self._padded = int(last_x - first_x + 1), 2 * count
        self._widths = np.diff(edges)
        columns = ColumnsRequest(edges=edges, dy=grid.dy, cells_y=count, extent=(-np.inf, np.inf))
        xx, xy, yy = _compliances(materials, columns.kernel)
        self._inverse = np.linalg.inv(np.block([[xx, -xy], [xy, yy]]))
        self._derivative = _derivative(self._padded, grid.dy) if rolling else np.ones(count + 1, dtype=np.complex128)

    def __call__(self, slip: FloatArray) -> FloatArray:
        """Approximate tractions (2, cell) that relieve a slip (2, cell)."""
        padded_slips = np.zeros((2, self._rows, self._padded))
        padded_slips[:, *self._cells] = slip / self._root
        spectra = fft.rfft(padded_slips) / self._derivative
        spectra[1] *= -1j
        vectors = spectra.reshape(2 * self._rows, -1).T
        solution = np.matmul(self._inverse, np.stack([vectors.real, vectors.imag], axis=-1))
        spectra = (solution[..., 0] + 1j * solution[..., 1]).T.reshape(spectra.shape)
        spectra[1] *= 1j
        tractions = fft.irfft(spectra, self._padded)[:, *self._cells]
        return np.asarray(self._root * tractions / self._widths[self._cells[0]])


def tangential_inverse(
    materials: list[Material], cells: IntArray, grid: Grid, *, rolling: bool
) -> TangentialInverse | ColumnsInverse:
    """Return the inverse for uniform or graded cells."""
    if not grid.observes_means:
        return TangentialInverse(materials, cells, (grid.dx, grid.dy), rolling=rolling)
    return ColumnsInverse(materials, cells, grid, rolling=rolling)


def _derivative(cell_count: int, dy: float) -> ComplexArray:
    """Spectrum of the reversed derivative along y, by the differences of `RollingCells.derivative`."""
    # The derivative at b = 1/2, ahead of the solver's, damps short waves. An added constant, 1.5 times the derivative
    # at the first wavenumber, makes the derivative of a constant invertible. Speed.
    phase = 2 * np.pi * np.arange(cell_count // 2 + 1) / cell_count
    derivative = -(np.exp(1j * phase) - 1.0) / dy
    return np.asarray(derivative + 1.5 * phase[1] / dy)


def _leading_root(cells: IntArray, *, rolling: bool) -> FloatArray:
    """Square root with which tractions rise behind the leading edge of each row: array (cell)."""
    # The derivative along y of the compliance is a Hilbert transform. Its inverse on an interval is the inverse on the
    # whole line, multiplied by this factor from the left and by its reciprocal from the right.
    if not rolling:
        return np.ones(cells.shape[1])
    row, column = cells
    first, last = np.full(row.max() + 1, column.max()), np.zeros(row.max() + 1, dtype=np.int64)
    np.minimum.at(first, row, column)
    np.maximum.at(last, row, column)
    return np.asarray(np.sqrt((last[row] + 0.5 - column) / (last[row] - first[row] + 1.0)))


COMPONENTS = (
    Response(Load.ALONG_X, Load.ALONG_X),
    Response(Load.ALONG_X, Load.ALONG_Y),
    Response(Load.ALONG_Y, Load.ALONG_Y),
)


def _compliances(materials: list[Material], kernel: Callable[[Response, float], FloatArray]) -> list[FloatArray]:
    """Kernels of all components of the displacement, summed over the bodies."""
    return [
        np.sum([kernel(response, body.poisson) / (4 * np.pi * body.shear_modulus) for body in materials], axis=0)
        for response in COMPONENTS
    ]


def _spectrum(kernel: FloatArray, response: Response, shape: tuple[int, ...]) -> ComplexArray:
    """Spectrum over a whole period of a kernel, given at non-negative offsets."""
    for axis, sign in enumerate((response.sign_x, response.sign_y)):
        offset_count = kernel.shape[axis]
        mirrored = np.flip(np.take(kernel, np.arange(1, shape[axis] - offset_count + 1), axis=axis), axis=axis)
        kernel = np.concatenate([kernel, sign * mirrored], axis=axis)
    return np.asarray(fft.rfft2(kernel))
