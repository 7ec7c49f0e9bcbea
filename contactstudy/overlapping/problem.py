"""What the free ends are asked to do: a load on the top, in harmonics along y, as each set of axial modes sees it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy.checks import ComplexArray, FloatArray, IntArray
from contactstudy.grid import Grid
from contactstudy.overlapping.axial import AxialModes
from contactstudy.overlapping.quadrature import Resolution, lateral_nodes

# Points on the loaded corner itself are evaluated this part of a cell below it: both bodies' parts have a logarithm
# there, of which only the sum is finite.
CORNER_OFFSET = 1e-2


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
    """

    length: float
    poisson: float
    pressure: FloatArray
    grid: Grid
    tangential: bool
    resolution: Resolution

    @property
    def corner_offset(self) -> float:
        """Distance from the corner below which nothing is evaluated, metres."""
        return CORNER_OFFSET * min(self.grid.dx, self.grid.dy)

    def from_end(self, x: FloatArray) -> FloatArray:
        """Distance of positions from the nearest end."""
        return np.minimum(x, self.length - x)


@dataclass(frozen=True, eq=False)
class LateralAmplitudes:
    """Top loads as amplitudes along x for each wavenumber along y.

    Attributes
    ----------
    pressure, traction : array (cell, q, column)
        Amplitudes. The first two columns are a pressure, whose part in one column makes stresses that are even in
        y follow ``cos(k_y y)`` and in the other ``sin(k_y y)``; two more, if there, are an equal traction along y.
    """

    pressure: FloatArray
    traction: FloatArray


def lateral_amplitudes(
    pressure: FloatArray, grid: Grid, wavenumbers: FloatArray, *, tangential: bool
) -> LateralAmplitudes:
    """Amplitudes of cell-wise uniform `pressure` (x, y) and, if asked, of an equal traction."""
    width = grid.dy * np.sinc(wavenumbers * grid.dy / (2 * np.pi))
    cosine = pressure @ (np.cos(np.outer(grid.y, wavenumbers)) * width)
    sine = pressure @ (np.sin(np.outer(grid.y, wavenumbers)) * width)
    none = np.zeros_like(cosine)
    if not tangential:
        return LateralAmplitudes(np.stack([cosine, sine], axis=-1), np.stack([none, none], axis=-1))
    # Kernels of a traction carry a factor i against those of a pressure, which turns cosine into sine.
    return LateralAmplitudes(
        np.stack([cosine, sine, none, none], axis=-1), np.stack([none, none, sine, -cosine], axis=-1)
    )


def lateral_quadrature(problem: EndProblem, y: FloatArray, shortest: float) -> tuple[FloatArray, FloatArray]:
    """Wavenumbers along y and their weights, for points at `y` no nearer than `shortest` to a loaded corner."""
    grid, resolution = problem.grid, problem.resolution
    loaded = np.abs(grid.y[problem.pressure.any(axis=0)]).max(initial=0.0) + 0.5 * grid.dy
    reach = loaded + np.abs(y).max()
    return lateral_nodes(
        0.1 / min(problem.length, 4 * max(grid.x_range[1], reach)),
        reach,
        # Along y the load is known to the cell only; finer than half a cell there is nothing to resolve.
        resolution.lateral_reach / max(shortest, 0.5 * min(grid.dx, grid.dy)),
        resolution,
    )


def lateral_synthesis(lateral: FloatArray, weights: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """From amplitudes to values at `y`: arrays (wavenumber, column, y) for parts even and odd along y."""
    cosine, sine = (function(np.outer(lateral, y)) * (weights / np.pi)[:, None] for function in (np.cos, np.sin))
    return np.stack([cosine, sine], axis=1), np.stack([-sine, cosine], axis=1)


@dataclass(frozen=True, eq=False)
class View:
    """Loads and points as one set of axial modes sees them; from end II when `flipped`.

    `rows` says which of the points are within reach, `x` is their distance from the end.
    """

    modes: AxialModes
    pressure: ComplexArray
    traction: ComplexArray
    rows: IntArray
    x: FloatArray
    cosine: ComplexArray
    sine: ComplexArray
    flipped: bool


def views_of(
    modes: AxialModes, problem: EndProblem, loads: LateralAmplitudes, batch: slice, x: FloatArray
) -> list[View]:
    """Return a batch of loads and the points `x` as `modes` see them, from each end on its own if need be."""
    grid, length = problem.grid, problem.length
    edges = np.linspace(0.0, grid.x_range[1], grid.cells_x + 1)
    integrals = modes.load_weights[:, None] * modes.cell_integrals(edges)
    # Ends that know nothing of each other are two quarter spaces, the second seen from its own end.
    sides = (False, True) if np.isfinite(length) and not modes.parity else (False,)
    views = []
    for flipped in sides:
        facing = integrals[:, ::-1] if flipped else integrals
        pressure = np.tensordot(facing, loads.pressure[:, batch], axes=1)
        traction = np.tensordot(facing, loads.traction[:, batch], axes=1)
        distance = length - x if flipped else x
        rows = np.flatnonzero(distance <= modes.reach)
        distance = distance[rows]
        cosine, sine = modes.cosine(distance), modes.sine(distance)
        views.append(View(modes, pressure, traction, rows, distance, cosine, sine, flipped))
    return views
