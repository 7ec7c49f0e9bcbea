"""What the free ends add to the normal displacement of the top, between positions graded towards the ends.

V leaves no normal displacement on the top, so the body sinks as H does under ``P_h = p + R``. Of this the part under
``p`` is the mirrored half-space; the part under ``R`` is, for each wavenumber along y and each parity,

    u(x) = C p,   C(x, x') = c at(x)^T (1 / scale - N)^-1 at(x'),   at(x; k_z) = (4/pi) sum M cosine(x) / k

(equations.py): a symmetric operator, smooth but for the ends. C is sampled at positions graded towards them and
transformed along y to the wavenumbers of the zero-padded grid, once per body and window. Far along y a finite-length
body is a plate in plane stress, so C grows like ``1 / k_y``: the displacement is stated relative to the top far away,
at ``|y| = reference``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import FreedEnds
from contactstudy.cache import kept
from contactstudy.checks import FloatArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.axial import AxialModes
from contactstudy.overlapping.equations import EquationSet
from contactstudy.overlapping.lateral import POLES_ALONE, LateralPanel, lateral_panels
from contactstudy.overlapping.panels import POSITIONS_PER_PANEL, cell_moments, graded_positions
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.overlapping.single_mirror import SingleMirrorModes, modes_between_ends

MORE_NODES = 3
"""Wavenumbers along y per panel beyond those for a field: an operator is built once for every load. Accuracy."""


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
    loads : tuple of Load
        Directions of the loads that it will be applied to.
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
    loads: tuple[Load, ...]
    reference: float
    resolution: Resolution

    @classmethod
    def of(
        cls,
        freed: FreedEnds,
        material: Material,
        grid: Grid,
        loads: tuple[Load, ...],
        reference: float,
        resolution: Resolution,
    ) -> EndRequest:
        """Request of a grid that begins at ``x = 0``; cells of any width along x share it."""
        finest = grid.dx
        if not grid.uniform:
            # Next to a loaded end the pressure follows the ends' part down to some hundredths of the contact's width.
            at_ends = min(grid.widths[0], grid.widths[-1]) if np.isfinite(freed.length) else grid.widths[0]
            finest = grid.dy / FINER if at_ends <= 2 * grid.dy else grid.dy
        return cls(freed, material, grid.dy, grid.cells_y, grid.x_range[1], finest, loads, reference, resolution)

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
    samples : dict of Load to list of array (wavenumber, position, position)
        Per parity, displacement at the positions from a load there, without the factor i of a load along y.
    """

    request: EndRequest
    edges: FloatArray
    positions: FloatArray
    samples: Mapping[Load, list[FloatArray]]

    def moments(self, parity: int, cell_edges: FloatArray) -> FloatArray:
        """Integrals over the cells of the polynomials on the positions: array (position, cell)."""
        one_side = cell_moments(self.edges, self.positions, cell_edges)
        if not parity:
            return one_side
        length = self.request.freed.length
        return np.asarray(
            one_side + parity * cell_moments(self.edges, self.positions, length - cell_edges[::-1])[:, ::-1]
        )

    def between(self, load: Load, cell_edges: FloatArray) -> FloatArray:
        """Displacement averaged over cells from forces on cells: array (wavenumber, cell, cell)."""
        total: FloatArray = np.zeros(())
        for parity, kernel in zip(self.request.parities, self.samples[load], strict=True):
            means = self.moments(parity, cell_edges) / np.diff(cell_edges)
            total = total + means.T @ kernel @ means
        return total

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        return sum(array.nbytes for array in chain.from_iterable(self.samples.values()))


def _sampled(
    modes: AxialModes,
    wavenumber: float,
    positions: FloatArray,
    material: Material,
    shortest: float,
    resolution: Resolution,
    loads: Sequence[Load],
) -> list[FloatArray]:
    """Correction between the graded positions at one wavenumber, from each of the loads."""
    sources = modes.load_weights[:, None] * modes.cosine(positions)
    factor = (1 - material.poisson) / material.shear_modulus * (np.pi if modes.parity else np.pi / 2)
    system = EquationSet.build(modes, wavenumber, material.poisson, shortest, resolution)
    by_load = {load: system.source(load, sources) for load in dict.fromkeys((Load.NORMAL, *loads))}
    if isinstance(modes, SingleMirrorModes):  # no reciprocity: its ends carry shear
        k = np.sqrt(modes.wavenumbers**2 + wavenumber**2)
        sunk = modes.cosine(positions) * ((1 - material.poisson) / material.shear_modulus / k)[:, None]
        return [np.real(sunk.T @ system.on_top(system.solve(by_load[load]))) for load in loads]
    # By reciprocity, what a unit pressure leaves on the ends tells how far they sink the top.
    return [factor * by_load[Load.NORMAL].T @ system.solve(by_load[load]) for load in loads]


