"""A load on cells as a smooth function: its square is linear between the faces and the middle of each cell.

Near the border of a contact a pressure is proportional to the square root of the distance, and its square is linear.
The square on a face is interpolated linearly from the neighbours, and the force of the cell determines the value in the
middle: the function is continuous. Where a load falls to zero, the force of the last cell determines the border inside
this cell; a load that ends without falling, as at a sharp end, ends in a step.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from contactstudy.checks import BoolArray, FloatArray, IntArray

MAX_FACE_RATIO = 1.4
"""Largest value on a face over the smaller neighbour: above 1.5 a cell cannot keep its force. Accuracy."""

MIN_EQUAL_RATIO = 0.999
"""Least ratio of equal neighbouring loads; a load must not end between cells that differ by rounding. Accuracy."""

MIN_NEIGHBOUR_RATIO = 0.5
"""Least ratio of the shape's means in neighbouring cells with a continuous ratio between them. Accuracy."""

CONSTANT_ROUNDING = 1e-14  # rounding of a constant over the largest value. Rounding.
EMPTY_LEVEL = 1e-12  # uniform shape in cells without a shape, over the largest mean. Accuracy.

MIN_LOADED_FRACTION = 0.5
"""Loaded part of the last cell below which the last two cells share their force. Accuracy: the discrete contact puts
too little force into a last cell with a smaller loaded part, and too much into its neighbour."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SmoothLoad:
    """Loads along rows of cells as smooth functions."""

    edges: FloatArray  # (cell + 1): edges of the cells, metres
    sign: FloatArray  # (row, cell): sign of the load
    first: FloatArray
    """(row, cell): magnitude of the load on the first face, at the knot and on the last face; between them its
    square is linear."""
    middle: FloatArray
    last: FloatArray
    knot: FloatArray  # (row, cell): position of the knot in the cell, from 0 to 1
    coupled_to_next: BoolArray  # (row, cell): cells that exchange force with the next cell of their row

    @classmethod
    def of(cls, cell_loads: FloatArray, edges: FloatArray, *, extends_beyond: bool = False) -> SmoothLoad:
        """Smooth functions through `cell_loads` (row, cell); with `extends_beyond` half a cell beyond loaded cells."""
        loads, widths = np.abs(cell_loads), np.diff(edges)
        sign = np.sign(cell_loads)
        row_count = loads.shape[0]
        # The load is zero on faces where the sign changes.
        squares = loads**2
        face_squares = (squares[:, :-1] * widths[1:] + squares[:, 1:] * widths[:-1]) / (widths[1:] + widths[:-1])
        smaller_loads = np.minimum(loads[:, :-1], loads[:, 1:])
        equal_signs = sign[:, :-1] == sign[:, 1:]
        face_values = np.zeros((row_count, widths.size + 1))
        face_values[:, 1:-1] = np.where(
            equal_signs, np.minimum(np.sqrt(face_squares), MAX_FACE_RATIO * smaller_loads), 0.0
        )
        first, last = face_values[:, :-1].copy(), face_values[:, 1:].copy()
        middle, knot = np.zeros(loads.shape), np.full(loads.shape, 0.5)
        is_fixed, coupled_to_next = np.zeros(loads.shape, bool), np.zeros(loads.shape, bool)
        forward_rows = _DirectedRows(
            loads=loads, sign=sign, widths=widths, first=first, middle=middle, last=last, knot=knot, is_fixed=is_fixed
        )
        for cell_row, cell in forward_rows.shape_ends(extends_beyond=extends_beyond):
            coupled_to_next[cell_row, cell] = True
        backward_rows = forward_rows.reverse()
        np.subtract(1.0, knot, out=knot)
        for cell_row, cell in backward_rows.shape_ends(extends_beyond=extends_beyond):
            coupled_to_next[cell_row, widths.size - 2 - cell] = True
        np.subtract(1.0, knot, out=knot)
        is_free = ~is_fixed & (loads > 0)
        middle[is_free] = _solve_knot_value(loads[is_free], first[is_free], last[is_free])
        return cls(
            edges=edges, sign=sign, first=first, middle=middle, last=last, knot=knot, coupled_to_next=coupled_to_next
        )

    def shape_loads(self, cell_loads: FloatArray) -> ShapedLoad:
        """Return `cell_loads` (row, cell) of this shape: the shape times a ratio, linear between centres and faces."""
        # The ratio on a face is a mean of the ratios at both cells' centres, and does not exceed both: tractions keep
        # their bound. The cells keep the sum of their forces; coupled cells have one ratio.
        widths, count = np.diff(self.edges), cell_loads.shape[1]
        (force,) = self.moments_up_to(np.arange(count), self.edges[1:], 0)
        is_empty = force == 0
        level = EMPTY_LEVEL * float(np.abs(force / widths).max(initial=0.0)) or 1.0
        force, cell_force = np.where(is_empty, level * widths, force), cell_loads * widths
        first, middle, last = (np.where(is_empty, level, values) for values in (self.first, self.middle, self.last))
        shape = replace(self, sign=np.where(is_empty, 1.0, self.sign), first=first, middle=middle, last=last)
        is_coupled_back = np.pad(self.coupled_to_next[:, :-1], ((0, 0), (1, 0)))
        group_force = force
        if self.coupled_to_next.any():
            group_start = np.maximum.accumulate(np.where(is_coupled_back, 0, np.arange(count)), axis=1)
            cell_force, group_force = (_group_sums(values, group_start) for values in (cell_force, force))
        ratio = cell_force / group_force
        mean = np.where(self.coupled_to_next | is_coupled_back | is_empty, 0.0, force / widths)
        mean_before, mean_behind = mean[:, :-1], mean[:, 1:]
        # The ratio in a cell with a small mean is inaccurate.
        is_continuous = mean_before * mean_behind > MIN_NEIGHBOUR_RATIO * np.maximum(mean_before**2, mean_behind**2)
        first_force, last_force = shape._face_forces()
        weight = first_force[:, 1:] / np.where(is_continuous, first_force[:, 1:] + last_force[:, :-1], 1.0)
        face_ratio = ratio[:, :-1] + weight * np.diff(ratio, axis=1)
        first_ratio, last_ratio = ratio.copy(), ratio.copy()
        np.copyto(first_ratio[:, 1:], face_ratio, where=is_continuous)
        np.copyto(last_ratio[:, :-1], face_ratio, where=is_continuous)
        return ShapedLoad(shape, first_ratio, ratio, last_ratio)

    def _face_forces(self) -> tuple[FloatArray, FloatArray]:
        """Return forces of the shape times a ratio that rises from 0 at the centre to 1 on the first or last face."""
        cell, half_width = np.arange(self.edges.size - 1), 0.5 * np.diff(self.edges)
        half_force, half_moment = self.moments_up_to(cell, self.edges[:-1] + half_width, 1)
        force, moment = self.moments_up_to(cell, self.edges[1:], 1)
        last = (moment - half_moment) / half_width - (force - half_force)
        return np.abs(half_force - half_moment / half_width), np.abs(last)

    def moments_up_to(self, cell: IntArray, x: FloatArray, order: int) -> list[FloatArray]:
        """Moments from 0, the force, to `order` between the start of each `cell` and `x`, about the start: (row, x)."""
        width = np.diff(self.edges)[cell]
        fraction = np.clip((x - self.edges[cell]) / width, 0.0, 1.0)
        first, middle, last, knot, sign = (
            values[:, cell] for values in (self.first, self.middle, self.last, self.knot, self.sign)
        )
        moments = _moments_of_root(first, middle, np.minimum(fraction, knot), knot, order)
        behind = _moments_of_root(middle, last, np.maximum(fraction - knot, 0.0), 1 - knot, order)
        if order == 2:
            behind[2] += knot * (2 * behind[1] + knot * behind[0])
        if order:
            behind[1] += knot * behind[0]
        factor = sign * width
        for moment, moment_behind in zip(moments, behind, strict=True):
            moment += moment_behind
            moment *= factor
            factor = factor * width
        return moments


@dataclass(frozen=True, eq=False)
class ShapedLoad:
    """Loads along rows of cells: a shape times a ratio that is linear in each half of a cell."""

    shape: SmoothLoad
    first: FloatArray  # (row, cell): ratio on the first face, at the centre and on the last face
    middle: FloatArray
    last: FloatArray

    @property
    def edges(self) -> FloatArray:
        """Edges of the cells, metres."""
        return self.shape.edges

    @cached_property
    def _cell_moments(self) -> tuple[FloatArray, FloatArray]:
        """Force of each cell, and first moment about the cell's start: arrays (row, cell)."""
        cell = np.arange(self.edges.size - 1)
        force, moment = self._moments_up_to(cell, self.edges[1:], 1)[:2]
        return force, moment

    @cached_property
    def _has_constant_ratios(self) -> bool:
        """Whether the ratio is constant in each cell, to rounding."""
        return _are_constant(self.first, self.middle, self.last)

    @property
    def is_constant(self) -> bool:
        """Whether the load is constant in each cell, to rounding."""
        return self._has_constant_ratios and _are_constant(self.shape.first, self.shape.middle, self.shape.last)

    def _moments_up_to(self, cell: IntArray, x: FloatArray, order: int) -> list[FloatArray]:
        """Moments between each `cell`'s start and `x`: the load's up to `order`, then the shape's up to `order + 1`."""
        first, middle, last = self.first[:, cell], self.middle[:, cell], self.last[:, cell]
        whole = self.shape.moments_up_to(cell, x, order + 1)
        if self._has_constant_ratios:
            return [*(middle * moment for moment in whole[:-1]), *whole]
        half_width = 0.5 * np.diff(self.edges)[cell]
        half = self.shape.moments_up_to(cell, np.minimum(x, self.edges[cell] + half_width), order + 1)
        slope, intercept = (last - middle) / half_width, 2 * middle - last  # in the second half
        first_slope, change = (middle - first) / half_width, first - intercept
        moments = [
            intercept * whole[i] + slope * whole[i + 1] + change * half[i] + (first_slope - slope) * half[i + 1]
            for i in range(order + 1)
        ]
        return [*moments, *whole]

    @property
    def cell_means(self) -> FloatArray:
        """Mean in each cell: array (row, cell)."""
        return self._cell_moments[0] / np.diff(self.edges)

    @property
    def moments(self) -> FloatArray:
        """First moment about each cell's centre, Pa m2: array (row, cell)."""
        force, moment = self._cell_moments
        return moment - 0.5 * np.diff(self.edges) * force

    def integral(self, x: FloatArray) -> FloatArray:
        """Integral of the load up to the positions: array (row, x)."""
        cell = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, self.edges.size - 2)
        force_before = np.pad(np.cumsum(self._cell_moments[0], axis=1), ((0, 0), (1, 0)))
        return np.asarray(force_before[:, cell] + self._moments_up_to(cell, x, 0)[0])

    def equivalent_means(self, edges: FloatArray) -> FloatArray:
        """Return loads on cells between other edges, with the load's forces at the shape's centroids: (row, cell)."""
        # With the moments of the ratio a traction would exceed its bound.
        inner_edges = self.edges[(self.edges > edges[0]) & (self.edges < edges[-1])]
        points = np.union1d(edges, inner_edges)
        midpoints = 0.5 * (points[1:] + points[:-1])
        cell = np.clip(np.searchsorted(self.edges, midpoints, side="right") - 1, 0, self.edges.size - 2)
        cell_of_point = np.clip(np.searchsorted(edges, midpoints, side="right") - 1, 0, edges.size - 2)
        first_points = np.flatnonzero(np.append(True, np.diff(cell_of_point) > 0))
        # Differences of sums over all cells would lose digits.
        sums = np.stack(self._moments_up_to(np.append(cell[0], cell), points, 0))
        force, shape_force, moment = sums[..., 1:] - np.where(np.append(True, np.diff(cell) == 0), sums[..., :-1], 0.0)
        moment -= (0.5 * (edges[1:] + edges[:-1])[cell_of_point] - self.edges[cell]) * shape_force
        terms = np.stack([force, moment, np.sign(shape_force) * force, np.abs(shape_force)])
        force, moment, aligned_force, size = np.add.reduceat(terms, first_points, axis=-1)
        ratio = aligned_force / np.where(size > 0, size, 1.0)
        return np.asarray(force / np.diff(edges) + moment_loads(edges, ratio * moment))


