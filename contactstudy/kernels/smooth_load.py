"""A load on cells as a smooth function: its square is linear between the faces and the middle of each cell.

Near the border of a contact a pressure goes like the square root of the distance, and its square is linear. Faces get
the square that lies on the line between the neighbours, middles the value that keeps the force of the cell, so the
function is continuous and every cell carries what it did. Where a load falls to nothing the border lies inside the
last cell, where its force puts it; a load that ends without falling, as at a sharp end, ends in a step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contactstudy.checks import BoolArray, FloatArray, IntArray

STEEPEST_FACE = 1.4
"""Largest value on a face over the smaller of its neighbours': cells keep their force up to 1.5. Accuracy."""

ITERATIONS = 8
"""Newton's iterations of the middles. Accuracy."""

ALIKE = 0.999
"""Part of a neighbour's load from which on a cell counts as loaded alike. Accuracy: on few cells the two in the middle
are alike but for rounding, which must not decide how a load ends."""

TOGETHER = 16_384
"""Rows and positions that are evaluated at once. Speed: what they make stays in the processor's cache."""

NARROW = 0.5
"""Part of the last cell below which its force and that of the cell before are shared. Accuracy: contacts solved on
cells put too little into a last cell of which less is pressed, and too much into the one before."""


@dataclass(frozen=True, eq=False)
class SmoothLoad:
    """Loads along rows of cells as smooth functions.

    Attributes
    ----------
    edges : array (cell + 1)
        Edges of the cells, metres.
    sign : array (row, cell)
        Sign of the load.
    first, middle, last : array (row, cell)
        Magnitude of the load on the first face, at the knot and on the last face; between them its square is linear.
    knot : array (row, cell)
        Where in the cell the knot is, from 0 to 1.
    """

    edges: FloatArray
    sign: FloatArray
    first: FloatArray
    middle: FloatArray
    last: FloatArray
    knot: FloatArray

    @classmethod
    def of(cls, cells: FloatArray, edges: FloatArray, *, spilling: bool = False) -> SmoothLoad:
        """Smooth functions through the loads `cells` (row, cell).

        Where `spilling`, a load may reach half a cell beyond its last one: cells whose centre is not pressed have none.
        """
        loads, widths = np.abs(cells), np.diff(edges)
        sign = np.sign(cells)
        rows = loads.shape[0]
        # Faces: between loaded cells of one sign; where the sign changes the load passes zero.
        squared = loads**2
        between = (squared[:, :-1] * widths[1:] + squared[:, 1:] * widths[:-1]) / (widths[1:] + widths[:-1])
        least = np.minimum(loads[:, :-1], loads[:, 1:])
        same = sign[:, :-1] == sign[:, 1:]
        faces = np.zeros((rows, widths.size + 1))
        faces[:, 1:-1] = np.where(same, np.minimum(np.sqrt(between), STEEPEST_FACE * least), 0.0)
        first, last = faces[:, :-1].copy(), faces[:, 1:].copy()
        middle, knot = np.zeros(loads.shape), np.full(loads.shape, 0.5)
        fixed = np.zeros(loads.shape, bool)
        forwards = _Row(loads, sign, widths, first, middle, last, knot, fixed)
        forwards.end(spilling=spilling)
        backwards = _Row(
            loads[:, ::-1],
            sign[:, ::-1],
            widths[::-1],
            last[:, ::-1],
            middle[:, ::-1],
            first[:, ::-1],
            knot[:, ::-1],
            fixed[:, ::-1],
        )
        np.subtract(1.0, knot, out=knot)
        backwards.end(spilling=spilling)
        np.subtract(1.0, knot, out=knot)
        free = ~fixed & (loads > 0)
        middle[free] = _middle(loads[free], first[free], last[free])
        return cls(edges, sign, first, middle, last, knot)

    @property
    def cell_means(self) -> FloatArray:
        """Mean in each cell: array (row, cell)."""
        return self.sign * (
            self.knot * _mean(self.first, self.middle) + (1 - self.knot) * _mean(self.middle, self.last)
        )

    @property
    def moments(self) -> FloatArray:
        """First moment about each cell's centre, Pa m2: array (row, cell)."""
        knot = self.knot
        before = knot**2 * _first_moment(self.first, self.middle)
        behind = (1 - knot) ** 2 * _first_moment(self.middle, self.last)
        behind += (1 - knot) * knot * _mean(self.middle, self.last)
        return np.asarray((self.sign * (before + behind) - 0.5 * self.cell_means) * np.diff(self.edges) ** 2)

    def gathered(self) -> FloatArray:
        """Load per area on the same cells that far away makes the field of the smooth one: array (row, cell)."""
        return self.cell_means + sent(self.edges, self.moments).total

    def integral(self, at: FloatArray) -> FloatArray:
        """Integral of each row from its first edge to the positions `at`, metres: array (row, position)."""
        cell, before, behind, _ = self._pieces(at)
        widths = np.diff(self.edges)
        inside = widths[cell] * (before.force + behind.force)
        return np.asarray(_sum_before(self.cell_means * widths)[:, cell] + self.sign[:, cell] * inside)

    def means(self, edges: FloatArray) -> FloatArray:
        """Means between other edges, metres: array (row, cell)."""
        return np.asarray(np.diff(self.integral(edges), axis=1) / np.diff(edges))

    def gathered_on(self, edges: FloatArray) -> FloatArray:
        """Load per area between other edges that away from them makes the field of the smooth one."""
        found = np.empty((self.sign.shape[0], edges.size - 1))
        step = max(1, TOGETHER // max(edges.size, self.edges.size))
        for start in range(0, found.shape[0], step):
            rows = slice(start, start + step)
            arrays = (each[rows] for each in (self.sign, self.first, self.middle, self.last, self.knot))
            force, moment = (np.diff(each, axis=1) for each in SmoothLoad(self.edges, *arrays).integrals(edges))
            moment -= (0.5 * (edges[1:] + edges[:-1]) - self.edges[0]) * force
            found[rows] = force / np.diff(edges) + sent(edges, moment).total
        return found

    def integrals(self, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Integrals of the load, and of its moment about the first edge, up to the positions `at`: arrays (row, at)."""
        cell, before, behind, knot = self._pieces(at)
        widths, starts = np.diff(self.edges), self.edges[:-1] - self.edges[0]
        forces = self.cell_means * widths
        inside = before.force + behind.force
        turning = before.moment + behind.moment + knot * behind.force
        force = _sum_before(forces)[:, cell] + self.sign[:, cell] * widths[cell] * inside
        moment = _sum_before(self.moments + (starts + 0.5 * widths) * forces)[:, cell]
        moment += self.sign[:, cell] * widths[cell] * (starts[cell] * inside + widths[cell] * turning)
        return force, moment

    def _pieces(self, at: FloatArray) -> tuple[IntArray, _Piece, _Piece, FloatArray]:
        """Cells of positions, the pieces of the load there before the knot and behind it, and the knot."""
        last_cell = self.edges.size - 2
        cell = np.clip(np.searchsorted(self.edges, at, side="right") - 1, 0, last_cell)
        part = np.clip((at - self.edges[cell]) / np.diff(self.edges)[cell], 0.0, 1.0)
        first, middle, last, knot = (each[:, cell] for each in (self.first, self.middle, self.last, self.knot))
        before = _Piece.of(first, middle, np.minimum(part, knot), knot)
        return cell, before, _Piece.of(middle, last, np.maximum(part - knot, 0.0), 1 - knot), knot


class Sent(NamedTuple):
    """Loads per area that stand for the moments of cells: arrays (row, cell), by the cell that they stand for.

    Attributes
    ----------
    before, own, behind : array (row, cell)
        On the cell before, on the cell itself and on the one behind.
    """

    before: FloatArray
    own: FloatArray
    behind: FloatArray

    @property
    def total(self) -> FloatArray:
        """What every cell receives."""
        total = self.own.copy()
        total[:, :-1] += self.before[:, 1:]
        total[:, 1:] += self.behind[:, :-1]
        return total


def sent(edges: FloatArray, moments: FloatArray) -> Sent:
    """Put forces on each cell and its neighbours that have its moment, no resultant and no second moment."""
    widths = np.diff(edges)
    if widths.size == 1:
        return Sent(*(np.zeros(moments.shape) for _ in range(3)))
    apart = 0.5 * (widths[1:] + widths[:-1])
    # The first and the last cell have one neighbour.
    ahead, back = np.append(apart, np.inf), np.append(np.inf, apart)
    share = np.ones(widths.size)
    share[1:-1] = back[1:-1] / (ahead[1:-1] + back[1:-1])
    behind = moments * share / ahead
    share = np.ones(widths.size)
    share[1:-1] = ahead[1:-1] / (ahead[1:-1] + back[1:-1])
    before = -moments * share / back
    return Sent(before / np.append(1.0, widths[:-1]), -(before + behind) / widths, behind / np.append(widths[1:], 1.0))


@dataclass(frozen=True, eq=False)
class _Row:
    """Rows of cells seen in one direction, in which their loads end."""

    loads: FloatArray
    sign: FloatArray
    widths: FloatArray
    first: FloatArray
    middle: FloatArray
    last: FloatArray
    knot: FloatArray
    fixed: BoolArray

    def end(self, *, spilling: bool) -> None:
        """Shape the cells behind which there is no load."""
        loads, sign = self.loads, self.sign
        loaded = loads > 0
        ends = loaded.copy()
        ends[:, :-1] &= ~loaded[:, 1:]
        row, cell = np.nonzero(ends)
        own = loads[row, cell]
        self.last[row, cell] = own

        def before(steps: int) -> FloatArray:
            """Load of the cells some steps before, 0 where there is none of the same sign."""
            at = np.maximum(cell - steps, 0)
            found = np.where(sign[row, at] == sign[row, cell], loads[row, at], 0.0)
            return np.where(cell >= steps, found, 0.0)

        one, two, three = before(1), before(2), before(3)
        face, room = self._face(cell, one, two, 1), self.widths[cell]
        falling = np.flatnonzero((two > ALIKE * one) & (one > own / ALIKE) & (face > 0))
        row, cell = row[falling], cell[falling]
        own, one, two, three, face, room = (each[falling] for each in (own, one, two, three, face, room))
        self.first[row, cell] = face
        self.last[row, cell - 1] = face
        # The square falls linearly from the face: over 3/2 of the mean over the face's value, if that is in the cell.
        reach = 1.5 * own / face
        inside = reach <= 1
        at = row[inside], cell[inside]
        self.knot[at], self.middle[at], self.last[at], self.fixed[at] = reach[inside], 0.0, 0.0, True
        # Not into a cell at the end of the row, nor beside another contact.
        last = self.widths.size - 1
        beyond = spilling & (reach > 1) & (reach < 1.5) & (cell < last)
        beyond &= loads[row, np.minimum(cell + 2, last)] == 0
        full = ~inside & ~beyond
        at = row[full], cell[full]
        self.last[at] = np.minimum(_other_face(own[full], face[full]), own[full])
        self._spill(row[beyond], cell[beyond], face[beyond], reach[beyond])
        # Too little in the last cell: the last two share their force.
        face = self._face(cell, two, three, 2)
        width = self.widths[np.maximum(cell - 1, 0)]
        length = 1.5 * (one * width + own * room) / np.where(face > 0, face, np.inf)
        shared = np.flatnonzero(
            (reach < NARROW) & (three > ALIKE * two) & (face > 0) & (length > width) & (length < width + room)
        )
        row, cell = row[shared], cell[shared]
        face, width, room, length = (each[shared] for each in (face, width, room, length))
        self.last[row, cell - 2] = self.first[row, cell - 1] = face
        self.middle[row, cell - 1] = face * np.sqrt(1 - 0.5 * width / length)
        self.last[row, cell - 1] = self.first[row, cell] = face * np.sqrt(1 - width / length)
        self.knot[row, cell - 1], self.fixed[row, cell - 1] = 0.5, True
        self.knot[row, cell] = (length - width) / room

    def _spill(self, row: IntArray, cell: IntArray, face: FloatArray, reach: FloatArray) -> None:
        """Let the square fall to nothing in the cell behind the last one."""
        self.middle[row, cell] = face * np.sqrt(1 - 0.5 / reach)
        self.last[row, cell] = self.first[row, cell + 1] = face * np.sqrt(1 - 1 / reach)
        self.fixed[row, cell] = True
        width = self.widths[cell] / self.widths[cell + 1]
        self.knot[row, cell + 1] = (reach - 1) * width
        self.sign[row, cell + 1] = self.sign[row, cell]

    def _face(self, cell: IntArray, near: FloatArray, far: FloatArray, steps: int) -> FloatArray:
        """Value on the last face of the cells `steps` before, on the line through their square and the one before."""
        own = self.widths[np.maximum(cell - steps, 0)]
        other = self.widths[np.maximum(cell - steps - 1, 0)]
        squared = near**2 - (far**2 - near**2) * own / (own + other)
        return np.sqrt(np.maximum(squared, 0.0))


def _mean(a: FloatArray, b: FloatArray) -> FloatArray:
    """Mean of a function whose square is linear, from its values at both ends."""
    total = a + b
    return np.asarray(2 / 3 * (a * a + a * b + b * b) / np.where(total > 0, total, 1.0))


def _first_moment(a: FloatArray, b: FloatArray) -> FloatArray:
    """First moment of such a function about its first end, over the length squared."""
    total = a + b
    total = np.where(total > 0, total, 1.0)
    cubes = ((3 * b + 6 * a) * b + 4 * a * a) * b + 2 * a * a * a
    return np.asarray(2 / 15 * cubes / (total * total))


class _Piece(NamedTuple):
    """Part of a function whose square is linear: its values at both ends, and how long it is over the cell."""

    first: FloatArray
    last: FloatArray
    along: FloatArray

    @classmethod
    def of(cls, a: FloatArray, b: FloatArray, along: FloatArray, length: FloatArray) -> _Piece:
        """Return the first `along` of the `length` from `a` to `b`."""
        squared = a * a + (b * b - a * a) * (along / np.where(length > 0, length, 1.0))
        return cls(a, np.sqrt(np.maximum(squared, 0.0)), along)

    @property
    def force(self) -> FloatArray:
        """Integral over the piece."""
        return self.along * _mean(self.first, self.last)

    @property
    def moment(self) -> FloatArray:
        """First moment about where it begins."""
        return self.along**2 * _first_moment(self.first, self.last)


def _sum_before(values: FloatArray) -> FloatArray:
    """Sum what is before each cell of a row, and all of it."""
    return np.asarray(np.pad(np.cumsum(values, axis=1), ((0, 0), (1, 0))))


def _middle(mean: FloatArray, first: FloatArray, last: FloatArray) -> FloatArray:
    """Value in the middle of a cell that gives it its mean, by Newton's method from above: the mean is convex in it."""
    value = 1.5 * mean
    for _ in range(ITERATIONS):
        excess = 0.5 * (_mean(first, value) + _mean(value, last)) - mean
        slope = sum((value**2 + 2 * value * face) / (value + face) ** 2 for face in (first, last)) / 3
        value = np.maximum(value - excess / slope, 1e-12 * mean)
    return np.asarray(value)


def _other_face(mean: FloatArray, face: FloatArray) -> FloatArray:
    """Value at the other end of a function whose square is linear, from its mean and one end."""
    half = 0.5 * (1.5 * mean - face)
    return np.asarray(half + np.sqrt(np.maximum(half**2 + face * (1.5 * mean - face), 0.0)))
