"""What the free ends are asked to do: a load on the top, in harmonics along y, as each set of axial modes sees it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from contactstudy.checks import ComplexArray, FloatArray, IntArray
from contactstudy.grid import Grid
from contactstudy.overlapping.axial import AxialModes
from contactstudy.overlapping.quadrature import Resolution, lateral_nodes

# Points on the loaded corner itself are evaluated this part of a cell below it: both bodies' parts have a logarithm
# there, of which only the sum is finite.
CORNER_OFFSET = 1e-2
# Below this wavenumber along y, over the smallest length of the problem, an amplitude is its poles and a constant. The
# double pole (a sliding load off-centre turns the body) amplifies rounding errors if it is taken much lower.
POLES_ALONE = 0.1
POLE_SAMPLES = (1 / 3, 2 / 3, 1.0)


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


@dataclass(frozen=True, eq=False)
class LateralSum:
    """The integral over the wavenumber along y as a sum.

    Attributes
    ----------
    wavenumbers, weights : array
        Nodes, 1/m, and their weights.
    reference : float or None
        If given, the first three nodes (`POLE_SAMPLES` of `first`) stand for an amplitude ``b / k**2 + c / k + d`` from
        0 to `first`, whose integral is taken in closed form; the poles' are relative to ``|y| = reference``.
    """

    wavenumbers: FloatArray
    weights: FloatArray
    reference: float | None = None

    def below(self, limit: float) -> LateralSum:
        """Return the sum over the wavenumbers below a limit."""
        kept = self.wavenumbers < limit
        return replace(self, wavenumbers=self.wavenumbers[kept], weights=self.weights[kept])

    def synthesis(self, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """From amplitudes to values at `y`: arrays (wavenumber, column, y) for parts even and odd along y."""
        phase = np.outer(self.wavenumbers, y)
        cosine, sine = (function(phase) * (self.weights / np.pi)[:, None] for function in (np.cos, np.sin))
        if self.reference is not None:
            first = self.wavenumbers[len(POLE_SAMPLES) - 1]
            powers = np.vander(1 / self.wavenumbers[: len(POLE_SAMPLES)], 3)
            cosine[: len(POLE_SAMPLES)] = np.linalg.solve(powers.T, cosine_moments(first, y, self.reference) / np.pi)
            sine[: len(POLE_SAMPLES)] = np.linalg.solve(powers.T, _sine_moments(first, y, self.reference) / np.pi)
        return np.stack([cosine, sine], axis=1), np.stack([-sine, cosine], axis=1)


def cosine_moments(first: float, y: FloatArray, reference: float) -> FloatArray:
    """Integrals of ``cos(k y)`` times ``k**-2, k**-1, 1`` over k from 0 to `first`: array (3, y).

    The first two are relative to ``|y| = reference``, of which all wavenumbers are taken here: they stand for rigid
    motions, and no more than these is to be moved.
    """
    argument = np.maximum(first * np.abs(y), 1e-30)
    sine_integral, cosine_integral = special.sici(argument)
    return np.array(
        [
            (1 - np.cos(argument)) / first - np.abs(y) * sine_integral + 0.5 * np.pi * reference,
            cosine_integral - np.log(argument) + np.log(first * reference),
            first * np.sinc(argument / np.pi),
        ]
    )


def _sine_moments(first: float, y: FloatArray, reference: float) -> FloatArray:
    """Likewise of ``sin(k y)``; the first stands for a rotation, which is moved with the cosine's second."""
    argument = first * y
    pole = cosine_moments(first, y, reference)[1]
    return np.array(
        [
            y * (1 - np.sinc(argument / np.pi) + pole),
            special.sici(argument)[0],
            first * np.sin(0.5 * argument) * np.sinc(0.5 * argument / np.pi),
        ]
    )


def lateral_sum(problem: EndProblem, y: FloatArray, shortest: float, reference: float | None = None) -> LateralSum:
    """Sum over the wavenumber along y, for points at `y` no nearer than `shortest` to a loaded corner."""
    grid, resolution = problem.grid, problem.resolution
    loaded = np.abs(grid.y[problem.pressure.any(axis=0)]).max(initial=0.0) + 0.5 * grid.dy
    reach = loaded + np.abs(y).max()
    first = (0.1 if reference is None else POLES_ALONE) / min(problem.length, 4 * max(grid.x_range[1], reach))
    # Along y the load is known to the cell only; finer than half a cell there is nothing to resolve.
    last = resolution.lateral_reach / max(shortest, 0.5 * min(grid.dx, grid.dy))
    lateral, weights = lateral_nodes(first, reach, last, resolution)
    if reference is None:
        return LateralSum(lateral, weights)
    samples, rest = first * np.array(POLE_SAMPLES), slice(resolution.order, None)
    return LateralSum(np.concatenate([samples, lateral[rest]]), np.concatenate([0 * samples, weights[rest]]), reference)


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
