"""What the free ends add to the normal displacement of the top, on uniform cells: a symmetric operator, compressed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.end_kernel import EndKernel


@dataclass(frozen=True, eq=False)
class EndCorrection:
    """The ends' part of the displacement, acting on transforms along y of the zero-padded grid.

    Attributes
    ----------
    moments : list of array (position, cell)
        Per parity, from cells to graded positions. Two parities know the cells up to the middle only: those beyond
        are folded onto them.
    kernels : dict of Load to list of array (wavenumber, position, position)
        Per parity, displacement at the graded positions from a load there, without the factor i of a load along y.
    cell : float
        Cell size along x.
    """

    moments: list[FloatArray]
    kernels: Mapping[Load, list[FloatArray]]
    cell: float

    def apply(self, load: Load, transform: ComplexArray) -> ComplexArray:
        """Correction from the transform (cell, wavenumber) of a load."""
        phase = 1.0 if load.sign_y > 0 else 1j
        cells = transform.shape[0]
        # The operator is real: real products on pairs of real and imaginary part are four times faster.
        pairs = np.ascontiguousarray(transform).view(np.float64)
        sunk = [
            moments.T @ self._between(kernel, moments @ part)
            for moments, kernel, part in zip(self.moments, self.kernels[load], self._folded(pairs), strict=True)
        ]
        return np.asarray(self._unfolded(sunk, cells).view(np.complex128) * (phase / self.cell))

    @staticmethod
    def _between(kernel: FloatArray, sources: FloatArray) -> FloatArray:
        """Apply a kernel (wavenumber, position, position) to pairs (position, wavenumber and part)."""
        positions = sources.shape[0]
        sunk = np.matmul(kernel, sources.reshape(positions, -1, 2).transpose(1, 0, 2))
        return np.asarray(sunk.transpose(1, 0, 2).reshape(positions, -1))

    def _folded(self, values: FloatArray) -> list[FloatArray]:
        """Sum and difference of the cells on either side of the middle; with one end, the cells themselves."""
        if len(self.moments) == 1:
            return [values]
        cells = values.shape[0]
        half = (cells + 1) // 2
        near, far = values[:half], values[::-1][:half]
        even, odd = near + far, near - far
        if cells % 2:  # the middle cell has met itself
            even[-1] *= 0.5
        return [even, odd]

    @staticmethod
    def _unfolded(parts: list[FloatArray], cells: int) -> FloatArray:
        """Undo `_folded`, up to its factor."""
        if len(parts) == 1:
            return parts[0]
        even, odd = parts
        values = np.empty((cells, even.shape[1]))
        np.add(even, odd, out=values[: even.shape[0]])
        np.subtract(even[: cells // 2], odd[: cells // 2], out=values[::-1][: cells // 2])
        return values

    def coarsened(self) -> EndCorrection:
        """Return the correction on cells of twice the size: good enough for a first guess, and made in no time.

        The lower half of the wavenumbers is the coarse grid's, but for the small part that its cells alias.
        """
        moments = []
        for parity, fine in zip((1, -1) if len(self.moments) == 2 else (0,), self.moments, strict=True):
            if parity and fine.shape[1] % 2:  # the middle cell of the coarse grid lies on both sides
                fine = np.hstack([fine, parity * fine[:, -1:]])
            moments.append(fine[:, ::2] + fine[:, 1::2])
        lower = {
            load: [kernel[: (len(kernel) - 1) // 2 + 1] for kernel in kernels] for load, kernels in self.kernels.items()
        }
        return EndCorrection(moments, lower, 2 * self.cell)

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        return sum(array.nbytes for array in (*self.moments, *chain.from_iterable(self.kernels.values())))

    @classmethod
    def on(cls, grid: Grid, ends: EndKernel) -> EndCorrection:
        """Correction on uniform cells that begin at ``x = 0``."""
        near = (grid.cells_x + 1) // 2
        moments = [
            np.ascontiguousarray(ends.moments(parity, grid.x_edges)[:, : near if parity else None])
            for parity in ends.request.parities
        ]
        return cls(moments, ends.samples, grid.dx)
