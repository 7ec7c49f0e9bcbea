"""The film of a case, from its parameters to a labelled result with errors and certificate."""

from __future__ import annotations

import time
import warnings
from typing import NamedTuple

import numpy as np
import scipy
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, attribute, check_solved_for, with_provenance
from contactstudy.arrays.peaks import lagrange_weights
from contactstudy.arrays.variables import cell_coordinates, describe, require, without_error
from contactstudy.case.case import Case
from contactstudy.case.magnitudes import warn_of_magnitudes
from contactstudy.checks import BoolArray, FloatArray
from contactstudy.contact.normal.prescribed_loads import RigidMotion
from contactstudy.contact.solve import reference_depths
from contactstudy.errors import ConvergenceWarning, FilmError, InvalidInputError, MagnitudeWarning
from contactstudy.film.asperities import Asperities
from contactstudy.film.levels import (
    RESOLUTION,
    FilmCase,
    FilmOnCells,
    FilmResolution,
    Level,
    continue_solution,
    film_on_level,
)
from contactstudy.film.newton import SETTINGS, FilmSettings, FilmSolution, StepFailedError
from contactstudy.threads import one_blas_thread

ACCURACIES = (2e-3, 0.2)  # Range of the accuracies that the levels reach. Limit.
DIRECTIONS = ("cells", "columns")  # of refinement
CELLS_SAFETY = 1.5  # Stated error along y over that of cells of second order. Accuracy.
ORDER_RATIOS = 0.25, 0.5  # Ratio of successive changes as columns halve: order 2, order 1. Accuracy.
NEXT_RATIO = 0.5  # Largest ratio of the errors on two levels of the same direction. Accuracy.
MIN_RELATIVE_ERROR = 1e-3  # Least stated error over the value. Accuracy.
VISCOSITY_EXPONENT = 1.3  # Viscosity ratio ``kappa = Lambda**1.3`` from the film ratio (ISO 281:2007). Physics.