@kept("end kernels", lambda kernel: kernel.nbytes)
def end_kernel(request: EndRequest) -> EndKernel:
    """Kernel of the ends of a body."""
    length, mirrored_once = request.freed
    relative = np.isfinite(length) and not mirrored_once
    window = 2 * request.dy * request.cells_y
    shortest = 0.5 * request.finest
    first = POLES_ALONE / min(length, 4 * max(request.span, window))
    # So far that a load on a single cell at the edge is right to 1e-4 there; smooth ones need half of it.
    last = 2 * max(2.0 * np.pi / request.dy, 6.0 / request.finest)
    finer = replace(request.resolution, lateral_nodes=request.resolution.lateral_nodes + MORE_NODES)
    panels = lateral_panels(first, 0.5 * window, last, finer, request.reference if relative else None)
    half = 0.5 * length if np.isfinite(length) else request.span
    edges, positions = graded_positions(half, shortest, POSITIONS_PER_PANEL)
    samples = _samples(request, panels, positions, shortest)
    even, odd = _lateral_transforms(panels, request.dy, request.cells_y)
    spread = {
        load: [np.tensordot(even if load.sign_y > 0 else odd, own, axes=1) for own in samples[:, i]]
        for i, load in enumerate(request.loads)
    }
    return EndKernel(request, edges, positions, spread)


def _samples(request: EndRequest, panels: Sequence[LateralPanel], positions: FloatArray, shortest: float) -> FloatArray:
    """Sample the kernel at the panels' wavenumbers: array (parity, load, wavenumber, position, position)."""
    (length, mirrored_once), material, resolution = request.freed, request.material, request.resolution
    count = sum(panel.nodes.size for panel in panels)
    samples = np.empty((len(request.parities), len(request.loads), count, positions.size, positions.size))
    i = 0
    for panel in panels:
        smallest = float(panel.nodes[0])
        modes = modes_between_ends(length, smallest, shortest, resolution, mirrored_once=mirrored_once)
        for wavenumber in panel.nodes:
            for number, (parity, mode) in enumerate(zip(request.parities, modes, strict=False)):
                sampled = _sampled(mode, float(wavenumber), positions, material, shortest, resolution, request.loads)
                if mode.parity == parity:
                    samples[number, :, i] = sampled
                else:  # ends that know nothing of each other: both parities see half of either quarter space
                    samples[:, :, i] = 0.5 * np.array(sampled)
            i += 1
    return samples


def _lateral_transforms(panels: Sequence[LateralPanel], dy: float, cells_y: int) -> tuple[FloatArray, FloatArray]:
    """Matrices from samples over the wavenumber along y to the zero-padded grid's transform.

    Returns the one for even kernels and the one for odd kernels: arrays (grid wavenumber, sample).
    """
    offsets: FloatArray = dy * np.arange(cells_y + 1.0)
    columns: tuple[list[FloatArray], list[FloatArray]] = ([], [])
    for panel in panels:
        averaged = dy * np.sinc(panel.fine * dy / (2 * np.pi))
        for waves, gathered in zip(panel.waves(offsets), columns, strict=True):
            cells = waves.T * averaged
            gathered.append(cells if panel.interpolation is None else cells @ panel.interpolation)
    cosine, sine = (np.concatenate(gathered, axis=1) for gathered in columns)
    size = cells_y
    turns = np.cos(np.pi * np.outer(np.arange(size + 1), np.arange(size + 1)) / size)
    twists = np.sin(np.pi * np.outer(np.arange(size + 1), np.arange(size + 1)) / size)
    ends = np.full(size + 1, 2.0)
    ends[0] = ends[-1] = 1.0
    # An odd kernel -sin(k y) has the transform 2i sum sin sin; with its factor i taken outside, +2 sum sin sin.
    ends_odd = np.where(ends == 1.0, 0.0, 2.0)
    return (turns * ends) @ cosine, (twists * ends_odd) @ sine
