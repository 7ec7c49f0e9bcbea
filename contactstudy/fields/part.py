"""Displacement of the top of one part of a body: a half-space with the load mirrored, and what frees its ends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from scipy import fft

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import Extent, Part
from contactstudy.checks import FloatArray
from contactstudy.kernels.convolution import GridTransform, even_spectrum, odd_spectrum
from contactstudy.kernels.images import FAR_LIMIT, CornerFunction, cell_kernel, mirrored_kernel
from contactstudy.kernels.load import Load
from contactstudy.kernels.patch import normal_displacement_corner, tangential_displacement_corner
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.overlapping.surface import EndCorrection, build_end_correction
from contactstudy.threads import one_blas_thread

REFERENCE_LENGTHS = 10.0
"""A finite-length body's displacement is relative to its top at ``|y|`` = this many lengths. A definition."""


class PartOperator:
    """Normal displacement of the top of one part of a body.

    Parameters
    ----------
    extent : tuple of float
        Where the mirrors stand, metres; infinite for none.
    grid : Grid
        Cells.
    spectra : mapping of Load to array
        Spectrum of the mirrored half-space's kernel, for each load that the operator takes.
    ends : EndCorrection or None
        What frees the ends; None where they stay as mirroring leaves them.
    """

    def __init__(
        self, extent: Extent, grid: Grid, spectra: Mapping[Load, FloatArray], ends: EndCorrection | None
    ) -> None:
        self.extent, self.grid = extent, grid
        self._spectra, self._ends = spectra, ends
        padding = _Padding(extent, grid)
        # Mirrored in its second end alone, the body is seen from there.
        self._flipped = padding.mirrored and bool(np.isinf(extent[0]))
        self._transform = GridTransform(*grid.shape, padding.cells_x, mirrored=padding.mirrored)

    @classmethod
    def of(
        cls, material: Material, part: Part, grid: Grid, loads: Sequence[Load], resolution: Resolution
    ) -> PartOperator:
        """Operator of a part of a body made of `material`, for `loads` of the given directions."""
        ends = None
        if part.freed:
            with one_blas_thread():
                ends = build_end_correction(
                    part.freed.length,
                    material,
                    grid,
                    loads,
                    reference=_reference(part.extent),
                    resolution=resolution,
                    mirrored_once=part.freed.mirrored_once,
                )
        spectra = {load: _spectrum(load, material, part.extent, grid) for load in loads}
        return cls(part.extent, grid, spectra, ends)

    @property
    def reference(self) -> float:
        """Distance along y at which the displacement is zero, metres; infinite unless the body has two ends."""
        return _reference(self.extent)

    def coarsened(self, material: Material) -> PartOperator:
        """Return the operator on cells of twice the size, under pressure alone."""
        grid = self.grid.coarsened()
        spectra = {Load.NORMAL: _spectrum(Load.NORMAL, material, self.extent, grid)}
        return PartOperator(self.extent, grid, spectra, self._ends.coarsened() if self._ends is not None else None)

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement (m) of the cell centres under `loads` (Pa): array (x, y)."""
        first, *others = (self._under(load, cells) for load, cells in loads.items())
        for other in others:
            first += other
        return first

    def _under(self, load: Load, cells: FloatArray) -> FloatArray:
        lateral = self._transform.lateral(cells[::-1] if self._flipped else cells)
        correction = self._ends.apply(load, lateral) if self._ends is not None else None
        full = self._transform.along()
        full *= self._spectra[load]
        if load.sign_y < 0:
            full *= 1j
        displacement = self._transform.back(correction)
        return displacement[::-1] if self._flipped else displacement

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that sinks the cells by `gap`: the inverse of the mirrored half-space's spectrum."""
        self._transform.lateral(gap)
        full = self._transform.along()
        full *= self._inverse
        return self._transform.back()

    @cached_property
    def _inverse(self) -> FloatArray:
        # The constant's own entry depends on the reference only; the next one stands in for it.
        spectrum = self._spectra[Load.NORMAL].copy()
        spectrum[0, 0] = max(spectrum[0, 1], spectrum[1, 0])
        return np.asarray(1.0 / np.maximum(spectrum, 1e-3 * spectrum.min(where=spectrum > 0, initial=np.inf)))

    @property
    def nbytes(self) -> int:
        """Memory held, bytes, with the inverse that preconditioning adds."""
        ends = self._ends.nbytes if self._ends is not None else 0
        spectra = sum(spectrum.nbytes for spectrum in self._spectra.values())
        return int(spectra + self._spectra[Load.NORMAL].nbytes) + ends + self._transform.nbytes


class _Padding:
    """How the cells continue along x: mirrored in the ends, or padded with zeros."""

    def __init__(self, extent: Extent, grid: Grid) -> None:
        low, high = (bool(np.isfinite(end)) for end in extent)
        self.mirrored, self.periodic = low or high, low and high
        self.cells_x = grid.cells_x if self.periodic else 2 * grid.cells_x


def _reference(extent: Extent) -> float:
    return REFERENCE_LENGTHS * (extent[1] - extent[0])


def _spectrum(load: Load, material: Material, extent: Extent, grid: Grid) -> FloatArray:
    """Spectrum of the mirrored half-space's kernel, without the factor i of a load along y: array (x, y)."""
    padding = _Padding(extent, grid)
    x: FloatArray = grid.dx * np.arange(padding.cells_x + 1.0 if padding.mirrored else grid.cells_x + 1.0)
    y: FloatArray = grid.dy * np.arange(grid.cells_y + 1.0)
    if load is Load.NORMAL:
        factor = (1 - material.poisson) / (2 * np.pi * material.shear_modulus)
        along_y = even_spectrum(_kernel(normal_displacement_corner, extent, grid, x, y))
    else:
        factor = (1 - 2 * material.poisson) / (4 * np.pi * material.shear_modulus)
        along_y = odd_spectrum(_kernel(tangential_displacement_corner, extent, grid, x, y))
    spectrum = fft.dct(along_y, type=1, axis=0)
    if padding.mirrored:
        return np.asarray(factor * spectrum[:-1])
    return np.asarray(factor * np.concatenate([spectrum, spectrum[-2:0:-1]]))


def _kernel(corner: CornerFunction, extent: Extent, grid: Grid, x: FloatArray, y: FloatArray) -> FloatArray:
    """Kernel of a half-space with all mirror images, at offsets that are not negative."""
    if not np.isfinite(extent).all():
        return cell_kernel(corner, x, y, grid.dx, grid.dy)
    length = extent[1]
    kernel = mirrored_kernel(corner, x, y, grid.dx, grid.dy, length)
    if corner is normal_displacement_corner:
        # The images make a line load along x; its logarithm is set to zero at the reference.
        kernel -= grid.cell_area / length * np.log(2 * FAR_LIMIT * length / _reference(extent))
    return kernel