def solve_film(
    case: Case,
    *,
    accuracy: float = 0.02,
    asperities: Asperities | None = None,
    inlet: float | None = None,
    start: xr.Dataset | None = None,
    resolution: FilmResolution = RESOLUTION,
    settings: FilmSettings = SETTINGS,
) -> xr.Dataset:
    """Solve for the lubricating film of a case: isothermal, Newtonian, steady elastohydrodynamic lubrication.

    Parameters
    ----------
    case : Case
        With a `lubricant` and a motion that has speeds. Friction does not displace the surfaces.
    accuracy : float
        Largest error of the central and of the least films, over the central film, from 0.002
        to 0.2; refinement ends once the error is below this value. The result contains the error reached.
    asperities : Asperities, optional
        Roughness, whose asperities carry a part of the load. Default: the surfaces are smooth.
    inlet : float, optional
        Distance of the lubricant's meniscus in the inlet from the middle of the contact, metres. Default: at a distance
        that floods the inlet fully.
    start : Dataset, optional
        Film of the same case at another speed or with another lubricant, from which the iteration starts: on the cells
        of a similar film, with its relative errors.
    resolution : FilmResolution
        Cells of the coarsest level, and the refinement.
    settings : FilmSettings
        Settings of the iteration.

    Returns
    -------
    Dataset
        `film_thickness`, `pressure` and the flows per width, `flow_x` and `flow_y`, at ambient density (x, y), NaN
        where the film is broken; `end_flow_first` and `end_flow_last` through the end faces; `approach` and `tilt`
        as in `solve_contact`. Between rough surfaces also `asperity_pressure` and the film ratio `film_ratio` (x).
        `slice_film` (x), Moes' formula for the dry load per length of each slice, as bearing programs compute it;
        `central_film` in the middle of the contact; `least_film` and its position ``_x``, ``_y``; `least_film_middle`
        in the middle section, `least_film_first` and `least_film_last` towards either end, the latter two with
        ``_x``; each film with its error ``<name>_error``. `entrainment_speed`, `slide_roll_ratio`, `moes_load`,
        `moes_lubricant` of the largest load per length; `asperity_load_share` and the `viscosity_ratio` kappa of
        ISO 281. Certificate: `mass_error`, largest net outflow of a full cell over the central flow times the cell's
        width; `film_load_error`; `film_complementarity_error`. `newton_steps`, `linear_steps`, `film_levels`.

    Raises
    ------
    InvalidInputError
        If the case has no lubricant, no speed, or no load, or an argument is out of range.
    FilmError
        If no film separates smooth surfaces somewhere, no film forms, or the iteration does not converge.

    Warns
    -----
    ConvergenceWarning
        If the finest level does not reach the accuracy.
    MagnitudeWarning
        If the magnitude of an input is unusual, or the pressure exceeds the range of the viscosity law.

    Examples
    --------
    >>> from contactstudy import HalfSpace, Lubricant, Material, Roller, Sliding, profiles
    >>> body = HalfSpace(material=Material(210e9, 0.3))
    >>> roller = Roller(radius=5e-3, length=0.3e-3, profile=profiles.Lundberg(amplitude=0.4e-6))
    >>> oil = Lubricant.preset("heavy machine oil", 60.0)
    >>> motion = Sliding(body_speed=1.0, roller_speed=1.0)
    >>> case = Case(body=body, roller=roller, max_pressure=1.5e9, motion=motion, lubricant=oil)
    >>> result = solve_film(case, accuracy=0.1)
    >>> round(1e6 * float(result.central_film), 1)
    0.2
    """
    film = create_film_case(case, asperities, inlet, resolution)
    warn_of_magnitudes(case)
    max_error = checks.positive("accuracy", accuracy)
    if not ACCURACIES[0] <= max_error <= ACCURACIES[1]:
        allowed = f"from {ACCURACIES[0]:g} to {ACCURACIES[1]:g} of the central film"
        raise InvalidInputError("accuracy", max_error, allowed)
    start_time = time.perf_counter()
    if start is not None:
        require(start, "film_thickness", "pressure", "moes_load", argument="start")
    try:
        with one_blas_thread():
            refined_film = _refine(film, max_error, settings, start)
            level_film = continue_solution(film, refined_film.level_film, settings)
    except StepFailedError as error:
        raise _create_film_error(error, film.half_width) from None
    continued = refined_film._replace(level_film=level_film, solutions=[*refined_film.solutions, level_film.solution])
    result = _label_film(film, continued)
    seconds = time.perf_counter() - start_time
    relative_error = max(float(result[f"{name}_error"]) for name in FILM_NAMES) / float(result["central_film"])
    if relative_error > max_error:
        warnings.warn(
            f"the films have converged to {relative_error:.2g} of the central film, not to accuracy = {max_error:g}: "
            "allow more levels, or more error",
            ConvergenceWarning,
            stacklevel=2,
        )
    _warn_of_viscosity(film, level_film)
    described_result = describe(result, "lubricated contact of a roller with an elastic body")
    labelled_result = without_error(described_result, "slice_film", "approach", "tilt")
    errors = {name: values.tolist() for name, values in refined_film.direction_errors.items()}
    refinement = {"level": level_film.level._asdict(), "direction_errors": errors}
    recorded_arguments = {"accuracy": max_error, **film.settings, **refinement}
    return with_provenance(labelled_result, case, recorded_arguments, {"film": seconds})


def create_film_case(
    case: Case,
    asperities: Asperities | None = None,
    inlet: float | None = None,
    resolution: FilmResolution = RESOLUTION,
) -> FilmCase:
    """Return the film of a case, or raise `InvalidInputError` if the case has none."""
    checks.instance("case", case, Case, "a Case")
    if case.lubricant is None:
        raise InvalidInputError("case.lubricant", None, "a Lubricant(...) for a film")
    speeds = case.motion.speeds
    if speeds is None or speeds.entrainment == 0:
        allowed = "one whose speeds draw the lubricant in, such as Sliding(body_speed=2.0, roller_speed=2.1)"
        raise InvalidInputError("case.motion", case.motion, allowed, "speeds are in m/s along +y, against the contact")
    if case.coupled:
        raise InvalidInputError("case.coupled", True, "False for a film")
    if asperities is not None:
        checks.instance("asperities", asperities, Asperities, "an Asperities(...), or None for smooth surfaces")
    film = FilmCase(
        case=case,
        lubricant=case.lubricant,
        speeds=speeds,
        asperities=asperities,
        resolution=resolution,
        inlet=None if inlet is None else checks.positive("inlet", inlet, "metres"),
    )
    if film.inlet is not None and film.inlet <= (contact_half_width := film.contact_half_width * film.half_width):
        allowed = f"more than the half-width of the contact, {contact_half_width:.3g} m"
        raise InvalidInputError("inlet", film.inlet, allowed, "a meniscus inside the contact forms no film")
    return film


