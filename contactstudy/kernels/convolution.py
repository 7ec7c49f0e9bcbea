"""Discrete convolution on the grid of cells by fast Fourier transform (DC-FFT), planned once and reused.

The kernel is zero-padded along y, so the loads outside the window are zero and not periodic (S. Liu, Q. Wang, G. Liu,
Wear 243 (2000) 101). Along x it is zero-padded as well, or, for a body with ends, mirrored: the convolution of a
load extended evenly about its ends is diagonal in the cosine transform, extended oddly in the sine transform.
"""

from __future__ import annotations

import threading

import numpy as np
from scipy import fft

from contactstudy.cache import cached
from contactstudy.checks import ComplexArray, FloatArray, IntArray
from contactstudy.kernels.images import Influence


def even_spectrum(kernel: FloatArray) -> FloatArray:
    """Spectrum along y of a kernel that is even in y, given at offsets 0 .. N (last axis)."""
    return np.asarray(fft.dct(kernel, type=1, axis=-1))


def odd_spectrum(kernel: FloatArray) -> FloatArray:
    """Spectrum along y, without its factor i, of a kernel that is odd in y, given at offsets 0 .. N (last axis)."""
    spectrum = np.zeros_like(kernel)
    if kernel.shape[-1] > 2:  # an odd kernel on a single cell vanishes
        spectrum[..., 1:-1] = -fft.dst(kernel[..., 1:-1], type=1, axis=-1)
    return spectrum


def spectrum_matrices(cell_count: int) -> tuple[FloatArray, FloatArray]:
    """Matrices (offset, wavenumber) of `even_spectrum` and of `odd_spectrum`, at offsets 0 .. `cell_count`."""
    indices = np.arange(cell_count + 1)
    phase = np.pi * np.outer(indices, indices) / cell_count
    factors = np.full(cell_count + 1, 2.0)
    factors[[0, -1]] = 1.0
    return factors[:, None] * np.cos(phase), np.where(factors == 1.0, 0.0, -2.0)[:, None] * np.sin(phase)


class _Buffers:
    """Aligned memory and the transforms planned on it, for one thread."""

    def __init__(self, cells_x: int, cells_y: int, padded_x: int, mirror: int) -> None:
        import pyfftw  # imports dask's arrays, which readers of results do not need

        self.real = pyfftw.zeros_aligned((padded_x, 2 * cells_y), dtype="float64")
        self.lateral = pyfftw.zeros_aligned((padded_x, cells_y + 1), dtype="complex128")
        # A measured plan differs from run to run, and with it the last bits of the result.
        options = {"threads": 1, "flags": ("FFTW_ESTIMATE",)}
        # The padding rows stay zero.
        rows = slice(0, cells_x)
        self.forward_y = pyfftw.FFTW(self.real[rows], self.lateral[rows], axes=(1,), **options)
        self.inverse_y = pyfftw.FFTW(
            self.lateral[rows], self.real[rows], axes=(1,), direction="FFTW_BACKWARD", **options
        )
        if mirror:
            view, kind = self.lateral.view(np.float64), "REDFT" if mirror > 0 else "RODFT"
            self.forward_x = pyfftw.FFTW(view, view, axes=(0,), direction=f"FFTW_{kind}10", **options)
            self.inverse_x = pyfftw.FFTW(view, view, axes=(0,), direction=f"FFTW_{kind}01", **options)
        else:
            self.forward_x = pyfftw.FFTW(self.lateral, self.lateral, axes=(0,), **options)
            self.inverse_x = pyfftw.FFTW(self.lateral, self.lateral, axes=(0,), direction="FFTW_BACKWARD", **options)
        self.real[:] = 0.0


class GridTransform:
    """Transforms of cell values, along x padded (mirror 0), or mirrored evenly (1) or oddly (-1) about both ends."""

    def __init__(self, cells_x: int, cells_y: int, padded_x: int, mirror: int) -> None:
        self.cells_x, self.cells_y, self.padded_x, self.mirror = cells_x, cells_y, padded_x, mirror
        self._scale = 1.0 / ((2 if mirror else 1) * padded_x * 2 * cells_y)
        self._thread = threading.local()

    @property
    def _buffers(self) -> _Buffers:
        """Buffers of this thread: all threads share the operators."""
        if not hasattr(self._thread, "buffers"):
            self._thread.buffers = _Buffers(self.cells_x, self.cells_y, self.padded_x, self.mirror)
        buffers: _Buffers = self._thread.buffers
        return buffers

    def transform_y(self, cell_loads: FloatArray) -> ComplexArray:
        """Transform cell values along y, and return a view (cell, wavenumber) of the buffer."""
        buffers = self._buffers
        buffers.real[: self.cells_x, : self.cells_y] = cell_loads
        buffers.real[: self.cells_x, self.cells_y :] = 0.0
        buffers.lateral[self.cells_x :] = 0.0
        buffers.forward_y.execute()
        return np.asarray(buffers.lateral[: self.cells_x])

    def transform_x(self) -> ComplexArray:
        """Transform the buffer of `transform_y` along x, in place: returns the buffer, to be multiplied in place."""
        buffers = self._buffers
        buffers.forward_x.execute()
        return np.asarray(buffers.lateral)

    @property
    def spectrum(self) -> ComplexArray:
        """The buffer, to be filled with a spectrum for `invert`."""
        return np.asarray(self._buffers.lateral)

    @property
    def added_nbytes(self) -> int:
        """Memory of one thread's buffers, bytes."""
        return int(self._buffers.real.nbytes + self._buffers.lateral.nbytes)

    def invert(self, spectrum_correction: ComplexArray | None = None) -> FloatArray:
        """Cell values of the spectrum in the buffer, plus a correction (cell, wavenumber) transformed along y only."""
        buffers = self._buffers
        buffers.inverse_x.execute()
        if spectrum_correction is not None:
            buffers.lateral[: self.cells_x] += spectrum_correction / (self._scale * 2 * self.cells_y)
        buffers.inverse_y.execute()
        return np.asarray(buffers.real[: self.cells_x, : self.cells_y] * self._scale)


