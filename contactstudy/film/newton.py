"""A film on arrays: problem, unknowns, and a semi-smooth Newton method for pressure, rigid motion and cavitation."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy import linalg, sparse
from scipy.sparse.linalg import LinearOperator, gmres

from contactstudy.checks import BoolArray, FloatArray, SingleArray
from contactstudy.errors import ContactStudyError
from contactstudy.film.reynolds import FilmCells, Fluid, Law, scale_columns, scale_rows

LOGGER = logging.getLogger(__name__)

INVERSE_STEPS = 8  # Steps from film to distance of rough surfaces; the next Newton step removes the remainder. Speed.


@dataclass(frozen=True, kw_only=True)
class FilmSettings:
    """Settings of the iteration.

    Attributes
    ----------
    tolerance : float
        Tolerance of a cell's net outflow over the flow ``um h_c``, and of the load's relative error. Accuracy.
    level_tolerance : float
        Tolerance on the coarser levels, which give first guesses and error estimates. Speed.
    steps : tuple of float
        Pseudo-time steps, in a / um, before the steady state. Speed.
    newton_steps : int
        Bound on the Newton steps of one pseudo-time step; the steady state may take five times as many. Speed.
    linear_tolerance : float
        Tolerance of the linear systems. Speed.
    linear_steps : int
        Bound on the steps of one linear system. Speed.
    elimination_ratio : float
        Residual over the previous residual below which the preconditioner is reused. Speed.
    max_closing : float
        Largest relative decrease of the film of a cell in one step. Speed.
    max_pressure_change : float
        Largest change of the pressure in one step, over Hertz' pressure of the column with the largest load. Speed.
    closed_film_ratio, nearly_closed_ratio : float
        Film over the central film below which an iteration ends, and below which a failure is a closed film.
    """

    tolerance: float = 1e-7
    level_tolerance: float = 1e-3
    steps: tuple[float, ...] = (0.3, 0.9, 2.7, 8.1, 24.0, 73.0)
    newton_steps: int = 12
    linear_tolerance: float = 1e-2
    linear_steps: int = 200
    elimination_ratio: float = 0.1
    max_closing: float = 0.6
    max_pressure_change: float = 0.3
    closed_film_ratio: float = 1e-6
    nearly_closed_ratio: float = 1e-3


SETTINGS = FilmSettings()  # Default settings


@dataclass(frozen=True, kw_only=True, eq=False)
class FilmProblem:
    """A film to solve, in the units of `FilmCells`."""

    cells: FilmCells
    fluid: Fluid
    gap: FloatArray  # (x, y): gap before deformation
    displace: Callable[[FloatArray], FloatArray]  # displacement of the surfaces apart (x, y) under a pressure
    column_stiffness: SingleArray  # (x, y, y): displacement of a column's cells under a pressure equal in all columns
    load: float  # prescribed sum of the pressure times the areas
    lever: FloatArray | None  # (x): distances from the load's position over the largest one, if free to tilt
    central_film: float  # estimate of the central film: the scale of tolerances
    asperities: Callable[[FloatArray], Law] | None = None  # pressure of the asperities at a distance of the surfaces
    mean_height: Callable[[FloatArray], Law] | None = None  # film at a distance of rough surfaces

    @cached_property
    def motions(self) -> FloatArray:
        """Changes of the distance of the surfaces by unit rigid motions: array (motion, cell)."""
        ones = np.ones(self.cells.shape)
        motions = [ones] if self.lever is None else [ones, self.lever[:, None] * ones]
        return np.stack([motion.ravel() for motion in motions])

    @cached_property
    def resultants(self) -> FloatArray:
        """Factors by which a sum over the pressure gives load and moment: array (motion, cell)."""
        return np.asarray(self.motions * self.cells.areas.ravel())

    def compute_film(self, distance: FloatArray) -> Law:
        """Mean height of the film at a distance of the surfaces."""
        return Law(distance, np.ones_like(distance)) if self.mean_height is None else self.mean_height(distance)

    def create_state(self, pressure: FloatArray, motion: FloatArray, distance: FloatArray) -> FilmState:
        """Return a state with the mismatch of the given values."""
        rigid_displacement = (motion @ self.motions).reshape(self.gap.shape)
        return FilmState(pressure, motion, distance, distance - self.gap - self.displace(pressure) - rigid_displacement)

    def solve_distance(self, height: FloatArray, start: FloatArray) -> FloatArray:
        """Distance of the surfaces at a mean film, by Newton's method for the film's logarithm from a `start`."""
        if self.mean_height is None:
            return height
        # The mean height exceeds the distance of the surfaces by at most the height at distance zero.
        touching_height = self.mean_height(np.zeros_like(height)).value
        distance = np.where(height > touching_height, np.maximum(start, height - touching_height), start)
        for _ in range(INVERSE_STEPS):
            film = self.mean_height(distance)
            distance = distance + film.value / film.slope * np.log(height / film.value)
        return distance


class FilmState(NamedTuple):
    """Unknowns of an iteration."""

    pressure: FloatArray  # (x, y): pressure on the surfaces, of fluid and asperities
    motion: FloatArray  # (motion): rigid motion, height and, if free, tilt
    distance: FloatArray  # (x, y): distance of the surfaces, unknown since a start may be interpolated from other cells
    mismatch: FloatArray  # (x, y): distance less the distance that pressure and motion cause


class FilmSolution(NamedTuple):
    """Solution of a film problem and its certificate."""

    state: FilmState
    fluid_pressure: FloatArray  # (x, y)
    asperity_pressure: FloatArray  # (x, y)
    film: FloatArray  # (x, y): mean height
    residual: float  # largest net outflow of a full cell over the central film
    balance_error: float  # flow out of all full cells, through their outer faces, over the central film and the length
    load_error: float  # error of load and moment over the load
    complementarity_error: float  # largest net inflow of a cavitated cell over the central film
    newton_steps: int
    linear_steps: int
    converged: bool  # whether every error is within the tolerance


class StepFailedError(ContactStudyError):
    """A pseudo-time step did not converge; the film closes at `position` (x, y), in half-widths, or is open (None)."""

    def __init__(self, message: str, position: tuple[float, float] | None = None) -> None:
        self.position = position
        super().__init__(message)


class _LinearisedEquations(NamedTuple):
    """Equations linearised about a state."""

    outflow: FloatArray  # (cell): net outflow per width
    residual: FloatArray  # (cell + motion): residuals over the cells' film, and residuals of load and moment
    pressure_jacobian: sparse.csr_array  # (cell, cell): derivatives of the cells' residuals at a fixed distance
    distance_jacobian: sparse.csr_array  # (cell, cell): derivatives at a fixed pressure
    cavitated: BoolArray  # (cell): cells with a broken film
    fluid_pressure: FloatArray
    asperity_pressure: FloatArray
    film: FloatArray


def solve_newton(
    problem: FilmProblem, guess: FilmState | None, settings: FilmSettings, make_start: Callable[[], FilmState]
) -> FilmSolution:
    """Solve for the film from a guess; without a guess, or if it fails, by pseudo-time steps from `make_start`."""
    iteration = _Iteration(problem, settings)
    if guess is not None:
        try:
            return iteration.converge(guess, np.inf, None)
        except StepFailedError:
            LOGGER.info("the guess is too far: pseudo-time steps")
    state = make_start()
    pending_steps = list(settings.steps)
    while pending_steps:
        step = pending_steps[0]
        try:
            state = iteration.converge(state, step, iteration.compute_mass(state)).state
            pending_steps.pop(0)
        except StepFailedError:
            if step < settings.steps[0] / 30:
                raise
            pending_steps.insert(0, step / 3)
    return iteration.converge(state, np.inf, None)


@dataclass(eq=False)
class _Iteration:
    """Newton's method for one problem."""

    problem: FilmProblem
    settings: FilmSettings
    newton_steps: int = 0
    linear_steps: int = 0

    def compute_mass(self, state: FilmState) -> FloatArray:
        """Mass of the film in each cell per area."""
        problem, pressure = self.problem, state.pressure
        fluid_pressure = pressure if problem.asperities is None else pressure - problem.asperities(state.distance).value
        film = problem.compute_film(state.distance).value
        return np.asarray((problem.fluid.density(fluid_pressure).value * film).ravel())

    def linearise(self, state: FilmState, step: float, mass: FloatArray | None) -> _LinearisedEquations:
        """Return residual and derivatives at a state."""
        problem = self.problem
        cells, distance = problem.cells, state.distance
        film = problem.compute_film(distance)
        no_pressure = Law(np.zeros(cells.shape), np.zeros(cells.shape))
        asperities = no_pressure if problem.asperities is None else problem.asperities(distance)
        fluid_pressure = state.pressure - asperities.value
        outflow, pressure_jacobian, distance_jacobian = cells.flow(problem.fluid, fluid_pressure, film)
        if mass is not None:
            density = problem.fluid.density(fluid_pressure.ravel())
            lengths = np.tile(cells.lengths, cells.shape[0]) / step
            outflow = outflow + lengths * (density.value * film.value.ravel() - mass)
            pressure_jacobian = pressure_jacobian + sparse.diags_array(lengths * density.slope * film.value.ravel())
            distance_jacobian = distance_jacobian + sparse.diags_array(lengths * density.value * film.slope.ravel())
        # The fluid pressure is the total pressure minus the pressure of the asperities.
        if problem.asperities is not None:
            distance_jacobian = distance_jacobian - scale_columns(pressure_jacobian, asperities.slope.ravel())
        elastic = _elastic_diagonal(problem.column_stiffness, distance_jacobian)
        diagonal = np.abs(pressure_jacobian.diagonal() + elastic)
        cavitated = fluid_pressure.ravel() - outflow / diagonal <= 0
        # The residual is divided by the film of the cell: a norm of pressures would neglect the far inlet.
        factors = np.where(cavitated, 0.0, 1 / film.value.ravel())
        pressure_jacobian = scale_rows(factors, pressure_jacobian) + sparse.diags_array(cavitated.astype(np.float64))
        cavity_slopes = cavitated * asperities.slope.ravel()
        distance_jacobian = scale_rows(factors, distance_jacobian) - sparse.diags_array(cavity_slopes)
        # The moment about the load's position is zero.
        prescribed = np.array([problem.load, 0.0][: len(problem.motions)])
        resultant_errors = problem.resultants @ state.pressure.ravel() - prescribed
        residual = np.where(cavitated, fluid_pressure.ravel(), outflow / film.value.ravel())
        return _LinearisedEquations(
            outflow=outflow,
            residual=np.concatenate([residual, resultant_errors / problem.load]),
            pressure_jacobian=sparse.csr_array(pressure_jacobian),
            distance_jacobian=sparse.csr_array(distance_jacobian),
            cavitated=cavitated,
            fluid_pressure=fluid_pressure,
            asperity_pressure=asperities.value,
            film=film.value,
        )

    def converge(self, state: FilmState, step: float, mass: FloatArray | None) -> FilmSolution:
        """Iterate to a pseudo-time step, or, without `mass`, to the steady state; raise on failure."""
        settings = self.settings
        max_steps = settings.newton_steps if mass is not None else 5 * settings.newton_steps
        elimination, norm, min_film_ratio = None, np.inf, np.inf
        for _ in range(max_steps):
            equations = self.linearise(state, step, mass)
            if not np.isfinite(equations.residual).all():
                break
            solution = self.certify(state, equations)
            if mass is None and solution.converged:
                return solution
            previous_norm, norm = norm, float(np.linalg.norm(equations.residual))
            if elimination is None or norm > settings.elimination_ratio * previous_norm:
                elimination = _ColumnElimination.of(equations, self.problem)
            change = self.solve_linear(equations, elimination, state.mismatch.ravel())
            state, step_fraction, pressure_change = self.apply_step(state, change)
            if mass is not None and step_fraction == 1 and pressure_change < 1e-3:
                return self.certify(state, self.linearise(state, step, mass))
            if self.problem.mean_height is None:
                min_film_ratio = float(state.distance.min()) / self.problem.central_film
            if min_film_ratio < settings.closed_film_ratio:
                break
        position = None
        if min_film_ratio < settings.nearly_closed_ratio:
            row, cell = np.unravel_index(int(state.distance.argmin()), state.distance.shape)
            position = float(self.problem.cells.x[row]), float(self.problem.cells.y[cell])
        raise StepFailedError(f"no convergence within {max_steps} Newton steps", position)

    def certify(self, state: FilmState, equations: _LinearisedEquations) -> FilmSolution:
        """Return the solution: a state and its certificate."""
        central_film, cavitated = self.problem.central_film, equations.cavitated
        # A cavitated cell may lose mass; a full cell loses none.
        residual = float(np.abs(equations.outflow[~cavitated]).max(initial=0.0)) / central_film
        # Flows between full cells cancel: the sum contains inlet, exit and both ends.
        widths = self.problem.cells.widths
        balance = (widths @ np.where(cavitated, 0.0, equations.outflow).reshape(widths.size, -1)).sum()
        inflow = float(np.maximum(-equations.outflow[cavitated], 0.0).max(initial=0.0)) / central_film
        cavity_pressure = float(np.abs(equations.fluid_pressure.ravel()[cavitated]).max(initial=0.0))
        load_error = float(np.abs(equations.residual[cavitated.size :]).max())
        mismatch = float(np.abs(state.mismatch).max()) / central_film
        return FilmSolution(
            state=state,
            fluid_pressure=np.maximum(equations.fluid_pressure, 0.0),
            asperity_pressure=equations.asperity_pressure,
            film=equations.film,
            residual=residual,
            balance_error=abs(float(balance)) / (central_film * float(widths.sum())),
            load_error=load_error,
            complementarity_error=max(inflow, cavity_pressure),
            newton_steps=self.newton_steps,
            linear_steps=self.linear_steps,
            converged=max(residual, inflow, cavity_pressure, load_error, mismatch) <= self.settings.tolerance,
        )

    def apply_step(self, state: FilmState, change: FloatArray) -> tuple[FilmState, float, float]:
        """Return the next state, the fraction of the step applied, and the largest change of the pressure, relative."""
        problem, settings = self.problem, self.settings
        cell_count = problem.gap.size
        pressure, motion = change[:cell_count].reshape(problem.gap.shape), change[cell_count:]
        distance = problem.displace(pressure) + (motion @ problem.motions).reshape(problem.gap.shape) - state.mismatch
        # Under a sharp end the Hertz pressure exceeds p0 by powers of ten; a spike of the film has no effect on it.
        hertz_pressure = np.sqrt(2 / np.pi * float((state.pressure @ problem.cells.lengths).max()))
        max_change = float(np.abs(pressure).max()) / hertz_pressure
        step_fraction = min(1.0, settings.max_pressure_change / max(max_change, 1e-300))
        linear_distance = state.distance + step_fraction * distance
        # Only closing cells are bounded. Between rough surfaces the film, not the distance, is linear in the step; the
        # next step removes the mismatch.
        film = problem.compute_film(state.distance)
        height = film.value + film.slope * (linear_distance - state.distance)
        height = np.maximum(height, (1 - settings.max_closing) * film.value)
        next_distance = problem.solve_distance(height, state.distance)
        next_state = FilmState(
            state.pressure + step_fraction * pressure,
            state.motion + step_fraction * motion,
            next_distance,
            (1 - step_fraction) * state.mismatch + (next_distance - linear_distance),
        )
        self.newton_steps += 1
        return next_state, step_fraction, max_change

    def solve_linear(
        self, equations: _LinearisedEquations, elimination: _ColumnElimination, mismatch: FloatArray
    ) -> FloatArray:
        """Change of pressure and rigid motion, by GMRES with elimination of columns as preconditioner, eq. (405)."""
        problem, settings = self.problem, self.settings
        cell_count = problem.gap.size
        motions, resultants = problem.motions, problem.resultants / problem.load
        pressure_jacobian, distance_jacobian = equations.pressure_jacobian, equations.distance_jacobian
        motion_jacobian = distance_jacobian @ motions.T
        inverse_motions = np.stack([elimination.solve(column) for column in motion_jacobian.T], axis=1)
        schur = np.linalg.inv(resultants @ inverse_motions)

        def precondition(outflows: FloatArray, load: FloatArray) -> tuple[FloatArray, FloatArray]:
            pressure = elimination.solve(outflows)
            motion = schur @ (resultants @ pressure - load)
            return pressure - inverse_motions @ motion, motion

        def apply(pressure: FloatArray, motion: FloatArray) -> FloatArray:
            displacement = problem.displace(pressure.reshape(problem.gap.shape)).ravel()
            outflows = pressure_jacobian @ pressure + distance_jacobian @ displacement + motion_jacobian @ motion
            return np.asarray(outflows)

        def count_step(_: object) -> None:
            self.linear_steps += 1

        # The preconditioner satisfies load and moment: the iteration is for the outflows alone.
        load_change, no_load = -equations.residual[cell_count:], np.zeros(len(motions))
        load_correction = precondition(np.zeros(cell_count), load_change)
        outflow_change = distance_jacobian @ mismatch - equations.residual[:cell_count] - apply(*load_correction)
        operator = LinearOperator(
            (cell_count, cell_count), matvec=lambda outflows: apply(*precondition(outflows, no_load)), dtype=np.float64
        )
        outflows, _ = gmres(
            operator,
            outflow_change,
            rtol=settings.linear_tolerance,
            restart=settings.linear_steps,
            maxiter=1,
            callback=count_step,
            callback_type="pr_norm",
        )
        return np.concatenate(precondition(outflows, load_change))