FILM_NAMES = ("central_film", "least_film_middle", "least_film_first", "least_film_last", "least_film")


class Minimum(NamedTuple):
    """Minimum of a film along one axis."""

    film: float
    position: float
    length: float  # distance from the minimum at which the logarithm of the film is greater by a half


class Films(NamedTuple):
    """Film thicknesses over the height scale, and their positions over the half-width."""

    central_film: float
    least_film_middle: float
    first: Minimum
    last: Minimum
    least: Minimum
    least_y: float

    @property
    def thicknesses(self) -> FloatArray:
        """Films in the order of `FILM_NAMES`."""
        return np.array([self.central_film, self.least_film_middle, self.first.film, self.last.film, self.least.film])


class _RefinedFilm(NamedTuple):
    """Film on the finest level, relative errors by the direction of refinement, solutions of all levels."""

    level_film: FilmOnCells
    direction_errors: dict[str, FloatArray]
    solutions: list[FilmSolution]


def _refine(film: FilmCase, accuracy: float, settings: FilmSettings, start: xr.Dataset | None = None) -> _RefinedFilm:
    """Refine the cells in the direction of the larger error until the film reaches the accuracy."""
    if start is not None and (continued_film := _continue_film(film, accuracy, settings, start)) is not None:
        return continued_film
    level, refined_film, previous_thicknesses, direction = film.coarsest_level, None, np.zeros(len(FILM_NAMES)), ""
    changes: dict[str, list[FloatArray]] = {name: [] for name in ("", *DIRECTIONS)}
    while True:
        try:
            level_film = film_on_level(film, level, settings, refined_film.level_film if refined_film else start)
        except StepFailedError:
            if refined_film is None or np.isinf([*refined_film.direction_errors.values()]).any():
                raise
            return refined_film
        films = compute_films(film, level_film)
        thicknesses = films.thicknesses
        changes[direction].append(thicknesses - previous_thicknesses)
        direction_errors = {name: _estimate_errors(name, changes[name]) / thicknesses for name in DIRECTIONS}
        solutions = [*(refined_film.solutions if refined_film else []), level_film.solution]
        refined_film = _RefinedFilm(level_film, direction_errors, solutions)
        directions = [name for name in DIRECTIONS if getattr(level, name) < film.resolution.levels - 1]
        error = _combine_errors(direction_errors, thicknesses).max() / films.central_film
        if error <= accuracy or not directions:
            return refined_film
        direction = max(directions, key=lambda name: float((direction_errors[name] * thicknesses).max()))
        level = level.refined(direction, film, (films.first[1:], films.last[1:]))
        previous_thicknesses = thicknesses


def _estimate_errors(direction: str, changes: list[FloatArray]) -> FloatArray:
    """Errors of the films from their latest two changes by refinement in a direction; infinite before."""
    if len(changes) < 2:
        return np.full(len(FILM_NAMES), np.inf)
    previous_change, latest_change = np.abs(changes[-2:])
    if direction == "cells":
        # Two refinements halve every cell along y, one refinement halves some, since cells merge in powers of two.
        return np.asarray(CELLS_SAFETY / 3 * (previous_change + latest_change))
    ratio = np.clip(latest_change / np.maximum(previous_change, 1e-300), *ORDER_RATIOS)
    # The latest change may vanish by chance.
    return np.asarray(np.maximum(latest_change, ORDER_RATIOS[0] * previous_change) * ratio / (1 - ratio))


def _combine_errors(direction_errors: dict[str, FloatArray], thicknesses: FloatArray) -> FloatArray:
    """Errors of films of some thicknesses from their relative errors by direction."""
    return np.asarray((np.sum([*direction_errors.values()], axis=0) + MIN_RELATIVE_ERROR) * thicknesses)


