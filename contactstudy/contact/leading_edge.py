"""Steady rolling on cells: where in each cell the slip is taken, and what the cell at the leading edge carries.

In steady rolling along +y the slip per distance is that of rigid surfaces and the change of the displacement along y.
On cells it is taken from the displacement of a cell and the two ahead of it, whose material arrives next:

    du/dy (y + b dy) = [(b - 3/2) u_0 + (2 - 2 b) u_1 + (b - 1/2) u_2] / dy,

of second order wherever it is taken, in the cell (b from -1/2 to 1/2) or beside it. The plain difference of neighbours
is b = 1/2: half a cell late. What remains is an error from the leading edge, where the traction begins as a root, which
is linear in the part c of the leading cell that lies in the contact (more than 1 if the edge lies in the next one). It
vanishes if the foremost point lies 0.34 cells behind the edge, b = c - 0.84. A leading cell with little in the contact
is no unknown of its own: it carries the same part of its bound as the cell behind, and b = 0.475. Both rules were found
from Carter's solution. At any place of the edge in its cell, and creepages from small to almost full sliding, the force
is then right to 1e-3 of full sliding at 14 cells per half-width, 5e-4 at 22.

Where all of a column slips, the traction is the bound and does not begin as a root. Then b = 0: the direction of slip,
which may turn within few cells, would otherwise be off in the first order of the cell's length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy.checks import BoolArray, FloatArray, IntArray

LEAST_PART = 0.72
"""Part of the leading cell in the contact below which it is tied to the cell behind. Accuracy."""

EDGE_OFFSET, TIED_PLACE, SLIDING_PLACE = -0.84, 0.475, 0.0
"""Place at which the slip is taken: ``EDGE_OFFSET + c``, or, where the leading cell is tied or no cell sticks, a fixed
one. Accuracy."""

FEWEST = 6
"""Cells along y from which on the place of the edge is told from the pressure. Accuracy."""

TOGETHER = 1.0
"""Distance of columns, over a cell's length along y, below which the places of both are mixed. Accuracy."""

BEHIND = 1.5
"""Cells between the third last centre and the inner border of the last cell."""

PARTS = (0.25, 1.4)
"""Range of the part c that occurs: less is not pressed, more is another pressed cell. Accuracy."""


