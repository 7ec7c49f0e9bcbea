"""Displacements of the top of one part of a body: a half-space with the load mirrored, and what frees its ends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from scipy import fft

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import Extent, Part
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.kernels.convolution import GridTransform, even_spectrum, odd_spectrum
from contactstudy.kernels.load import SINKS, Load, Response
from contactstudy.kernels.surface import surface_kernel
from contactstudy.overlapping.end_kernel import EndRequest, end_kernel
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.overlapping.surface import EndCorrection
from contactstudy.threads import one_blas_thread

REFERENCE_LENGTHS = 10.0
"""A finite-length body's displacement is relative to its top at ``|y|`` = this many lengths. A definition."""


class PartOperator:
    """Displacements of the top of one part of a body.

    Parameters
    ----------
    extent : tuple of float
        Where the mirrors stand, metres; infinite for none.
    grid : Grid
        Cells.
    spectra : mapping of Response to array
        Spectrum of the mirrored half-space's kernel, for each pair of displacement and load that the operator takes.
    ends : EndCorrection or None
        What frees the ends; None where they stay as mirroring leaves them.
    """

    def __init__(
        self, extent: Extent, grid: Grid, spectra: Mapping[Response, FloatArray], ends: EndCorrection | None
    ) -> None:
        self.extent, self.grid = extent, grid
        self._spectra, self._ends = spectra, ends
        padding = _Padding(extent, grid)
        # Mirrored in its second end alone, the body is seen from there.
        self._flipped = padding.mirrored and bool(np.isinf(extent[0]))

        def transforms(directions: Sequence[Load]) -> dict[Load, GridTransform]:
            return {
                each: GridTransform(*grid.shape, padding.cells_x, each.sign_x if padding.mirrored else 0)
                for each in dict.fromkeys(directions)
            }

        self._loaded = transforms([response.load for response in spectra])
        self._displaced = transforms([response.displacement for response in spectra])

    @classmethod
    def of(
        cls, material: Material, part: Part, grid: Grid, responses: Sequence[Response], resolution: Resolution
    ) -> PartOperator:
        """Operator of a part of a body made of `material`, for pairs of displacement and load."""
        ends = None
        if part.freed:
            check_freed(part, responses)
            with one_blas_thread():
                reference = reference_of(part.extent)
                request = EndRequest.of(part.freed, material, grid, tuple(responses), reference, resolution)
                ends = EndCorrection.on(grid, end_kernel(request))
        spectra = {response: _spectrum(response, material, part.extent, grid) for response in responses}
        return cls(part.extent, grid, spectra, ends)

    @property
    def reference(self) -> float:
        """Distance along y at which the displacement is zero, metres; infinite unless the body has two ends."""
        return reference_of(self.extent)

    def coarsened(self, material: Material) -> PartOperator:
        """Return the operator on cells of twice the size."""
        grid = self.grid.coarsened()
        spectra = {response: _spectrum(response, material, self.extent, grid) for response in self._spectra}
        return PartOperator(self.extent, grid, spectra, self._ends.coarsened() if self._ends is not None else None)

    def __call__(self, loads: Mapping[Load, FloatArray], directions: Sequence[Load]) -> dict[Load, FloatArray]:
        """Displacements (m) of the cell centres in some `directions` under `loads` (Pa): arrays (x, y)."""
        spectra, gathered = {}, {}
        for load, cells in loads.items():
            transform = self._loaded[load]
            lateral = transform.lateral(load.sign_x * cells[::-1] if self._flipped else cells)
            if self._ends is not None:
                gathered[load] = self._ends.gathered(load, lateral)
            spectra[load] = transform.along()
        displacements = {}
        for direction in directions:
            transform = self._displaced[direction]
            self._fill(transform.spectrum, direction, spectra)
            cells_x = self.grid.cells_x
            ends = self._ends.displaced(direction, gathered, cells_x) if self._ends is not None else None
            displaced = transform.back(ends)
            displacements[direction] = direction.sign_x * displaced[::-1] if self._flipped else displaced
        return displacements

    def _fill(self, total: ComplexArray, direction: Load, loads: Mapping[Load, ComplexArray]) -> None:
        """Fill a buffer with the spectrum of the displacement that the mirrored half-space has under `loads`.

        A sine transform begins with wavenumber 1, a cosine transform with wavenumber 0.
        """
        mirrored = bool(self._displaced[direction].mirror)
        for number, (load, spectrum) in enumerate(loads.items()):
            response = Response(direction, load)
            kernel = self._spectra[response]
            seen, loaded = total, spectrum
            if mirrored and response.sign_x < 0:
                seen, loaded = (total[:-1], spectrum[1:]) if direction.sign_x < 0 else (total[1:], spectrum[:-1])
                if not number:
                    total[-1 if direction.sign_x < 0 else 0] = 0.0
            if not number:
                np.multiply(kernel, loaded, out=seen)
            elif response.sign_y > 0 and (mirrored or response.sign_x > 0):
                seen += kernel * loaded
                continue
            # Kernels without their factors i: of a component odd along y, and along x unless mirrored.
            turns = int(response.sign_y < 0) + int(response.sign_x < 0 and not mirrored)
            factor = (1, 1j, -1)[turns]
            if number:
                seen += (factor * kernel) * loaded
            elif turns:
                seen *= factor

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that sinks the cells by `gap`: the inverse of the mirrored half-space's spectrum."""
        transform = self._loaded[Load.NORMAL]
        transform.lateral(gap)
        full = transform.along()
        full *= self._inverse
        return transform.back()

    @cached_property
    def _inverse(self) -> FloatArray:
        # The constant's own entry depends on the reference only; the next one stands in for it.
        spectrum = self._spectra[SINKS].copy()
        spectrum[0, 0] = max(spectrum[0, 1], spectrum[1, 0])
        return np.asarray(1.0 / np.maximum(spectrum, 1e-3 * spectrum.min(where=spectrum > 0, initial=np.inf)))

    @property
    def nbytes(self) -> int:
        """Memory held, bytes, with the inverse that preconditioning adds."""
        ends = self._ends.nbytes if self._ends is not None else 0
        spectra = [spectrum.nbytes for spectrum in self._spectra.values()]
        buffers = sum(each.nbytes for each in (*self._loaded.values(), *self._displaced.values()))
        return int(sum(spectra) + max(spectra)) + ends + buffers


