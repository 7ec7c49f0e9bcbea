"""Temperature of a moving surface under heat in its cells: the diffusion of heat between insulated ends.

The steady temperature is the integral of eq. (601) over the length of spreading s. For uniform heat in a cell the
integrand has one factor along each axis (docs/explanation/heat_and_wear.md); insulated ends mirror the cell along x.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.fft import fft, irfft, irfft2, next_fast_len, rfft, rfft2
from scipy.special import erf

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.case.magnitudes import warn_of_values
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
        If a value lies outside its usual range, which suggests a wrong unit.

    Examples
    --------
    >>> steel = ThermalProperties(conductivity=46.0, density=7850.0, specific_heat=470.0)
    >>> round(1e6 * steel.diffusivity, 2)
    12.47
    """

    conductivity: float = field(metadata=checks.number(checks.positive, "W/(m K)"))
    density: float = field(metadata=checks.number(checks.positive, "kg/m3"))
    specific_heat: float = field(metadata=checks.number(checks.positive, "J/(kg K)"))

    def __post_init__(self) -> None:
        checks.store_numbers(self)
        warn_of_values(stacklevel=4, **vars(self))

    @property
    def diffusivity(self) -> float:
        """Thermal diffusivity ``kappa = lambda / (rho c)``, m2/s."""
        return self.conductivity / (self.density * self.specific_heat)


MAX_SPREADS = 6.5  # Lengths of spreading beyond which the heat of a cell vanishes: erfc(6.5) = 4e-20


def spread_nodes(min_width: float, step: float, window: float, drift: float) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights over the length of spreading s, in which heat moves by ``drift s**2 / 2``, drift in 1/m."""
    speed = abs(drift)
    # The integral ends when the heat of all cells has drifted beyond the window; for a source at rest, at 1e8
    # windows, where the remainder is 1e-8.
    max_spread = 1e8 * window
    if speed:
        max_spread = min((MAX_SPREADS + np.sqrt(MAX_SPREADS**2 + 2 * speed * window)) / speed, max_spread)
    # Length of spreading below which the midpoint of the smallest cell keeps its heat
    min_spread = 0.125 * min_width
    panel_count = max(1, int(np.ceil(np.log(max_spread / min_spread) / np.log(2.0))))  # Ratio of neighbouring panels
    edges = [np.zeros(1), np.geomspace(min_spread, max_spread, panel_count + 1)]
    if speed:
        # Lengths of spreading at which the edge of a drifting cell passes the midpoint of another cell.
        crossings = np.sqrt(2 * step * (np.arange(int(np.ceil(window / step)) + 1) + 0.5) / speed)
        edges.append(crossings[crossings < max_spread])
    panel_edges = np.unique(np.concatenate(edges))
    panel_edges = panel_edges[np.concatenate([[True], np.diff(panel_edges) > 1e-9 * panel_edges[1:]])]
    # Gauss points in each panel of the integral over the length of spreading
    points, weights = np.polynomial.legendre.leggauss(6)
    half_widths = 0.5 * np.diff(panel_edges)
    midpoints = 0.5 * (panel_edges[1:] + panel_edges[:-1])
    return (midpoints[:, None] + half_widths[:, None] * points).ravel(), (half_widths[:, None] * weights).ravel()


def lateral_factors(spread: FloatArray, distance: FloatArray, step: float, drift: float) -> FloatArray:
    """Fraction of a cell's heat density that remains at distances along y from its midpoint: (spread, distance)."""
    s = spread[:, None]
    drifted = distance[None, :] - 0.5 * drift * s**2
    return np.asarray(0.5 * (erf((drifted + 0.5 * step) / s) - erf((drifted - 0.5 * step) / s)))


def axial_factors(spread: FloatArray, x: FloatArray, edges: FloatArray, ends: tuple[float, float]) -> FloatArray:
    """Fraction at positions `x` of the heat density of cells between `edges`: array (spread, x, cell)."""
    length = ends[1] - ends[0]
    primitives = _primitive(spread, x[:, None] - edges[None, :], length)
    if np.isfinite(ends[0]):
        primitives = primitives - _primitive(spread, x[:, None] + edges[None, :] - 2 * ends[0], length)
    return np.asarray(primitives[..., :-1] - primitives[..., 1:])


def _primitive(spread: FloatArray, distance: FloatArray, length: float) -> FloatArray:
    """Primitive along x of the heat kernel; for a finite length also of the kernel's images at every second length."""
    distance = np.asarray(distance)
    s = spread.reshape(-1, *[1] * distance.ndim)
    if not np.isfinite(length):
        return np.asarray(0.5 * erf(distance / s))
    periods = np.round(distance / (2 * length))
    reduced_distance = distance - 2 * length * periods
    primitive = np.empty((spread.size, *distance.shape))
    # Length of spreading over the distance between two ends above which the cosine series replaces the images
    is_wide = spread >= 0.6 * length
    # The cosines decay like exp(-(m pi / L)**2 kappa t) with 4 kappa t = s**2
    if is_wide.any():
        # The first neglected term is ``exp(-(9 pi 0.6 / 2)**2)``.
        wavenumbers = np.arange(1, 9) * np.pi / length
        decay = np.exp(-0.25 * np.outer(spread[is_wide], wavenumbers) ** 2) / (wavenumbers * length)
        waves = np.sin(wavenumbers.reshape(-1, *[1] * distance.ndim) * reduced_distance)
        primitive[is_wide] = reduced_distance / (2 * length) + np.tensordot(decay, waves, axes=1)
    if not is_wide.all():
        short_spreads = spread[~is_wide]
        image_count = max(0, int(np.ceil((MAX_SPREADS * short_spreads.max() / length - 1) / 2)))
        shifts = 2 * length * np.arange(-image_count, image_count + 1)
        primitive[~is_wide] = sum(0.5 * erf((reduced_distance + shift) / s[~is_wide]) for shift in shifts)
    return primitive + periods