def _continue_film(film: FilmCase, accuracy: float, settings: FilmSettings, start: xr.Dataset) -> _RefinedFilm | None:
    """Film on the cells of a similar film, at most one refinement finer; None if these cells do not suffice."""
    start_settings = attribute(start, INPUTS_ATTRIBUTE).get("settings", {})
    try:
        check_solved_for(start, film.case)
        level = Level(**start_settings["level"])
        # Errors are of second order in the cells over the inlet length, a power 2/3 of the film: eq. (403).
        growth = max(film.film_ratio(start) ** (-4 / 3), 1.0)
        direction_errors = {name: growth * np.array(start_settings["direction_errors"][name]) for name in DIRECTIONS}
    except (InvalidInputError, KeyError, TypeError):
        return None
    is_near = abs(np.log(film.inlet_length / level.inlet_length)) < 1.01 * np.log(film.resolution.ratio)
    ratios = np.array([float(start[name] / start["central_film"]) for name in FILM_NAMES])
    for name in sorted(DIRECTIONS, key=lambda name: -float((direction_errors[name] * ratios).max())):
        error = _combine_errors(direction_errors, ratios).max()
        if error > accuracy and getattr(level, name) < film.resolution.levels - 1:
            level = level._replace(**{name: getattr(level, name) + 1})
            direction_errors[name] *= NEXT_RATIO
    has_settings = all(start_settings.get(name) == value for name, value in film.settings.items())
    if not (is_near and has_settings) or _combine_errors(direction_errors, ratios).max() > accuracy:
        return None
    try:
        level_film = film_on_level(film, level, settings, start)
    except StepFailedError:
        return None
    return _RefinedFilm(level_film, direction_errors, [level_film.solution])


def _create_film_error(error: StepFailedError, half_width: float) -> FilmError:
    """Return the error of a failed iteration, with the position where the film closes."""
    if error.position is None:
        return FilmError(f"the film's iteration does not converge: {error}; another speed or load may help")
    x, y = (half_width * position for position in error.position)
    return FilmError(
        f"the film of smooth surfaces closes at x = {x:.4g} m, y = {y:.4g} m: give asperities=Asperities(rms=...), "
        "a profile with a larger drop at the ends, or a higher speed"
    )


def compute_films(film: FilmCase, level_film: FilmOnCells) -> Films:
    """Return central and least films of a solution, by parabolas between the cells and up to the end faces."""
    cells, height = level_film.problem.cells, level_film.solution.film
    low, high = film.contact_ends
    mid_length = 0.5 * (low + high)
    is_near_contact = np.abs(cells.y) < 1.5 * film.contact_half_width
    column_minima = [_find_minimum(cells.y, cells.y_edges, row, is_near_contact) for row in height]
    least_films, positions, _ = np.transpose(column_minima)
    centre_films = np.array([np.interp(0.0, cells.y, row) for row in height])
    first_half = cells.x < mid_length
    first, last = (_find_minimum(cells.x, cells.x_edges, least_films, half) for half in (first_half, ~first_half))
    least = min(first, last)
    return Films(
        central_film=_interpolate(cells.x, centre_films, mid_length),
        least_film_middle=_interpolate(cells.x, least_films, mid_length),
        first=first,
        last=last,
        least=least,
        least_y=float(np.interp(least.position, cells.x, positions)),
    )


def _interpolate(x: FloatArray, films: FloatArray, position: float) -> float:
    """Value at a position by the parabola through the three nearest columns."""
    start = min(max(int(np.abs(x - position).argmin()) - 1, 0), x.size - 3)
    neighbours = slice(start, start + 3)
    return float(lagrange_weights(x[neighbours], np.array([position]))[0] @ films[neighbours])