@cached("half-space kernels")
def _kernel_spectrum(
    influence: Influence, cell: tuple[float, float], shape: tuple[int, int], length: float, depth: float
) -> FloatArray:
    """Spectrum of the kernels, without a factor i per odd direction: (component, x, y)."""
    x, y = (size * np.arange(count + 1.0) for size, count in zip(cell, shape, strict=True))
    spectrum = influence.kernel(x, y, *cell, length=length, depth=depth)
    for axis, signs in ((1, influence.sign_along_x), (2, influence.sign_along_y)):
        axis_last = spectrum.swapaxes(axis, 2)
        is_even = np.array(signs) > 0
        axis_spectrum = np.empty_like(axis_last)
        axis_spectrum[is_even] = even_spectrum(axis_last[is_even])
        axis_spectrum[~is_even] = odd_spectrum(axis_last[~is_even])
        spectrum = axis_spectrum.swapaxes(axis, 2)
    return np.ascontiguousarray(spectrum)


def _invert_along_x(spectrum: FloatArray, load_transform: ComplexArray, *, mirrored: bool, odd: bool) -> ComplexArray:
    """Transform along y (component, row, wavenumber) of components even or odd along x, from kernels and load."""
    last = spectrum.shape[1] - 1
    if mirrored and not odd:
        return np.asarray(fft.idct(spectrum[:, :last] * load_transform, type=2, axis=1, overwrite_x=True))
    product = np.zeros((spectrum.shape[0], *load_transform.shape), np.complex128)
    if mirrored:
        np.multiply(-spectrum[:, 1:last], load_transform[1:], out=product[:, :-1])
        return np.asarray(fft.idst(product, type=2, axis=1, overwrite_x=True))
    np.multiply(spectrum, load_transform[: last + 1], out=product[:, : last + 1])
    np.multiply(spectrum[:, last - 1 : 0 : -1], load_transform[last + 1 :], out=product[:, last + 1 :])
    if odd:
        product[:, : last + 1] *= 1j
        product[:, last + 1 :] *= -1j
    return np.asarray(fft.ifft(product, axis=1, overwrite_x=True))


def centred_field(
    load: FloatArray,
    influence: Influence,
    cell: tuple[float, float],
    rows: IntArray,
    columns: IntArray,
    z: FloatArray,
    *,
    extent: tuple[float, float],
) -> FloatArray:
    """Field (component, row, column, z) at cell centres; rows and columns count from the first cell of the load."""
    # The load begins at end I, or both ends are infinitely far away.
    mirrored, length = bool(np.isfinite(extent[0])), extent[1]
    cells_x, cells_y = load.shape
    reach_y = max(int(columns.max()), cells_y - 1 - int(columns.min()))
    if not mirrored:
        half_x = fft.next_fast_len(max(int(rows.max()) + 1, cells_x - int(rows.min())), real=True)
    elif np.isinf(length):
        half_x = fft.next_fast_len(max(int(rows.max()) + 1, cells_x) + cells_x, real=True)
    else:
        half_x = cells_x
    # At half a period an odd kernel is undefined: both signs coincide.
    shape = (half_x, fft.next_fast_len(reach_y + 1, real=True))
    lateral = fft.rfft(load, 2 * shape[1], axis=1)
    load_transform = fft.dct(lateral, type=2, n=half_x, axis=0) if mirrored else fft.fft(lateral, 2 * half_x, axis=0)
    is_odd_x, is_odd_y = np.array(influence.sign_along_x) < 0, np.array(influence.sign_along_y) < 0
    field = np.empty((influence.components, rows.size, z.size, columns.size))
    for depth_index, depth in enumerate(z.tolist()):
        spectrum = _kernel_spectrum(influence, cell, shape, length, depth=depth)
        for odd in (False, True):
            components = np.flatnonzero(is_odd_x == odd)
            field_along_y = _invert_along_x(spectrum[components], load_transform, mirrored=mirrored, odd=odd)[:, rows]
            field_along_y[is_odd_y[components]] *= 1j
            field[components, :, depth_index] = fft.irfft(field_along_y, 2 * shape[1], axis=2)[..., columns]
    return field.swapaxes(2, 3)
