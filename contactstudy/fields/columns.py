"""Displacement of the top of one part of a body on cells of any width along x."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from scipy import fft, linalg

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import Extent, Part
from contactstudy.checks import FloatArray
from contactstudy.fields.part import factor_of, reference_of
from contactstudy.kernels.columns import columns_kernel
from contactstudy.kernels.load import Load
from contactstudy.overlapping.end_kernel import EndRequest, end_kernel
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.threads import one_blas_thread

LEAST_EIGENVALUE = 1e-3
"""Least eigenvalue of a preconditioned matrix that is not positive, over their mean magnitude. Speed."""


class ColumnsOperator:
    """Normal displacement of the top of one part of a body, averaged over the width of each cell.

    Parameters
    ----------
    extent : tuple of float
        Where the mirrors stand, metres; infinite for none.
    grid : Grid
        Cells.
    kernels : mapping of Load to array (wavenumber, cell, cell)
        Displacement per force along y, for each load that the operator takes, ends included.
    """

    def __init__(self, extent: Extent, grid: Grid, kernels: Mapping[Load, FloatArray]) -> None:
        self.extent, self.grid, self._kernels = extent, grid, kernels
        self._widths = grid.widths[:, None]

    @classmethod
    def of(
        cls, material: Material, part: Part, grid: Grid, loads: Sequence[Load], resolution: Resolution
    ) -> ColumnsOperator:
        """Operator of a part of a body made of `material`, for `loads` of the given directions."""
        edges, reference = grid.x_edges, reference_of(part.extent)
        with one_blas_thread():
            kernels = {
                load: factor_of(load, material)
                * columns_kernel(load, edges, grid.dy, grid.cells_y, part.extent, reference)
                for load in loads
            }
            if part.freed:
                request = EndRequest.of(part.freed, material, grid, tuple(loads), reference, resolution)
                ends = end_kernel(request)
                for load, kernel in kernels.items():
                    kernel += ends.between(load, edges)
        return cls(part.extent, grid, kernels)

    @property
    def reference(self) -> float:
        """Distance along y at which the displacement is zero, metres; infinite unless the body has two ends."""
        return reference_of(self.extent)

    def coarsened(self, material: Material) -> ColumnsOperator:
        """Return the operator on cells joined in twos, under pressure alone: good enough for a first guess."""
        grid = self.grid.coarsened()
        fine = self.grid.widths
        joined = np.zeros((grid.cells_x, fine.size))
        joined[np.minimum(np.arange(fine.size) // 2, grid.cells_x - 1), np.arange(fine.size)] = fine
        joined /= grid.widths[:, None]
        lower = self._kernels[Load.NORMAL][: grid.cells_y + 1]
        return ColumnsOperator(self.extent, grid, {Load.NORMAL: joined @ lower @ joined.T})

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement (m) of the cells under `loads` (Pa): array (x, y)."""
        return np.asarray(
            sum(self._product(self._kernels[load], self._widths * cells, load) for load, cells in loads.items())
        )

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that sinks the cells by `gap`."""
        return self._product(self._inverse, gap, Load.NORMAL) / self._widths

    def _product(self, matrices: FloatArray, values: FloatArray, load: Load) -> FloatArray:
        """Convolve along y and multiply along x."""
        cells_y = self.grid.cells_y
        spectrum = np.ascontiguousarray(fft.rfft(values, n=2 * cells_y, axis=1).T)
        # Real products on pairs of real and imaginary part.
        pairs = spectrum.view(np.float64).reshape(*spectrum.shape, 2)
        product = np.ascontiguousarray(np.matmul(matrices, pairs)).view(np.complex128)[..., 0]
        if load.sign_y < 0:
            product = 1j * product
        return np.asarray(fft.irfft(product.T, n=2 * cells_y, axis=1)[:, :cells_y])

    @cached_property
    def _inverse(self) -> FloatArray:
        """Inverse of the pressure's matrix, per wavenumber."""
        kernel = self._kernels[Load.NORMAL]
        inverse = np.empty_like(kernel)
        with one_blas_thread():
            for matrix, found in zip(kernel, inverse, strict=True):
                found[:] = _inverted(matrix)
        return inverse

    @property
    def nbytes(self) -> int:
        """Memory held, bytes, with the inverse that preconditioning adds."""
        return sum(kernel.nbytes for kernel in self._kernels.values()) + self._kernels[Load.NORMAL].nbytes


def _inverted(matrix: FloatArray) -> FloatArray:
    """Inverse of a symmetric matrix; where the reference of the displacement makes it indefinite, of one beside it."""
    factor, failed = linalg.lapack.dpotrf(matrix)
    if not failed:
        upper, _ = linalg.lapack.dpotri(factor)
        return np.asarray(np.triu(upper) + np.triu(upper, 1).T)
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
    values = np.maximum(np.abs(values), LEAST_EIGENVALUE * np.abs(values).max() / values.size)
    return np.asarray((vectors / values) @ vectors.T)