def _find_minimum(centres: FloatArray, edges: FloatArray, films: FloatArray, mask: BoolArray) -> Minimum:
    """Minimum in the lowest cell of a mask, by a cubic spline of the logarithms of positive `films`."""
    cell = int(np.where(mask, films, np.inf).argmin())
    neighbours = slice(max(cell - 3, 0), cell + 4)
    spline = scipy.interpolate.CubicSpline(centres[neighbours], np.log(films[neighbours]))
    extrema = spline.derivative().roots(extrapolate=True)
    positions = np.clip(np.append(extrema[np.isfinite(extrema)], edges[[cell, cell + 1]]), edges[cell], edges[cell + 1])
    logarithms = spline(positions)
    minimum = int(logarithms.argmin())
    curvature = float(spline(positions[minimum], 2))
    length = curvature**-0.5 if curvature > 0 else float(edges[cell + 1] - edges[cell])
    return Minimum(float(np.exp(logarithms[minimum])), float(positions[minimum]), length)


def _label_film(film: FilmCase, refined_film: _RefinedFilm) -> xr.Dataset:
    """Label a film: on uniform cells along y, in the coordinates of the case."""
    level_film = refined_film.level_film
    solution, grid = level_film.solution, level_film.shape.grid
    # The solver's lubricant flows along +y.
    is_mirrored = film.speeds.entrainment < 0
    sign = -1 if is_mirrored else 1

    def expand(values: FloatArray, outer_value: float) -> FloatArray:
        expanded = np.full(grid.shape, outer_value)
        expanded[level_film.columns] = values
        return expanded[:, ::-1] if is_mirrored else expanded

    fluid_pressure, asperity_pressure = (
        film.pressure_scale * _spread_pressure(level_film, values)
        for values in (solution.fluid_pressure, solution.asperity_pressure)
    )
    fields = {"pressure": expand(fluid_pressure + asperity_pressure, 0.0)}
    if film.asperities is not None:
        fields["asperity_pressure"] = expand(asperity_pressure, 0.0)
    cells = level_film.problem.cells
    uniform_y = np.clip(grid.y / film.half_width, cells.y[0], cells.y[-1])
    flow_x, flow_y, end_flows = cells.cell_flows(level_film.problem.fluid, solution.fluid_pressure, solution.film)
    flow_scale, is_full = film.speed * film.height_scale, fluid_pressure > 0
    for name, values, scale, is_known in (
        ("film_thickness", solution.film, film.height_scale, np.True_),
        ("flow_x", flow_x, flow_scale, is_full),
        ("flow_y", flow_y, sign * flow_scale, is_full),
    ):
        uniform_values = scale * scipy.interpolate.PchipInterpolator(cells.y, values, axis=1)(uniform_y)
        fields[name] = expand(np.where(is_known, uniform_values, np.nan), np.nan)
    motion = compute_rigid_motion(film, level_film)
    y = -grid.y[::-1] if is_mirrored else grid.y
    films = compute_films(film, level_film)
    thicknesses = film.height_scale * films.thicknesses
    errors = _combine_errors(refined_film.direction_errors, thicknesses).tolist()
    scalars: dict[str, float | int | bool] = {}
    for name, thickness, error in zip(FILM_NAMES, thicknesses.tolist(), errors, strict=True):
        scalars |= {name: thickness, f"{name}_error": error}
    ends_error = scalars["least_film_error"] + scalars["least_film_middle_error"]
    scalars |= {
        "end_film_ratio": films.least.film / films.least_film_middle,
        "end_film_ratio_error": ends_error / scalars["least_film_middle"],
        "least_film_x": film.half_width * films.least.position,
        "least_film_y": sign * film.half_width * films.least_y,
        "least_film_first_x": film.half_width * films.first.position,
        "least_film_last_x": film.half_width * films.last.position,
        "entrainment_speed": film.speeds.entrainment,
        "slide_roll_ratio": film.speeds.slide_roll_ratio,
        "moes_load": film.moes_load(film.largest_line_load),
        "moes_lubricant": film.moes_lubricant,
        "approach": motion.level,
        "tilt": motion.tilt,
        **reference_depths(film.case.body, film.case.counterbody),
        "end_flow_first": flow_scale * film.half_width * end_flows[0],
        "end_flow_last": flow_scale * film.half_width * end_flows[1],
        "normal_load": film.case.normal_load,
        "mass_error": solution.residual * level_film.problem.central_film / films.central_film,
        "film_balance_error": solution.balance_error * level_film.problem.central_film / films.central_film,
        "film_load_error": solution.load_error,
        "film_complementarity_error": solution.complementarity_error,
        "converged": solution.converged,
        "newton_steps": sum(entry.newton_steps for entry in refined_film.solutions),
        "linear_steps": sum(entry.linear_steps for entry in refined_film.solutions),
        "film_levels": len(refined_film.solutions) - 1,
        "hertz_half_width": film.half_width,
        "hertz_max_pressure": film.pressure_scale,
    }
    profiles = {"slice_film": (("x",), film.slice_film(grid.x))}
    if film.asperities is not None:
        rms = film.asperities.rms
        min_ratio = np.full(grid.cells_x, np.nan)
        min_ratio[level_film.columns] = film.height_scale * solution.film.min(axis=1) / rms
        profiles["film_ratio"] = (("x",), min_ratio)
        # The ends are outside ISO 281: kappa refers to the film of the middle section.
        viscosity_ratio = (scalars["least_film_middle"] / rms) ** VISCOSITY_EXPONENT
        relative_error = scalars["least_film_middle_error"] / scalars["least_film_middle"]
        scalars |= {
            "asperity_load_share": float((solution.asperity_pressure * cells.areas).sum() / level_film.problem.load),
            "roughness_rms": rms,
            "least_film_ratio": scalars["least_film"] / rms,
            "least_film_ratio_error": scalars["least_film_error"] / rms,
            "viscosity_ratio": viscosity_ratio,
            "viscosity_ratio_error": VISCOSITY_EXPONENT * relative_error * viscosity_ratio,
        }
    return xr.Dataset(
        {name: (("x", "y"), values) for name, values in fields.items()} | profiles | scalars,
        coords={"x": grid.x, "y": y} | cell_coordinates(grid),
    )


