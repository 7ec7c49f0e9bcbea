"""Temperature of a moving surface under heat in its cells: the diffusion of heat between insulated ends.

The steady temperature is the integral of eq. (601) over the length of spreading s, with one factor along each axis of
uniform heat in a cell (docs/explanation/heat_and_wear.md). Insulated ends act on X alone: they mirror the cell.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.fft import fft, irfft, irfft2, next_fast_len, rfft, rfft2
from scipy.special import erf

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.case.magnitudes import warn_doubtful_values
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.errors import InvalidInputError


@dataclass(frozen=True, kw_only=True)
class ThermalProperties:
    """Thermal properties of a material, independent of its temperature.

    Parameters
    ----------
    conductivity : float
        Thermal conductivity, W/(m K).
    density : float
        Density, kg/m3.
    specific_heat : float
        Heat capacity of a unit of mass, J/(kg K).

    Raises
    ------
    InvalidInputError
        If a value is not a positive finite number.

    Warns
    -----
    MagnitudeWarning
        If a value is of a size that is mostly a mistake in the unit.

    Examples
    --------
    >>> steel = ThermalProperties(conductivity=46.0, density=7850.0, specific_heat=470.0)
    >>> round(1e6 * steel.diffusivity, 2)
    12.47
    """

    conductivity: float
    density: float
    specific_heat: float

    def __post_init__(self) -> None:
        units = {"conductivity": "W/(m K)", "density": "kg/m3", "specific_heat": "J/(kg K)"}
        checks.store(self, **{name: checks.positive(name, getattr(self, name), unit) for name, unit in units.items()})
        warn_doubtful_values(stacklevel=4, **{name: getattr(self, name) for name in units})

    @property
    def heat_capacity(self) -> float:
        """Heat capacity of a unit of volume, J/(m3 K)."""
        return self.density * self.specific_heat

    @property
    def diffusivity(self) -> float:
        """Thermal diffusivity ``kappa = lambda / (rho c)``, m2/s."""
        return self.conductivity / self.heat_capacity


TAIL = 6.5  # Lengths of spreading beyond which the heat of a cell vanishes: erfc(6.5) = 4e-20


def spread_lengths(smallest: float, step: float, window: float, drift: float) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights over the length of spreading s, in which heat moves by ``drift s**2 / 2``, drift in 1/m."""
    speed = abs(drift)
    # Cells of the window drift out of it; after that their heat is gone when it no longer reaches back.
    # Length of spreading over the window at which a source at rest is cut off; the remainder is 1e-8
    last = 1e8 * window
    if speed:
        last = min((TAIL + np.sqrt(TAIL**2 + 2 * speed * window)) / speed, last)
    # Length of spreading, over the smallest cell, below which the middle of a cell keeps its heat
    first = 0.125 * smallest
    count = max(1, int(np.ceil(np.log(last / first) / np.log(2.0))))  # Ratio of neighbouring panels
    edges = [np.zeros(1), np.geomspace(first, last, count + 1)]
    if speed:
        # Where the border of a cell passes the middle of another, as far as the border is still sharp.
        passing = np.sqrt(2 * step * (np.arange(int(np.ceil(window / step)) + 1) + 0.5) / speed)
        edges.append(passing[passing < last])
    borders = np.unique(np.concatenate(edges))
    borders = borders[np.concatenate([[True], np.diff(borders) > 1e-9 * borders[1:]])]
    # Gauss points in each panel of the integral over the length of spreading
    points, weights = np.polynomial.legendre.leggauss(6)
    halves = 0.5 * np.diff(borders)
    middles = 0.5 * (borders[1:] + borders[:-1])
    return (middles[:, None] + halves[:, None] * points).ravel(), (halves[:, None] * weights).ravel()


def along_y(spread: FloatArray, distance: FloatArray, step: float, drift: float) -> FloatArray:
    """Part of a cell's heat density left at distances along y from its middle: array (spread, distance)."""
    s = spread[:, None]
    behind = distance[None, :] - 0.5 * drift * s**2
    return np.asarray(0.5 * (erf((behind + 0.5 * step) / s) - erf((behind - 0.5 * step) / s)))


def along_x(spread: FloatArray, x: FloatArray, edges: FloatArray, ends: tuple[float, float]) -> FloatArray:
    """Part left at positions `x` of the heat of cells between `edges`: array (spread, x, cell)."""
    length = ends[1] - ends[0]
    passed = _primitive(spread, x[:, None] - edges[None, :], length)
    if np.isfinite(ends[0]):
        passed = passed - _primitive(spread, x[:, None] + edges[None, :] - 2 * ends[0], length)
    return np.asarray(passed[..., :-1] - passed[..., 1:])