class MovingBody(NamedTuple):
    """Thermal properties, speed and ends of a body."""

    properties: ThermalProperties
    speed: float  # of its surface along +y relative to the contact, m/s
    ends: tuple[float, float]  # positions of the insulated ends, m; infinite where the body has no end

    @property
    def drift(self) -> float:
        """``V / (2 kappa)``, 1/m."""
        return self.speed / (2 * self.properties.diffusivity)


class SourceOperator:
    """Temperature rise (K) at the cells' midpoints, at one depth, from heat (W/m2) uniform in each cell."""

    def __init__(self, body: MovingBody, grid: Grid, columns: slice, depth: float = 0.0) -> None:
        self._columns, self._shape, self._uniform = columns, grid.shape, grid.uniform
        self._size_y = next_fast_len(2 * grid.cells_y - 1, real=True)  # padded, so that the wake does not return
        edges = grid.x_edges[columns.start : columns.stop + 1]
        x = grid.x[columns]
        length = body.ends[1] - body.ends[0]
        window = grid.dy * grid.cells_y
        # Below this Peclet number of the window a surface is at rest.
        if np.isfinite(length) and abs(body.drift) * window < 1e-6:
            allowed = "such that the surface of a body with two ends leaves the contact"
            hint = "a surface at rest gets hotter without limit, and the other body takes all heat: give partition"
            raise InvalidInputError("speed", body.speed, allowed, hint)
        spread, weights = spread_nodes(min(float(np.diff(edges).min()), grid.dy), grid.dy, window, body.drift)
        # eq. (601)
        weights = weights * np.exp(-((depth / spread) ** 2)) / (body.properties.conductivity * np.sqrt(np.pi))
        lags = np.arange(self._size_y)
        lags[lags >= grid.cells_y] -= self._size_y
        lateral = rfft(weights[:, None] * lateral_factors(spread, grid.dy * lags, grid.dy, body.drift), axis=-1)
        if not grid.uniform:
            pairs = x.size * edges.size
            self._spectra = {1: _sum_products(spread, lateral, pairs, lambda s: axial_factors(s, x, edges, body.ends))}
            return
        self._size_x = next_fast_len(2 * x.size - 1, real=True)
        offsets = np.arange(self._size_x)
        offsets[offsets >= x.size] -= self._size_x

        def compute_spectrum(distance: float) -> ComplexArray:
            """Fractions at distances along x from the midpoint of a cell and of its images in both ends."""
            lower, upper = (distance + grid.dx * offsets + side * grid.dx for side in (-0.5, 0.5))

            def factors(s: FloatArray) -> FloatArray:
                return _primitive(s, upper, length) - _primitive(s, lower, length)

            return np.asarray(fft(_sum_products(spread, lateral, lower.size, factors), axis=0))

        self._spectra = {1: compute_spectrum(0.0)}  # by the order of the cells along x
        if np.isfinite(body.ends[0]):
            # In reversed order cell j lies at x[-1] - dx j, and the cell's image in the end e at 2 e - x[-1] + dx j.
            self._spectra[-1] = compute_spectrum(x[0] + x[-1] - 2 * body.ends[0])

    def __call__(self, heat: FloatArray) -> FloatArray:
        """Temperature rise under `heat` on all cells of the grid; zero on columns beyond the body."""
        body_heat = heat[self._columns]
        rise = np.zeros(self._shape)
        if self._uniform:
            size = (self._size_x, self._size_y)
            rise_spectrum = sum(spectrum * rfft2(body_heat[::order], size) for order, spectrum in self._spectra.items())
            column_rises = irfft2(rise_spectrum, size)[: body_heat.shape[0]]
        else:
            line_spectra = rfft(body_heat, self._size_y, axis=-1)
            column_rises = irfft(np.einsum("xck,ck->xk", self._spectra[1], line_spectra), self._size_y, axis=-1)
        rise[self._columns] = column_rises[:, : self._shape[1]]
        return rise


def _sum_products(
    spread: FloatArray, lateral: ComplexArray, size: int, factors: Callable[[FloatArray], FloatArray]
) -> ComplexArray:
    """Sum, over the lengths of spreading, of axial factors (`size` numbers) times spectra of lateral factors."""
    # Products of real numbers cost half as much as products of complex numbers.
    real_factors = np.ascontiguousarray(lateral).view(np.float64)
    sums: FloatArray = np.zeros(())
    step = max(1, 2**22 // size)  # Lengths of spreading in memory at a time
    for start in range(0, spread.size, step):
        chunk = slice(start, start + step)
        sums = sums + np.tensordot(factors(spread[chunk]), real_factors[chunk], axes=(0, 0))
    return np.ascontiguousarray(sums).view(np.complex128)
