"""A load on the top of a body with free ends, expressed in axial modes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from contactstudy.arrays.grid import EDGE_ROUNDING, Grid
from contactstudy.checks import ComplexArray, FloatArray, IntArray
from contactstudy.errors import InvalidInputError
from contactstudy.kernels.load import Load
from contactstudy.overlapping.axial_modes import AxialModes, axial_modes
from contactstudy.overlapping.lateral_modes import (
    BENDING_POLES,
    NEGLIGIBLE_LOAD,
    POLE_PANEL_FACTOR,
    POLES,
    LateralColumns,
    LateralPanel,
    lateral_panels,
)
from contactstudy.overlapping.quadrature import Resolution

CORNER_OFFSET = 1e-2
"""Depth below a loaded corner, over a cell, at which points on the corner are evaluated. Accuracy. H and V each have a
logarithm at the corner; their sum is finite."""

FIRST_PANEL_FACTOR = 0.1
"""End of the first panel along ``k_y``, over the smallest length of the problem, of a field without poles. Accuracy."""

MIN_LENGTH_RATIO = 0.004
"""Least length of a body over the width of the load. Accuracy: at this length the ends keep a stress of 6e-4 of the
pressure, at a third of this length a tenth."""


@dataclass(frozen=True, kw_only=True, eq=False)
class EndProblem:
    """A distribution of load on the top of a body with one end or two, acting in one direction or in several."""

    length: float  # distance between the ends, metres; infinite for one end
    poisson: float
    cell_loads: FloatArray  # (cell_x, cell_y): load per area on the cells of `grid`, Pa
    loads: tuple[Load, ...]  # directions of the load, each a separate problem; mirror images keep all or reverse all
    grid: Grid  # cells, from ``x = 0``
    resolution: Resolution  # quadrature settings
    mirrored_once: bool = False  # whether loads have one pair of images only instead of all
    finest: float | None = None  # size of the cells of the given load, metres, if `grid` is finer

    def __post_init__(self) -> None:
        loaded_rows = np.flatnonzero(self.cell_loads.any(axis=0))
        width = self.grid.dy * (loaded_rows[-1] - loaded_rows[0] + 1) if loaded_rows.size else 0.0
        if self.length < MIN_LENGTH_RATIO * width:
            raise InvalidInputError(
                "body.length",
                self.length,
                f"at least {MIN_LENGTH_RATIO:g} of the width of the contact, {width:.3g} m: the traction left on the "
                "ends of a thinner body exceeds 1e-3 of the pressure",
                "such a disc is in plane stress",
            )

    @cached_property
    def column_edges(self) -> FloatArray:
        """Edges of the columns, metres: edges of the cells and, between two ends, mirror images of these edges."""
        edges = self.grid.x_edges
        if self.grid.uniform or np.isinf(self.length):
            return edges
        symmetric_edges = np.union1d(edges, self.length - edges)
        symmetric_edges = symmetric_edges[np.append(True, np.diff(symmetric_edges) > EDGE_ROUNDING * self.length)]
        symmetric_edges[0], symmetric_edges[-1] = 0.0, self.length
        return np.asarray(0.5 * (symmetric_edges + self.length - symmetric_edges[::-1]))

    @cached_property
    def cell_of_column(self) -> IntArray:
        """Index of the cell that contains each column."""
        edges = self.column_edges
        cells = np.searchsorted(self.grid.x_edges, 0.5 * (edges[1:] + edges[:-1])) - 1
        return np.asarray(np.clip(cells, 0, self.grid.cells_x - 1))

    @property
    def sign_x(self) -> int:
        """1 if a mirror image keeps the loads, -1 if it reverses them."""
        return self.loads[0].sign_x

    def split_by_mirror_sign(self) -> Iterator[EndProblem]:
        """Yield the problem of loads that images keep, and the problem of loads that images reverse."""
        for sign in (1, -1):
            loads = tuple(load for load in self.loads if load.sign_x == sign)
            if loads:
                yield replace(self, loads=loads, resolution=self.resolution.for_loads(loads))

    @property
    def corner_offset(self) -> float:
        """Least distance of evaluated positions from the corner, metres."""
        return CORNER_OFFSET * self.finest_size

    @property
    def finest_size(self) -> float:
        """Size of a cell, metres; of graded cells the size along y."""
        return self.finest or finest_cell(self.grid)

    def smallest_scale(self, nearest: float) -> float:
        """Smallest relevant distance from a corner, for positions at least `nearest` from the corner, metres."""
        # A field depends on the steps of the load near a corner, at distant positions as well; every edge is
        # included, so that fields of loads add up.
        inner_edges = self.column_edges[1:-1]
        return max(min(nearest, float(self.from_end(inner_edges).min(initial=nearest))), self.corner_offset)

    def from_end(self, x: FloatArray) -> FloatArray:
        """Distance of positions from the nearest end."""
        return np.minimum(x, self.length - x)

    def panels(self, y: FloatArray, shortest: float, reference: float | None = None) -> list[LateralPanel]:
        """Panels along ``k_y`` for points at `y` no nearer than `shortest` to a loaded corner."""
        grid = self.grid
        max_distance = max(map(abs, grid.y_range)) + np.abs(y).max()
        poles = BENDING_POLES if self.sign_x < 0 else POLES
        first_panel_factor = FIRST_PANEL_FACTOR if reference is None else POLE_PANEL_FACTOR[poles]
        first_wavenumber = first_panel_factor / min(self.length, 4 * max(grid.x_range[1], max_distance))
        # Along y the load is uniform in cells: half a cell is the finest scale.
        last_wavenumber = self.resolution.lateral_reach / max(shortest, 0.5 * self.finest_size)
        return lateral_panels(first_wavenumber, max_distance, last_wavenumber, self.resolution, reference, poles=poles)


def finest_cell(grid: Grid) -> float:
    """Size of a cell, metres; of graded cells the size along y."""
    return min(grid.dx, grid.dy) if grid.uniform else grid.dy


def split_by_parity(cell_loads: FloatArray, sign_x: int) -> dict[int, FloatArray]:
    """Even (1) and odd (-1) parts of a load (x, y) about mid-length, if not negligible; `sign_x` -1 swaps the parts."""
    parity_loads = {parity: 0.5 * (cell_loads + sign_x * parity * cell_loads[::-1]) for parity in (1, -1)}
    min_amplitude = NEGLIGIBLE_LOAD * np.abs(cell_loads).max()
    return {
        parity: parity_load for parity, parity_load in parity_loads.items() if np.abs(parity_load).max() > min_amplitude
    }


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """A load and positions in one set of axial modes; from end II when `flipped`."""

    # `spectra`: (axial wavenumber, node or 1, column); `columns`: their indices; `rows`, `x`: positions within reach,
    # and their distances from the end.

    modes: AxialModes
    spectra: ComplexArray
    columns: IntArray
    rows: IntArray
    x: FloatArray
    cosine: ComplexArray
    sine: ComplexArray
    flipped: bool


def make_views(problem: EndProblem, load: LateralColumns, x: FloatArray, shortest: float) -> list[View]:
    """Return views of a load and of positions `x`, one per set of axial modes."""
    # Ends too far apart to interact are two quarter spaces; a load split by parity has positions in the first half.
    length, edges = problem.length, problem.column_edges
    is_split = bool(load.parities.all())
    views = []
    for modes in axial_modes(
        length, float(load.nodes[0]), shortest, problem.resolution, mirrored_once=problem.mirrored_once
    ):
        columns = np.flatnonzero((load.parities == modes.parity) | (load.parities == 0) | (modes.parity == 0))
        if not columns.size:
            continue
        integrals = modes.load_weights[:, None] * modes.cell_integrals(problem.loads[0], edges)
        for flipped in (False, True) if np.isfinite(length) and not modes.parity and not is_split else (False,):
            end_integrals = problem.sign_x * integrals[:, ::-1] if flipped else integrals
            distance = length - x if flipped else x
            rows = np.flatnonzero(distance <= modes.reach)
            distance = distance[rows]
            views.append(
                View(
                    modes=modes,
                    spectra=np.tensordot(end_integrals, load.along_x[..., columns], axes=1),
                    columns=columns,
                    rows=rows,
                    x=distance,
                    cosine=modes.cosine(distance),
                    sine=modes.sine(distance),
                    flipped=flipped,
                )
            )
    return views