def _group_sums(values: FloatArray, start: IntArray) -> FloatArray:
    """Sum over each cell's group of cells, whose first cell is `start`: array (row, cell)."""
    group = start + np.arange(values.shape[0])[:, None] * values.shape[1]
    return np.asarray(np.bincount(group.ravel(), values.ravel(), values.size)[group])


def moment_loads(edges: FloatArray, moments: FloatArray) -> FloatArray:
    """Return loads per area with the moments (row, cell) of the cells, without resultants and second moments."""
    # Each cell and its neighbours carry the moment of the cell; the first and the last cell have one neighbour.
    widths, loads = np.diff(edges), np.zeros(moments.shape)
    if widths.size == 1:
        return loads
    spacings = 0.5 * (widths[1:] + widths[:-1])
    spacing_ahead, spacing_back = np.append(spacings, np.inf), np.append(np.inf, spacings)
    weight = np.ones(widths.size)
    weight[1:-1] = spacing_back[1:-1] / (spacing_ahead[1:-1] + spacing_back[1:-1])
    load_behind = moments * weight / spacing_ahead  # eq. (32d)
    weight = np.ones(widths.size)
    weight[1:-1] = spacing_ahead[1:-1] / (spacing_ahead[1:-1] + spacing_back[1:-1])
    load_before = -moments * weight / spacing_back
    loads -= (load_before + load_behind) / widths
    loads[:, :-1] += load_before[:, 1:] / widths[:-1]
    loads[:, 1:] += load_behind[:, :-1] / widths[1:]
    return loads