def _primitive(spread: FloatArray, distance: FloatArray, length: float) -> FloatArray:
    """Primitive along x of the heat kernel and, for a finite length, of its copies at every second length."""
    distance = np.asarray(distance)
    s = spread.reshape(-1, *[1] * distance.ndim)
    if not np.isfinite(length):
        return np.asarray(0.5 * erf(distance / s))
    turns = np.round(distance / (2 * length))
    reduced = distance - 2 * length * turns
    result = np.empty((spread.size, *distance.shape))
    # Length of spreading over the distance between two ends above which the cosine series replaces the images
    wide = spread >= 0.6 * length
    # exp(-(m pi / L)**2 kappa t) with 4 kappa t = s**2
    if wide.any():
        # Terms of that series: the next one has lost ``exp(-(9 pi 0.6 / 2)**2)``
        number = np.arange(1, 9) * np.pi / length
        decay = np.exp(-0.25 * np.outer(spread[wide], number) ** 2) / (number * length)
        waves = np.sin(number.reshape(-1, *[1] * distance.ndim) * reduced)
        result[wide] = reduced / (2 * length) + np.tensordot(decay, waves, axes=1)
    if not wide.all():
        near = spread[~wide]
        images = max(0, int(np.ceil((TAIL * near.max() / length - 1) / 2)))
        values = 0.5 * erf(reduced / s[~wide])
        for image in range(1, images + 1):
            for shift in (-2 * length * image, 2 * length * image):
                values += 0.5 * erf((reduced + shift) / s[~wide])
        result[~wide] = values
    return result + turns


class MovingBody(NamedTuple):
    """Thermal properties, speed and ends of a body."""

    properties: ThermalProperties
    speed: float  # of its surface along +y relative to the contact, m/s
    ends: tuple[float, float]  # insulated, m; without an end, or without the second, infinite

    @property
    def drift(self) -> float:
        """``V / (2 kappa)``, 1/m."""
        return self.speed / (2 * self.properties.diffusivity)


class SourceOperator:
    """Temperature rise (K) at the cells' middles, at one depth, from heat (W/m2) uniform in each cell.

    Zeros pad the window along y: the wake does not come back. Columns of different widths are convolved pair by pair.
    """

    def __init__(self, body: MovingBody, grid: Grid, columns: slice, depth: float = 0.0) -> None:
        self._columns, self._shape = columns, grid.shape
        self._length = next_fast_len(2 * grid.cells_y - 1, real=True)
        edges = grid.x_edges[columns.start : columns.stop + 1]
        x = grid.x[columns]
        length = body.ends[1] - body.ends[0]
        window = grid.dy * grid.cells_y
        # Peclet number of the window below which a surface counts as resting
        if np.isfinite(length) and abs(body.drift) * window < 1e-6:
            raise InvalidInputError(
                "speed",
                body.speed,
                "such that the surface of a body with two ends leaves the contact",
                "resting under it, it gets hotter without limit: in the end the other body takes all heat, which a "
                "stated partition says",
            )
        spread, weights = spread_lengths(min(float(np.diff(edges).min()), grid.dy), grid.dy, window, body.drift)
        # eq. (601)
        weights = weights * np.exp(-((depth / spread) ** 2)) / (body.properties.conductivity * np.sqrt(np.pi))
        steps = np.arange(self._length)
        steps[steps >= grid.cells_y] -= self._length
        lateral = rfft(weights[:, None] * along_y(spread, grid.dy * steps, grid.dy, body.drift), axis=-1)
        self._mirrored: ComplexArray | None = None
        if not grid.uniform:
            pairs = x.size * edges.size
            self._spectrum = _summed(spread, lateral, pairs, lambda part: along_x(part, x, edges, body.ends))
            return
        self._height = next_fast_len(2 * x.size - 1, real=True)
        offsets = np.arange(self._height)
        offsets[offsets >= x.size] -= self._height

        def kernel(first: float) -> ComplexArray:
            """Part left at distances along x from the middle of a cell and of its images in both ends."""
            low, high = (first + grid.dx * offsets + side * grid.dx for side in (-0.5, 0.5))

            def factors(part: FloatArray) -> FloatArray:
                return _primitive(part, high, length) - _primitive(part, low, length)

            return np.asarray(fft(_summed(spread, lateral, low.size, factors), axis=0))

        self._spectrum = kernel(0.0)
        mirror = body.ends[0]
        if np.isfinite(mirror):
            # Counted from the last one, cell j lies at x[-1] - dx j, and its image at 2 mirror - x[-1] + dx j.
            self._mirrored = kernel(x[0] + x[-1] - 2 * mirror)

    def __call__(self, heat: FloatArray) -> FloatArray:
        """Temperature rise under `heat` on all cells of the grid; zero on columns beyond the body."""
        body_heat = heat[self._columns]
        result = np.zeros(self._shape)
        if self._spectrum.ndim == 3:
            lines = rfft(body_heat, self._length, axis=-1)
            spread = irfft(np.einsum("xck,ck->xk", self._spectrum, lines), self._length, axis=-1)
            result[self._columns] = spread[:, : self._shape[1]]
            return result
        size = (self._height, self._length)
        total = self._spectrum * rfft2(body_heat, size)
        if self._mirrored is not None:
            total += self._mirrored * rfft2(body_heat[::-1], size)
        result[self._columns] = irfft2(total, size)[: body_heat.shape[0], : self._shape[1]]
        return result


def _summed(
    spread: FloatArray, lateral: ComplexArray, size: int, factors: Callable[[FloatArray], FloatArray]
) -> ComplexArray:
    """Sum over the lengths of spreading of factors along x, of `size` numbers each, times spectra of those along y."""
    # Real products cost half as much as complex ones.
    parts = np.ascontiguousarray(lateral).view(np.float64)
    total: FloatArray = np.zeros(())
    step = max(1, 2**22 // size)  # Numbers in the factors along x that are made at a time
    for start in range(0, spread.size, step):
        part = slice(start, start + step)
        total = total + np.tensordot(factors(spread[part]), parts[part], axes=(0, 0))
    return np.ascontiguousarray(total).view(np.complex128)
