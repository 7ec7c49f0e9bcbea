"""Displacements of the top from the free ends, between positions graded towards the ends.

The part of the pressure is the mirrored half-space; the part of the end correction follows from the equation set by
reciprocity, eqs. (28) to (29b): a symmetric operator, smooth except at the ends. It is sampled at graded positions
and transformed along y to the wavenumbers of the zero-padded grid, once per body and window. Displacements refer to
the top far away, at ``|y| = reference``, where the curvature under a force along x is zero, too, eqs. (30) and (30a).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import NamedTuple

import numpy as np
from scipy import linalg

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import FreeEnds
from contactstudy.cache import cached
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.kernels.convolution import spectrum_matrices
from contactstudy.kernels.load import Load, Response
from contactstudy.overlapping.equations import AxialModes, EquationSet, SingleMirrorModes, axial_modes
from contactstudy.overlapping.problem import BENDING_POLES, POLE_PANEL_FACTOR, POLES, LateralPanel, lateral_panels
from contactstudy.overlapping.quadrature import Resolution, cell_moments, graded_positions

EXTRA_NODES = 2
"""Additional wavenumbers along y per panel, against a field: an operator is built once for all loads. Accuracy."""

RAY_FACTOR = (
    1.25  # angle of the axial ray and step along the ray, over the values for a field: no depth ray limits them. Speed.
)

CELLS_PER_FINEST = 8  # cells along y over the finest resolved distance from an end with narrow cells along x. Accuracy.


class EndRequest(NamedTuple):
    """Request of a kernel of the ends."""

    free_ends: FreeEnds  # free ends, at ``x = 0`` and at the length (infinite: one end)
    material: Material
    dy: float  # cell size along y, metres, and number of cells
    cells_y: int
    span: float  # length that the cells cover from ``x = 0``, metres
    finest: float  # finest resolved distance from the ends, metres
    responses: tuple[Response, ...]  # pairs of displacement and load
    reference: float  # distance along y at which the displacement of a finite-length body is zero, metres
    resolution: Resolution  # quadrature settings

    @classmethod
    def of(
        cls,
        free_ends: FreeEnds,
        material: Material,
        grid: Grid,
        responses: tuple[Response, ...],
        reference: float,
        resolution: Resolution,
    ) -> EndRequest:
        """Request of a grid that begins at ``x = 0``; cells of any width along x share it."""
        finest = grid.dx
        if not grid.uniform:
            # Next to a loaded end the pressure follows the ends' part down to some hundredths of the contact's width.
            end_width = min(grid.widths[0], grid.widths[-1]) if np.isfinite(free_ends.length) else grid.widths[0]
            finest = grid.dy / CELLS_PER_FINEST if end_width <= 2 * grid.dy else grid.dy
        resolution = resolution.for_loads(chain.from_iterable(responses))
        operator_resolution = replace(
            resolution,
            angle=RAY_FACTOR * resolution.angle,
            step=RAY_FACTOR * resolution.step,
            lateral_nodes=resolution.lateral_nodes + EXTRA_NODES,
        )
        return cls(
            free_ends=free_ends,
            material=material,
            dy=grid.dy,
            cells_y=grid.cells_y,
            span=grid.x_range[1],
            finest=finest,
            responses=responses,
            reference=reference,
            resolution=operator_resolution,
        )

    @property
    def parities(self) -> tuple[int, ...]:
        """Parities that the ends do not mix."""
        return (1, -1) if np.isfinite(self.free_ends.length) else (0,)


@dataclass(frozen=True, eq=False)
class EndKernel:
    """The ends' part of the displacement between graded positions."""

    request: EndRequest
    edges: FloatArray  # edges of panels along x, from end I to mid-length (or over the span), and their Gauss positions
    positions: FloatArray
    samples: Mapping[Response, list[FloatArray]]  # (wavenumber, position, position) per parity, as in `EndCorrection`

    def add_to(self, kernel: FloatArray, response: Response, cell_edges: FloatArray) -> None:
        """Add the displacement averaged over cells from forces on cells to an array (wavenumber, cell, cell)."""
        widths = np.diff(cell_edges)
        side_moments = self.moments(cell_edges)
        for parity, samples in zip(self.request.parities, self.samples[response], strict=True):
            observed_means, loaded_means = (
                sum_of_ends(side_moments, parity * direction.sign_x) / widths for direction in response
            )
            for total, sampled in zip(kernel, samples, strict=True):
                total += observed_means.T @ sampled @ loaded_means

    def moments(self, cell_edges: FloatArray) -> list[FloatArray]:
        """Integrals over the cells of the polynomials on the positions, from each end: arrays (position, cell)."""
        side_moments = [cell_moments(self.edges, self.positions, cell_edges)]
        length = self.request.free_ends.length
        if np.isfinite(length):
            side_moments.append(cell_moments(self.edges, self.positions, length - cell_edges[::-1])[:, ::-1])
        return side_moments


