"""Preconditioners: the half-space's tangential compliance, inverted wavenumber by wavenumber.

On uniform cells the transform runs along both axes; on graded cells along y alone, with one matrix along x for each
wavenumber.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import fft

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.checks import ComplexArray, FloatArray, IntArray
from contactstudy.kernels.load import Load, Response
from contactstudy.kernels.strips import ColumnsRequest, surface_kernel


class TangentialInverse:
    """Inverse of the tangential compliance, or of its reversed derivative along y, on uniform cells."""

    def __init__(self, materials: list[Material], cells: IntArray, cell: tuple[float, float], *, rolling: bool) -> None:
        first = cells.min(axis=1)
        self._cells, self._root = tuple(cells - first[:, None]), _leading_root(cells, rolling=rolling)
        size = cells.max(axis=1) - first + 1
        self._shape = tuple(fft.next_fast_len(int(2 * count), real=True) for count in size)
        x, y = (step * np.arange(count // 2 + 1.0) for count, step in zip(self._shape, cell, strict=True))
        kernels = _compliances(materials, lambda response, poisson: surface_kernel(response, poisson, x, y, cell))
        xx, xy, yy = (_spectrum(kernel, pair, self._shape) for kernel, pair in zip(kernels, COMPONENTS, strict=True))
        if rolling:
            derivative = _derivative(self._shape[1], cell[1])
            xx, xy, yy = derivative * xx, derivative * xy, derivative * yy
        determinant = xx * yy - xy * xy
        # Single precision suffices for a preconditioner. Speed.
        entries = (yy / determinant, -xy / determinant, xx / determinant)
        self._inverse = tuple(entry.astype(np.complex64) for entry in entries)

    def __call__(self, slip: FloatArray) -> FloatArray:
        """Approximate tractions (2, cell) that relieve a slip (2, cell)."""
        slip = slip / self._root
        scale = float(np.abs(slip).max()) or 1.0
        spectra = []
        for component in slip:
            layer = np.zeros(self._shape, np.float32)
            layer[self._cells] = component / scale
            spectra.append(fft.rfft2(layer))
        xx, xy, yy = self._inverse
        solution = (xx * spectra[0] + xy * spectra[1], xy * spectra[0] + yy * spectra[1])
        tractions = np.stack([fft.irfft2(spectrum, self._shape)[self._cells] for spectrum in solution]).astype(
            np.float64
        )
        return scale * self._root * tractions


class ColumnsInverse:
    """Inverse of the tangential compliance, or of its reversed derivative along y, on cells of any width."""

    # After a transform along y, with components along y times i, the compliance is a real matrix per wavenumber.

    def __init__(self, materials: list[Material], cells: IntArray, grid: Grid, *, rolling: bool) -> None:
        (first, start), (last, stop) = cells.min(axis=1), cells.max(axis=1)
        self._cells, self._root = tuple(cells - np.array([[first], [start]])), _leading_root(cells, rolling=rolling)
        edges, count = grid.x_edges[first : last + 2], int(stop - start + 1)
        self._rows, self._padded = int(last - first + 1), 2 * count
        self._widths = np.diff(edges)
        columns = ColumnsRequest(edges=edges, dy=grid.dy, cells_y=count, extent=(-np.inf, np.inf))
        xx, xy, yy = _compliances(materials, columns.kernel)
        self._inverse = np.linalg.inv(np.block([[xx, -xy], [xy, yy]]))
        self._derivative = _derivative(self._padded, grid.dy) if rolling else np.ones(count + 1, dtype=np.complex128)

    def __call__(self, slip: FloatArray) -> FloatArray:
        """Approximate tractions (2, cell) that relieve a slip (2, cell)."""
        layers = np.zeros((2, self._rows, self._padded))
        layers[:, *self._cells] = slip / self._root
        spectra = fft.rfft(layers) / self._derivative
        spectra[1] *= -1j
        pairs = spectra.reshape(2 * self._rows, -1).T
        solution = np.matmul(self._inverse, np.stack([pairs.real, pairs.imag], axis=-1))
        spectra = (solution[..., 0] + 1j * solution[..., 1]).T.reshape(spectra.shape)
        spectra[1] *= 1j
        tractions = fft.irfft(spectra, self._padded)[:, *self._cells]
        return np.asarray(self._root * tractions / self._widths[self._cells[0]])


def tangential_inverse(
    materials: list[Material], cells: IntArray, grid: Grid, *, rolling: bool
) -> TangentialInverse | ColumnsInverse:
    """Return the inverse for uniform or graded cells."""
    if not grid.observes_means:
        return TangentialInverse(materials, cells, (grid.dx, grid.dy), rolling=rolling)
    return ColumnsInverse(materials, cells, grid, rolling=rolling)


def _derivative(cell_count: int, dy: float) -> ComplexArray:
    """Spectrum of the reversed derivative along y, by the differences of `RollingCells.derivative`."""
    # The derivative at b = 1/2, later than in the solver, damps short waves; an added constant, 1.5 times the
    # derivative of the first wavenumber, makes the derivative of a constant invertible. Speed.
    phase = 2 * np.pi * np.arange(cell_count // 2 + 1) / cell_count
    derivative = -(np.exp(1j * phase) - 1.0) / dy
    return np.asarray(derivative + 1.5 * phase[1] / dy)


def _leading_root(cells: IntArray, *, rolling: bool) -> FloatArray:
    """Square root with which tractions rise behind the leading edge of each row: array (cell)."""
    # The derivative along y of the compliance is a Hilbert transform; its inverse on an interval is the inverse on the
    # whole line, between this factor and its reciprocal.
    if not rolling:
        return np.ones(cells.shape[1])
    row, column = cells
    first, last = np.full(row.max() + 1, column.max()), np.zeros(row.max() + 1, dtype=np.int64)
    np.minimum.at(first, row, column)
    np.maximum.at(last, row, column)
    return np.asarray(np.sqrt((last[row] + 0.5 - column) / (last[row] - first[row] + 1.0)))


COMPONENTS = (
    Response(Load.ALONG_X, Load.ALONG_X),
    Response(Load.ALONG_X, Load.ALONG_Y),
    Response(Load.ALONG_Y, Load.ALONG_Y),
)


def _compliances(materials: list[Material], kernel: Callable[[Response, float], FloatArray]) -> list[FloatArray]:
    """Kernels of all components of the displacement, summed over the bodies."""
    return [
        np.sum([kernel(response, body.poisson) / (4 * np.pi * body.shear_modulus) for body in materials], axis=0)
        for response in COMPONENTS
    ]


def _spectrum(kernel: FloatArray, response: Response, shape: tuple[int, ...]) -> ComplexArray:
    """Spectrum over a whole period of a kernel, given at non-negative offsets."""
    for axis, sign in enumerate((response.sign_x, response.sign_y)):
        half = kernel.shape[axis]
        mirrored = np.flip(np.take(kernel, np.arange(1, shape[axis] - half + 1), axis=axis), axis=axis)
        kernel = np.concatenate([kernel, sign * mirrored], axis=axis)
    return np.asarray(fft.rfft2(kernel))
