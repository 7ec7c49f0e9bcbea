"""Where the pressure jumps from column to column, so that these are split."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from contactstudy.checks import BoolArray, FloatArray
from contactstudy.contact.normal.problem import between_columns
from contactstudy.contact.refinement.columns import MOST_COLUMNS, AxialShape, centres_of, first_edges, overlooked, split
from contactstudy.contact.refinement.laws import EndLaw, Laws, Sample, end_loads, from_end, law_of, read_ends

POWERS = (2.0, 16.0)  # powers of the pressure whose jumps are marked. Accuracy.
LESSER_HALF = 0.1  # least pressure of a half, over the largest, that jumps in this half are measured by. Accuracy.


def pressure_jumps(edges: FloatArray, pressure: FloatArray) -> FloatArray:
    """Per column: largest step of the pressure's powers to a neighbour, over the peak of its half or its own crest."""
    jumps = [_jumps(edges, pressure, power) for power in POWERS]
    return np.asarray(np.max([*jumps, _crest_jumps(pressure)], axis=0))


def _crest_jumps(pressure: FloatArray) -> FloatArray:
    """Per column with a pressure above both neighbours: the larger step of its square, over this square."""
    # A narrow crest beside a contact's end may be lower than the peak of its half, by which jumps are measured.
    top = pressure.max(axis=1)
    middle, lowest = top[1:-1], np.minimum(top[:-2], top[2:])
    crest = (middle > top[:-2]) & (middle > top[2:]) & (middle > LESSER_HALF * top.max())
    steps = np.zeros_like(top)
    steps[1:-1][crest] = 1 - (lowest[crest] / middle[crest]) ** POWERS[0]
    return np.asarray(steps)


def _jumps(edges: FloatArray, pressure: FloatArray, power: float) -> FloatArray:
    """Per column: largest step of a power of the pressure to a neighbour, over its largest in the same half."""
    first_half = centres_of(edges) < 0.5 * (edges[0] + edges[-1])
    top = np.where(first_half, pressure[first_half].max(), pressure[~first_half].max())
    top = np.maximum(top, LESSER_HALF * pressure.max())
    steps = np.abs(np.diff((pressure / pressure.max()) ** power, axis=0)).max(axis=1)
    return np.asarray(np.maximum(np.append(steps, 0), np.insert(steps, 0, 0)) / (top / pressure.max()) ** power)


LOGGER = logging.getLogger(__name__)

FIRST_THETA, SHRINK, LOOSEST = 0.5, 0.7, 0.26
"""Threshold of the jumps at first, its reduction, and the largest at which the refinement may end. Accuracy."""

SECOND_THETA = SHRINK * FIRST_THETA  # threshold to which columns are refined roughly. Speed.

THETA_PER_ERROR = 50.0
"""Threshold over the least error that is stated with it. Accuracy: at 100 it covered 96 to 99 % of the ends."""

END_STEP = 4.0  # weight of the step that is left between a pressed end and the line through its two columns. Accuracy.

LAST_COLUMNS = 0.25
"""Width over the half-width of the columns within one half-width of the contact's ends along x. Accuracy."""

END_COLUMN = 0.012  # width over the half-width of the outermost column at a pressed end of the body. Accuracy.

SHARPEST, SMALLEST = 2e-3, 2e-4
"""Widths over the half-width down to which a sharp end is followed, and a column is split at all. Accuracy."""

CORNER_GROWTH = 0.25  # width of the columns next to a convex corner, over the distance to it. Accuracy.
ROUGH, POLISHED = 1e-2, 1e-5  # tolerances of the contact at the levels and where values are read. Speed and accuracy.


class ColumnPressure(NamedTuple):
    """A contact on some columns."""

    pressure: FloatArray  # (column, y): pressure, Pa
    opening: Callable[[], FloatArray]
    """Least gap of each column under load, metres: array (column). It takes one more application of the operator."""


Solve = Callable[[FloatArray, FloatArray | None, float], ColumnPressure]
"""From edges, a first guess of the pressure (or none) and a tolerance to the contact."""


