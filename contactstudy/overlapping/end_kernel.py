"""What the free ends add to the displacements of the top, between positions graded towards the ends.

V leaves no normal displacement on the top, so the body sinks as H does under ``P_h = p + R``. Of this the part under
``p`` is the mirrored half-space; the part under ``R`` is, for each wavenumber along y and each parity,

    u(x) = C p,   C(x, x') = c at(x)^T (1 / scale - N)^-1 at(x'),   at(x; k_z) = (4/pi) sum M cosine(x) / k

(equations.py): a symmetric operator, smooth but for the ends. The same holds for all nine pairs of displacements and
loads. Let the mirrored half-space under load i leave the normal stress ``s_i`` on the ends, where it has no shear and
no displacement along x. By the reciprocity of that state and of the one that frees the ends from ``s_j``, the work of
load i on what freeing the ends from load j adds to the top is ``s_i^T G s_j``, with the symmetric compliance G of the
ends: the same ``c (1 / scale - N)^-1``, between the sources of load i and load j.

C is sampled at positions graded towards the ends and transformed along y to the wavenumbers of the zero-padded grid,
once per body and window. Far along y a finite-length body is a plate in plane stress, so C grows like ``1 / k_y``: the
displacement is stated relative to the top far away, at ``|y| = reference``. A force along x bends that plate, and the
displacement along x grows like ``1 / k_y**3``: its curvature is zero there as well.
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
from contactstudy.bodies.models import FreedEnds
from contactstudy.cache import kept
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.kernels.load import Load, Response
from contactstudy.overlapping.axial import AxialModes
from contactstudy.overlapping.equations import EquationSet
from contactstudy.overlapping.lateral import ALONE, BENDING_POLES, POLES, LateralPanel, lateral_panels
from contactstudy.overlapping.panels import POSITIONS_PER_PANEL, cell_moments, graded_positions
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.overlapping.single_mirror import SingleMirrorModes, modes_between_ends

MORE_NODES = 2
"""Wavenumbers along y per panel beyond those for a field: an operator is built once for every load. Accuracy."""

STEEPER = 1.25
"""Angle of the axial ray, and step along it, over those for a field: no ray of depths limits it. Speed."""

FINER = 8
"""Cells along y over the distance from an end down to which the kernel is resolved if cells along x are narrow there.
Accuracy."""


class EndRequest(NamedTuple):
    """What decides the kernel of the ends.

    Attributes
    ----------
    freed : FreedEnds
        Ends, at 0 and at its length (infinite: one end).
    material : Material
        Elastic constants.
    dy, cells_y : float, int
        Cell size along y, metres, and number of cells.
    span : float
        Length that the cells cover from ``x = 0``, metres.
    finest : float
        Distance from the ends down to which the kernel is resolved, metres.
    responses : tuple of Response
        Pairs of displacement and load that it will be asked for.
    reference : float
        Distance along y at which the displacement of a finite-length body is zero, metres.
    resolution : Resolution
        Quadrature settings.
    """

    freed: FreedEnds
    material: Material
    dy: float
    cells_y: int
    span: float
    finest: float
    responses: tuple[Response, ...]
    reference: float
    resolution: Resolution

    @classmethod
    def of(
        cls,
        freed: FreedEnds,
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
            at_ends = min(grid.widths[0], grid.widths[-1]) if np.isfinite(freed.length) else grid.widths[0]
            finest = grid.dy / FINER if at_ends <= 2 * grid.dy else grid.dy
        resolution = resolution.for_loads(chain.from_iterable(responses))
        resolution = replace(
            resolution,
            angle=STEEPER * resolution.angle,
            step=STEEPER * resolution.step,
            lateral_nodes=resolution.lateral_nodes + MORE_NODES,
        )
        return cls(freed, material, grid.dy, grid.cells_y, grid.x_range[1], finest, responses, reference, resolution)

    @property
    def parities(self) -> tuple[int, ...]:
        """Parities that the ends do not mix."""
        return (1, -1) if np.isfinite(self.freed.length) else (0,)


@dataclass(frozen=True, eq=False)
class EndKernel:
    """The ends' part of the displacement between graded positions.

    Attributes
    ----------
    request : EndRequest
        What it was made for.
    edges, positions : array
        Panels along x, from end I to mid-length (or over the span), and Gauss positions in them.
    samples : dict of Response to list of array (wavenumber, position, position)
        Per parity, displacement at the positions from a load there, without the factor i of kernels odd along y.
    """

    request: EndRequest
    edges: FloatArray
    positions: FloatArray
    samples: Mapping[Response, list[FloatArray]]

    def add_to(self, kernel: FloatArray, response: Response, cell_edges: FloatArray) -> None:
        """Add the displacement averaged over cells from forces on cells to an array (wavenumber, cell, cell)."""
        widths = np.diff(cell_edges)
        sides = self.moments(cell_edges)
        for parity, samples in zip(self.request.parities, self.samples[response], strict=True):
            seen, loaded = (seen_alike(sides, parity * direction.sign_x) / widths for direction in response)
            for total, sampled in zip(kernel, samples, strict=True):
                total += seen.T @ sampled @ loaded

    def moments(self, cell_edges: FloatArray) -> list[FloatArray]:
        """Integrals over the cells of the polynomials on the positions, from each end: arrays (position, cell)."""
        sides = [cell_moments(self.edges, self.positions, cell_edges)]
        length = self.request.freed.length
        if np.isfinite(length):
            sides.append(cell_moments(self.edges, self.positions, length - cell_edges[::-1])[:, ::-1])
        return sides

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        return sum(array.nbytes for array in chain.from_iterable(self.samples.values()))


def seen_alike(sides: list[FloatArray], sign: int) -> FloatArray:
    """Sum of what both ends see of a load whose mirror image is `sign` times it; what one end sees if it is alone."""
    return np.asarray(sides[0] + sign * sides[1]) if len(sides) > 1 else sides[0]


@dataclass(frozen=True, eq=False)
class Waves:
    """Positions as axial modes see them: shared by all wavenumbers along y that these modes serve.

    Attributes
    ----------
    modes : AxialModes
        The modes.
    positions : array
        Positions within their reach, metres.
    by_load : dict of Load to array (mode, position)
        Weighted spectra of unit loads at the positions.
    """

    modes: AxialModes
    positions: FloatArray
    by_load: Mapping[Load, ComplexArray]

    @classmethod
    def of(cls, modes: AxialModes, positions: FloatArray, responses: Sequence[Response]) -> Waves:
        """Waves for all directions of some responses."""
        within = positions[positions <= modes.reach]
        directions = dict.fromkeys(
            chain.from_iterable((response.load, response.displacement) for response in responses)
        )
        weights = modes.load_weights[:, None]
        by_load = {load: weights * modes.wave(load, within) for load in directions}
        return cls(modes, within, by_load)


def sampled_kernel(waves: Waves, wavenumber: float, request: EndRequest, shortest: float) -> list[FloatArray]:
    """Correction between the graded positions within reach at one wavenumber, for each of the responses."""
    modes, material, responses = waves.modes, request.material, request.responses
    factor = (1 - material.poisson) / material.shear_modulus * (np.pi if modes.parity else np.pi / 2)
    system = EquationSet.build(modes, wavenumber, material.poisson, shortest, request.resolution)
    loads = dict.fromkeys(response.load for response in responses)
    if isinstance(modes, SingleMirrorModes):  # no reciprocity: its ends carry shear
        k = np.sqrt(modes.wavenumbers**2 + wavenumber**2)
        sunk = modes.cosine(waves.positions) * ((1 - material.poisson) / material.shear_modulus / k)[:, None]
        top = {load: system.on_top(system.solve(system.source(load, waves.by_load[load]))) for load in loads}
        return [np.real(sunk.T @ top[response.load]) for response in responses]
    left = {load: system.source(load, spectrum) for load, spectrum in waves.by_load.items()}
    freed = {load: system.solve(left[load]) for load in loads}
    kernels = []
    for displacement, load in responses:
        kernel = left[displacement].T @ freed[load]
        if displacement in freed:  # rounding is all that reciprocity lacks, but between two ends it is amplified
            back = kernel if displacement is load else left[load].T @ freed[displacement]
            kernel = 0.5 * (kernel + back.T)
        kernels.append(factor * _phase(Response(displacement, load)) * kernel)
    return kernels


def _phase(response: Response) -> int:
    """Sign of a kernel without its factor i: work is done by the conjugate of what leaves ``i s`` on the ends."""
    return -1 if response.displacement.sign_y < 0 < response.load.sign_y else 1


@kept("end kernels", lambda kernel: kernel.nbytes)
def end_kernel(request: EndRequest) -> EndKernel:
    """Kernel of the ends of a body."""
    length, mirrored_once = request.freed
    relative = np.isfinite(length) and not mirrored_once
    window = 2 * request.dy * request.cells_y
    shortest = 0.5 * request.finest
    # So far that a load on a single cell at the edge is right to 1e-4 there; smooth ones need half of it.
    last = 2 * max(2.0 * np.pi / request.dy, 6.0 / request.finest)
    reference = request.reference if relative else None
    half = 0.5 * length if np.isfinite(length) else request.span
    edges, positions = graded_positions(half, shortest, POSITIONS_PER_PANEL)
    spread: dict[Response, list[FloatArray]] = {}
    known: dict[float, FloatArray] = {}  # samples at wavenumbers that kernels with either pole share
    for poles in sorted({_poles(response) for response in request.responses}):
        first = ALONE[poles] / min(length, 4 * max(request.span, window))
        panels = lateral_panels(first, 0.5 * window, last, request.resolution, reference, poles)
        own = [response for response in request.responses if _poles(response) == poles]
        numbers = [request.responses.index(response) for response in own]
        size, parities = positions.size, len(request.parities)
        totals = np.zeros((len(own), parities, request.cells_y + 1, size**2))
        for panel, even, odd in _lateral_transforms(panels, request.dy, request.cells_y):
            samples = np.zeros((len(own), parities, panel.nodes.size, size, size))
            for at, sampled in enumerate(_samples(request, panel, positions, shortest, known)):
                reach = sampled.shape[-1]
                samples[:, :, at, :reach, :reach] = sampled[:, numbers].swapaxes(0, 1)
            for response, total, own_samples in zip(own, totals, samples, strict=True):
                for sums, each in zip(total, own_samples, strict=True):
                    add_product(sums, even if response.sign_y > 0 else odd, each.reshape(-1, size**2))
        shape = (request.cells_y + 1, size, size)
        for response, total in zip(own, totals, strict=True):
            spread[response] = [sums.reshape(shape) for sums in total]
    return EndKernel(request, edges, positions, spread)


def _poles(response: Response) -> int:
    """Order of a response's pole at wavenumber 0 along y."""
    return BENDING_POLES if Load.ALONG_X in response else POLES