def sum_of_ends(side_moments: list[FloatArray], sign: int) -> FloatArray:
    """Sum over both ends for a load whose image is `sign` times the load; with a single end, its value."""
    return np.asarray(side_moments[0] + sign * side_moments[1]) if len(side_moments) > 1 else side_moments[0]


class PositionWaves:
    """Waves of axial modes at positions, for all directions of some responses and all wavenumbers along y."""

    def __init__(self, modes: AxialModes, positions: FloatArray, responses: Sequence[Response]) -> None:
        self.modes, self.positions = modes, positions[positions <= modes.reach]  # positions within reach, metres
        # (mode, position): weighted spectra of unit loads at the positions
        self.by_load = {
            load: modes.load_weights[:, None] * modes.wave(load, self.positions)
            for load in dict.fromkeys(chain.from_iterable(responses))
        }


def sampled_kernel(waves: PositionWaves, wavenumber: float, request: EndRequest, shortest: float) -> list[FloatArray]:
    """Correction between the graded positions within reach at one wavenumber, for each of the responses."""
    modes, material, responses = waves.modes, request.material, request.responses
    factor = (1 - material.poisson) / material.shear_modulus * (np.pi if modes.parity else np.pi / 2)
    system = EquationSet.build(modes, wavenumber, material.poisson, shortest, request.resolution)
    loads = dict.fromkeys(response.load for response in responses)
    if isinstance(modes, SingleMirrorModes):  # no reciprocity: the ends of this scheme carry shear
        k = np.sqrt(modes.wavenumbers**2 + wavenumber**2)  # eq. (28)
        compliance = modes.cosine(waves.positions) * ((1 - material.poisson) / material.shear_modulus / k)[:, None]
        top_loads = {
            load: system.spectrum_on_top(system.solve(system.source(load, waves.by_load[load]))) for load in loads
        }
        return [np.real(compliance.T @ top_loads[response.load]) for response in responses]
    sources = {load: system.source(load, spectrum) for load, spectrum in waves.by_load.items()}
    face_loads = {load: system.solve(sources[load]) for load in loads}
    kernels = []
    for displacement, load in responses:
        kernel = sources[displacement].T @ face_loads[load]  # eqs. (29) and (29b), sources of eq. (28a)
        if displacement in face_loads:
            # Two ends amplify rounding: the mean of both kernels restores reciprocity.
            reverse_kernel = kernel if displacement is load else sources[load].T @ face_loads[displacement]
            kernel = 0.5 * (kernel + reverse_kernel.T)
        # The kernel lacks the factor i of odd kernels; the sign is due to the conjugate of ``i s``.
        sign = -1 if displacement.sign_y < 0 < load.sign_y else 1
        kernels.append(factor * sign * kernel)
    return kernels