@dataclass(frozen=True, kw_only=True, eq=False)
class _DirectedRows:
    """Rows of cells in one direction, with loads that end at the last loaded cells."""

    loads: FloatArray
    sign: FloatArray
    widths: FloatArray
    first: FloatArray
    middle: FloatArray
    last: FloatArray
    knot: FloatArray
    is_fixed: BoolArray

    def reverse(self) -> _DirectedRows:
        """Return the same arrays in the opposite direction."""
        reversed_arrays = {name: values[..., ::-1] for name, values in vars(self).items()}
        return _DirectedRows(**{**reversed_arrays, "first": reversed_arrays["last"], "last": reversed_arrays["first"]})

    def shape_ends(self, *, extends_beyond: bool) -> list[tuple[IntArray, IntArray]]:
        """Shape the last loaded cells; return rows and cells that exchange force with the next cell."""
        loads, sign = self.loads, self.sign
        is_loaded = loads > 0
        is_end = is_loaded.copy()
        is_end[:, :-1] &= ~is_loaded[:, 1:]
        row, cell = np.nonzero(is_end)
        end_load = loads[row, cell]
        self.last[row, cell] = end_load

        def previous_loads(steps: int) -> FloatArray:
            """Return loads of the cells some steps before; 0 where the sign differs."""
            index = np.maximum(cell - steps, 0)
            values = np.where(sign[row, index] == sign[row, cell], loads[row, index], 0.0)
            return np.where(cell >= steps, values, 0.0)

        load_1, load_2, load_3 = previous_loads(1), previous_loads(2), previous_loads(3)
        face, width = self._extrapolate_face(cell, load_1, load_2, 1), self.widths[cell]
        falling_ends = np.flatnonzero(
            (load_2 > MIN_EQUAL_RATIO * load_1) & (load_1 > end_load / MIN_EQUAL_RATIO) & (face > 0)
        )
        row, cell = row[falling_ends], cell[falling_ends]
        end_load, load_1, load_2, load_3, face, width = (
            values[falling_ends] for values in (end_load, load_1, load_2, load_3, face, width)
        )
        self.first[row, cell] = face
        self.last[row, cell - 1] = face
        # The square falls linearly from the face to zero; the force determines the distance over the width.
        length_ratio = 1.5 * end_load / face  # eq. (32b)
        is_inside = length_ratio <= 1
        index = row[is_inside], cell[is_inside]
        self.knot[index], self.is_fixed[index] = length_ratio[is_inside], True
        self.middle[index] = self.last[index] = 0.0
        # The load extends neither into the last cell of the row nor to a neighbour of another contact.
        last_cell = self.widths.size - 1
        is_beyond = extends_beyond & (length_ratio > 1) & (length_ratio < 1.5) & (cell < last_cell)
        is_beyond &= loads[row, np.minimum(cell + 2, last_cell)] == 0
        is_full = ~is_inside & ~is_beyond
        index = row[is_full], cell[is_full]
        self.last[index] = np.minimum(_opposite_face(end_load[is_full], face[is_full]), end_load[is_full])
        self._extend_beyond(row[is_beyond], cell[is_beyond], face[is_beyond], length_ratio[is_beyond])
        extended_cells = row[is_beyond], cell[is_beyond]
        # If the loaded part of the last cell is narrow, the last two cells share their force.
        face = self._extrapolate_face(cell, load_2, load_3, 2)
        previous_width = self.widths[np.maximum(cell - 1, 0)]
        length = 1.5 * (load_1 * previous_width + end_load * width) / np.where(face > 0, face, np.inf)
        narrow_ends = np.flatnonzero(
            (length_ratio < MIN_LOADED_FRACTION)
            & (load_3 > MIN_EQUAL_RATIO * load_2)
            & (face > 0)
            & (length > previous_width)
            & (length < previous_width + width)
        )
        row, cell = row[narrow_ends], cell[narrow_ends]
        face, previous_width, width, length = (values[narrow_ends] for values in (face, previous_width, width, length))
        self.last[row, cell - 2] = self.first[row, cell - 1] = face
        self.middle[row, cell - 1] = face * np.sqrt(1 - 0.5 * previous_width / length)
        self.last[row, cell - 1] = self.first[row, cell] = face * np.sqrt(1 - previous_width / length)
        self.knot[row, cell - 1], self.is_fixed[row, cell - 1] = 0.5, True
        self.knot[row, cell] = (length - previous_width) / width
        return [extended_cells, (row, cell - 1)]

    def _extend_beyond(self, row: IntArray, cell: IntArray, face: FloatArray, length_ratio: FloatArray) -> None:
        """Shape the last loaded cell and the next, in which the square falls to zero."""
        self.middle[row, cell] = face * np.sqrt(1 - 0.5 / length_ratio)
        self.last[row, cell] = self.first[row, cell + 1] = face * np.sqrt(1 - 1 / length_ratio)
        self.is_fixed[row, cell] = True
        width_ratio = self.widths[cell] / self.widths[cell + 1]
        self.knot[row, cell + 1] = (length_ratio - 1) * width_ratio
        self.sign[row, cell + 1] = self.sign[row, cell]

    def _extrapolate_face(self, cell: IntArray, near_load: FloatArray, far_load: FloatArray, steps: int) -> FloatArray:
        """Value on the last face of the cells `steps` before, extrapolated linearly in the square."""
        near_width = self.widths[np.maximum(cell - steps, 0)]
        far_width = self.widths[np.maximum(cell - steps - 1, 0)]
        squared = near_load**2 - (far_load**2 - near_load**2) * near_width / (near_width + far_width)  # eq. (32b)
        return np.sqrt(np.maximum(squared, 0.0))


