"""A field that the free ends add to the mirrored half-space, from the equivalent loads.

For each wavenumber along y the equivalent load ``R`` (in H) and the face loads ``S`` (in V) are evaluated on their
rays, where every factor decays with the distance from the loaded corner; the field is a sum of separable terms
``f(k, x) g(k, z)``, taken as matrix products. Only points within reach of a corner take part at a high wavenumber.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from contactstudy.checks import BoolArray, ComplexArray, FloatArray, IntArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.axial import DECAY_LENGTHS
from contactstudy.overlapping.equations import AuxiliaryLoads, EquationSet
from contactstudy.overlapping.lateral import LateralColumns
from contactstudy.overlapping.panels import POSITIONS_PER_PANEL, graded_interpolation
from contactstudy.overlapping.problem import EndProblem, View, parity_parts, views_of
from contactstudy.threads import one_blas_thread

SAME_POSITION = 12
"""Digits to which positions over the length agree that are the same distance from either end. Accuracy."""


@dataclass(frozen=True)
class Harmonics:
    """A field of H under the equivalent load and of V under the face loads, for one wavenumber along y.

    Attributes
    ----------
    below_equivalent_load : callable
        From equation set, equivalent load (wavenumber, column), cosine and sine (wavenumber, x) and depths to
        amplitudes (component, x, z, column).
    beside_face_load : callable
        From equation set, depth wavenumbers, weighted face loads (depth, column), distances from the end and depths
        to the same.
    even_in_y, odd_in_y : list of int
        Components that under a pressure even in y are even or odd.
    odd_along_x : list of int
        Components that change sign when seen from the other end.
    """

    below_equivalent_load: Callable[[EquationSet, ComplexArray, ComplexArray, ComplexArray, FloatArray], FloatArray]
    beside_face_load: Callable[[EquationSet, ComplexArray, ComplexArray, FloatArray, FloatArray], FloatArray]
    even_in_y: list[int]
    odd_in_y: list[int]
    odd_along_x: list[int]

    @property
    def count(self) -> int:
        """Number of components."""
        return len(self.even_in_y) + len(self.odd_in_y)


class Place(NamedTuple):
    """Points where a field is wanted: the tensor product of `x`, `y` and `z`, metres."""

    x: FloatArray
    y: FloatArray
    z: FloatArray


TOGETHER = 2000
"""Points, of the positions and depths of all places, up to which these are evaluated at once. Speed."""


@dataclass(frozen=True, eq=False)
class _Folded:
    """A place as its field is summed: at few positions, seen from the nearest end, never on the loaded corner itself.

    Attributes
    ----------
    x, y, z : array
        Points of the sum; the last depth is that a little below the corner if the place has the corner.
    where, beyond : array
        Which of `x` each position is, and whether it is nearer to the far end.
    interpolation : array or None
        From the positions to the place's own; None where they are the same.
    corner : tuple of array, or None
        Numbers of `x` and of the depths that are on the corner; None if the place does not have it.
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    where: IntArray
    beyond: BoolArray
    interpolation: FloatArray | None
    corner: tuple[IntArray, IntArray] | None

    @classmethod
    def of(cls, problem: EndProblem, place: Place) -> _Folded:
        """Fold a place: many positions along x are interpolated from fewer that are graded towards the ends."""
        length, offset = problem.length, problem.corner_offset
        fewer = graded_interpolation(place.x, length, POSITIONS_PER_PANEL)
        positions, interpolation = (place.x, None) if fewer is None else fewer
        if np.isinf(length):
            x, where = positions, np.arange(positions.size)
        else:
            half, where = np.unique(np.round(problem.from_end(positions) / length, SAME_POSITION), return_inverse=True)
            x = length * half
        on_corner = np.flatnonzero(x < offset), np.flatnonzero(place.z < offset)
        has_corner = bool(on_corner[0].size and on_corner[1].size)
        z = np.append(place.z, offset) if has_corner else place.z
        corner = on_corner if has_corner else None
        return cls(x, place.y, z, where, positions > 0.5 * length, interpolation, corner)

    @property
    def distance(self) -> FloatArray:
        """Distance of the points from the loaded corner: array (x, z)."""
        distance = np.hypot(self.x[:, None], self.z[None, :])
        if self.corner is not None:
            # What is summed there is not used.
            distance[self.corner[0][:, None], self.corner[1]] = np.inf
        return distance

    def unfolded(self, fields: Mapping[int, FloatArray], odd_along_x: list[int]) -> FloatArray:
        """Field (load, component, x, y, z) at the place from the sums by parity (load, component, x, z, y)."""
        if self.corner is not None:
            rows, columns = self.corner
            for field in fields.values():
                field[:, :, rows[:, None], columns] = field[:, :, rows, -1:]
            fields = {parity: field[:, :, :, :-1] for parity, field in fields.items()}
        loads, count, _, *rest = next(iter(fields.values())).shape
        result = np.empty((loads, count, self._size, *rest))
        for number, (parity, field) in enumerate(fields.items()):
            signs = np.array([-parity if component in odd_along_x else parity for component in range(count)])
            if self.interpolation is None:
                self._copy(field, signs, result, bool(number))
            else:
                self._interpolate(field, signs, result, bool(number))
        return np.asarray(result.swapaxes(3, 4))

    def _copy(self, field: FloatArray, signs: IntArray, result: FloatArray, added: bool) -> None:
        """Copy or add a sum to a result at the same positions, beyond mid-length with the `signs` of its components."""
        beyond = np.where(signs == 0, 1, signs)[:, None, None]
        for row, (number, far) in enumerate(zip(self.where.tolist(), self.beyond.tolist(), strict=True)):
            own = field[:, :, number]
            if added:
                result[:, :, row] += beyond * own if far else own
            elif far:
                np.multiply(beyond, own, out=result[:, :, row])
            else:
                result[:, :, row] = own

    def _interpolate(self, field: FloatArray, signs: IntArray, result: FloatArray, added: bool) -> None:
        """Likewise to the place's own positions."""
        for component, sign in enumerate(signs.tolist()):
            spread = self._spread(sign)
            for load in range(field.shape[0]):
                own = np.ascontiguousarray(field[load, component]).reshape(field.shape[2], -1)
                place = result[load, component].reshape(self._size, -1)
                if added:
                    place += spread @ own
                else:
                    np.matmul(spread, own, out=place)

    @property
    def _size(self) -> int:
        """Number of the place's own positions along x."""
        return self.where.size if self.interpolation is None else self.interpolation.shape[0]

    def _spread(self, sign: int) -> FloatArray:
        """Matrix from the positions of the sum to the place's own, for a field that is `sign` times its image.

        0 stands for one end only, which has no image.
        """
        assert self.interpolation is not None
        spread = np.zeros((self.where.size, self.x.size))
        spread[np.arange(self.where.size), self.where] = np.where(self.beyond, sign or 1, 1)
        return np.asarray(self.interpolation @ spread)


