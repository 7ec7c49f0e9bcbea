"""What the free ends add to the displacements of the top, on uniform cells: a symmetric operator, compressed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.kernels.load import Load, Response
from contactstudy.overlapping.end_kernel import EndKernel, seen_alike


@dataclass(frozen=True, eq=False)
class EndCorrection:
    """The ends' part of the displacements, acting on transforms along y of the zero-padded grid.

    Attributes
    ----------
    parities : tuple of int
        Parities that the ends do not mix; 0 alone for one end.
    moments : dict of Load to list of array (position, cell)
        By direction and per parity, from cells to graded positions. Two parities know the cells up to the middle
        only: those beyond are folded onto them.
    kernels : dict of Response to list of array (wavenumber, position, position)
        Per parity, displacement at the graded positions from a load there, without the factor i of kernels odd along y.
    cell : float
        Cell size along x.
    """

    parities: tuple[int, ...]
    moments: Mapping[Load, list[FloatArray]]
    kernels: Mapping[Response, list[FloatArray]]
    cell: float

    def gathered(self, load: Load, transform: ComplexArray) -> list[FloatArray]:
        """Per parity, a load's transform (cell, wavenumber) on the graded positions, to be seen by `displaced`.

        Arrays (real or imaginary part, wavenumber, position): a product of a kernel with one column at a time is three
        times faster than with both.
        """
        # The operator is real: real products on pairs of real and imaginary part are four times faster.
        pairs = np.ascontiguousarray(transform).view(np.float64)
        folded = zip(self.moments[load], self._folded(pairs, load.sign_x), strict=True)
        return [
            np.ascontiguousarray((moments @ part).reshape(len(moments), -1, 2).transpose(2, 1, 0))
            for moments, part in folded
        ]

    def displaced(self, direction: Load, loads: Mapping[Load, list[FloatArray]], cells: int) -> ComplexArray:
        """Displacement in one direction, transformed along y (cell, wavenumber), from all `gathered` loads."""
        sunk: list[FloatArray] = []
        for number, moments in enumerate(self.moments[direction]):
            total = np.zeros_like(next(iter(loads.values()))[number])
            for load, gathered in loads.items():
                response = Response(direction, load)
                kernel, (real, imaginary) = self.kernels[response][number], gathered[number]
                if response.sign_y > 0:
                    total[0] += _product(kernel, real)
                    total[1] += _product(kernel, imaginary)
                else:  # times i
                    total[0] -= _product(kernel, imaginary)
                    total[1] += _product(kernel, real)
            sunk.append(moments.T @ np.ascontiguousarray(total.transpose(2, 1, 0)).reshape(len(moments), -1))
        return np.asarray(self._unfolded(sunk, cells, direction.sign_x).view(np.complex128) / self.cell)

    def _folded(self, values: FloatArray, sign_x: int) -> list[FloatArray]:
        """Sum and difference of the cells on either side of the middle, by parity; with one end, the cells."""
        if len(self.parities) == 1:
            return [values]
        cells = values.shape[0]
        half = (cells + 1) // 2
        near, far = values[:half], values[::-1][:half]
        even, odd = near + far, near - far
        if cells % 2:  # the middle cell has met itself
            even[-1] *= 0.5
        return [even, odd] if sign_x > 0 else [odd, even]

    def _unfolded(self, parts: list[FloatArray], cells: int, sign_x: int) -> FloatArray:
        """Undo `_folded`, up to its factor."""
        if len(parts) == 1:
            return parts[0]
        even, odd = parts if sign_x > 0 else parts[::-1]
        values = np.empty((cells, even.shape[1]))
        np.add(even, odd, out=values[: even.shape[0]])
        np.subtract(even[: cells // 2], odd[: cells // 2], out=values[::-1][: cells // 2])
        return values

    def coarsened(self) -> EndCorrection:
        """Return the correction on cells of twice the size: good enough for a first guess, and made in no time.

        The lower half of the wavenumbers is the coarse grid's, but for the small part that its cells alias.
        """
        coarse: dict[Load, list[FloatArray]] = {}
        for direction, moments in self.moments.items():
            joined = []
            for parity, fine in zip(self.parities, moments, strict=True):
                if parity and fine.shape[1] % 2:  # the middle cell of the coarse grid lies on both sides
                    fine = np.hstack([fine, parity * direction.sign_x * fine[:, -1:]])
                joined.append(fine[:, ::2] + fine[:, 1::2])
            coarse[direction] = joined
        lower = {
            response: [kernel[: (len(kernel) - 1) // 2 + 1] for kernel in kernels]
            for response, kernels in self.kernels.items()
        }
        return EndCorrection(self.parities, coarse, lower, 2 * self.cell)

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        arrays = chain(chain.from_iterable(self.moments.values()), chain.from_iterable(self.kernels.values()))
        return sum(array.nbytes for array in arrays)

    @classmethod
    def on(cls, grid: Grid, ends: EndKernel) -> EndCorrection:
        """Correction on uniform cells that begin at ``x = 0``."""
        near = (grid.cells_x + 1) // 2
        parities, sides = ends.request.parities, ends.moments(grid.x_edges)
        moments = {
            direction: [
                np.ascontiguousarray(seen_alike(sides, parity * direction.sign_x)[:, : near if parity else None])
                for parity in parities
            ]
            for direction in dict.fromkeys(chain.from_iterable(ends.samples))
        }
        return cls(parities, moments, ends.samples, grid.dx)


def _product(kernel: FloatArray, values: FloatArray) -> FloatArray:
    """Product of a matrix for each wavenumber (wavenumber, position, position) with its column."""
    return np.asarray(np.matmul(kernel, values[..., None])[..., 0])
