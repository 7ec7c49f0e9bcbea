"""Columns along the axis: initial columns follow the shape; columns with a jump of the pressure are split."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.grid import centres_of, interpolate_columns
from contactstudy.arrays.peaks import section_maxima
from contactstudy.checks import BoolArray, FloatArray
from contactstudy.contact.refinement.laws import EndLaw, Sample, law_of

FIRST_COLUMN = 0.1  # width of the first columns at the ends, over the half-width. Accuracy: wider ones miss sharp ends.
MIN_COLUMNS = 16  # least number of columns over the length. Accuracy.
CHORD_TOLERANCE = 0.1  # distance of the shape from its chord in a first column, over ``a**2 / 2R``. Accuracy.

SAMPLE_POSITIONS = np.linspace(0.0, 1.0, 257)
"""Sampling points of the shape in a column. Accuracy: in the widest first columns they are 1/4096 of the length apart,
and narrower ridges are missed."""

PENETRATION_TOLERANCE = 0.02
"""Largest depth, over ``a**2 / 2R``, of the shape below the displaced top in an open column. Accuracy: a missed crest
then carries 0.14 of the Hertz pressure at most."""

MIN_CHORD_WIDTH = 0.1  # width over the half-width below which a first column is not split for its shape. Speed.
MAX_WIDTH_RATIO = 2.6  # largest ratio of neighbouring widths. Accuracy.
MAX_COLUMNS = 600  # columns at which the refinement ends without convergence. Speed.


@dataclass(frozen=True, kw_only=True, eq=False)
class AxialShape:
    """Shape of the indenter along the axis."""

    start: float  # range of possible contact, metres
    stop: float
    half_width: float  # Hertz half-width ``a``, metres
    depth: float  # depth ``a**2 / 2R`` to which a cylinder sinks, metres
    height: Callable[[FloatArray], FloatArray]  # height along the axis over the plane of first touch, metres
    face_beyond: tuple[float, float]  # length of the body's face beyond either end, metres; 0 or less where it ends
    exponents: tuple[float, float] = (np.nan, np.nan)  # ``m`` of ``K d**-m`` at sharp ends; NaN without a law
    has_fading_end: bool = False  # whether the pressure at a common end falls to 0 too steeply to be resolved
    corners: tuple[float, ...] = ()  # positions of convex corners and of column edges, metres
    nodes: FloatArray = field(default_factory=lambda: np.zeros(0))  # positions between which the shape is smooth, m

    @cached_property
    def node_heights(self) -> FloatArray:
        """Heights at the nodes, metres."""
        return self.height(self.nodes)

    def is_singular(self, end: int) -> bool:
        """Whether the pressure at an end is singular if the end is loaded."""
        return self.exponents[end] > 0


def first_edges(shape: AxialShape) -> FloatArray:
    """Edges of the first columns: widths double from either end, and are halved where the shape bends."""
    length = shape.stop - shape.start
    width = min(FIRST_COLUMN * shape.half_width, length / (4 * MIN_COLUMNS))
    widths = [width]
    while sum(widths) < 0.5 * length:
        widths.append(min(2 * widths[-1], length / MIN_COLUMNS))
    half_edges = np.append(0.0, np.cumsum(widths)) * (0.5 * length / sum(widths))
    edges = shape.start + np.concatenate([half_edges, length - half_edges[-2::-1]])
    edges[-1] = shape.stop
    if shape.corners:
        edges = split_columns(_insert_edges(edges, shape.corners), np.zeros(0, dtype=bool))
    while True:
        _, lowest, is_bent = _sample(shape, edges)
        # Columns are split only where the shape is so low that contact is certain.
        is_marked = is_bent & (lowest - lowest.min() < 3 * shape.depth)
        is_marked &= np.diff(edges) > MIN_CHORD_WIDTH * shape.half_width
        if not is_marked.any() or edges.size > MAX_COLUMNS:
            return edges
        edges = split_columns(edges, is_marked)


def _sample(shape: AxialShape, edges: FloatArray) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Heights (column, point); per column the least height, nodes included, and whether the shape leaves its chord."""
    # The outer points lie just inside the column, because the shape may jump at its edges.
    fractions = np.clip(SAMPLE_POSITIONS, 1e-9, 1 - 1e-9)
    positions = edges[:-1, None] + np.diff(edges)[:, None] * fractions
    heights = shape.height(positions.ravel()).reshape(positions.shape)
    rise, lowest = heights[:, -1] - heights[:, 0], heights.min(axis=1)
    deviations = np.abs(heights - heights[:, :1] - rise[:, None] * SAMPLE_POSITIONS).max(axis=1)
    if shape.nodes.size:
        columns = np.clip(np.searchsorted(edges, shape.nodes, side="right") - 1, 0, edges.size - 2)
        fraction = (shape.nodes - edges[columns]) / np.diff(edges)[columns]
        np.maximum.at(deviations, columns, np.abs(shape.node_heights - heights[columns, 0] - rise[columns] * fraction))
        np.minimum.at(lowest, columns, shape.node_heights)
    return heights, lowest, deviations > CHORD_TOLERANCE * shape.depth


