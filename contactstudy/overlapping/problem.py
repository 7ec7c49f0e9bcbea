"""What the free ends are asked to do: a load on the top, in harmonics along y, as each set of axial modes sees it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy import special

from contactstudy.checks import ComplexArray, FloatArray, IntArray
from contactstudy.grid import Grid
from contactstudy.overlapping.axial import AxialModes
from contactstudy.overlapping.quadrature import Resolution, lateral_nodes
from contactstudy.overlapping.single_mirror import modes_between_ends

# Points on the loaded corner itself are evaluated this part of a cell below it: both bodies' parts have a logarithm
# there, of which only the sum is finite.
CORNER_OFFSET = 1e-2
# A part smaller than this, over the load, is left out: a contact symmetric but for its tolerance is symmetric.
NEGLIGIBLE = 1e-9
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


class Column(NamedTuple):
    """One column of a load's amplitudes.

    Attributes
    ----------
    load : int
        0 for the pressure, 1 for an equal traction along y.
    phase : int
        0 if it makes components that are even in y follow ``cos(k_y y)``, 1 for ``sin(k_y y)``.
    parity : int
        1 or -1 for the part of the load even or odd about mid-length, 0 for a load that is not split.
    """

    load: int
    phase: int
    parity: int


@dataclass(frozen=True, eq=False)
class LateralAmplitudes:
    """Top loads as amplitudes along x for each wavenumber along y.

    Attributes
    ----------
    pressure, traction : array (cell, q, column)
        Amplitudes.
    columns : list of Column
        What each column is; those that are negligible are left out.
    """

    pressure: FloatArray
    traction: FloatArray
    columns: list[Column]


def parity_parts(pressure: FloatArray) -> dict[int, FloatArray]:
    """Parts of a pressure (x, y) even (1) and odd (-1) about mid-length; one that is negligible is left out."""
    parts = {parity: 0.5 * (pressure + parity * pressure[::-1]) for parity in (1, -1)}
    least = NEGLIGIBLE * np.abs(pressure).max()
    return {parity: part for parity, part in parts.items() if np.abs(part).max() > least}


def lateral_amplitudes(
    parts: Mapping[int, FloatArray], grid: Grid, wavenumbers: FloatArray, *, tangential: bool
) -> LateralAmplitudes:
    """Amplitudes of the `parts` (by parity) of a cell-wise uniform pressure and, if asked, of an equal traction."""
    width = grid.dy * np.sinc(wavenumbers * grid.dy / (2 * np.pi))
    waves = [function(np.outer(grid.y, wavenumbers)) * width for function in (np.cos, np.sin)]
    pressures, tractions, columns = [], [], []
    for parity, pressure in parts.items():
        cosine, sine = (pressure @ wave for wave in waves)
        none = np.zeros_like(cosine)
        least = NEGLIGIBLE * max(np.abs(cosine).max(), np.abs(sine).max())
        # Kernels of a traction carry a factor i against those of a pressure, which turns cosine into sine.
        for load, amplitudes in enumerate([(cosine, sine), (sine, -cosine)][: 1 + tangential]):
            for phase, amplitude in enumerate(amplitudes):
                if np.abs(amplitude).max() > least:
                    columns.append(Column(load, phase, parity))
                    pressures.append(none if load else amplitude)
                    tractions.append(amplitude if load else none)
    return LateralAmplitudes(np.stack(pressures, axis=-1), np.stack(tractions, axis=-1), columns)


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

    `columns` says which of the loads' columns they are, `rows` which of the points are within reach, `x` is the
    points' distance from the end.
    """

    modes: AxialModes
    pressure: ComplexArray
    traction: ComplexArray
    columns: IntArray
    rows: IntArray
    x: FloatArray
    cosine: ComplexArray
    sine: ComplexArray
    flipped: bool


def views_of(
    modes: AxialModes, problem: EndProblem, loads: LateralAmplitudes, batch: slice, x: FloatArray
) -> list[View]:
    """Return a batch of loads and the points `x` as `modes` see them.

    Of loads that are split by parity, the field is wanted on the first half of the body only. Otherwise ends that know
    nothing of each other are two quarter spaces, the second seen from its own end.
    """
    grid, length = problem.grid, problem.length
    parities = np.array([column.parity for column in loads.columns])
    split = bool(parities.all())
    columns = np.flatnonzero((parities == modes.parity) | (parities == 0) | (modes.parity == 0))
    if not columns.size:
        return []
    edges = np.linspace(0.0, grid.x_range[1], grid.cells_x + 1)
    integrals = modes.load_weights[:, None] * modes.cell_integrals(edges)
    sides = (False, True) if np.isfinite(length) and not modes.parity and not split else (False,)
    views = []
    for flipped in sides:
        facing = integrals[:, ::-1] if flipped else integrals
        pressure = np.tensordot(facing, loads.pressure[:, batch, columns], axes=1)
        traction = np.tensordot(facing, loads.traction[:, batch, columns], axes=1)
        distance = length - x if flipped else x
        rows = np.flatnonzero(distance <= modes.reach)
        distance = distance[rows]
        cosine, sine = modes.cosine(distance), modes.sine(distance)
        views.append(View(modes, pressure, traction, columns, rows, distance, cosine, sine, flipped))
    return views