@cached("end kernels")
def end_kernel(request: EndRequest) -> EndKernel:
    """Kernel of the ends of a body."""
    length, mirrored_once = request.free_ends
    is_relative = np.isfinite(length) and not mirrored_once
    window = 2 * request.dy * request.cells_y
    shortest = 0.5 * request.finest
    # A load on a single cell at the edge is accurate to 1e-4 at the edge; smooth loads need half of the range.
    last_wavenumber = 2 * max(2.0 * np.pi / request.dy, 6.0 / request.finest)
    reference = request.reference if is_relative else None
    half_length = 0.5 * length if np.isfinite(length) else request.span
    edges, positions = graded_positions(half_length, shortest)
    offsets: FloatArray = request.dy * np.arange(request.cells_y + 1.0)
    even_matrix, odd_matrix = spectrum_matrices(request.cells_y)
    # Matrices from samples at the offsets to the padded grid's transform; an odd kernel is -sin(k y).
    transforms = {1: np.ascontiguousarray(even_matrix.T), -1: np.ascontiguousarray(-odd_matrix.T)}
    samples_by_response: dict[Response, list[FloatArray]] = {}
    for poles in sorted({_poles(response) for response in request.responses}):
        first_wavenumber = POLE_PANEL_FACTOR[poles] / min(length, 4 * max(request.span, window))
        panels = lateral_panels(
            first_wavenumber, 0.5 * window, last_wavenumber, request.resolution, reference, poles=poles
        )
        responses = [response for response in request.responses if _poles(response) == poles]
        indices = [request.responses.index(response) for response in responses]
        size, parities = positions.size, len(request.parities)
        totals = np.zeros((len(responses), parities, request.cells_y + 1, size**2))
        for panel in panels:
            cell_factor = request.dy * np.sinc(panel.fine_nodes * request.dy / (2 * np.pi))
            panel_transforms = {}
            for sign_y in {response.sign_y for response in responses}:
                transform = transforms[sign_y] @ (panel.wave(offsets, sign_y).T * cell_factor)
                panel_transforms[sign_y] = transform if panel.interpolation is None else transform @ panel.interpolation
            samples = np.zeros((len(responses), parities, panel.nodes.size, size, size))
            for node, sampled in enumerate(_sample_panel(request, panel, positions, shortest)):
                count = sampled.shape[-1]
                samples[:, :, node, :count, :count] = sampled[:, indices].swapaxes(0, 1)
            for response, total, response_samples in zip(responses, totals, samples, strict=True):
                for sums, parity_samples in zip(total, response_samples, strict=True):
                    add_product(sums, panel_transforms[response.sign_y], parity_samples.reshape(-1, size**2))
        shape = (request.cells_y + 1, size, size)
        for response, total in zip(responses, totals, strict=True):
            samples_by_response[response] = [sums.reshape(shape) for sums in total]
    return EndKernel(request, edges, positions, samples_by_response)


def _poles(response: Response) -> int:
    """Order of a response's pole at wavenumber 0 along y."""
    return BENDING_POLES if Load.ALONG_X in response else POLES


def _sample_panel(
    request: EndRequest, panel: LateralPanel, positions: FloatArray, shortest: float
) -> Iterator[FloatArray]:
    """Yield the kernel at each of a panel's wavenumbers: arrays (parity, response, position, position)."""
    length, mirrored_once = request.free_ends
    first_wavenumber = float(panel.nodes[0])
    modes = axial_modes(length, first_wavenumber, shortest, request.resolution, mirrored_once=mirrored_once)
    waves = [PositionWaves(mode, positions, request.responses) for mode in modes]
    for wavenumber in panel.nodes.tolist():
        kernel = np.array([sampled_kernel(mode_waves, wavenumber, request, shortest) for mode_waves in waves])
        # Ends do not interact: each parity has half of a quarter space's kernel.
        yield 0.5 * np.repeat(kernel, 2, axis=0) if len(request.parities) > len(modes) else kernel


def add_product(total: FloatArray, left_factor: FloatArray, right_factor: FloatArray) -> None:
    """Add ``left_factor @ right_factor`` to `total`, a contiguous array, in its place."""
    # The transposes are in Fortran's order: BLAS copies nothing.
    linalg.blas.dgemm(1.0, right_factor.T, np.ascontiguousarray(left_factor).T, 1.0, total.T, overwrite_c=True)


