"""What the free ends are asked to do: a load on the top, in harmonics along y, as each set of axial modes sees it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.cache import BoundedCache, digest
from contactstudy.checks import ComplexArray, FloatArray, IntArray
from contactstudy.errors import InvalidInputError
from contactstudy.overlapping.axial import AxialModes
from contactstudy.overlapping.equations import AuxiliaryLoads, EquationSet
from contactstudy.overlapping.lateral import (
    NEGLIGIBLE,
    POLES_ALONE,
    LateralLoads,
    LateralPanel,
    lateral_loads,
    lateral_panels,
)
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.overlapping.single_mirror import modes_between_ends

# Points on the loaded corner itself are evaluated this part of a cell below it: both bodies' parts have a logarithm
# there, of which only the sum is finite.
CORNER_OFFSET = 1e-2
# Length over the width of the load: at this one the ends keep 6e-4 of the pressure, at a third of it a tenth.
THINNEST = 0.004

_EQUATION_SETS: BoundedCache[EquationSet] = BoundedCache(2**26, lambda system: system.nbytes)


@dataclass(frozen=True, eq=False)
class EndProblem:
    """A pressure on a body with one end or two, and perhaps an equal traction beside it.

    Attributes
    ----------
    length : float
        Distance between the ends, metres; infinite for one end.
    poisson : float
        Poisson's ratio.
    pressure : array (cell_x, cell_y)
        Pressure on the cells of `grid`, Pa.
    grid : Grid
        Cells, from ``x = 0``.
    tangential : bool
        Whether the stresses under a traction along +y, equal to the pressure, are wanted as well.
    resolution : Resolution
        Quadrature settings.
    mirrored_once : bool
        Whether loads have one pair of images only (single_mirror.py) instead of all.
    """

    length: float
    poisson: float
    pressure: FloatArray
    grid: Grid
    tangential: bool
    resolution: Resolution
    mirrored_once: bool = False

    def __post_init__(self) -> None:
        """Refuse a body too thin for its ends to be freed by these quadratures."""
        loaded = np.flatnonzero(self.pressure.any(axis=0))
        width = self.grid.dy * (loaded[-1] - loaded[0] + 1) if loaded.size else 0.0
        if self.length < THINNEST * width:
            raise InvalidInputError(
                "body.length",
                self.length,
                f"at least {THINNEST:g} of the width of the contact, {width:.3g} m: the traction left on the ends of a "
                "thinner body exceeds 1e-3 of the pressure",
                "such a disc is in plane stress",
            )

    def axial_modes(self, lateral: float, shortest: float) -> list[AxialModes]:
        """Axial modes for wavenumbers along y from `lateral` on, see `modes_between_ends`."""
        return modes_between_ends(self.length, lateral, shortest, self.resolution, mirrored_once=self.mirrored_once)

    @property
    def corner_offset(self) -> float:
        """Distance from the corner below which nothing is evaluated, metres."""
        return CORNER_OFFSET * min(self.grid.dx, self.grid.dy)

    def from_end(self, x: FloatArray) -> FloatArray:
        """Distance of positions from the nearest end."""
        return np.minimum(x, self.length - x)

    def panels(self, y: FloatArray, shortest: float, reference: float | None = None) -> list[LateralPanel]:
        """Panels along ``k_y`` for points at `y` no nearer than `shortest` to a loaded corner."""
        grid = self.grid
        loaded = np.abs(grid.y[self.pressure.any(axis=0)]).max(initial=0.0) + 0.5 * grid.dy
        reach = loaded + np.abs(y).max()
        first = (0.1 if reference is None else POLES_ALONE) / min(self.length, 4 * max(grid.x_range[1], reach))
        # Along y the load is known to the cell only; finer than half a cell there is nothing to resolve.
        last = self.resolution.lateral_reach / max(shortest, 0.5 * min(grid.dx, grid.dy))
        return lateral_panels(first, reach, last, self.resolution, reference)

    def batches(self, panel: LateralPanel, parts: Mapping[int, FloatArray], y: FloatArray) -> Iterator[LateralLoads]:
        """Columns of the load's `parts` within one panel, a few at a time."""
        loads = lateral_loads(panel, parts, self.grid, y)
        yield from loads.batches() if loads else ()

    def auxiliary_loads(
        self, view: View, lateral: float, number: int, shortest: float
    ) -> tuple[EquationSet, AuxiliaryLoads]:
        """Equation set and its solution at wavenumber `lateral`, the `number`-th of the view's."""
        modes = view.modes
        key = (type(modes), modes.length, modes.parity, digest(modes.ray.view(np.float64)), lateral, shortest)
        system = _EQUATION_SETS.get(
            (*key, self.poisson, self.resolution),
            lambda: EquationSet.build(modes, lateral, self.poisson, shortest, self.resolution),
        )
        spectrum = view.spectra[:, number if view.spectra.shape[1] > 1 else 0]
        return system, system.auxiliary_loads(
            spectrum, tangential=self.tangential, shortest=shortest, resolution=self.resolution
        )


def parity_parts(pressure: FloatArray) -> dict[int, FloatArray]:
    """Parts of a pressure (x, y) even (1) and odd (-1) about mid-length; one that is negligible is left out."""
    parts = {parity: 0.5 * (pressure + parity * pressure[::-1]) for parity in (1, -1)}
    least = NEGLIGIBLE * np.abs(pressure).max()
    return {parity: part for parity, part in parts.items() if np.abs(part).max() > least}


@dataclass(frozen=True, eq=False)
class View:
    """Loads and points as one set of axial modes sees them; from end II when `flipped`.

    `spectra` are the loads' weighted spectra (axial wavenumber, node or 1, column), `columns` says which of the loads'
    columns they are, `rows` which of the points are within reach, `x` is the points' distance from the end.
    """

    modes: AxialModes
    spectra: ComplexArray
    columns: IntArray
    rows: IntArray
    x: FloatArray
    cosine: ComplexArray
    sine: ComplexArray
    flipped: bool


def views_of(problem: EndProblem, loads: LateralLoads, x: FloatArray, shortest: float) -> list[View]:
    """Return `loads` and the points `x` as each set of axial modes sees them.

    Of loads that are split by parity, the field is wanted on the first half of the body only. Otherwise ends that know
    nothing of each other are two quarter spaces, the second seen from its own end.
    """
    grid, length = problem.grid, problem.length
    edges = np.linspace(0.0, grid.x_range[1], grid.cells_x + 1)
    split = bool(loads.parities.all())
    views = []
    for modes in problem.axial_modes(float(loads.nodes[0]), shortest):
        columns = np.flatnonzero((loads.parities == modes.parity) | (loads.parities == 0) | (modes.parity == 0))
        if not columns.size:
            continue
        integrals = modes.load_weights[:, None] * modes.cell_integrals(edges)
        for flipped in (False, True) if np.isfinite(length) and not modes.parity and not split else (False,):
            facing = integrals[:, ::-1] if flipped else integrals
            distance = length - x if flipped else x
            rows = np.flatnonzero(distance <= modes.reach)
            distance = distance[rows]
            views.append(
                View(
                    modes=modes,
                    spectra=np.tensordot(facing, loads.columns[..., columns], axes=1),
                    columns=columns,
                    rows=rows,
                    x=distance,
                    cosine=modes.cosine(distance),
                    sine=modes.sine(distance),
                    flipped=flipped,
                )
            )
    return views
