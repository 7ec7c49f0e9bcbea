"""Discrete convolution on the grid of cells by fast Fourier transform (DC-FFT), planned once and reused.

The kernel is zero-padded along y, so the loads outside the window are zero and not periodic (S. Liu, Q. Wang, G. Liu,
Wear 243 (2000) 101). Along x it is zero-padded as well, or, for a body with ends, mirrored: a load extended evenly
about its ends is diagonal in the cosine transform, without any padding.
"""

from __future__ import annotations

import numpy as np
import pyfftw
from scipy import fft

from contactstudy.checks import ComplexArray, FloatArray


def even_spectrum(kernel: FloatArray) -> FloatArray:
    """Spectrum along y of a kernel that is even in y, given at offsets 0 .. N (last axis)."""
    return np.asarray(fft.dct(kernel, type=1, axis=-1))


def odd_spectrum(kernel: FloatArray) -> FloatArray:
    """Spectrum along y, without its factor i, of a kernel that is odd in y, given at offsets 0 .. N (last axis)."""
    spectrum = np.zeros_like(kernel)
    spectrum[..., 1:-1] = -fft.dst(kernel[..., 1:-1], type=1, axis=-1)
    return spectrum


class GridTransform:
    """Forward and backward transforms of cell values, with aligned buffers that every call reuses.

    Parameters
    ----------
    cells_x, cells_y : int
        Cells of the grid.
    padded_x : int
        Cells along x with padding; `mirrored` decides what the padding stands for.
    mirrored : bool
        Whether the load continues evenly about ``x = 0`` and about the padded end (cosine transform along x).
    threads : int
        Threads of the transform.
    """

    def __init__(self, cells_x: int, cells_y: int, padded_x: int, *, mirrored: bool, threads: int = 1) -> None:
        self.cells_x, self.cells_y, self.mirrored = cells_x, cells_y, mirrored
        self._real = pyfftw.zeros_aligned((padded_x, 2 * cells_y), dtype="float64")
        self._lateral = pyfftw.zeros_aligned((padded_x, cells_y + 1), dtype="complex128")
        # A plan that was measured differs from run to run, and its last bits with it.
        options = {"threads": threads, "flags": ("FFTW_ESTIMATE",)}
        # Only rows that hold cells are transformed along y; the padding rows stay zero.
        rows = slice(0, cells_x)
        self._to_lateral = pyfftw.FFTW(self._real[rows], self._lateral[rows], axes=(1,), **options)
        self._from_lateral = pyfftw.FFTW(
            self._lateral[rows], self._real[rows], axes=(1,), direction="FFTW_BACKWARD", **options
        )
        if mirrored:
            view = self._lateral.view(np.float64)
            self._along = pyfftw.FFTW(view, view, axes=(0,), direction="FFTW_REDFT10", **options)
            self._back = pyfftw.FFTW(view, view, axes=(0,), direction="FFTW_REDFT01", **options)
            self._scale = 1.0 / (2 * padded_x * 2 * cells_y)
        else:
            self._along = pyfftw.FFTW(self._lateral, self._lateral, axes=(0,), **options)
            self._back = pyfftw.FFTW(self._lateral, self._lateral, axes=(0,), direction="FFTW_BACKWARD", **options)
            self._scale = 1.0 / (padded_x * 2 * cells_y)
        self._real[:] = 0.0

    def lateral(self, values: FloatArray) -> ComplexArray:
        """Transform along y of cell `values`: a view (cell, wavenumber) of the buffer."""
        self._real[: self.cells_x, : self.cells_y] = values
        self._real[: self.cells_x, self.cells_y :] = 0.0
        self._lateral[self.cells_x :] = 0.0
        self._to_lateral.execute()
        return np.asarray(self._lateral[: self.cells_x])

    def along(self) -> ComplexArray:
        """Transform the buffer of `lateral` along x as well, in place: the buffer, to be multiplied in place."""
        self._along.execute()
        return np.asarray(self._lateral)

    @property
    def nbytes(self) -> int:
        """Memory of the buffers, bytes."""
        return int(self._real.nbytes + self._lateral.nbytes)

    def back(self, spectrum_correction: ComplexArray | None = None) -> FloatArray:
        """Cell values of the buffer that `along` returned; a transform along y alone may be added on the way."""
        self._back.execute()
        if spectrum_correction is not None:
            self._lateral[: self.cells_x] += spectrum_correction / (self._scale * 2 * self.cells_y)
        self._from_lateral.execute()
        return np.asarray(self._real[: self.cells_x, : self.cells_y] * self._scale)
