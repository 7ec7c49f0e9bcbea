"""What the free ends are asked to do: a load on the top, in harmonics along y, as each set of axial modes sees it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.cache import kept
from contactstudy.checks import ComplexArray, FloatArray, IntArray
from contactstudy.errors import InvalidInputError
from contactstudy.kernels.load import Load
from contactstudy.overlapping.axial import AxialModes
from contactstudy.overlapping.equations import AuxiliaryLoads, EquationSet
from contactstudy.overlapping.lateral import (
    ALONE,
    BENDING_POLES,
    NEGLIGIBLE,
    POLES,
    LateralColumns,
    LateralPanel,
    lateral_columns,
    lateral_panels,
)
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.overlapping.single_mirror import modes_between_ends

CORNER_OFFSET = 1e-2
"""Part of a cell below a loaded corner where points on the corner itself are evaluated. Accuracy. H and V each have a
logarithm there, of which only the sum is finite."""

SAME_EDGE = 1e-12
"""Part of the length by which an edge and the image of another may differ and be the same. Accuracy."""

FIRST = 0.1
"""End of the first panel along ``k_y``, over the smallest length of the problem, of a field without poles. Accuracy."""

THINNEST = 0.004
"""Least length of a body over the width of the load. Accuracy: at this one the ends keep 6e-4 of the pressure, at a
third of it a tenth."""


class _EquationSetRequest(NamedTuple):
    """What decides an equation set."""

    modes: AxialModes
    lateral: float
    poisson: float
    shortest: float
    resolution: Resolution


@kept("equation sets", lambda system: system.nbytes)
def _equation_set(request: _EquationSetRequest) -> EquationSet:
    """Equation set of some axial wavenumbers at one wavenumber along y."""
    return EquationSet.build(*request)


@dataclass(frozen=True, eq=False)
class EndProblem:
    """A distribution of load on the top of a body with one end or two, acting in one direction or in several.

    Attributes
    ----------
    length : float
        Distance between the ends, metres; infinite for one end.
    poisson : float
        Poisson's ratio.
    cells : array (cell_x, cell_y)
        Load per area on the cells of `grid`, Pa.
    loads : tuple of Load
        Directions in which it acts, each a problem for itself; all kept, or all reversed, by their mirror images.
    grid : Grid
        Cells, from ``x = 0``.
    resolution : Resolution
        Quadrature settings.
    mirrored_once : bool
        Whether loads have one pair of images only (single_mirror.py) instead of all.
    finest : float, optional
        Size of the cells on which the load is known, metres, where those of `grid` only make it smooth.
    """

    length: float
    poisson: float
    cells: FloatArray
    loads: tuple[Load, ...]
    grid: Grid
    resolution: Resolution
    mirrored_once: bool = False
    finest: float | None = None

    def __post_init__(self) -> None:
        """Refuse a body too thin for its ends to be freed by these quadratures."""
        loaded = np.flatnonzero(self.cells.any(axis=0))
        width = self.grid.dy * (loaded[-1] - loaded[0] + 1) if loaded.size else 0.0
        if self.length < THINNEST * width:
            raise InvalidInputError(
                "body.length",
                self.length,
                f"at least {THINNEST:g} of the width of the contact, {width:.3g} m: the traction left on the ends of a "
                "thinner body exceeds 1e-3 of the pressure",
                "such a disc is in plane stress",
            )

    @cached_property
    def columns(self) -> tuple[FloatArray, FloatArray]:
        """Edges along x, metres, and the load between them; symmetric about mid-length where there are two ends."""
        edges = self.grid.x_edges
        if self.grid.uniform or np.isinf(self.length):
            return edges, self.cells
        both = np.union1d(edges, self.length - edges)
        both = both[np.append(True, np.diff(both) > SAME_EDGE * self.length)]
        both[0], both[-1] = 0.0, self.length
        both = 0.5 * (both + self.length - both[::-1])
        own = np.clip(np.searchsorted(edges, 0.5 * (both[1:] + both[:-1])) - 1, 0, self.cells.shape[0] - 1)
        return both, self.cells[own]

    @property
    def sign_x(self) -> int:
        """1 if a mirror image keeps the loads, -1 if it reverses them."""
        return self.loads[0].sign_x

    def alike(self) -> Iterator[EndProblem]:
        """Yield the same for loads that images keep, and for those that they reverse: they differ in every wave."""
        for sign in (1, -1):
            loads = tuple(load for load in self.loads if load.sign_x == sign)
            if loads:
                yield replace(self, loads=loads, resolution=self.resolution.for_loads(loads))

    def axial_modes(self, lateral: float, shortest: float) -> list[AxialModes]:
        """Axial modes for wavenumbers along y from `lateral` on, see `modes_between_ends`."""
        return modes_between_ends(self.length, lateral, shortest, self.resolution, mirrored_once=self.mirrored_once)

    @property
    def corner_offset(self) -> float:
        """Distance from the corner below which nothing is evaluated, metres."""
        return CORNER_OFFSET * self._finest

    @property
    def _finest(self) -> float:
        """Size of a cell, metres; of graded cells, of which the narrow ones vary along x only, the one along y."""
        return self.finest or finest_cell(self.grid)

    def from_end(self, x: FloatArray) -> FloatArray:
        """Distance of positions from the nearest end."""
        return np.minimum(x, self.length - x)

    def panels(self, y: FloatArray, shortest: float, reference: float | None = None) -> list[LateralPanel]:
        """Panels along ``k_y`` for points at `y` no nearer than `shortest` to a loaded corner."""
        grid = self.grid
        loaded = np.abs(grid.y[self.cells.any(axis=0)]).max(initial=0.0) + 0.5 * grid.dy
        reach = loaded + np.abs(y).max()
        poles = BENDING_POLES if self.sign_x < 0 else POLES
        alone = FIRST if reference is None else ALONE[poles]
        first = alone / min(self.length, 4 * max(grid.x_range[1], reach))
        # Along y the load is known to the cell only; finer than half a cell there is nothing to resolve.
        last = self.resolution.lateral_reach / max(shortest, 0.5 * self._finest)
        return lateral_panels(first, reach, last, self.resolution, reference, poles)

    def batches(self, panel: LateralPanel, parts: Mapping[int, FloatArray], y: FloatArray) -> Iterator[LateralColumns]:
        """Columns of the load's `parts` within one panel, a few at a time."""
        columns = lateral_columns(panel, parts, self.grid, y)
        yield from columns.batches() if columns else ()

    def auxiliary_loads(
        self, view: View, lateral: float, number: int, shortest: float
    ) -> tuple[EquationSet, AuxiliaryLoads]:
        """Equation set and its solution at wavenumber `lateral`, the `number`-th of the view's."""
        request = _EquationSetRequest(view.modes, lateral, self.poisson, shortest, self.resolution)
        system = _equation_set(request)
        spectrum = view.spectra[:, number if view.spectra.shape[1] > 1 else 0]
        return system, system.auxiliary_loads(spectrum, self.loads, shortest=shortest, resolution=self.resolution)


