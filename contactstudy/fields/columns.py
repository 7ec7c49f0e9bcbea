"""Displacements of the top of one part of a body on cells of any width along x."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from scipy import fft, linalg

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import Extent, Part
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.fields.part import check_freed, displaced_by_unit, reference_of
from contactstudy.kernels.columns import ColumnsRequest
from contactstudy.kernels.load import SINKS, Load, Response
from contactstudy.overlapping.end_kernel import EndRequest, end_kernel
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.threads import one_blas_thread

LEAST_EIGENVALUE = 1e-3
"""Least eigenvalue of a preconditioned matrix that is not positive, over their mean magnitude. Speed."""


class ColumnsOperator:
    """Displacements of the top of one part of a body, averaged over the width of each cell.

    Parameters
    ----------
    extent : tuple of float
        Where the mirrors stand, metres; infinite for none.
    grid : Grid
        Cells.
    kernels : mapping of Response to array (wavenumber, cell, cell)
        Displacement per force along y, for each pair that the operator takes, ends included.
    """

    def __init__(self, extent: Extent, grid: Grid, kernels: Mapping[Response, FloatArray]) -> None:
        self.extent, self.grid, self._kernels = extent, grid, kernels
        self._widths = grid.widths[:, None]

    @classmethod
    def of(
        cls, material: Material, part: Part, grid: Grid, responses: Sequence[Response], resolution: Resolution
    ) -> ColumnsOperator:
        """Operator of a part of a body made of `material`, for pairs of displacement and load."""
        edges, reference = grid.x_edges, reference_of(part.extent)
        check_freed(part, responses)
        columns = ColumnsRequest(edges, grid.dy, grid.cells_y, part.extent, reference)
        with one_blas_thread():
            kernels = {
                response: displaced_by_unit(material) * columns.kernel(response, material.poisson)
                for response in responses
            }
            if part.freed:
                request = EndRequest.of(part.freed, material, grid, tuple(responses), reference, resolution)
                ends = end_kernel(request)
                for response, kernel in kernels.items():
                    ends.add_to(kernel, response, edges)
        return cls(part.extent, grid, kernels)

    @property
    def reference(self) -> float:
        """Distance along y at which the displacement is zero, metres; infinite unless the body has two ends."""
        return reference_of(self.extent)

    def coarsened(self, material: Material) -> ColumnsOperator:
        """Return the operator on cells joined in twos: good enough for a first guess."""
        grid = self.grid.coarsened()
        fine = self.grid.widths
        joined = np.zeros((grid.cells_x, fine.size))
        joined[np.minimum(np.arange(fine.size) // 2, grid.cells_x - 1), np.arange(fine.size)] = fine
        joined /= grid.widths[:, None]
        lower = {response: joined @ kernel[: grid.cells_y + 1] @ joined.T for response, kernel in self._kernels.items()}
        return ColumnsOperator(self.extent, grid, lower)

    def __call__(self, loads: Mapping[Load, FloatArray], directions: Sequence[Load]) -> dict[Load, FloatArray]:
        """Displacements (m) of the cells in some `directions` under `loads` (Pa): arrays (x, y)."""
        spectra = {load: self._along_y(self._widths * cells) for load, cells in loads.items()}
        displacements = {}
        for direction in directions:
            parts = (self._product(Response(direction, load), spectrum) for load, spectrum in spectra.items())
            displacements[direction] = self._back(sum(parts, np.zeros(1, np.complex128)))
        return displacements

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that sinks the cells by `gap`."""
        return self._back(_times(self._inverse, self._along_y(gap))) / self._widths

    def _along_y(self, values: FloatArray) -> ComplexArray:
        """Transform along y: array (wavenumber, cell)."""
        return np.ascontiguousarray(fft.rfft(values, n=2 * self.grid.cells_y, axis=1).T)

    def _product(self, response: Response, spectrum: ComplexArray) -> ComplexArray:
        """Multiply along x, for each wavenumber along y."""
        product = _times(self._kernels[response], spectrum)
        return product if response.sign_y > 0 else 1j * product

    def _back(self, spectrum: ComplexArray) -> FloatArray:
        """Values on the cells from their transform along y (wavenumber, cell)."""
        cells_y = self.grid.cells_y
        return np.asarray(fft.irfft(spectrum.T, n=2 * cells_y, axis=1)[:, :cells_y])

    @cached_property
    def _inverse(self) -> FloatArray:
        """Inverse of the pressure's matrix, per wavenumber."""
        kernel = self._kernels[SINKS]
        inverse = np.empty_like(kernel)
        with one_blas_thread():
            for matrix, found in zip(kernel, inverse, strict=True):
                found[:] = _inverted(matrix)
        return inverse

    @property
    def nbytes(self) -> int:
        """Memory held, bytes, with the inverse that preconditioning adds."""
        sizes = [kernel.nbytes for kernel in self._kernels.values()]
        return sum(sizes) + max(sizes)


def _times(matrices: FloatArray, spectrum: ComplexArray) -> ComplexArray:
    """Real matrices (wavenumber, cell, cell) times a spectrum (wavenumber, cell), as real products on pairs."""
    pairs = spectrum.view(np.float64).reshape(*spectrum.shape, 2)
    return np.ascontiguousarray(np.matmul(matrices, pairs)).view(np.complex128)[..., 0]


def _inverted(matrix: FloatArray) -> FloatArray:
    """Inverse of a symmetric matrix; where the reference of the displacement makes it indefinite, of one beside it."""
    factor, failed = linalg.lapack.dpotrf(matrix)
    if not failed:
        upper, _ = linalg.lapack.dpotri(factor)  # zeros below
        inverse = upper + upper.T
        inverse.flat[:: inverse.shape[0] + 1] *= 0.5
        return np.asarray(inverse)
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
    values = np.maximum(np.abs(values), LEAST_EIGENVALUE * np.abs(values).max() / values.size)
    return np.asarray((vectors / values) @ vectors.T)