def _insert_edges(edges: FloatArray, corners: tuple[float, ...]) -> FloatArray:
    """Add edges at the corners; edges closer to a corner than a quarter of their narrower column are dropped."""
    inner_edges, widths = edges[1:-1], np.diff(edges)
    distances = np.abs(inner_edges[:, None] - corners).min(axis=1)
    inner_edges = inner_edges[distances >= 0.25 * np.minimum(widths[:-1], widths[1:])]
    return np.unique(np.concatenate([edges[:1], inner_edges, corners, edges[-1:]]))


def find_overlooked(shape: AxialShape, edges: FloatArray, loaded: BoolArray, opening: FloatArray) -> BoolArray:
    """Mark columns in which a solved contact misses details of the shape: a bend under pressure, or an open crest."""
    # An open column is overlooked if the shape lies below the displaced surface, unless a contact ends in the column.
    heights, lowest, is_bent = _sample(shape, edges)
    rigid_height = heights.mean(axis=1) - opening
    lowest_point = heights.argmin(axis=1)
    is_neighbour = np.zeros_like(loaded)
    is_neighbour[1:] |= loaded[:-1] & (lowest_point[1:] == 0)
    is_neighbour[:-1] |= loaded[1:] & (lowest_point[:-1] == SAMPLE_POSITIONS.size - 1)
    is_neighbour &= lowest >= heights.min(axis=1)
    is_missed = ~loaded & ~is_neighbour & (rigid_height - lowest > PENETRATION_TOLERANCE * shape.depth)
    is_wide = np.diff(edges) > MIN_CHORD_WIDTH * shape.half_width
    return np.asarray(is_wide & (is_missed | (loaded & is_bent)))


def split_columns(edges: FloatArray, is_marked: BoolArray) -> FloatArray:
    """Halve marked columns, and every column that is then much wider than a neighbour."""
    edges = np.sort(np.concatenate([edges, centres_of(edges)[is_marked]])) if is_marked.any() else edges
    while True:
        widths = np.diff(edges)
        is_too_wide = np.zeros(widths.size, dtype=bool)
        is_too_wide[:-1] |= widths[:-1] > MAX_WIDTH_RATIO * widths[1:]
        is_too_wide[1:] |= widths[1:] > MAX_WIDTH_RATIO * widths[:-1]
        if not is_too_wide.any():
            return edges
        edges = np.sort(np.concatenate([edges, centres_of(edges)[is_too_wide]]))


JUMP_POWERS = (2.0, 16.0)  # powers of the pressure whose jumps are marked. Accuracy.
MIN_HALF_PRESSURE = 0.1  # least scale of the jumps in a half, over the largest pressure. Accuracy.


def pressure_jumps(edges: FloatArray, pressure: FloatArray) -> FloatArray:
    """Per column, the largest step of powers of the pressure to a neighbour, over the half's peak or the crest."""
    jumps = [_power_jumps(edges, pressure, power) for power in JUMP_POWERS]
    return np.asarray(np.max([*jumps, _crest_jumps(pressure)], axis=0))


