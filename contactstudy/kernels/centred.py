"""A field of the half-space at the centres of the cells, where every component is even or odd in both directions.

So the kernel is evaluated at offsets that are not negative only, its spectrum is real, and it is kept: it depends on
the cells and the depth, not on the load. A load that is mirrored in end I is a sum of cosines along x; what it makes is
one of cosines or, for components odd along x, one of sines, and the mirrored half is never computed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import fft

from contactstudy.cache import kept
from contactstudy.checks import ComplexArray, FloatArray, IntArray
from contactstudy.kernels.convolution import even_spectrum, odd_spectrum
from contactstudy.kernels.influence import Influence

NEGLIGIBLE = 1e-13
"""Odd wavenumbers of a load, over the largest of all, below which it is symmetric about mid-length. Speed."""


@dataclass(frozen=True)
class CentredConvolution:
    """Convolution of a load with the kernels of an influence at one depth.

    Attributes
    ----------
    influence : Influence
        What a unit load does.
    dx, dy : float
        Cell size.
    length : float
        Distance between the ends that mirror the load; infinite if there are not two.
    mirrored : bool
        Whether the load is mirrored in end I.
    shape : tuple of int
        Largest offsets of the kernel, in cells: half the periods of the transforms.
    depth : float
        Depth of the points.
    """

    influence: Influence
    dx: float
    dy: float
    length: float
    mirrored: bool
    shape: tuple[int, int]
    depth: float

    def fill(self, layer: FloatArray, transformed: ComplexArray, rows: IntArray, columns: IntArray) -> None:
        """Fill a `layer` (component, row, column) of the field from the transform of the load.

        The transform of a load that is symmetric about mid-length comes without its odd wavenumbers, which are zero.
        """
        spectrum = _kernel_spectrum(self)
        odd_x = np.array(self.influence.sign_along_x) < 0
        beyond, seen = np.zeros(rows.size, bool), rows
        if self.symmetric(transformed):
            beyond, seen = rows >= transformed.shape[0], np.minimum(rows, self.shape[0] - 1 - rows)
        own, where = np.unique(seen, return_inverse=True)
        for odd, members in ((False, np.flatnonzero(~odd_x)), (True, np.flatnonzero(odd_x))):
            if members.size:
                along_y = self._back_along_x(spectrum[members], transformed, own, odd=odd)
                along_y[np.array(self.influence.sign_along_y)[members] < 0] *= 1j
                found = fft.irfft(along_y, 2 * self.shape[1], axis=2)[..., _span(columns)]
                layer[members] = found[:, _span(where)]
                if odd and beyond.any():
                    layer[np.ix_(members, beyond)] *= -1

    def symmetric(self, transformed: ComplexArray) -> bool:
        """Whether this is the transform of a load that is symmetric about mid-length."""
        return self.mirrored and transformed.shape[0] < self.shape[0]

    def _back_along_x(
        self, spectrum: FloatArray, transformed: ComplexArray, rows: IntArray, *, odd: bool
    ) -> ComplexArray:
        """Transform along y (component, row, wavenumber) of components even or odd along x."""
        half = self.shape[0]
        if not self.mirrored:
            product = np.empty((spectrum.shape[0], *transformed.shape), np.complex128)
            np.multiply(spectrum, transformed[: half + 1], out=product[:, : half + 1])
            np.multiply(spectrum[:, half - 1 : 0 : -1], transformed[half + 1 :], out=product[:, half + 1 :])
            if odd:
                product[:, : half + 1] *= 1j
                product[:, half + 1 :] *= -1j
            return np.asarray(fft.ifft(product, axis=1, overwrite_x=True)[:, rows])
        step = 2 if self.symmetric(transformed) else 1
        if odd:
            product = np.zeros((spectrum.shape[0], *transformed.shape), np.complex128)
            np.multiply(-spectrum[:, step:half:step], transformed[1:], out=product[:, :-1])
            return np.asarray(fft.idst(product, type=2, axis=1, overwrite_x=True)[:, rows])
        return np.asarray(fft.idct(spectrum[:, :half:step] * transformed, type=2, axis=1, overwrite_x=True)[:, rows])


def _span(numbers: IntArray) -> slice | IntArray:
    """Return an index of ascending numbers, as a slice if none between them is missing."""
    whole = bool((np.diff(numbers) == 1).all())
    return slice(numbers[0], numbers[-1] + 1) if whole and numbers[0] >= 0 else numbers


@kept("half-space kernels", lambda spectrum: spectrum.nbytes)
def _kernel_spectrum(request: CentredConvolution) -> FloatArray:
    """Spectrum of the kernels, without a factor i per odd direction: (component, x, y)."""
    x: FloatArray = request.dx * np.arange(request.shape[0] + 1.0)
    y: FloatArray = request.dy * np.arange(request.shape[1] + 1.0)
    influence = request.influence
    spectrum = influence.kernel(x, y, request.dx, request.dy, request.length, request.depth)
    for axis, signs in ((1, influence.sign_along_x), (2, influence.sign_along_y)):
        moved = spectrum.swapaxes(axis, 2)
        even = np.array(signs) > 0
        transformed = np.empty_like(moved)
        transformed[even], transformed[~even] = even_spectrum(moved[even]), odd_spectrum(moved[~even])
        spectrum = transformed.swapaxes(axis, 2)
    return np.ascontiguousarray(spectrum)


def _load_spectrum(load: FloatArray, shape: tuple[int, int], *, mirrored: bool) -> ComplexArray:
    """Spectrum of a load (cell, cell): array (wavenumber along x, wavenumber along y)."""
    along_y = fft.rfft(load, 2 * shape[1], axis=1)
    if not mirrored:
        return np.asarray(fft.fft(along_y, 2 * shape[0], axis=0))
    return np.asarray(fft.dct(along_y, type=2, n=shape[0], axis=0))


def centred_field(
    load: FloatArray,
    influence: Influence,
    cell: tuple[float, float],
    rows: IntArray,
    columns: IntArray,
    z: FloatArray,
    *,
    mirrored: bool,
    length: float,
) -> FloatArray:
    """Field at the centres of cells.

    Parameters
    ----------
    load : array (cell_x, cell_y)
        Load; if it is mirrored, the first cell begins at end I.
    influence : Influence
        What a unit load does.
    cell : tuple of float
        Cell size along x and y, metres.
    rows, columns : array of int
        Cells along x and y, counted from the load's first; they may lie outside it, but not beyond a mirror.
    z : array
        Depths, metres.
    mirrored : bool
        Whether the load is mirrored in end I.
    length : float
        Distance from end I to end II, in which it is mirrored too; infinite if there is no such end.

    Returns
    -------
    array (component, row, column, z)
    """
    cells_x, cells_y = load.shape
    reach_y = max(int(columns.max()), cells_y - 1 - int(columns.min()))
    if not mirrored:
        half = fft.next_fast_len(max(int(rows.max()) + 1, cells_x - int(rows.min())), real=True)
    elif np.isinf(length):
        half = fft.next_fast_len(max(int(rows.max()) + 1, cells_x) + cells_x, real=True)
    else:
        half = cells_x
    # At half a period an odd kernel has no place: it would be positive on one side and negative on the other.
    shape = (half, fft.next_fast_len(reach_y + 1, real=True))
    transformed = _load_spectrum(load, shape, mirrored=mirrored)
    if mirrored and np.isfinite(length) and half % 2 == 0:
        odd, most = np.abs(transformed[1::2]).max(), np.abs(transformed).max()
        if odd <= NEGLIGIBLE * most:
            # As the transform of the first half of the load, whose mirror is mid-length.
            transformed = 0.5 * transformed[::2]
    field = np.empty((influence.components, rows.size, z.size, columns.size))
    for number, depth in enumerate(z.tolist()):
        convolution = CentredConvolution(influence, *cell, length, mirrored, shape, depth)
        convolution.fill(field[:, :, number], transformed, rows, columns)
    return field.swapaxes(2, 3)