def finest_cell(grid: Grid) -> float:
    """Size of a cell, metres; of graded cells, of which the narrow ones vary along x only, the one along y."""
    return min(grid.dx, grid.dy) if grid.uniform else grid.dy


def parity_parts(cells: FloatArray, sign_x: int) -> dict[int, FloatArray]:
    """Parts of a load (x, y) that a reflection about mid-length keeps (1) and reverses (-1), but negligible ones.

    The reflection turns round the direction of loads with `sign_x` -1 as well: of these the first part is odd.
    """
    parts = {parity: 0.5 * (cells + sign_x * parity * cells[::-1]) for parity in (1, -1)}
    least = NEGLIGIBLE * np.abs(cells).max()
    return {parity: part for parity, part in parts.items() if np.abs(part).max() > least}


@dataclass(frozen=True, eq=False)
class View:
    """A load and points as one set of axial modes sees them; from end II when `flipped`.

    `spectra` are the columns' weighted spectra (axial wavenumber, node or 1, column), `columns` says which of the
    load's columns they are, `rows` which of the points are within reach, `x` is the points' distance from the end.
    """

    modes: AxialModes
    spectra: ComplexArray
    columns: IntArray
    rows: IntArray
    x: FloatArray
    cosine: ComplexArray
    sine: ComplexArray
    flipped: bool


def views_of(problem: EndProblem, load: LateralColumns, x: FloatArray, shortest: float) -> list[View]:
    """Return the columns of a load and the points `x` as each set of axial modes sees them.

    Of a load that is split by parity, the field is wanted on the first half of the body only. Otherwise ends that know
    nothing of each other are two quarter spaces, the second seen from its own end.
    """
    length, (edges, _) = problem.length, problem.columns
    split = bool(load.parities.all())
    views = []
    for modes in problem.axial_modes(float(load.nodes[0]), shortest):
        columns = np.flatnonzero((load.parities == modes.parity) | (load.parities == 0) | (modes.parity == 0))
        if not columns.size:
            continue
        integrals = modes.load_weights[:, None] * modes.cell_integrals(problem.loads[0], edges)
        for flipped in (False, True) if np.isfinite(length) and not modes.parity and not split else (False,):
            facing = problem.sign_x * integrals[:, ::-1] if flipped else integrals
            distance = length - x if flipped else x
            rows = np.flatnonzero(distance <= modes.reach)
            distance = distance[rows]
            views.append(
                View(
                    modes=modes,
                    spectra=np.tensordot(facing, load.along_x[..., columns], axes=1),
                    columns=columns,
                    rows=rows,
                    x=distance,
                    cosine=modes.cosine(distance),
                    sine=modes.sine(distance),
                    flipped=flipped,
                )
            )
    return views