def _samples(
    request: EndRequest, panel: LateralPanel, positions: FloatArray, shortest: float, known: dict[float, FloatArray]
) -> Iterator[FloatArray]:
    """Kernel at each of a panel's wavenumbers, if not yet `known`: arrays (parity, response, position, position).

    The positions are those within reach of either end.
    """
    length, mirrored_once = request.freed
    smallest = float(panel.nodes[0])
    modes = modes_between_ends(length, smallest, shortest, request.resolution, mirrored_once=mirrored_once)
    waves = [Waves.of(mode, positions, request.responses) for mode in modes]
    shared = len({_poles(response) for response in request.responses}) > 1
    for wavenumber in panel.nodes.tolist():
        sampled = known.get(wavenumber)
        if sampled is None:
            sampled = np.array([sampled_kernel(each, wavenumber, request, shortest) for each in waves])
            # Ends that know nothing of each other: both parities see half of either quarter space.
            if len(request.parities) > len(modes):
                sampled = 0.5 * np.repeat(sampled, 2, axis=0)
            if shared:
                known[wavenumber] = sampled
        yield sampled


def _lateral_transforms(
    panels: Sequence[LateralPanel], dy: float, cells_y: int
) -> Iterator[tuple[LateralPanel, FloatArray, FloatArray]]:
    """Each panel, with matrices from samples at its wavenumbers along y to the zero-padded grid's transform.

    They are for even and for odd kernels: arrays (grid wavenumber, sample).
    """
    offsets: FloatArray = dy * np.arange(cells_y + 1.0)
    phase = np.pi * np.outer(np.arange(cells_y + 1), np.arange(cells_y + 1)) / cells_y
    ends = np.full(cells_y + 1, 2.0)
    ends[0] = ends[-1] = 1.0
    # An odd kernel -sin(k y) has the transform 2i sum sin sin; with its factor i taken outside, +2 sum sin sin.
    transforms = np.cos(phase) * ends, np.sin(phase) * np.where(ends == 1.0, 0.0, 2.0)
    for panel in panels:
        averaged = dy * np.sinc(panel.fine * dy / (2 * np.pi))
        even, odd = (
            transform @ (waves.T * averaged) for transform, waves in zip(transforms, panel.waves(offsets), strict=True)
        )
        if panel.interpolation is not None:
            even, odd = even @ panel.interpolation, odd @ panel.interpolation
        yield panel, even, odd


def add_product(total: FloatArray, left: FloatArray, right: FloatArray) -> None:
    """Add ``left @ right`` to `total`, a contiguous array, in its place."""
    # Of arrays in Fortran's order, as their transposes are, none is copied.
    linalg.blas.dgemm(1.0, right.T, np.ascontiguousarray(left).T, 1.0, total.T, overwrite_c=True)
