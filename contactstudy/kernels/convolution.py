"""Discrete convolution on the grid of cells by fast Fourier transform (DC-FFT), planned once and reused.

The kernel is zero-padded along y, so the loads outside the window are zero and not periodic (S. Liu, Q. Wang, G. Liu,
Wear 243 (2000) 101). Along x it is zero-padded as well, or, for a body with ends, mirrored: a load extended evenly
about its ends is diagonal in the cosine transform, one extended oddly in the sine transform, without any padding.
"""

from __future__ import annotations

import threading

import numpy as np
from scipy import fft

from contactstudy.checks import ComplexArray, FloatArray


def even_spectrum(kernel: FloatArray) -> FloatArray:
    """Spectrum along y of a kernel that is even in y, given at offsets 0 .. N (last axis)."""
    return np.asarray(fft.dct(kernel, type=1, axis=-1))


def odd_spectrum(kernel: FloatArray) -> FloatArray:
    """Spectrum along y, without its factor i, of a kernel that is odd in y, given at offsets 0 .. N (last axis)."""
    spectrum = np.zeros_like(kernel)
    if kernel.shape[-1] > 2:  # an odd kernel on a single cell is nothing
        spectrum[..., 1:-1] = -fft.dst(kernel[..., 1:-1], type=1, axis=-1)
    return spectrum


class _Buffers:
    """Aligned memory and the transforms planned on it, for one thread."""

    def __init__(self, cells_x: int, cells_y: int, padded_x: int, mirror: int) -> None:
        import pyfftw  # which brings dask's arrays: not for those who only look at results

        self.real = pyfftw.zeros_aligned((padded_x, 2 * cells_y), dtype="float64")
        self.lateral = pyfftw.zeros_aligned((padded_x, cells_y + 1), dtype="complex128")
        # A plan that was measured differs from run to run, and its last bits with it.
        options = {"threads": 1, "flags": ("FFTW_ESTIMATE",)}
        # Only rows that hold cells are transformed along y; the padding rows stay zero.
        rows = slice(0, cells_x)
        self.to_lateral = pyfftw.FFTW(self.real[rows], self.lateral[rows], axes=(1,), **options)
        self.from_lateral = pyfftw.FFTW(
            self.lateral[rows], self.real[rows], axes=(1,), direction="FFTW_BACKWARD", **options
        )
        if mirror:
            view, kind = self.lateral.view(np.float64), "REDFT" if mirror > 0 else "RODFT"
            self.along = pyfftw.FFTW(view, view, axes=(0,), direction=f"FFTW_{kind}10", **options)
            self.back = pyfftw.FFTW(view, view, axes=(0,), direction=f"FFTW_{kind}01", **options)
        else:
            self.along = pyfftw.FFTW(self.lateral, self.lateral, axes=(0,), **options)
            self.back = pyfftw.FFTW(self.lateral, self.lateral, axes=(0,), direction="FFTW_BACKWARD", **options)
        self.real[:] = 0.0

    @property
    def nbytes(self) -> int:
        """Memory, bytes."""
        return int(self.real.nbytes + self.lateral.nbytes)


class GridTransform:
    """Forward and backward transforms of cell values, with aligned buffers that every call of a thread reuses.

    Parameters
    ----------
    cells_x, cells_y : int
        Cells of the grid.
    padded_x : int
        Cells along x with padding; `mirror` decides what the padding stands for.
    mirror : int
        1 or -1 if the values continue evenly or oddly about ``x = 0`` and about the padded end (cosine or sine
        transform along x), 0 if they do not.
    """

    def __init__(self, cells_x: int, cells_y: int, padded_x: int, mirror: int) -> None:
        self.cells_x, self.cells_y, self.padded_x, self.mirror = cells_x, cells_y, padded_x, mirror
        self._scale = 1.0 / ((2 if mirror else 1) * padded_x * 2 * cells_y)
        self._thread = threading.local()

    @property
    def _buffers(self) -> _Buffers:
        """Buffers of this thread: operators are shared by all."""
        found: _Buffers | None = getattr(self._thread, "buffers", None)
        if found is None:
            found = _Buffers(self.cells_x, self.cells_y, self.padded_x, self.mirror)
            self._thread.buffers = found
        return found

    def lateral(self, values: FloatArray) -> ComplexArray:
        """Transform along y of cell `values`: a view (cell, wavenumber) of the buffer."""
        buffers = self._buffers
        buffers.real[: self.cells_x, : self.cells_y] = values
        buffers.real[: self.cells_x, self.cells_y :] = 0.0
        buffers.lateral[self.cells_x :] = 0.0
        buffers.to_lateral.execute()
        return np.asarray(buffers.lateral[: self.cells_x])

    def along(self) -> ComplexArray:
        """Transform the buffer of `lateral` along x as well, in place: the buffer, to be multiplied in place."""
        buffers = self._buffers
        buffers.along.execute()
        return np.asarray(buffers.lateral)

    @property
    def spectrum(self) -> ComplexArray:
        """The buffer, to be filled with a spectrum for `back`."""
        return np.asarray(self._buffers.lateral)

    @property
    def nbytes(self) -> int:
        """Memory of one thread's buffers, bytes."""
        return self._buffers.nbytes

    def back(self, spectrum_correction: ComplexArray | None = None) -> FloatArray:
        """Cell values of the spectrum in the buffer; a transform along y alone may be added on the way."""
        buffers = self._buffers
        buffers.back.execute()
        if spectrum_correction is not None:
            buffers.lateral[: self.cells_x] += spectrum_correction / (self._scale * 2 * self.cells_y)
        buffers.from_lateral.execute()
        return np.asarray(buffers.real[: self.cells_x, : self.cells_y] * self._scale)