def _crest_jumps(pressure: FloatArray) -> FloatArray:
    """Per column with a pressure above both neighbours, the larger step of the squared pressure, over the square."""
    # A narrow crest near a contact's end may be lower than the peak of its half, the scale of the other jumps.
    maxima = pressure.max(axis=1)
    inner, neighbour = maxima[1:-1], np.minimum(maxima[:-2], maxima[2:])
    is_crest = (inner > maxima[:-2]) & (inner > maxima[2:]) & (inner > MIN_HALF_PRESSURE * maxima.max())
    steps = np.zeros_like(maxima)
    steps[1:-1][is_crest] = 1 - (neighbour[is_crest] / inner[is_crest]) ** JUMP_POWERS[0]
    return np.asarray(steps)


def _power_jumps(edges: FloatArray, pressure: FloatArray, power: float) -> FloatArray:
    """For each column, the largest step of a power of the pressure to a neighbour, over the half's largest power."""
    first_half = centres_of(edges) < 0.5 * (edges[0] + edges[-1])
    half_maxima = np.where(first_half, pressure[first_half].max(), pressure[~first_half].max())
    half_maxima = np.maximum(half_maxima, MIN_HALF_PRESSURE * pressure.max())
    steps = np.abs(np.diff((pressure / pressure.max()) ** power, axis=0)).max(axis=1)
    return np.asarray(np.maximum(np.append(steps, 0), np.insert(steps, 0, 0)) / (half_maxima / pressure.max()) ** power)


ValuePairs = Mapping[str, list[float]]
"""Values of the first and the last half or end, by their names in results: the largest pressure of a half, the pressure
at an end, and the load on the last half-width at an end, over the width of a cell along y."""


def evaluate_pairs(
    edges: FloatArray, pressure: FloatArray, shape: AxialShape, laws: Sequence[EndLaw | None]
) -> tuple[ValuePairs, float]:
    """Values of a pressure (column, y), and relative increase of the peak by a parabola along y."""
    maxima, sums = section_maxima(pressure), pressure.sum(axis=1)
    half_length, mid_x = 0.5 * (edges[-1] - edges[0]), 0.5 * (edges[0] + edges[-1])
    loaded_corners = _loaded_corners(shape.corners, edges, pressure)
    values: dict[str, list[float]] = {"peak_pressure": [], "end_pressure": [], "end_load": []}
    for end, law in enumerate(laws):
        distances, axial_pressure = count_from_end(end, edges, maxima)
        end_pressure = np.inf if law else _extrapolate_to_end(distances, axial_pressure)
        half_pressure = axial_pressure[centres_of(distances) < half_length]
        # Where the pressure rises through mid-length, the peak of a half lies at mid-length.
        peak = max(float(half_pressure.max()), float(np.interp(half_length, centres_of(distances), axial_pressure)))
        # The peak exceeds the mean of the outermost column only if the pressure rises to the end.
        if half_pressure.argmax() == 0:
            peak = max(peak, end_pressure)
        is_unbounded = law or any(corner >= mid_x if end else corner <= mid_x for corner in loaded_corners)
        values["peak_pressure"].append(np.inf if is_unbounded else peak)
        values["end_pressure"].append(end_pressure)
        column_sums = count_from_end(end, edges, sums)[1]
        values["end_load"].append(float(column_sums @ np.diff(np.minimum(distances, shape.half_width))))
    return values, float(maxima.max() / pressure.max()) - 1


def _loaded_corners(corners: tuple[float, ...], edges: FloatArray, pressure: FloatArray) -> list[float]:
    """Corners next to a column with a pressure (column, y)."""
    indices = [int(np.abs(edges - corner).argmin()) for corner in corners]
    return [corner for corner, i in zip(corners, indices, strict=True) if pressure[i - 1 : i + 1].any()]