def _select_column_entries(matrix: sparse.csr_array, cell_count: int) -> sparse.csr_array:
    """Entries between cells of the same column: array (cell, cell of the column)."""
    entries = matrix.tocoo()
    is_inside = entries.row // cell_count == entries.col // cell_count
    row, column_cell = entries.row[is_inside], entries.col[is_inside] % cell_count
    return sparse.csr_array((entries.data[is_inside], (row, column_cell)), (matrix.shape[0], cell_count))


def _elastic_diagonal(stiffness: SingleArray, distance_jacobian: sparse.csr_array) -> FloatArray:
    """Diagonal (cell) of the product of the derivative by the distance and the columns' stiffness."""
    entries = _select_column_entries(distance_jacobian, cell_count := stiffness.shape[1]).tocoo()
    products = entries.data * stiffness[entries.row // cell_count, entries.col, entries.row % cell_count]
    return np.asarray(np.bincount(entries.row, products, minlength=distance_jacobian.shape[0]), dtype=np.float64)


@dataclass(frozen=True, eq=False)
class _ColumnElimination:
    """Elimination of the columns one after the other, as if the pressure changed equally in all columns."""

    inverses: SingleArray  # (x, y, y): of the columns' equations after elimination of earlier columns
    lower: SingleArray  # (x, y): coefficients of the pressures in the column before; `upper`: in the column after
    upper: SingleArray

    @classmethod
    def of(cls, equations: _LinearisedEquations, problem: FilmProblem) -> _ColumnElimination:
        """Return the elimination of the linearised equations."""
        columns, cell_count = problem.cells.shape
        lower, upper = np.zeros((2, columns, cell_count), dtype=np.float32)
        lower[1:] = equations.pressure_jacobian.diagonal(-cell_count).reshape(-1, cell_count)
        upper[:-1] = equations.pressure_jacobian.diagonal(cell_count).reshape(-1, cell_count)
        distance_jacobian = _select_column_entries(equations.distance_jacobian, cell_count)
        pressure_jacobian = _select_column_entries(equations.pressure_jacobian, cell_count)
        inverses = np.empty((columns, cell_count, cell_count), dtype=np.float32)
        for column, stiffness in enumerate(problem.column_stiffness):
            cells = slice(column * cell_count, (column + 1) * cell_count)
            matrix = distance_jacobian[cells] @ stiffness + pressure_jacobian[cells].toarray()
            if column:
                matrix -= lower[column][:, None] * inverses[column - 1] * upper[column - 1]
            inverses[column] = linalg.inv(matrix, overwrite_a=True, check_finite=False)
        return cls(inverses, lower, upper)

    def solve(self, residual: FloatArray) -> FloatArray:
        """Pressures that remove a residual: array (cell)."""
        pressures = residual.reshape(self.lower.shape).astype(np.float32)
        for column in range(1, len(pressures)):
            pressures[column] -= self.lower[column] * (self.inverses[column - 1] @ pressures[column - 1])
        pressures[-1] = self.inverses[-1] @ pressures[-1]
        for column in range(len(pressures) - 2, -1, -1):
            pressures[column] = self.inverses[column] @ (pressures[column] - self.upper[column] * pressures[column + 1])
        return pressures.ravel().astype(np.float64)