Pairs = Mapping[str, Sequence[float]]
"""Values of the first and the last half or end, by their names in results: the largest pressure of a half, the pressure
at an end and the load on its last half-width, the load over the width of a cell along y."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RefinedColumns:
    """Columns of a refined contact."""

    edges: FloatArray  # edges of the columns, metres
    pressure: FloatArray  # (column, y): pressure, Pa
    values: Pairs  # pressures infinite at a singular end, 0 where it is not pressed
    errors: Pairs  # their estimated errors
    laws: Laws  # law of a singular end
    settled: bool  # whether every error that is stated is within the accuracy
    first: FloatArray  # edges of the columns of the first threshold, metres
    least_error: float  # least error that is stated on these columns, over the value

    @property
    def peak(self) -> float:
        """Largest pressure, Pa."""
        return max(self.values["peak_pressure"])

    @property
    def peak_error(self) -> float:
        """Estimated error of the largest pressure, Pa."""
        pairs = zip(self.values["peak_pressure"], self.errors["peak_pressure"], strict=True)
        return max(error for peak, error in pairs if peak == self.peak)


def rough_columns(solve: Solve, shape: AxialShape) -> Refinement:
    """First columns, with a peak to some percent."""
    state = Refinement(solve=solve, shape=shape, edges=first_edges(shape))
    for theta in (FIRST_THETA, SECOND_THETA):
        state.refine(theta)
    return state


def refine_columns(solve: Solve, shape: AxialShape, accuracy: float, begin: FloatArray | None = None) -> RefinedColumns:
    """Refine columns, from the edges `begin` of a rough contact, until peak and end pressures settle to `accuracy`."""
    state = Refinement(solve=solve, shape=shape, edges=first_edges(shape) if begin is None else begin)
    theta = FIRST_THETA if begin is None else SECOND_THETA
    while True:
        state.refine(theta)
        state.read()
        if len(state.readings) > 1:
            refined = state.result(theta, accuracy)
            if (theta <= LOOSEST and refined.settled) or state.edges.size > MOST_COLUMNS:
                return refined
        theta *= SHRINK


@dataclass(kw_only=True, eq=False)
class Refinement:
    """Where the refinement stands."""

    solve: Solve
    shape: AxialShape
    edges: FloatArray
    pressure: FloatArray = field(init=False)
    first: FloatArray | None = None
    readings: list[Pairs] = field(default_factory=list)
    along_y: float = 0.0
    laws: list[EndLaw | None] = field(default_factory=lambda: [None, None])
    samples: tuple[list[Sample], list[Sample]] = field(default_factory=lambda: ([], []))

    def __post_init__(self) -> None:
        self.pressure = self.solve(self.edges, None, ROUGH).pressure
        self._sample()

    @property
    def singular(self) -> bool:
        """Whether an end has a law, or will have one: a sharp one that is pressed."""
        return any(self.laws) or any(self.shape.sharp(side) and self.pressure[-side].any() for side in (0, 1))

    def refine(self, theta: float) -> None:
        """Split columns until none is marked."""
        while True:
            while self.edges.size <= MOST_COLUMNS and (marks := self._marks(theta)).any():
                self._split(marks)
            self.pressure, opening = self.solve(self.edges, self.pressure, POLISHED)
            marks = overlooked(self.shape, self.edges, np.asarray(self.pressure.any(axis=1)), opening())
            if not marks.any() or self.edges.size > MOST_COLUMNS:
                break
            self._split(marks)
        if self.first is None:
            self.first = self.edges

    def _split(self, marks: BoolArray) -> None:
        """Split marked columns and solve the contact on them roughly."""
        finer = split(self.edges, marks)
        guess = np.sqrt(between_columns(self.pressure**2, centres_of(self.edges), centres_of(finer)))
        self.edges = finer
        self.pressure = self.solve(finer, guess, ROUGH).pressure
        LOGGER.info("refined to %d columns", finer.size - 1)
        self._sample()

    def _sample(self) -> None:
        """Note the outermost columns wherever they have been split, and decide on their law."""
        for side, samples in enumerate(self.samples):
            edges, pressure = from_end(side, self.edges, self.pressure)
            width = float(edges[1])
            if not samples or width < 0.99 * samples[-1].width:
                samples.append(Sample(width, float(pressure[0].max())))
                if self.laws[side] is None and width <= SHARPEST * self.shape.half_width:
                    self.laws[side] = law_of(samples, self.shape.exponents[side])

    def _marks(self, theta: float) -> BoolArray:
        """Columns to split."""
        edges, pressure, a = self.edges, self.pressure, self.shape.half_width
        widths, largest = np.diff(edges), pressure.max()
        jumps = pressure_jumps(edges, pressure)
        for side, (i, j) in enumerate(((0, 1), (-1, -2))):
            if self.laws[side] is None and pressure[i].max() > 0:
                step = np.abs(pressure[i] - pressure[j]).max() * widths[i] / (widths[i] + widths[j]) / largest
                jumps[i] = max(jumps[i], END_STEP * step)
                rises = pressure[i].max() >= self._half(side).max()
                sharp = self.shape.sharp(side) or self.shape.room[side] > 0 or rises
                if widths[i] > (SHARPEST if sharp else END_COLUMN) * a:
                    jumps[i] = np.inf
        touched = np.flatnonzero(pressure.any(axis=1))
        for end in (edges[touched[0]], edges[touched[-1] + 1]):
            near = (edges[:-1] < end + a) & (edges[1:] > end - a)
            jumps[near & (widths > LAST_COLUMNS * a)] = np.inf
        marks: BoolArray = (jumps > theta) & (widths > 2 * SMALLEST * a)
        for corner in self.shape.corners:
            index = int(np.abs(edges - corner).argmin())
            if pressure[index - 1 : index + 1].any():
                distances = np.maximum(edges[:-1] - corner, corner - edges[1:])
                near = distances < a
                marks[near] = widths[near] > np.maximum(SHARPEST * a, CORNER_GROWTH * distances[near])
        for side, outermost in enumerate(((0, 1), (-1, -2))):
            if self.laws[side] is not None:
                marks[list(outermost)] = False
        return marks

    def _half(self, side: int) -> FloatArray:
        first_half = centres_of(self.edges) < 0.5 * (self.edges[0] + self.edges[-1])
        half: FloatArray = self.pressure[first_half if side == 0 else ~first_half]
        return half

    def read(self) -> None:
        """Note the values of either half and end."""
        values, self.along_y = read_values(self.edges, self.pressure, self.shape, self.laws)
        self.readings.append(values)

    def result(self, theta: float, accuracy: float) -> RefinedColumns:
        """Values with their errors."""
        values = self.readings[-1]
        finite = [value for value in values["peak_pressure"] if 0 < value < np.inf]  # a half may have no contact
        scale = max(finite, default=float(self.pressure.max()))
        floor = scale * (theta / THETA_PER_ERROR + self.along_y)
        # Over a half-width under the mean load per length.
        length = float(self.edges[-1] - self.edges[0])
        usual = float(self.pressure.sum(axis=1) @ np.diff(self.edges)) * min(1.0, self.shape.half_width / length)
        floors = {"peak_pressure": floor, "end_pressure": floor, "end_load": usual * floor / scale}
        errors = {
            name: [_change_error([reading[name][side] for reading in self.readings], least) for side in (0, 1)]
            for name, least in floors.items()
        }
        for side in (0, 1):
            fades = self.shape.fades and self.shape.room[side] == 0
            # The pressure at an end, sharp or fading at the end of the face, does not settle and has no law.
            diverges = (self.shape.sharp(side) or fades) and self.laws[side] is None
            if diverges and self.pressure[-side].any():
                errors["end_pressure"][side] = np.inf
                if self._half(side).max() <= self.pressure[-side].max():
                    errors["peak_pressure"][side] = np.inf
        stated = [error for error in errors["peak_pressure"] + errors["end_pressure"] if np.isfinite(error)]
        settled = max(stated, default=floor) <= accuracy * scale and max(errors["end_load"]) <= accuracy * usual
        return RefinedColumns(
            edges=self.edges,
            pressure=self.pressure,
            values=values,
            errors=errors,
            laws=_fitted_laws(self.laws, self.edges, self.pressure, self.shape),
            settled=settled,
            first=self.edges if self.first is None else self.first,
            least_error=floor / scale,
        )


def replace_pressure(refined: RefinedColumns, pressure: FloatArray, shape: AxialShape) -> RefinedColumns:
    """Return the values of another pressure on the same columns, which the coupled friction has changed a little."""
    # The errors grow with the peak. The pressure of an end that only friction presses is its error.
    values, _ = read_values(refined.edges, pressure, shape, refined.laws)
    largest = max(values["peak_pressure"])
    factor = largest / refined.peak if np.isfinite(largest) else float(pressure.max() / refined.pressure.max())
    ends = zip(refined.values["end_pressure"], refined.errors["end_pressure"], values["end_pressure"], strict=True)
    errors = {
        "peak_pressure": [factor * error for error in refined.errors["peak_pressure"]],
        "end_pressure": [factor * error if before > 0 else now for before, error, now in ends],
    }
    laws = _fitted_laws(refined.laws, refined.edges, pressure, shape)
    return replace(refined, pressure=pressure, values=values, errors={**refined.errors, **errors}, laws=laws)


def read_values(
    edges: FloatArray, pressure: FloatArray, shape: AxialShape, laws: Sequence[EndLaw | None]
) -> tuple[Pairs, float]:
    """Values of a pressure (column, y), and by how much the parabola across lifts the largest pressure."""
    peaks, ends, along_y = read_ends(edges, pressure, laws)
    middle = 0.5 * (edges[0] + edges[-1])
    for corner in shape.corners:
        index = int(np.abs(edges - corner).argmin())
        if pressure[index - 1 : index + 1].any():
            peaks = (np.inf if corner <= middle else peaks[0]), (np.inf if corner >= middle else peaks[1])
    loads = end_loads(edges, pressure, shape.half_width)
    return {"peak_pressure": peaks, "end_pressure": ends, "end_load": loads}, along_y


def _fitted_laws(laws: Sequence[EndLaw | None], edges: FloatArray, pressure: FloatArray, shape: AxialShape) -> Laws:
    """Laws of both ends with the intensities of a pressure (column, y)."""
    first, last = (
        law.with_intensity(*from_end(side, edges, pressure), shape.room[side]) if law else None
        for side, law in enumerate(laws)
    )
    return first, last


def _change_error(values: list[float], floor: float) -> float:
    """Error of the last of some values; infinite for one that is, 0 for a pressure that stays 0."""
    last = values[-1]
    if not np.isfinite(last):
        return np.inf
    if not any(values[-3:]):
        return 0.0
    back = [abs(last - value) for value in values[-3:-1] if np.isfinite(value)]
    half = 0.5 * max(back, default=np.inf)
    return max(half, floor)  # eq. (40)
