"""What the free ends add to the normal displacement of the top: a symmetric operator, compressed.

V leaves no normal displacement on the top, so the body sinks as H does under ``P_h = p + R``. Of this the part under
``p`` is the mirrored half-space; the part under ``R`` is, for each wavenumber along y and each parity,

    u(x) = C p,   C(x, x') = c at(x)^T (1 / scale - N)^-1 at(x'),   at(x; k_z) = (4/pi) sum M cosine(x) / k

(equations.py). C is sampled at positions graded towards the ends and transformed along y to the wavenumbers of the
zero-padded grid, once per body and grid. Far along y a finite-length body is a plate in plane stress, so C grows like
``1 / k_y``: the displacement is stated relative to the top far away, at ``|y| = reference``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.axial import AxialModes
from contactstudy.overlapping.equations import EquationSet
from contactstudy.overlapping.lateral import POLES_ALONE, LateralPanel, lateral_panels
from contactstudy.overlapping.panels import POSITIONS_PER_PANEL, cell_moments, graded_positions
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.overlapping.single_mirror import SingleMirrorModes, modes_between_ends

MORE_NODES = 3
"""Wavenumbers along y per panel beyond those for a field: an operator is built once for every load. Accuracy."""


@dataclass(frozen=True, eq=False)
class EndCorrection:
    """The ends' part of the displacement, acting on transforms along y of the zero-padded grid.

    Attributes
    ----------
    moments : list of array (position, cell)
        Per parity, from cells to graded positions. Two parities know the cells up to the middle only: those beyond
        are folded onto them.
    kernels : dict of Load to list of array (wavenumber, position, position)
        Per parity, displacement at the graded positions from a load there, without the factor i of a load along y.
    cell : float
        Cell size along x.
    """

    moments: list[FloatArray]
    kernels: Mapping[Load, list[FloatArray]]
    cell: float

    def apply(self, load: Load, transform: ComplexArray) -> ComplexArray:
        """Correction from the transform (cell, wavenumber) of a load."""
        phase = 1.0 if load.sign_y > 0 else 1j
        cells = transform.shape[0]
        # The operator is real: real products on pairs of real and imaginary part are four times faster.
        pairs = np.ascontiguousarray(transform).view(np.float64)
        sunk = [
            moments.T @ self._between(kernel, moments @ part)
            for moments, kernel, part in zip(self.moments, self.kernels[load], self._folded(pairs), strict=True)
        ]
        return np.asarray(self._unfolded(sunk, cells).view(np.complex128) * (phase / self.cell))

    @staticmethod
    def _between(kernel: FloatArray, sources: FloatArray) -> FloatArray:
        """Apply a kernel (wavenumber, position, position) to pairs (position, wavenumber and part)."""
        positions = sources.shape[0]
        sunk = np.matmul(kernel, sources.reshape(positions, -1, 2).transpose(1, 0, 2))
        return np.asarray(sunk.transpose(1, 0, 2).reshape(positions, -1))

    def _folded(self, values: FloatArray) -> list[FloatArray]:
        """Sum and difference of the cells on either side of the middle; with one end, the cells themselves."""
        if len(self.moments) == 1:
            return [values]
        cells = values.shape[0]
        half = (cells + 1) // 2
        near, far = values[:half], values[::-1][:half]
        even, odd = near + far, near - far
        if cells % 2:  # the middle cell has met itself
            even[-1] *= 0.5
        return [even, odd]

    @staticmethod
    def _unfolded(parts: list[FloatArray], cells: int) -> FloatArray:
        """Undo `_folded`, up to its factor."""
        if len(parts) == 1:
            return parts[0]
        even, odd = parts
        values = np.empty((cells, even.shape[1]))
        np.add(even, odd, out=values[: even.shape[0]])
        np.subtract(even[: cells // 2], odd[: cells // 2], out=values[::-1][: cells // 2])
        return values

    def coarsened(self) -> EndCorrection:
        """Return the correction on cells of twice the size: good enough for a first guess, and made in no time.

        The lower half of the wavenumbers is the coarse grid's, but for the small part that its cells alias.
        """
        moments = []
        for parity, fine in zip((1, -1) if len(self.moments) == 2 else (0,), self.moments, strict=True):
            if parity and fine.shape[1] % 2:  # the middle cell of the coarse grid lies on both sides
                fine = np.hstack([fine, parity * fine[:, -1:]])
            moments.append(fine[:, ::2] + fine[:, 1::2])
        lower = {
            load: [kernel[: (len(kernel) - 1) // 2 + 1] for kernel in kernels] for load, kernels in self.kernels.items()
        }
        return EndCorrection(moments, lower, 2 * self.cell)

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        return sum(array.nbytes for array in (*self.moments, *chain.from_iterable(self.kernels.values())))


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


def build_end_correction(
    length: float,
    material: Material,
    grid: Grid,
    loads: Sequence[Load],
    *,
    reference: float,
    resolution: Resolution,
    mirrored_once: bool = False,
) -> EndCorrection:
    """Correction for a body with ends at 0 and `length` (infinite: one end) on a grid that begins at ``x = 0``.

    Parameters
    ----------
    length : float
        Distance between the ends, metres.
    material : Material
        Elastic constants.
    grid : Grid
        Cells; ``x_range[0]`` is 0.
    loads : sequence of Load
        Directions of the loads that it will be applied to.
    reference : float
        Distance along y at which the displacement of a finite-length body is zero, metres.
    resolution : Resolution
        Quadrature settings.
    mirrored_once : bool
        Whether loads have one pair of images only (single_mirror.py). They leave the far body at rest, so there is no
        `reference`.
    """
    relative = np.isfinite(length) and not mirrored_once
    span = grid.x_range[1]
    window = 2 * grid.dy * grid.cells_y
    shortest = 0.5 * grid.dx
    first = POLES_ALONE / min(length, 4 * max(span, window))
    # So far that a load on a single cell at the edge is right to 1e-4 there; smooth ones need half of it.
    lateral_last = 2 * max(2.0 * np.pi / grid.dy, 6.0 / grid.dx)
    finer = replace(resolution, lateral_nodes=resolution.lateral_nodes + MORE_NODES)
    panels = lateral_panels(first, 0.5 * window, lateral_last, finer, reference if relative else None)
    half = 0.5 * length if np.isfinite(length) else span
    edges, positions = graded_positions(half, 0.5 * grid.dx, POSITIONS_PER_PANEL)
    cell_edges = np.linspace(0.0, span, grid.cells_x + 1)
    one_side = cell_moments(edges, positions, cell_edges)
    parities = (1, -1) if np.isfinite(length) else (0,)
    lateral = np.concatenate([panel.nodes for panel in panels])
    samples = np.empty((len(parities), len(loads), lateral.size, positions.size, positions.size))
    i = 0
    for panel in panels:
        smallest = float(panel.nodes[0])
        modes = modes_between_ends(length, smallest, shortest, resolution, mirrored_once=mirrored_once)
        for wavenumber in panel.nodes:
            for parity, mode in zip(parities, modes, strict=False):
                sampled = _sampled(mode, float(wavenumber), positions, material, shortest, resolution, loads)
                if mode.parity == parity:
                    samples[abs(parity - 1) // 2 if parity else 0, :, i] = sampled
                else:  # ends that know nothing of each other: both parities see half of either quarter space
                    samples[:, :, i] = 0.5 * np.array(sampled)
            i += 1
    even, odd = _lateral_transforms(panels, grid)
    near = (grid.cells_x + 1) // 2
    moments = [
        np.ascontiguousarray((one_side + parity * one_side[:, ::-1])[:, :near]) if parity else one_side
        for parity in parities
    ]
    kernels = {
        load: [np.tensordot(even if load.sign_y > 0 else odd, own, axes=1) for own in samples[:, i]]
        for i, load in enumerate(loads)
    }
    return EndCorrection(moments, kernels, grid.dx)


def _lateral_transforms(panels: list[LateralPanel], grid: Grid) -> tuple[FloatArray, FloatArray]:
    """Matrices from samples over the wavenumber along y to the zero-padded grid's transform.

    Returns the one for even kernels and the one for odd kernels: arrays (grid wavenumber, sample).
    """
    offsets: FloatArray = grid.dy * np.arange(grid.cells_y + 1.0)
    columns: tuple[list[FloatArray], list[FloatArray]] = ([], [])
    for panel in panels:
        averaged = grid.dy * np.sinc(panel.fine * grid.dy / (2 * np.pi))
        for waves, gathered in zip(panel.waves(offsets), columns, strict=True):
            cells = waves.T * averaged
            gathered.append(cells if panel.interpolation is None else cells @ panel.interpolation)
    cosine, sine = (np.concatenate(gathered, axis=1) for gathered in columns)
    size = grid.cells_y
    turns = np.cos(np.pi * np.outer(np.arange(size + 1), np.arange(size + 1)) / size)
    twists = np.sin(np.pi * np.outer(np.arange(size + 1), np.arange(size + 1)) / size)
    ends = np.full(size + 1, 2.0)
    ends[0] = ends[-1] = 1.0
    # An odd kernel -sin(k y) has the transform 2i sum sin sin; with its factor i taken outside, +2 sum sin sin.
    ends_odd = np.where(ends == 1.0, 0.0, 2.0)
    return (turns * ends) @ cosine, (twists * ends_odd) @ sine