def compute_rigid_motion(film: FilmCase, level_film: FilmOnCells) -> RigidMotion:
    """Approach at the centre of tilt, and tilt, relative to the reference lines under the pressure."""
    problem, state = level_film.problem, level_film.solution.state
    forces = (problem.cells.areas * state.pressure).sum(axis=1)
    line_motion = level_film.line_motion(
        film, state.pressure, film.half_width * float(np.average(problem.cells.x, weights=forces))
    )
    height, *tilts = -film.height_scale * state.motion
    approach = height - line_motion.height(np.array([film.tilt_centre])).item()
    shape = level_film.shape
    return RigidMotion(approach, tilts[0] / shape.prescribed.max_arm(shape.grid) if tilts else film.case.tilt)


def _spread_pressure(level_film: FilmOnCells, values: FloatArray) -> FloatArray:
    """Pressure on the uniform cells along y, with the same load on every merged cell."""
    edges = level_film.merged.edges
    load = np.concatenate([np.zeros((len(values), 1)), np.cumsum(values * level_film.merged.counts, axis=1)], axis=1)
    spread_load = scipy.interpolate.PchipInterpolator(edges, load, axis=1)(np.arange(edges[-1] + 1))
    return np.asarray(np.maximum(np.diff(spread_load, axis=1), 0.0))


def _warn_of_viscosity(film: FilmCase, level_film: FilmOnCells) -> None:
    """Warn if the viscosity law does not hold at the largest pressure."""
    pressure = film.pressure_scale * level_film.solution.fluid_pressure
    row, cell = np.unravel_index(int(pressure.argmax()), pressure.shape)
    if film.lubricant.law_holds(pressure[row, cell]):
        return
    log_ratio = float(film.lubricant.log_viscosity(pressure[row, cell]))
    x, y = film.half_width * level_film.problem.cells.x[row], film.half_width * level_film.problem.cells.y[cell]
    warnings.warn(
        f"viscosity_law = {film.lubricant.viscosity_law!r} at {pressure[row, cell]:.3g} Pa (x = {x:.3g} m, "
        f"y = {abs(y):.3g} m from the middle) is exp({log_ratio:.0f}) times the ambient viscosity: the law does not "
        "hold at this pressure, which affects the traction; the film forms at lower pressures",
        MagnitudeWarning,
        stacklevel=3,
    )