@dataclass(frozen=True, eq=False)
class _Task:
    """A field that is wanted at several places."""

    problem: EndProblem
    harmonics: Harmonics
    places: list[_Folded]
    reference: float | None

    @property
    def y(self) -> FloatArray:
        """Positions along y of all places, one after another."""
        return np.concatenate([place.y for place in self.places])


def end_fields(
    problem: EndProblem, harmonics: Harmonics, places: Sequence[Place], *, reference: float | None = None
) -> list[dict[Load, FloatArray]]:
    """Field that the free ends add to the half-space with all mirrored loads, at several places.

    What the body answers to the load is solved for once for all places.

    Parameters
    ----------
    problem : EndProblem
        Body and load.
    harmonics : Harmonics
        Which field.
    places : sequence of Place
        Points inside the body.
    reference : float, optional
        For a field whose amplitudes have a pole at wavenumber 0 along y, as displacements between two ends have:
        where along y its rigid part is zero, metres.

    Returns
    -------
    list of dict of Load to array (component, x, y, z)
        At each place, under the load in each of the problem's directions.
    """
    fields: list[dict[Load, FloatArray]] = [{} for _ in places]
    with one_blas_thread():
        for alike in problem.alike():
            folded = [_Folded.of(alike, place) for place in places]
            cells = alike.columns[1]
            parts = {0: cells} if np.isinf(alike.length) else parity_parts(cells, alike.sign_x)
            sums = _sum_over_wavenumbers(_Task(alike, harmonics, folded, reference), parts)
            for found, place, own in zip(fields, folded, sums, strict=True):
                found |= dict(zip(alike.loads, place.unfolded(own, harmonics.odd_along_x), strict=True))
    return fields