class _Padding:
    """How the cells continue along x: mirrored in the ends, or padded with zeros."""

    def __init__(self, extent: Extent, grid: Grid) -> None:
        low, high = (bool(np.isfinite(end)) for end in extent)
        self.mirrored, self.periodic = low or high, low and high
        self.cells_x = grid.cells_x if self.periodic else 2 * grid.cells_x


def check_freed(part: Part, responses: Sequence[Response]) -> None:
    """Raise if a model of the ends says nothing of a displacement that is asked for."""
    tangential = any(response.displacement is not Load.NORMAL for response in responses)
    if tangential and part.freed is not None and part.freed.mirrored_once:
        raise InvalidInputError(
            "body.model",
            "single-mirror",
            'a model whose top is displaced tangentially as reciprocity says: "exact", "mirror" or "mirror-factor"',
            "its ends keep some shear",
        )


def reference_of(extent: Extent) -> float:
    """Distance along y at which the displacement of a part is zero, metres; infinite unless it has two ends."""
    return REFERENCE_LENGTHS * (extent[1] - extent[0])


def displaced_by_unit(material: Material) -> float:
    """Factor on the closed-form kernels of the displacement, 1/Pa."""
    return 1 / (4 * np.pi * material.shear_modulus)


def _spectrum(response: Response, material: Material, extent: Extent, grid: Grid) -> FloatArray:
    """Spectrum of the mirrored half-space's kernel, without its factors i: array (x, y).

    Mirrored, it takes a cosine or sine transform (of the load's kind) to another (of the displacement's kind).
    """
    padding = _Padding(extent, grid)
    x: FloatArray = grid.dx * np.arange(padding.cells_x + 1.0 if padding.mirrored else grid.cells_x + 1.0)
    y: FloatArray = grid.dy * np.arange(grid.cells_y + 1.0)
    length = extent[1] - extent[0]
    cell = (grid.dx, grid.dy)
    kernel = surface_kernel(response, material.poisson, x, y, cell, length, reference_of(extent))
    along_y = even_spectrum(kernel) if response.sign_y > 0 else odd_spectrum(kernel)
    factor = displaced_by_unit(material)
    if response.sign_x < 0:
        inner = factor * fft.dst(along_y[1:-1], type=1, axis=0)
        if padding.mirrored:
            return np.asarray(inner if response.displacement.sign_x < 0 else -inner)
        zero = np.zeros((1, inner.shape[1]))
        return np.concatenate([zero, -inner, zero, inner[::-1]])
    spectrum = factor * fft.dct(along_y, type=1, axis=0)
    if padding.mirrored:
        return np.asarray(spectrum[:-1] if response.displacement.sign_x > 0 else spectrum[1:])
    return np.concatenate([spectrum, spectrum[-2:0:-1]])
