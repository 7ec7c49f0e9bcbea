"""Roughly the tractions that make a slip: the half-space's tangential compliance, inverted wavenumber by wavenumber.

On uniform cells along both axes, on cells of different widths along y alone, with a matrix along x for each wavenumber.
"""

from __future__ import annotations

import numpy as np
from scipy import fft

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.checks import BoolArray, ComplexArray, FloatArray, IntArray
from contactstudy.kernels.columns import ColumnsRequest
from contactstudy.kernels.load import Load, Response
from contactstudy.kernels.surface import surface_kernel

LEAST_CHANGE = 1.5
"""Change along y that stands in for that of a constant, over that of the first wavenumber. Speed."""

TYPICAL_PLACE = 0.5
"""Where in a cell the slip of rolling is taken: later than it is, which damps short waves. Speed."""


class TangentialInverse:
    """Inverse of the tangential compliance of one half-space or two, on cells around a contact.

    Parameters
    ----------
    materials : sequence of Material
        Of the bodies.
    cells : array of int (2, cell)
        Row and column of the contact's cells.
    cell : tuple of float
        Cell size along x and y, metres.
    rolling : bool
        Whether it is the change of the displacement along y that is inverted, reversed, or the displacement.
    """

    def __init__(self, materials: list[Material], cells: IntArray, cell: tuple[float, float], *, rolling: bool) -> None:
        first = cells.min(axis=1)
        self._at, self._rise = tuple(cells - first[:, None]), _rise(cells, rolling=rolling)
        size = cells.max(axis=1) - first + 1
        self._shape = tuple(fft.next_fast_len(int(2 * each), real=True) for each in size)
        xx, xy, yy = (self._compliance(materials, direction, load, cell) for direction, load in COMPONENTS)
        if rolling:
            change = _change(self._shape[1], cell[1])
            xx, xy, yy = change * xx, change * xy, change * yy
        determinant = xx * yy - xy * xy
        # In single precision, which is enough for what is roughly right. Speed.
        parts = (yy / determinant, -xy / determinant, xx / determinant)
        self._inverse = tuple(part.astype(np.complex64) for part in parts)

    def _offsets(self, number: int, step: float) -> FloatArray:
        return np.asarray(step * np.arange(number // 2 + 1.0))

    def _compliance(
        self, materials: list[Material], direction: Load, load: Load, cell: tuple[float, float]
    ) -> ComplexArray:
        """Spectrum of the displacement in one direction under a load in another."""
        response = Response(direction, load)
        x, y = (self._offsets(number, step) for number, step in zip(self._shape, cell, strict=True))
        kernel = np.zeros((x.size, y.size))
        for material in materials:
            own = surface_kernel(response, material.poisson, x, y, cell, np.inf, np.inf)
            kernel += own / (4 * np.pi * material.shear_modulus)
        whole = _unfolded(_unfolded(kernel, self._shape[0], response.sign_x, 0), self._shape[1], response.sign_y, 1)
        return np.asarray(fft.rfft2(whole))

    def __call__(self, slip: FloatArray) -> FloatArray:
        """Tractions (2, cell) that roughly take a slip (2, cell) away."""
        slip = slip / self._rise
        scale = float(np.abs(slip).max()) or 1.0
        spectra = []
        for component in slip:
            layer = np.zeros(self._shape, np.float32)
            layer[self._at] = component / scale
            spectra.append(fft.rfft2(layer))
        xx, xy, yy = self._inverse
        along = (xx * spectra[0] + xy * spectra[1], xy * spectra[0] + yy * spectra[1])
        tractions = np.stack([fft.irfft2(each, self._shape)[self._at] for each in along]).astype(np.float64)
        return scale * self._rise * tractions


class ColumnsInverse:
    """Inverse of the tangential compliance of one half-space or two, on cells of any width around a contact.

    In the transform along y the compliance between tractions along one axis is even and real, that across odd and
    imaginary, so with the components along y times i it is a real matrix for each wavenumber.

    Parameters
    ----------
    materials : sequence of Material
        Of the bodies.
    cells : array of int (2, cell)
        Row and column of the contact's cells.
    grid : Grid
        Cells.
    rolling : bool
        Whether it is the change of the displacement along y that is inverted, reversed, or the displacement.
    """

    def __init__(self, materials: list[Material], cells: IntArray, grid: Grid, *, rolling: bool) -> None:
        (first, start), (last, stop) = cells.min(axis=1), cells.max(axis=1)
        self._at, self._rise = tuple(cells - np.array([[first], [start]])), _rise(cells, rolling=rolling)
        edges, count = grid.x_edges[first : last + 2], int(stop - start + 1)
        self._rows, self._padded = int(last - first + 1), 2 * count
        self._widths = np.diff(edges)
        columns = ColumnsRequest(edges, grid.dy, count, (-np.inf, np.inf))
        xx, xy, yy = (
            sum(
                columns.kernel(Response(*pair), material.poisson) / (4 * np.pi * material.shear_modulus)
                for material in materials
            )
            for pair in COMPONENTS
        )
        self._inverse = np.linalg.inv(np.block([[xx, -xy], [xy, yy]]))
        self._change = _change(self._padded, grid.dy) if rolling else np.ones(count + 1, dtype=np.complex128)

    def __call__(self, slip: FloatArray) -> FloatArray:
        """Tractions (2, cell) that roughly take a slip (2, cell) away."""
        layers = np.zeros((2, self._rows, self._padded))
        layers[:, *self._at] = slip / self._rise
        spectra = fft.rfft(layers) / self._change
        spectra[1] *= -1j
        pairs = spectra.reshape(2 * self._rows, -1).T
        found = np.matmul(self._inverse, np.stack([pairs.real, pairs.imag], axis=-1))
        spectra = (found[..., 0] + 1j * found[..., 1]).T.reshape(spectra.shape)
        spectra[1] *= 1j
        tractions = fft.irfft(spectra, self._padded)[:, *self._at]
        return np.asarray(self._rise * tractions / self._widths[self._at[0]])


def tangential_inverse(
    materials: list[Material], cells: IntArray, grid: Grid, *, rolling: bool
) -> TangentialInverse | ColumnsInverse:
    """Return the inverse that suits the grid."""
    if grid.uniform:
        return TangentialInverse(materials, cells, (grid.dx, grid.dy), rolling=rolling)
    return ColumnsInverse(materials, cells, grid, rolling=rolling)


def _change(cells: int, dy: float) -> ComplexArray:
    """Spectrum on so many cells of the change along y, reversed, as `RollingCells.change` takes it."""
    phase = 2 * np.pi * np.arange(cells // 2 + 1) / cells
    b, turn = TYPICAL_PLACE, np.exp(1j * phase)
    change = -((b - 1.5) + (2 - 2 * b) * turn + (b - 0.5) * turn**2) / dy
    return np.asarray(change + LEAST_CHANGE * phase[1] / dy)


def _rise(cells: IntArray, *, rolling: bool) -> FloatArray:
    """How tractions begin behind the leading edge of each row, as a root: array (cell).

    Along one line the change along y of the displacement is a Hilbert transform. Its inverse on an interval is that on
    the whole line between this factor and its reciprocal.
    """
    if not rolling:
        return np.ones(cells.shape[1])
    row, column = cells
    first, last = np.full(row.max() + 1, column.max()), np.zeros(row.max() + 1, dtype=np.int64)
    np.minimum.at(first, row, column)
    np.maximum.at(last, row, column)
    return np.asarray(np.sqrt((last[row] + 0.5 - column) / (last[row] - first[row] + 1.0)))


COMPONENTS = ((Load.ALONG_X, Load.ALONG_X), (Load.ALONG_X, Load.ALONG_Y), (Load.ALONG_Y, Load.ALONG_Y))


def _unfolded(kernel: FloatArray, number: int, sign: int, axis: int) -> FloatArray:
    """Values at all offsets of a period, from those that are not negative."""
    half = kernel.shape[axis]
    back = np.flip(np.take(kernel, np.arange(1, number - half + 1), axis=axis), axis=axis)
    return np.concatenate([kernel, sign * back], axis=axis)


def contact_cells(mask: BoolArray) -> IntArray:
    """Rows and columns (2, cell) of the cells of a mask (x, y)."""
    return np.argwhere(mask).T