def _are_constant(first: FloatArray, middle: FloatArray, last: FloatArray) -> bool:
    """Whether the values on the faces equal those in the middle of each cell, to rounding."""
    deviation = np.maximum(np.abs(first - middle), np.abs(last - middle))
    return bool((deviation <= CONSTANT_ROUNDING * np.abs(middle).max(initial=0.0)).all())


def _mean_of_root(a: FloatArray, b: FloatArray) -> FloatArray:
    """Mean of a function with a linear square, from the values at both ends."""
    total = a + b
    return np.asarray(2 / 3 * (a * a + a * b + b * b) / np.where(total > 0, total, 1.0))  # eq. (32a)


def _moments_of_root(
    a: FloatArray, b: FloatArray, length: FloatArray, section_length: FloatArray, order: int
) -> list[FloatArray]:
    """Moments up to `order` about the start of a section with a linear square, over its first `length`."""
    # The whole section has the length `section_length`, and the values `a` and `b` at its ends.
    end_square = a * a + (b * b - a * a) * (length / np.where(section_length > 0, section_length, 1.0))
    b = np.sqrt(np.maximum(end_square, 0.0))
    value_sum = np.where(a + b > 0, a + b, 1.0)
    moments = [length * _mean_of_root(a, b)]
    if order >= 1:
        cubes = ((3 * b + 6 * a) * b + 4 * a * a) * b + 2 * a * a * a
        moments.append(length**2 * (2 / 15 * cubes / (value_sum * value_sum)))
    if order == 2:
        powers = (((15 * b + 45 * a) * b + 48 * a * a) * b + 24 * a * a * a) * b + 8 * a * a * a * a
        moments.append(length**3 * (2 / 105 * powers / (value_sum * value_sum * value_sum)))
    return moments


def _solve_knot_value(mean: FloatArray, first: FloatArray, last: FloatArray) -> FloatArray:
    """Value in the middle of a cell with a given mean, by Newton's method: the mean is convex in the value."""
    value = 1.5 * mean
    for _ in range(8):
        excess = 0.5 * (_mean_of_root(first, value) + _mean_of_root(value, last)) - mean
        slope = sum((value**2 + 2 * value * face) / (value + face) ** 2 for face in (first, last)) / 3
        value = np.maximum(value - excess / slope, 1e-12 * mean)
    return np.asarray(value)


def _opposite_face(mean: FloatArray, face: FloatArray) -> FloatArray:
    """Value at one end of a function with a linear square, from the mean and the opposite end."""
    half_sum = 0.5 * (1.5 * mean - face)
    return np.asarray(half_sum + np.sqrt(np.maximum(half_sum**2 + face * (1.5 * mean - face), 0.0)))