@dataclass(frozen=True, eq=False)
class EndCorrection:
    """The ends' part of the displacements, acting on transforms along y of the zero-padded grid."""

    parities: tuple[int, ...]  # parities that the ends do not mix; 0 alone for one end
    moments: Mapping[Load, list[FloatArray]]
    """(position, cell): by direction and per parity, from cells to graded positions. With two parities the cells
    beyond the middle are folded onto the first half."""
    kernels: Mapping[Response, list[FloatArray]]
    """(wavenumber, position, position): per parity, displacement at graded positions from a load at each, without
    the factor i of kernels odd along y."""
    cell: float  # cell size along x

    def project_loads(self, load: Load, transform: ComplexArray) -> list[FloatArray]:
        """Per parity, a load's transform on the graded positions: (wavenumber, position, real or imaginary part)."""
        # The operator is real: real products on pairs of real and imaginary part are four times faster.
        pairs = np.ascontiguousarray(transform).view(np.float64)
        folded = zip(self.moments[load], self._fold(pairs, load.sign_x), strict=True)
        return [
            np.ascontiguousarray((moments @ parity_values).reshape(len(moments), -1, 2).transpose(1, 0, 2))
            for moments, parity_values in folded
        ]

    def compute_displacement(
        self, direction: Load, loads: Mapping[Load, list[FloatArray]], cell_count: int
    ) -> ComplexArray:
        """Displacement in one direction, transformed along y (cell, wavenumber), from all `project_loads` loads."""
        terms: list[FloatArray] = []
        for index, moments in enumerate(self.moments[direction]):
            projection_sum = np.zeros_like(next(iter(loads.values()))[index])
            for load, projected in loads.items():
                response = Response(direction, load)
                product = np.matmul(self.kernels[response][index], projected[index])
                if response.sign_y > 0:
                    projection_sum += product
                else:  # times i
                    projection_sum[..., 0] -= product[..., 1]
                    projection_sum[..., 1] += product[..., 0]
            terms.append(moments.T @ np.ascontiguousarray(projection_sum.transpose(1, 0, 2)).reshape(len(moments), -1))
        return np.asarray(self._unfold(terms, cell_count, direction.sign_x).view(np.complex128) / self.cell)

    def _fold(self, values: FloatArray, sign_x: int) -> list[FloatArray]:
        """Sum and difference of the cells on either side of the middle, by parity; with one end, the cells."""
        if len(self.parities) == 1:
            return [values]
        cell_count = values.shape[0]
        half_count = (cell_count + 1) // 2
        near_cells, far_cells = values[:half_count], values[::-1][:half_count]
        even_part, odd_part = near_cells + far_cells, near_cells - far_cells
        if cell_count % 2:  # the middle cell is its own image
            even_part[-1] *= 0.5
        return [even_part, odd_part] if sign_x > 0 else [odd_part, even_part]

    def _unfold(self, parity_values: list[FloatArray], cell_count: int, sign_x: int) -> FloatArray:
        """Undo `_fold`, up to its factor."""
        if len(parity_values) == 1:
            return parity_values[0]
        even_part, odd_part = parity_values if sign_x > 0 else parity_values[::-1]
        values = np.empty((cell_count, even_part.shape[1]))
        np.add(even_part, odd_part, out=values[: even_part.shape[0]])
        np.subtract(even_part[: cell_count // 2], odd_part[: cell_count // 2], out=values[::-1][: cell_count // 2])
        return values

    def coarsen(self) -> EndCorrection:
        """Return the correction on cells of twice the size, for a first guess: the lower half of the wavenumbers."""
        coarse_moments_of: dict[Load, list[FloatArray]] = {}
        for direction, moments in self.moments.items():
            coarse_moments = []
            for parity, fine in zip(self.parities, moments, strict=True):
                if parity and fine.shape[1] % 2:  # the middle cell of the coarse grid lies on both sides
                    fine = np.hstack([fine, parity * direction.sign_x * fine[:, -1:]])
                coarse_moments.append(fine[:, ::2] + fine[:, 1::2])
            coarse_moments_of[direction] = coarse_moments
        coarse_kernels = {
            response: [kernel[: (len(kernel) - 1) // 2 + 1] for kernel in kernels]
            for response, kernels in self.kernels.items()
        }
        return EndCorrection(self.parities, coarse_moments_of, coarse_kernels, 2 * self.cell)

    @classmethod
    def on_grid(cls, grid: Grid, ends: EndKernel) -> EndCorrection:
        """Correction on uniform cells that begin at ``x = 0``."""
        near_count = (grid.cells_x + 1) // 2
        parities, side_moments = ends.request.parities, ends.moments(grid.x_edges)
        moments = {
            direction: [
                np.ascontiguousarray(
                    sum_of_ends(side_moments, parity * direction.sign_x)[:, : near_count if parity else None]
                )
                for parity in parities
            ]
            for direction in dict.fromkeys(chain.from_iterable(ends.samples))
        }
        return cls(parities, moments, ends.samples, grid.dx)
