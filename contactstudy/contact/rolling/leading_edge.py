"""Steady rolling on cells: the offset of the slip in each cell, and the traction of the cell at the leading edge.

In steady rolling along +y the slip per distance is the rigid slip plus the derivative of the displacement along y.
On cells the derivative follows from a cell and the two cells ahead, whose material arrives next:

    du/dy (y + b dy) = [(b - 3/2) u_0 + (2 - 2 b) u_1 + (b - 1/2) u_2] / dy,

of second order at any offset b, inside the cell (b from -1/2 to 1/2) or beside it. The plain difference of neighbours
is b = 1/2: half a cell late. The remaining error comes from the leading edge, where the traction begins as a root. It
is linear in the part c of the leading cell inside the contact (more than 1 if the edge lies in the next cell), and
vanishes if the foremost point lies 0.34 cells behind the edge, b = c - 0.84. A leading cell with a small part in the
contact is not an unknown: it carries the same part of its bound as the cell behind, and b = 0.475. Both rules were
fitted to Carter's solution. For any position of the edge in its cell, and creepages from small to almost full sliding,
the error of the force is 1e-3 of full sliding at 14 cells per half-width, 5e-4 at 22.

Where a column slips from end to end, the traction is the bound and does not begin as a root. Then b = 0: the direction
of slip may turn within few cells, and another offset would cause an error of first order in the cell's length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy.checks import BoolArray, FloatArray, IntArray

LEAST_PART = 0.72  # part of the leading cell in the contact below which it is tied to the cell behind. Accuracy.

EDGE_OFFSET, TIED_OFFSET, SLIDING_OFFSET = -0.84, 0.475, 0.0
"""Place of the slip: ``EDGE_OFFSET + c``, a constant where the leading cell is tied or the column slides. Accuracy."""

FEWEST_CELLS = 6
"""Least number of cells along y for which the position of the edge follows from the pressure. Accuracy."""

PARTS = (0.25, 1.4)  # range of the part c: less is not pressed, more is another pressed cell. Accuracy.


@dataclass(frozen=True, eq=False)
class RollingCells:
    """Cells of a contact in steady rolling along +y."""

    unknown: IntArray  # (2, unknown): row and column of the cells with unknown tractions
    offset: FloatArray  # (unknown): place of the slip in each, in cells ahead of its centre
    tied: IntArray
    """(2, tied): row and column of the tied leading cells, and the number of the unknown cell behind each."""
    to: IntArray
    ratio: FloatArray  # (tied): their traction over the traction of the cell behind

    @classmethod
    def of(
        cls,
        pressure: FloatArray,
        bound: FloatArray,
        shares: FloatArray | None = None,
        slides: BoolArray | None = None,
    ) -> RollingCells:
        """Cells of a contact under `pressure` (x, y), with the bound on the traction."""
        # `shares` as from `neighbour_shares`; default: separate offsets. `slides` (x) marks columns without sticking
        # cells.
        loaded: BoolArray = (pressure > 0) & (bound > 0)
        leading = np.argwhere(loaded & ~np.pad(loaded, ((0, 0), (0, 1)))[:, 1:])
        offset = np.full(pressure.shape, EDGE_OFFSET + 1.0)
        tied, ratio = [], []
        for row, last in leading:
            unloaded = np.flatnonzero(~loaded[row, : last + 1])
            first = int(unloaded[-1]) + 1 if unloaded.size else 0
            if slides is not None and slides[row]:
                offset[row, first : last + 1] = SLIDING_OFFSET
                continue
            if last + 1 - first < FEWEST_CELLS:
                continue
            part = _part_inside(pressure[row, first : last + 1])
            if part >= LEAST_PART:
                offset[row, first : last + 1] = EDGE_OFFSET + part  # eq. (44a)
            else:
                offset[row, first : last + 1] = TIED_OFFSET
                tied.append((row, last))
                ratio.append(bound[row, last] / bound[row, last - 1])
        if shares is not None:
            weight = shares @ loaded
            offset = shares @ (loaded * offset) / np.where(weight > 0, weight, 1.0)
        free = loaded.copy()
        tied_cells = np.array(tied, dtype=np.int64).reshape(-1, 2).T
        free[tuple(tied_cells)] = False
        # A tied cell has the number of the last unknown cell before it.
        numbers = np.cumsum(free).reshape(free.shape) - 1
        unknown = np.argwhere(free).T
        return cls(unknown, offset[tuple(unknown)], tied_cells, numbers[tuple(tied_cells)], np.array(ratio))

    def on_grid(self, traction: FloatArray, shape: tuple[int, int]) -> FloatArray:
        """Tractions on all cells (2, x, y) from the unknown ones (2, unknown)."""
        total = np.zeros((2, *shape))
        total[:, self.unknown[0], self.unknown[1]] = traction
        total[:, self.tied[0], self.tied[1]] = self.ratio * traction[:, self.to]
        return total

    def gather(self, weights: FloatArray) -> FloatArray:
        """Weights (..., unknown) of a sum over the unknown cells, equal to weights (..., x, y) over all cells."""
        gathered = weights[..., self.unknown[0], self.unknown[1]].copy()
        tied = self.ratio * weights[..., self.tied[0], self.tied[1]]
        for number, unknown in enumerate(self.to):
            gathered[..., unknown] += tied[..., number]
        return np.asarray(gathered)

    def derivative(self, displacement: FloatArray, dy: float) -> FloatArray:
        """Return the derivative (unknown) along y of a displacement (x, y), constant beyond the last cell."""
        row, column = self.unknown
        b, last = self.offset, displacement.shape[1] - 1
        u0, u1, u2 = (displacement[row, np.minimum(column + step, last)] for step in (0, 1, 2))
        return np.asarray(((b - 1.5) * u0 + (2 - 2 * b) * u1 + (b - 0.5) * u2) / dy)


def neighbour_shares(x: FloatArray, widths: FloatArray, dy: float) -> FloatArray | None:
    """Shares of columns in the offset of the slip of each (column, column); None if all columns are far apart."""
    # At different offsets the slips of neighbours nearer than a cell's length would differ by more than their
    # tractions.
    near = np.maximum(1 - np.abs(x[:, None] - x) / dy, 0.0)
    return near * widths if np.count_nonzero(near) > x.size else None


def _part_inside(pressure: FloatArray) -> float:
    """Cells between the inner border of the last cell and the contact's edge."""
    # A parabola through the squared pressure of the third to fifth last cell: the edge affects the last two. The
    # contact may reach into the next cell, which then has no pressure.
    third, second, first = pressure[-5:-2] ** 2  # at 2, 1 and 0 cells behind the third last
    bend, slope = 0.5 * (third - 2 * second + first), 0.5 * (third - 4 * second + 3 * first)
    # first + slope s + bend s**2 = 0, s ahead of the third last centre
    root = slope**2 - 4 * bend * first
    if root < 0 or slope >= 0:
        return 1.0
    distance = 2 * first / (np.sqrt(root) - slope)
    # 1.5 cells lie between the third last centre and the inner border of the last cell.
    return float(np.clip(distance - 1.5, *PARTS))