@dataclass(frozen=True, eq=False)
class RollingCells:
    """Cells of a contact in steady rolling along +y.

    Attributes
    ----------
    unknown : array of int (2, unknown)
        Row and column of the cells with unknown tractions.
    place : array (unknown)
        Where in each the slip is taken, in cells ahead of its centre.
    tied, to : array of int (2, tied), array of int (tied)
        Row and column of the leading cells that are tied, and the number of the unknown cell behind.
    ratio : array (tied)
        Their traction over that of the cell behind.
    """

    unknown: IntArray
    place: FloatArray
    tied: IntArray
    to: IntArray
    ratio: FloatArray

    @classmethod
    def of(
        cls,
        pressure: FloatArray,
        bound: FloatArray,
        together: FloatArray | None = None,
        slides: BoolArray | None = None,
    ) -> RollingCells:
        """Cells of a contact under `pressure` (x, y), with the bound on the traction.

        `together` says how much each column counts in the place of each, as `taken_together` does. Default: each has
        its own. `slides` (x) says in which columns no cell sticks; default: in none.
        """
        carries: BoolArray = (pressure > 0) & (bound > 0)
        ahead = np.pad(carries, ((0, 0), (0, 1)))[:, 1:]
        leading = np.argwhere(carries & ~ahead)
        place = np.full(pressure.shape, EDGE_OFFSET + 1.0)
        tied, ratio = [], []
        for row, last in leading:
            below = np.flatnonzero(~carries[row, : last + 1])
            first = int(below[-1]) + 1 if below.size else 0
            if slides is not None and slides[row]:
                place[row, first : last + 1] = SLIDING_PLACE
                continue
            if last + 1 - first < FEWEST:
                continue
            part = _part_inside(pressure[row, first : last + 1])
            if part >= LEAST_PART:
                place[row, first : last + 1] = EDGE_OFFSET + part
            else:
                place[row, first : last + 1] = TIED_PLACE
                tied.append((row, last))
                ratio.append(bound[row, last] / bound[row, last - 1])
        if together is not None:
            counted = together @ carries
            place = together @ (carries * place) / np.where(counted > 0, counted, 1.0)
        own = carries.copy()
        tied_cells = np.array(tied, dtype=np.int64).reshape(-1, 2).T
        own[tuple(tied_cells)] = False
        # A tied cell has the number of the last unknown one before it.
        numbers = np.cumsum(own).reshape(own.shape) - 1
        unknown = np.argwhere(own).T
        return cls(unknown, place[tuple(unknown)], tied_cells, numbers[tuple(tied_cells)], np.array(ratio))

    def sliding(self, sticks: BoolArray, columns: int) -> BoolArray:
        """Columns (x) of the grid in which no cell sticks, from those of the unknown cells that do."""
        slides = np.zeros(columns, dtype=np.bool_)
        slides[self.unknown[0]] = True
        slides[self.unknown[0][sticks]] = False
        return slides

    def on_grid(self, traction: FloatArray, shape: tuple[int, int]) -> FloatArray:
        """Tractions on all cells (2, x, y) from the unknown ones (2, unknown)."""
        total = np.zeros((2, *shape))
        total[:, self.unknown[0], self.unknown[1]] = traction
        total[:, self.tied[0], self.tied[1]] = self.ratio * traction[:, self.to]
        return total

    def gathered(self, weights: FloatArray) -> FloatArray:
        """Weights (..., x, y) of a sum over all cells, as those of a sum over the unknown ones (..., unknown)."""
        own = weights[..., self.unknown[0], self.unknown[1]].copy()
        tied = self.ratio * weights[..., self.tied[0], self.tied[1]]
        for number, to in enumerate(self.to):
            own[..., to] += tied[..., number]
        return np.asarray(own)

    def change(self, displacement: FloatArray, dy: float) -> FloatArray:
        """Change along y of a displacement (x, y), at the places where the slip is taken: array (unknown).

        Beyond the last cell it goes on as it is there: good enough for a guess.
        """
        row, column = self.unknown
        b, last = self.place, displacement.shape[1] - 1
        here, next_, second = (displacement[row, np.minimum(column + step, last)] for step in (0, 1, 2))
        return np.asarray(((b - 1.5) * here + (2 - 2 * b) * next_ + (b - 0.5) * second) / dy)


def taken_together(x: FloatArray, widths: FloatArray, dy: float) -> FloatArray | None:
    """How much each column counts in the place at which another takes the slip: array (column, column).

    Columns nearer to each other than a cell is long share their places: taken at different places, the slips of narrow
    neighbours would differ by more than their tractions. None if there are none so near.
    """
    near = np.maximum(1 - np.abs(x[:, None] - x) / (TOGETHER * dy), 0.0)
    return near * widths if np.count_nonzero(near) > x.size else None


def _part_inside(pressure: FloatArray) -> float:
    """Cells between the inner border of the last cell and the contact's edge.

    The squared pressure is a parabola across the contact. That of the last two cells is off, as they meet the edge, so
    it is taken through the three before. The contact may reach into the next cell, which then has no pressure.
    """
    third, second, first = pressure[-5:-2] ** 2  # at 2, 1 and 0 cells behind the third last
    bend, slope = 0.5 * (third - 2 * second + first), 0.5 * (third - 4 * second + 3 * first)
    # first + slope s + bend s**2 = 0, s ahead of the third last centre
    root = slope**2 - 4 * bend * first
    if root < 0 or slope >= 0:
        return 1.0
    ahead = 2 * first / (np.sqrt(root) - slope)
    return float(np.clip(ahead - BEHIND, *PARTS))