def count_from_end(end: int, edges: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Distances of the edges from an end of the shape, and the values in the order from this end."""
    return (edges - edges[0], values) if end == 0 else (edges[-1] - edges[::-1], values[::-1])


def _extrapolate_to_end(edges: FloatArray, axial_pressure: FloatArray) -> float:
    """Pressure at the end, from the means of the three outermost columns."""
    if axial_pressure[0] <= 0:
        return 0.0
    sums = np.cumsum(axial_pressure[:3] * np.diff(edges[:4]))
    positions = edges[1:4]
    return max(float(np.linalg.solve(np.stack([positions, positions**2, positions**3], axis=1), sums)[0]), 0.0)


LOGGER = logging.getLogger(__name__)

FIRST_THETA, THETA_RATIO, MAX_THETA = 0.5, 0.7, 0.26  # Thresholds: first, successive ratio, largest last. Accuracy.
SECOND_THETA = THETA_RATIO * FIRST_THETA  # threshold of the jumps in a rough contact. Speed.
THETA_PER_ERROR = 50.0  # Threshold over the least stated error; with 100 it is too small at 1 to 4 % of ends. Accuracy.
END_STEP_WEIGHT = 4.0  # weight of the step from the outermost column to a loaded end, extrapolated linearly. Accuracy.
EDGE_COLUMN_WIDTH = 0.25  # Width over a of the columns within one half-width of the ends along x. Accuracy.
END_COLUMN_WIDTH = 0.012  # width over the half-width of the outermost column at a loaded end of the body. Accuracy.
MIN_END_COLUMN, MIN_COLUMN = 2e-3, 2e-4  # Least widths over a, at a sharp end and anywhere. Accuracy.
CORNER_GROWTH = 0.25  # width of the columns next to a convex corner, over the distance to it. Accuracy.
LEVEL_TOLERANCE = 1e-2  # tolerance of the contact between two splittings. Speed.
VALUE_TOLERANCE = 1e-5  # tolerance of the contact that determines the values. Accuracy.


class ColumnPressure(NamedTuple):
    """A contact on some columns."""

    pressure: FloatArray  # (column, y): pressure, Pa
    opening: Callable[[], FloatArray]  # (column): least gap under load, metres; each call applies the operator


Solve = Callable[[FloatArray, FloatArray | None, float], ColumnPressure]
"""Function from edges, an initial guess of the pressure (or None) and a tolerance to the contact on the columns."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RefinedColumns:
    """Columns of a refined contact."""

    edges: FloatArray  # edges of the columns, metres
    pressure: FloatArray  # (column, y): pressure, Pa
    values: ValuePairs  # values by name; a pressure is infinite at a singular end, 0 at an end without contact
    errors: ValuePairs  # estimated errors of the values
    laws: Sequence[EndLaw | None]  # law of each singular end
    accurate: bool  # whether every stated error is within the accuracy
    first_edges: FloatArray  # edges of the columns at the first threshold, metres
    least_error: float  # least stated error on these columns, over the value

    @property
    def peak(self) -> float:
        """Largest pressure, Pa."""
        return max(self.values["peak_pressure"])

    @property
    def peak_error(self) -> float:
        """Estimated error of the largest pressure, Pa."""
        peaks_and_errors = zip(self.values["peak_pressure"], self.errors["peak_pressure"], strict=True)
        return max(error for peak, error in peaks_and_errors if peak == self.peak)


def refine_coarsely(solve: Solve, shape: AxialShape) -> Refinement:
    """Refine the first columns until the peak is accurate to some percent."""
    refinement = Refinement(solve=solve, shape=shape, edges=first_edges(shape))
    for theta in (FIRST_THETA, SECOND_THETA):
        refinement.refine(theta)
    return refinement


def refine_columns(solve: Solve, shape: AxialShape, accuracy: float, start: FloatArray | None = None) -> RefinedColumns:
    """Refine columns from the edges `start` of a coarse contact until peak and end pressures reach `accuracy`."""
    refinement = Refinement(solve=solve, shape=shape, edges=first_edges(shape) if start is None else start)
    theta = FIRST_THETA if start is None else SECOND_THETA
    while True:
        refinement.refine(theta)
        refined = refinement.record_result(theta, accuracy)
        is_complete = (theta <= MAX_THETA and refined.accurate) or refined.edges.size > MAX_COLUMNS
        if len(refinement.history) > 1 and is_complete:
            return refined
        theta *= THETA_RATIO


@dataclass(kw_only=True, eq=False)
class Refinement:
    """State of the refinement."""

    solve: Solve
    shape: AxialShape
    edges: FloatArray
    pressure: FloatArray = field(init=False)
    history: list[tuple[FloatArray, ValuePairs]] = field(default_factory=list)
    laws: list[EndLaw | None] = field(default_factory=lambda: [None, None])
    samples: tuple[list[Sample], list[Sample]] = field(default_factory=lambda: ([], []))

    def __post_init__(self) -> None:
        self.pressure = self.solve(self.edges, None, LEVEL_TOLERANCE).pressure
        self._record_samples()

    @property
    def singular(self) -> bool:
        """Whether an end has a law, or will have a law because it is sharp and loaded."""
        return any(self.laws) or any(self.shape.is_singular(end) and self.pressure[-end].any() for end in (0, 1))

    def refine(self, theta: float) -> None:
        """Split columns until no column is marked."""
        while True:
            while self.edges.size <= MAX_COLUMNS and (is_marked := self._select_columns_to_split(theta)).any():
                self._split(is_marked)
            self.pressure, opening = self.solve(self.edges, self.pressure, VALUE_TOLERANCE)
            is_marked = find_overlooked(self.shape, self.edges, np.asarray(self.pressure.any(axis=1)), opening())
            if not is_marked.any() or self.edges.size > MAX_COLUMNS:
                break
            self._split(is_marked)

    def _split(self, is_marked: BoolArray) -> None:
        """Split marked columns and solve the contact on them roughly."""
        finer = split_columns(self.edges, is_marked)
        guess = np.sqrt(interpolate_columns(self.pressure**2, centres_of(self.edges), centres_of(finer)))
        self.edges = finer
        self.pressure = self.solve(finer, guess, LEVEL_TOLERANCE).pressure
        LOGGER.info("refined to %d columns", finer.size - 1)
        self._record_samples()

    def _record_samples(self) -> None:
        """Record the pressures of the outermost columns after a splitting, and determine the laws of the ends."""
        for end, samples in enumerate(self.samples):
            edges, pressure = count_from_end(end, self.edges, self.pressure)
            width = float(edges[1])
            if not samples or width < 0.99 * samples[-1].width:
                samples.append(Sample(width, float(pressure[0].max())))
                if self.laws[end] is None and width <= MIN_END_COLUMN * self.shape.half_width:
                    self.laws[end] = law_of(samples, self.shape.exponents[end])

    def _select_columns_to_split(self, theta: float) -> BoolArray:
        """Mark the columns to split at the threshold `theta`."""
        edges, pressure, a = self.edges, self.pressure, self.shape.half_width
        widths, max_pressure = np.diff(edges), pressure.max()
        jumps = pressure_jumps(edges, pressure)
        for end, (i, j) in enumerate(((0, 1), (-1, -2))):
            if self.laws[end] is None and pressure[i].max() > 0:
                step = np.abs(pressure[i] - pressure[j]).max() * widths[i] / (widths[i] + widths[j]) / max_pressure
                jumps[i] = max(jumps[i], END_STEP_WEIGHT * step)
                rises_to_end = pressure[i].max() >= self._half_pressure(end).max()
                is_sharp = self.shape.is_singular(end) or self.shape.face_beyond[end] > 0 or rises_to_end
                if widths[i] > (MIN_END_COLUMN if is_sharp else END_COLUMN_WIDTH) * a:
                    jumps[i] = np.inf
        loaded_columns = np.flatnonzero(pressure.any(axis=1))
        for contact_end in (edges[loaded_columns[0]], edges[loaded_columns[-1] + 1]):
            is_near = (edges[:-1] < contact_end + a) & (edges[1:] > contact_end - a)
            jumps[is_near & (widths > EDGE_COLUMN_WIDTH * a)] = np.inf
        is_marked: BoolArray = (jumps > theta) & (widths > 2 * MIN_COLUMN * a)
        corners = _loaded_corners(self.shape.corners, edges, pressure)
        distances = [np.maximum(edges[:-1] - corner, corner - edges[1:]) for corner in corners]
        corner_distance = np.min(distances, axis=0, initial=a)
        is_wide = widths > np.maximum(MIN_END_COLUMN * a, CORNER_GROWTH * corner_distance)
        is_marked = np.where(corner_distance < a, is_wide, is_marked)
        for end, outer_columns in enumerate(((0, 1), (-1, -2))):
            if self.laws[end] is not None:
                is_marked[list(outer_columns)] = False
        return is_marked

    def _half_pressure(self, end: int) -> FloatArray:
        first_half = centres_of(self.edges) < 0.5 * (self.edges[0] + self.edges[-1])
        return np.asarray(self.pressure[first_half if end == 0 else ~first_half])

    def record_result(self, theta: float, accuracy: float) -> RefinedColumns:
        """Columns of a threshold, with values and errors; record the values in the history."""
        values, lateral_excess = evaluate_pairs(self.edges, self.pressure, self.shape, self.laws)
        self.history.append((self.edges, values))
        finite_peaks = [value for value in values["peak_pressure"] if 0 < value < np.inf]  # a half may have no contact
        scale = max(finite_peaks, default=float(self.pressure.max()))
        least_error = scale * (theta / THETA_PER_ERROR + lateral_excess)
        # The scale of `end_load` is the mean load per length times a half-width.
        length = float(self.edges[-1] - self.edges[0])
        end_load = float(self.pressure.sum(axis=1) @ np.diff(self.edges)) * min(1.0, self.shape.half_width / length)
        end_load_error = end_load * least_error / scale
        least_errors = {"peak_pressure": least_error, "end_pressure": least_error, "end_load": end_load_error}
        errors = {
            name: [_change_error([earlier[name][end] for _, earlier in self.history], bound) for end in (0, 1)]
            for name, bound in least_errors.items()
        }
        for end in (0, 1):
            fades_out = self.shape.has_fading_end and self.shape.face_beyond[end] == 0
            # The pressure at an end, sharp or fading at the end of the face, does not converge and has no law.
            diverges = (self.shape.is_singular(end) or fades_out) and self.laws[end] is None
            if diverges and self.pressure[-end].any():
                errors["end_pressure"][end] = np.inf
                if self._half_pressure(end).max() <= self.pressure[-end].max():
                    errors["peak_pressure"][end] = np.inf
        finite_errors = [error for error in errors["peak_pressure"] + errors["end_pressure"] if np.isfinite(error)]
        accurate = max(errors["end_load"]) <= accuracy * end_load
        accurate &= max(finite_errors, default=least_error) <= accuracy * scale
        return RefinedColumns(
            edges=self.edges,
            pressure=self.pressure,
            values=values,
            errors=errors,
            laws=_fit_laws(self.laws, self.edges, self.pressure, self.shape),
            accurate=accurate,
            first_edges=self.history[0][0],
            least_error=least_error / scale,
        )


def replace_pressure(refined: RefinedColumns, pressure: FloatArray, shape: AxialShape) -> RefinedColumns:
    """Return the columns with the values of another pressure, which coupled friction has changed a little."""
    # The errors grow with the peak. At an end in contact only by friction the pressure itself is the error.
    values, _ = evaluate_pairs(refined.edges, pressure, shape, refined.laws)
    largest = max(values["peak_pressure"])
    factor = largest / refined.peak if np.isfinite(largest) else float(pressure.max() / refined.pressure.max())
    ends = zip(refined.values["end_pressure"], refined.errors["end_pressure"], values["end_pressure"], strict=True)
    errors = {
        "peak_pressure": [factor * error for error in refined.errors["peak_pressure"]],
        "end_pressure": [factor * error if previous > 0 else value for previous, error, value in ends],
    }
    laws = _fit_laws(refined.laws, refined.edges, pressure, shape)
    return replace(refined, pressure=pressure, values=values, errors={**refined.errors, **errors}, laws=laws)


def _fit_laws(
    laws: Sequence[EndLaw | None], edges: FloatArray, pressure: FloatArray, shape: AxialShape
) -> list[EndLaw | None]:
    """Laws of both ends with the intensities of a pressure (column, y)."""
    return [
        law and law.with_intensity(*count_from_end(end, edges, pressure), shape.face_beyond[end])
        for end, law in enumerate(laws)
    ]


def _change_error(values: list[float], least_error: float) -> float:
    """Error of the last value; infinite for an infinite value, 0 for a pressure that remains 0."""
    last_value = values[-1]
    if not np.isfinite(last_value):
        return np.inf
    if not any(values[-3:]):
        return 0.0
    changes = [abs(last_value - value) for value in values[-3:-1] if np.isfinite(value)]
    half_change = 0.5 * max(changes, default=np.inf)
    return max(half_change, least_error)  # eq. (40)
