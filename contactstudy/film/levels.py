"""Film of a case on the cells of one level of refinement."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy
import xarray as xr
from scipy.fft import next_fast_len

from contactstudy import checks
from contactstudy.bodies import hertz
from contactstudy.bodies.lubricant import Lubricant
from contactstudy.case.case import Case
from contactstudy.case.gridding import graded_grid
from contactstudy.case.motion import Sliding, SurfaceSpeeds
from contactstudy.checks import FloatArray, IntArray, SingleArray
from contactstudy.contact.normal.contact import Contact, Shape, contact_operator
from contactstudy.contact.normal.prescribed_loads import RigidMotion
from contactstudy.contact.normal.problem import ContactProblem, solve_normal
from contactstudy.contact.refinement.refined_contact import contact_shape, refine_contact
from contactstudy.errors import InvalidInputError
from contactstudy.film.asperities import Asperities
from contactstudy.film.newton import FilmProblem, FilmSettings, FilmSolution, FilmState, StepFailedError, solve_newton
from contactstudy.film.reynolds import FilmCells, Fluid, graded_edges
from contactstudy.kernels.load import Load

# Shortest and longest distances of `FilmResolution` over the inlet length. A longer inlet thickens the film of a line
# contact by 0.1 % at M = 20, by 0.2 % at M = 1000; an outlet of 0.25 suffices. Accuracy.
WINDOW_RANGES = {"inlet": (25.0, 100.0), "outlet": (1.0, 100.0)}
THICK_FILM_RATIO = 3.0  # film over the central film from which on a first guess is consistent with its pressure. Speed.


@dataclass(frozen=True, kw_only=True)
class FilmResolution:
    """Cells of the film. `inlet_length` is ``a (h_c R / a**2)**(2/3)``, over which the film forms.

    Attributes
    ----------
    finest : float
        Narrowest cells along y over the inlet length, on the coarsest level. Accuracy.
    finest_share : float
        Narrowest cells along y over the half-width, at most, on the coarsest level. Accuracy.
    inner : float
        Widest cells along y inside the contact over the half-width, on the coarsest level. Accuracy.
    inner_inlet : float
        Widest cells along y inside the contact over the inlet length, at most, on the coarsest level. Accuracy.
    growth : float
        Growth of the cells along y with the distance from the contact's edges. Accuracy.
    columns : float
        Narrowest columns over the half-width, on the coarsest level: at both ends of the contact. Accuracy.
    columns_inlet : float
        Narrowest columns over the inlet length, at most, on the coarsest level. Accuracy.
    columns_growth : float
        Growth of the columns with the distance from these ends, on the coarsest level. Accuracy.
    widest_column : float
        Widest columns over the half-width. Accuracy.
    inlet, outlet : float
        Distances of the window's ends from the contact's edges, over the inlet length. Accuracy.
    ratio : float
        Ratio of the widths of cells along y on two successive levels; narrowest columns have the square of this ratio.
    levels : int
        Maximum number of levels of each direction, at least 3.
    most_cells : int
        Maximum number of uniform cells along y. Speed.
    dry_accuracy, dry_tolerance : float
        Accuracy of the dry contact that defines the window, and tolerance of the dry contact that is the start. Speed.
    """

    finest: float = 0.55
    finest_share: float = 0.12
    inner: float = 0.16
    inner_inlet: float = 2.5
    growth: float = 0.12
    columns: float = 0.12
    columns_inlet: float = 0.4
    columns_growth: float = 0.35
    widest_column: float = 10.0
    inlet: float = 25.0
    outlet: float = 8.0
    ratio: float = 2**0.5
    levels: int = 5
    most_cells: int = 4096
    dry_accuracy: float = 0.05
    dry_tolerance: float = 1e-5

    def __post_init__(self) -> None:
        """Check the window, whose effect the estimated errors omit."""
        for name, (shortest, longest) in WINDOW_RANGES.items():
            if not shortest <= checks.positive(name, length := getattr(self, name)) <= longest:
                hint = "`inlet` of solve_film is the position of a meniscus" if name == "inlet" else ""
                raise InvalidInputError(name, length, f"from {shortest:g} to {longest:g} inlet lengths", hint)


RESOLUTION = FilmResolution()  # Default cells


def moes_line(load: FloatArray | float, lubricant: FloatArray | float) -> FloatArray:
    """Central film of a line contact, ``H = h / R (2 U)**-1/2``, by Moes' formula, eq. (410).

    Moes' numbers are ``M = w / (E' R) (2 U)**-1/2`` and ``L = alpha E' (2 U)**1/4``, with ``E' = 2 E*``.
    """
    h_ri, h_ei = 3.0 / np.asarray(load), 2.621 * np.asarray(load) ** -0.2
    h_rp = 1.287 * np.asarray(lubricant) ** (2 / 3)
    h_ep = 1.311 * np.asarray(load) ** -0.125 * np.asarray(lubricant) ** 0.75
    s = (7 + 8 * np.exp(-2 * h_ei / h_ri)) / 5
    piezoviscous = (h_rp**-3.5 + h_ep**-3.5) ** (-2 * s / 7)
    return np.asarray(((h_ri ** (7 / 3) + h_ei ** (7 / 3)) ** (3 * s / 7) + piezoviscous) ** (1 / s))


@dataclass(frozen=True, kw_only=True, eq=False)
class FilmCase:
    """A case and the scales of its film."""

    case: Case
    lubricant: Lubricant
    speeds: SurfaceSpeeds
    asperities: Asperities | None  # roughness; None: smooth surfaces
    resolution: FilmResolution
    inlet: float | None  # distance of the inlet's meniscus from the middle of the contact, metres; None: fully flooded

    @property
    def settings(self) -> dict[str, object]:
        """Arguments that determine the film of the case, as results record them."""
        rms = None if self.asperities is None else self.asperities.rms
        return {"inlet": self.inlet, "rms": rms, "resolution": asdict(self.resolution)}

    @property
    def speed(self) -> float:
        """Magnitude of the entrainment speed, m/s."""
        return abs(self.speeds.entrainment)

    @property
    def half_width(self) -> float:
        """Hertz half-width, metres: the scale of lengths."""
        return self.case.hertz_half_width

    @property
    def height_scale(self) -> float:
        """Scale of heights ``a**2 / R``, metres."""
        return self.half_width**2 / self.case.roller.radius

    @property
    def pressure_scale(self) -> float:
        """Scale of pressures p0, Pa."""
        return self.case.hertz_max_pressure

    @cached_property
    def dry_case(self) -> Case:
        """Case of the dry contact."""
        return replace(self.case, motion=Sliding(), friction=0.0, lubricant=None)

    @cached_property
    def dry_contact(self) -> Contact:
        """Dry contact on columns refined for its pressure."""
        return refine_contact(self.dry_case, self.resolution.dry_accuracy, 1e-6).contact

    @cached_property
    def contact_ends(self) -> tuple[float, float]:
        """First and last loaded x of the dry contact, over the half-width."""
        edges = self.dry_contact.shape.grid.x_edges / self.half_width
        loaded_columns = np.flatnonzero(self.dry_contact.pressure.any(axis=1))
        return edges[loaded_columns[0]], edges[loaded_columns[-1] + 1]

    @cached_property
    def contact_half_width(self) -> float:
        """Largest half-width of the dry contact over the Hertz half-width."""
        grid = self.dry_contact.shape.grid
        is_loaded = self.dry_contact.pressure.any(axis=0)
        return float(np.abs(grid.y[is_loaded]).max() + 0.5 * grid.dy) / self.half_width

    @property
    def tilt_centre(self) -> float:
        """Position x, metres, where the approach is independent of the tilt."""
        return self.case.roller_middle if self.case.load_position is None else self.case.load_position

    @property
    def speed_number(self) -> float:
        """Speed number ``U = eta0 um / (E' R)``."""
        return self.lubricant.viscosity * self.speed / (2 * self.case.modulus * self.case.roller.radius)

    def moes_load(self, line_load: float) -> float:
        """Moes' load number of a load per length, N/m."""
        return float(line_load / (2 * self.case.modulus * self.case.roller.radius * np.sqrt(2 * self.speed_number)))

    def moes_film(self, line_load: float) -> float:
        """Central film of a line contact with a load per length by Moes' formula, metres."""
        film = moes_line(self.moes_load(line_load), self.moes_lubricant)
        return float(film * self.case.roller.radius * np.sqrt(2 * self.speed_number))

    @property
    def moes_lubricant(self) -> float:
        """Moes' lubricant number."""
        return float(self.lubricant.pressure_viscosity * 2 * self.case.modulus * (2 * self.speed_number) ** 0.25)

    @cached_property
    def largest_line_load(self) -> float:
        """Largest load per length of the dry contact, N/m, as a mean over two half-widths along x."""
        grid = self.dry_contact.shape.grid
        line_loads = self.dry_contact.pressure.sum(axis=1) * grid.dy
        # The mean smooths the peak at a sharp end, which is narrower than the film's inlet at this end.
        cumulative_load = np.concatenate([[0.0], np.cumsum(line_loads * grid.widths)])
        span = min(2 * self.half_width, float(np.ptp(grid.x_edges)))
        centres = np.linspace(grid.x_edges[0] + 0.5 * span, grid.x_edges[-1] - 0.5 * span, 401)
        loads_at_ends = np.interp(np.add.outer(np.array([0.5, -0.5]) * span, centres), grid.x_edges, cumulative_load)
        return float((loads_at_ends[0] - loads_at_ends[1]).max() / span)

    @cached_property
    def central_film(self) -> float:
        """Central film by Moes' formula under the largest load per length, metres: the scale of the film."""
        return self.moes_film(self.largest_line_load)

    def slice_film(self, x: FloatArray) -> FloatArray:
        """Central film by Moes' formula under the dry contact's load per length at each x, metres; NaN without load."""
        grid = self.dry_contact.shape.grid
        column = np.clip(np.searchsorted(grid.x_edges, x) - 1, 0, grid.cells_x - 1)
        line_loads = self.dry_contact.pressure[column].sum(axis=1) * grid.dy
        return np.array([self.moes_film(load) if load else np.nan for load in line_loads.tolist()])

    @cached_property
    def inlet_length(self) -> float:
        """Length over which the film forms, over the half-width; rounded, so that similar speeds have equal cells."""
        max_pressure = hertz.line_max_pressure(self.largest_line_load, self.case.roller.radius, self.case.modulus)
        width = max_pressure / self.pressure_scale  # half-width of the line contact over the half-width
        inlet_length = width * (self.central_film / self.height_scale / width**2) ** (2 / 3)  # eq. (403)
        ratio = self.resolution.ratio
        return float(ratio ** np.round(np.log(inlet_length) / np.log(ratio)))

    @property
    def coarsest_level(self) -> Level:
        """Cells without refinement."""
        return Level(cells=0, columns=0, closures=[], inlet_length=self.inlet_length)

    def film_ratio(self, result: xr.Dataset) -> float:
        """Central film by Moes' formula over that of a film at another speed or with another lubricant."""
        former_load_number, load_number = float(result["moes_load"]), self.moes_load(self.largest_line_load)
        former_film = moes_line(former_load_number, float(result["moes_lubricant"])) / former_load_number
        return float(moes_line(load_number, self.moes_lubricant) / load_number / former_film)

    @cached_property
    def fluid(self) -> Fluid:
        """Laws of the lubricant in the scales of the film."""
        radius, a = self.case.roller.radius, self.half_width
        flow_number = 12 * self.speed * self.lubricant.viscosity * radius**2 / (a**3 * self.pressure_scale)  # eq. (404)
        return Fluid.of(self.lubricant, self.pressure_scale, flow_number)


@dataclass(frozen=True, eq=False)
class MergedCells:
    """Cells along y that are merged from uniform cells; the surface operator acts on the uniform cells."""

    edges: IntArray  # indices of the uniform edges between merged cells

    @classmethod
    def of(cls, cell_count: int, max_count: Callable[[float, float], float]) -> MergedCells:
        """Merge `cell_count` uniform cells in powers of two, at most ``max_count(first, last)`` into one."""
        edges = [0]
        while edges[-1] < cell_count:
            first_cell, width = edges[-1], 1
            previous_width = edges[-1] - edges[-2] if len(edges) > 1 else 1 << 30
            while (
                first_cell % (2 * width) == 0
                and first_cell + 2 * width <= cell_count
                and 2 * width <= min(2 * previous_width, max_count(first_cell, first_cell + 2 * width))
            ):
                width *= 2
            edges.append(first_cell + width)
        return cls(np.array(edges))

    @cached_property
    def counts(self) -> IntArray:
        """Numbers of uniform cells in the merged cells."""
        return np.diff(self.edges)

    @cached_property
    def centre_cells(self) -> tuple[IntArray, IntArray]:
        """Uniform cells on either side of each merged cell's centre; the same cell if their number is odd."""
        edge_sums = self.edges[1:] + self.edges[:-1]
        return (edge_sums - 1) // 2, edge_sums // 2

    def to_uniform_cells(self, field: FloatArray) -> FloatArray:
        """Values on the uniform cells from values (x, merged cell)."""
        return np.repeat(field, self.counts, axis=-1)

    def to_centres(self, field: FloatArray) -> FloatArray:
        """Values at the centres of merged cells from values (x, uniform cell)."""
        lower_cells, upper_cells = self.centre_cells
        return np.asarray(0.5 * (field[..., lower_cells] + field[..., upper_cells]))

    def average(self, field: FloatArray) -> FloatArray:
        """Means over the merged cells of values (x, uniform cell)."""
        return np.asarray(np.add.reduceat(field, self.edges[:-1], axis=-1) / self.counts)

    def compute_stiffness(self, response: FloatArray) -> SingleArray:
        """Displacement per pressure on merged cells (x, cell, cell), from a uniform cell's `response` (x, offset)."""
        cell_count = response.shape[-1]
        two_sided_response = np.concatenate([response[:, :0:-1], response], axis=-1)
        sums = np.concatenate([np.zeros((len(response), 1)), np.cumsum(two_sided_response, axis=-1)], axis=-1)
        # The offsets of the uniform cells of a merged cell are consecutive.
        offsets = [centre_cell[:, None] - self.edges[None, :] + cell_count for centre_cell in self.centre_cells]
        stiffness = np.empty((len(response), self.counts.size, self.counts.size), dtype=np.float32)
        for matrix, column_sums in zip(stiffness, sums, strict=True):
            matrix[:] = 0.5 * sum(-np.diff(column_sums[centre_offsets], axis=1) for centre_offsets in offsets)
        return stiffness


class Level(NamedTuple):
    """Cells of a film: numbers of refinements along y and of the columns, in the geometry of a case."""

    cells: int
    columns: int
    closures: list[tuple[float, float]]  # positions x of least films and widths of columns before refinement, over a
    inlet_length: float  # inlet length of the coarsest cells along y, over the half-width

    def refined(self, direction: str, film: FilmCase, minima: Iterable[tuple[float, float]]) -> Level:
        """Next level in a direction; `minima` are positions and lengths of the least films of both halves."""
        if direction == "cells":
            return self._replace(cells=self.cells + 1)
        # Each level halves the columns at the least films at least, even if the lengths grow.
        widths = [width for _, width in self.closures] or [np.inf, np.inf]
        closures = [
            (position, min(width, film.resolution.columns_inlet * length))
            for (position, length), width in zip(minima, widths, strict=True)
        ]
        return self._replace(columns=self.columns + 1, closures=closures)


class FilmOnCells(NamedTuple):
    """A solved film and its cells."""

    level: Level
    problem: FilmProblem
    solution: FilmSolution
    shape: Shape  # the dry contact on uniform cells along y and columns over the whole body
    columns: slice  # columns under the roller
    merged: MergedCells  # cells along y

    def line_motion(self, film: FilmCase, pressure: FloatArray, position: float) -> RigidMotion:
        """Motion of the reference lines under a pressure, its level below a position x, metres."""
        body_load = np.zeros(self.shape.grid.shape)
        body_load[self.columns] = film.pressure_scale * self.merged.to_uniform_cells(pressure)
        return self.shape.line_motions(body_load, position).total


def create_cells(film: FilmCase, level: Level) -> tuple[FilmCells, MergedCells]:
    """Return the cells of a level, and the uniform cells along y of which they are merged."""
    resolution = film.resolution
    scale, column_scale = resolution.ratio**-level.cells, resolution.ratio ** (-2 * level.columns)
    start, stop = (end / film.half_width for end in film.case.contact_range)
    min_dx = min(resolution.columns, resolution.columns_inlet * level.inlet_length, 0.1 * (stop - start)) * column_scale
    growth = resolution.columns_growth * column_scale**0.35
    closures = [(position, max(min_dx, column_scale * width)) for position, width in level.closures]
    narrow_columns = [(end, min_dx) for end in film.contact_ends] + closures

    def column_width(x: float) -> float:
        widths = (width + growth * max(abs(x - position) - 2 * width, 0.0) for position, width in narrow_columns)
        return float(min(resolution.widest_column, 0.2 * (stop - start), *widths))

    x_edges = graded_edges(start, stop, column_width)
    delta, half_width = level.inlet_length, film.contact_half_width
    meniscus = np.inf if film.inlet is None else film.inlet / film.half_width
    y_start = -min(half_width + resolution.inlet * delta, meniscus)
    y_stop = half_width + resolution.outlet * delta
    min_cell = min(resolution.finest * delta, resolution.finest_share) * scale
    # 16 times a length of fast transforms, so that cells can merge in powers of two.
    fast_length = int(next_fast_len(int(np.ceil((y_stop - y_start) / min_cell / 16)), real=True))
    cell_count = min(16 * fast_length, resolution.most_cells)
    step = (y_stop - y_start) / cell_count

    def max_cell_count(first_cell: float, stop_cell: float) -> float:
        y = y_start + 0.5 * (first_cell + stop_cell) * step
        distance = max(0.0, min(abs(y + 1), abs(y - 1), abs(y - half_width), abs(y + half_width)) - delta)
        inner_width = min(resolution.inner, resolution.inner_inlet * delta) * scale
        max_width = inner_width if abs(y) < half_width else 0.25 + 0.1 * (abs(y) - half_width)
        return float(max(min(min_cell + resolution.growth * scale**0.5 * distance, max_width) / step * 1.0001, 1.0))

    merged = MergedCells.of(cell_count, max_cell_count)
    return FilmCells(x_edges=x_edges, y_edges=np.asarray(y_start + step * merged.edges)), merged


def film_on_level(
    film: FilmCase, level: Level, settings: FilmSettings, start: FilmOnCells | xr.Dataset | None = None
) -> FilmOnCells:
    """Solve for the film on the cells of a level, to its tolerance, from another film or else from the dry contact."""
    cells, merged = create_cells(film, level)
    a, p0, height_scale = film.half_width, film.pressure_scale, film.height_scale
    window = a * float(cells.y_edges[0]), a * float(cells.y_edges[-1])
    grid = graded_grid(film.case, a * cells.x_edges, window, int(merged.edges[-1]))
    first_column = int(np.abs(grid.x_edges - a * cells.x_edges[0]).argmin())
    columns = slice(first_column, first_column + cells.shape[0])
    shape = contact_shape(film.dry_case, grid)
    operator = contact_operator(shape)

    def displace(load: FloatArray) -> FloatArray:
        body_load = np.zeros(grid.shape)
        body_load[columns] = p0 * load
        return operator({Load.NORMAL: body_load})[columns] / height_scale

    # The tilt refers to the reference lines, here under the dry contact, the height to the bodies far away.
    gap = shape.gap.values - RigidMotion(0.0, film.dry_contact.motions.total.tilt).height(grid.x - film.tilt_centre)
    resultants = shape.prescribed.resultants(grid)
    asperities = film.asperities
    problem = FilmProblem(
        cells=cells,
        fluid=film.fluid,
        gap=merged.to_centres(gap[columns]) / height_scale,
        displace=lambda pressure: merged.to_centres(displace(merged.to_uniform_cells(pressure))),
        column_stiffness=merged.compute_stiffness(displace(np.tile(np.eye(1, grid.cells_y), (cells.shape[0], 1)))),
        load=film.case.normal_load / (p0 * a**2),
        lever=None if resultants.lever is None else resultants.lever[columns, 0],
        central_film=film.central_film / height_scale,
        asperities=None if asperities is None else asperities.scaled_law(height_scale, p0, film.case.modulus),
        mean_height=None if asperities is None else asperities.mean_height(height_scale),
    )

    def start_from_dry_contact() -> FilmState:
        contact = ContactProblem(grid=grid, gap=gap, resultants=resultants, tolerance=film.resolution.dry_tolerance)
        # Cells enter the contact together but leave it one by one: interpolation would load cells outside.
        axes = (grid.x, film.dry_contact.shape.grid.x), (grid.y, film.dry_contact.shape.grid.y)
        nearest = (np.abs(positions[:, None] - centres).argmin(axis=1) for positions, centres in axes)
        dry = solve_normal(operator, contact, film.dry_contact.pressure[np.ix_(*nearest)])
        if not dry.converged:
            raise StepFailedError(f"the dry contact on its cells has not converged in {dry.applications} iterations")
        opening = gap + operator({Load.NORMAL: dry.pressure}) - contact.rigid_height(dry.motion)
        # Thin films separate rough surfaces by less than their height: the distance of the mean planes is negative.
        separation = problem.solve_distance(np.array([problem.central_film]), np.zeros(1))
        distance = merged.to_centres(opening[columns]) / height_scale + separation
        motion = np.append(separation, np.zeros(len(dry.motion) - 1)) - np.array(dry.motion) / height_scale
        return problem.create_state(merged.average(dry.pressure[columns]) / p0, motion, distance)

    guess = None
    if isinstance(start, xr.Dataset):
        guess = _convert_result(film, start, problem)
    elif start is not None:
        guess = _transfer_state(start, problem)
    settings = replace(settings, tolerance=max(settings.tolerance, settings.level_tolerance))
    solution = solve_newton(problem, guess, settings, start_from_dry_contact)
    return FilmOnCells(level=level, problem=problem, solution=solution, shape=shape, columns=columns, merged=merged)


def continue_solution(film: FilmCase, level_film: FilmOnCells, settings: FilmSettings) -> FilmOnCells:
    """Continue on the same cells, between the reference lines under the film, to the tolerance of the settings."""
    problem, state = level_film.problem, level_film.solution.state

    def rotate(tilt: float) -> FloatArray:
        return RigidMotion(0.0, tilt).height(film.half_width * problem.cells.x - film.tilt_centre) / film.height_scale

    problem = replace(
        problem,
        gap=problem.gap + rotate(film.dry_contact.motions.total.tilt),
        displace=lambda load: (
            level_film.problem.displace(load) - rotate(level_film.line_motion(film, load, film.tilt_centre).tilt)
        ),
    )
    state = problem.create_state(state.pressure, state.motion, state.distance)
    return level_film._replace(problem=problem, solution=solve_newton(problem, state, settings, lambda: state))


def _transfer_state(start: FilmOnCells, problem: FilmProblem) -> FilmState:
    """Return a guess: the film of other cells, interpolated between the cells' centres."""
    start_cells, cells, state = start.problem.cells, problem.cells, start.solution.state
    # The film rises by powers of ten from column to column at the contact's ends: its logarithm is interpolated.
    pressure, distance, log_film = (
        _interpolate_field(values, start_cells.x, start_cells.y, cells)
        for values in (state.pressure, state.distance, np.log(start.solution.film))
    )
    distance = problem.solve_distance(np.exp(log_film), distance)
    guess = problem.create_state(np.maximum(pressure, 0.0), state.motion, distance)
    # A thick film hardly affects the pressure: its distance follows from the pressure instead of the other cells.
    is_thick = np.minimum(distance / THICK_FILM_RATIO, distance - guess.mismatch) > problem.central_film
    correction = np.where(is_thick, guess.mismatch, 0.0)
    return guess._replace(distance=distance - correction, mismatch=guess.mismatch - correction)


def _convert_result(film: FilmCase, result: xr.Dataset, problem: FilmProblem) -> FilmState:
    """Return a guess: the film of another speed or lubricant, scaled by the central films of Moes' formula."""
    sign = -1 if result["entrainment_speed"] < 0 else 1
    fields = result[["pressure", "film_thickness"]].transpose("x", "y").dropna("x")
    x, y = (fields[axis].values / film.half_width for axis in "xy")
    pressure, log_film = (
        _interpolate_field(values[:, ::sign], x, (sign * y)[::sign], problem.cells)
        for values in (fields["pressure"].values / film.pressure_scale, np.log(fields["film_thickness"].values))
    )
    distance = np.exp(log_film) / film.height_scale
    film_ratio, central_film = film.film_ratio(result), float(result["central_film"]) / film.height_scale
    distance = np.where(distance < central_film, film_ratio * distance, distance + (film_ratio - 1) * central_film)
    is_loaded = pressure.ravel() > 0
    rigid_heights = (distance - problem.gap - problem.displace(pressure)).ravel()
    motion = np.asarray(np.linalg.lstsq(problem.motions[:, is_loaded].T, rigid_heights[is_loaded])[0], dtype=np.float64)
    return problem.create_state(pressure, motion, distance)


def _interpolate_field(field: FloatArray, x: FloatArray, y: FloatArray, cells: FilmCells) -> FloatArray:
    """Values at the centres of cells by monotone cubic polynomials, constant outside the given positions."""
    column_values = scipy.interpolate.PchipInterpolator(y, field, axis=1)(np.clip(cells.y, y[0], y[-1]))
    return np.asarray(scipy.interpolate.PchipInterpolator(x, column_values, axis=0)(np.clip(cells.x, x[0], x[-1])))