def _sum_over_wavenumbers(task: _Task, parts: Mapping[int, FloatArray]) -> list[dict[int, FloatArray]]:
    """Field (load, component, x, z, y) at each place by parity: the integral over the wavenumber along y."""
    problem, harmonics, places = task.problem, task.harmonics, task.places
    counts = (len(problem.loads), harmonics.count)
    result = [
        {parity: np.zeros((*counts, place.x.size, place.z.size, place.y.size)) for parity in parts} for place in places
    ]
    distances, y = [place.distance for place in places], task.y
    nearest = min(float(distance.min()) for distance in distances)
    shortest = max(nearest, problem.corner_offset)
    ends = np.cumsum([place.y.size for place in places])
    for panel in problem.panels(y, shortest, task.reference):
        if panel.nodes[0] * nearest >= DECAY_LENGTHS:
            break
        for columns in problem.batches(panel, parts, y):
            # Only points within reach of a corner take part.
            near = [columns.nodes[0] * distance < DECAY_LENGTHS for distance in distances]
            seen = [(np.flatnonzero(own.any(axis=1)), np.flatnonzero(own.any(axis=0))) for own in near]
            if not any(rows.size for rows, _ in seen):
                break
            points = [(place.x[rows], place.z[depths]) for place, (rows, depths) in zip(places, seen, strict=True)]
            amplitudes = _amplitudes(problem, harmonics, points, columns, shortest)
            for parity in parts:
                for i, load in enumerate(problem.loads):
                    even, odd = columns.synthesis(load, parity)
                    for at, (rows, depths), stop, own in zip(result, seen, ends, amplitudes, strict=True):
                        if not rows.size:
                            continue
                        alike = own[i][..., columns.parities == parity]
                        here = slice(stop - at[parity].shape[-1], stop)
                        shape, block = (rows.size, depths.size, -1), _block(rows, depths)
                        for component in range(harmonics.count):
                            wave = even if component in harmonics.even_in_y else odd
                            flat = alike[component].reshape(rows.size * depths.size, -1)
                            at[parity][i, component][block] += (flat @ wave[:, here]).reshape(shape)
    return result


def _block(rows: IntArray, columns: IntArray) -> tuple[slice | IntArray, slice | IntArray]:
    """Index of rows and columns in ascending order, as slices if none between them is missing: these are faster."""
    if all(numbers[-1] - numbers[0] + 1 == numbers.size for numbers in (rows, columns)):
        return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    return rows[:, None], columns


def _amplitudes(
    problem: EndProblem,
    harmonics: Harmonics,
    points: list[tuple[FloatArray, FloatArray]],
    columns: LateralColumns,
    shortest: float,
) -> list[FloatArray]:
    """Answers to a batch of columns at the points (x, z): arrays (load, component, x, z, wavenumber, column)."""
    count = len(problem.loads)
    amplitudes = [
        np.zeros((count, harmonics.count, x.size, z.size, columns.nodes.size, columns.parities.size)) for x, z in points
    ]
    starts = np.cumsum([0, *(x.size for x, _ in points)])
    stops = np.cumsum([z.size for _, z in points])
    depths = np.concatenate([z for _, z in points])
    for view in views_of(problem, columns, np.concatenate([x for x, _ in points]), shortest):
        own = [np.flatnonzero((view.rows >= low) & (view.rows < high)) for low, high in pairwise(starts)]
        together = view.x.size * depths.size <= TOGETHER
        for number, lateral in enumerate(columns.nodes):
            system, loads = problem.auxiliary_loads(view, float(lateral), number, shortest)
            every = _answer(harmonics, system, loads, view, slice(None), depths) if together else None
            for found, (_, z), start, stop, at in zip(amplitudes, points, starts, stops, own, strict=False):
                if not at.size:
                    continue
                if every is None:
                    field = _answer(harmonics, system, loads, view, at, z)
                else:
                    field = every[:, at, stop - z.size : stop]
                by_load = field.reshape(*field.shape[:3], count, -1)
                rows, numbers = (view.rows[at] - start)[:, None, None], np.arange(z.size)[:, None]
                for i in range(count):
                    found[i][:, rows, numbers, number, view.columns] = by_load[:, :, :, i]
    return amplitudes


def _answer(
    harmonics: Harmonics, system: EquationSet, loads: AuxiliaryLoads, view: View, at: IntArray | slice, z: FloatArray
) -> FloatArray:
    """Field of both auxiliary bodies at some of a view's positions: array (component, x, z, column)."""
    field = harmonics.below_equivalent_load(system, loads.equivalent, view.cosine[:, at], view.sine[:, at], z)
    field += harmonics.beside_face_load(system, loads.depth, loads.face_load, view.x[at], z)
    return field
