"""Temperature of a surface, or of a plane below it, that moves under a resting distribution of heat."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.fft import fft, irfft, irfft2, next_fast_len, rfft, rfft2

from contactstudy.arrays.grid import Grid
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.heat.properties import ThermalProperties
from contactstudy.heat.spreading import Ends, along_x, along_y, between_offsets, spread_lengths

SLOWEST = 1e-6
"""Peclet number of the window below which a surface counts as resting."""

CHUNK = 2**22
"""Numbers in the factors along x that are made at a time. Speed."""


class MovingBody(NamedTuple):
    """A body as heat sees it.

    Attributes
    ----------
    properties : ThermalProperties
        What it is made of.
    speed : float
        Velocity of its surface along +y relative to the contact, m/s.
    ends : Ends
        Its insulated ends.
    """

    properties: ThermalProperties
    speed: float
    ends: Ends

    @property
    def drift(self) -> float:
        """``V / (2 kappa)``, 1/m."""
        return self.speed / (2 * self.properties.diffusivity)


class SourceOperator:
    """Temperature rise (K) at the cells' middles, at one depth, from heat (W/m2) uniform in each cell.

    It convolves along y with zeros beyond the window: the wake that leaves the window does not come back. Columns of
    different widths are convolved pair by pair; uniform ones along x as well, once as they are and once mirrored.

    Parameters
    ----------
    body : MovingBody
        What is heated.
    grid : Grid
        Cells.
    columns : slice
        Columns of `grid` that lie on the body.
    depth : float
        Below the surface, metres.
    """

    def __init__(self, body: MovingBody, grid: Grid, columns: slice, depth: float = 0.0) -> None:
        self._columns, self._shape = columns, grid.shape
        self._length = next_fast_len(2 * grid.cells_y - 1, real=True)
        edges = grid.x_edges[columns.start : columns.stop + 1]
        x = grid.x[columns]
        length = body.ends.high - body.ends.low
        window = grid.dy * grid.cells_y
        if np.isfinite(length) and abs(body.drift) * window < SLOWEST:
            raise InvalidInputError(
                "speed",
                body.speed,
                "such that the surface of a body with two ends leaves the contact",
                "resting under it, it gets hotter without limit: in the end the other body takes all heat, which a "
                "stated partition says",
            )
        spread, weights = spread_lengths(
            min(float(np.diff(edges).min()), grid.dy),
            grid.dy,
            window,
            body.drift,
        )
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
            places = first + grid.dx * offsets
            summed = _summed(spread, lateral, places.size, lambda part: between_offsets(part, places, grid.dx, length))
            return np.asarray(fft(summed, axis=0))

        self._spectrum = kernel(0.0)
        mirror = body.ends.low if np.isfinite(body.ends.low) else body.ends.high
        if np.isfinite(mirror):
            # Counted from the last one, cell j lies at x[-1] - dx j, and its image at 2 mirror - x[-1] + dx j.
            self._mirrored = kernel(x[0] + x[-1] - 2 * mirror)

    def __call__(self, heat: FloatArray) -> FloatArray:
        """Temperature rise under `heat` on all cells of the grid; zero on columns beyond the body."""
        own = heat[self._columns]
        result = np.zeros(self._shape)
        if self._spectrum.ndim == 3:
            lines = rfft(own, self._length, axis=-1)
            spread = irfft(np.einsum("xck,ck->xk", self._spectrum, lines), self._length, axis=-1)
            result[self._columns] = spread[:, : self._shape[1]]
            return result
        size = (self._height, self._length)
        total = self._spectrum * rfft2(own, size)
        if self._mirrored is not None:
            total += self._mirrored * rfft2(own[::-1], size)
        result[self._columns] = irfft2(total, size)[: own.shape[0], : self._shape[1]]
        return result


def _summed(
    spread: FloatArray, lateral: ComplexArray, size: int, factors: Callable[[FloatArray], FloatArray]
) -> ComplexArray:
    """Sum over the lengths of spreading of factors along x, of `size` numbers each, times spectra of those along y."""
    # Real products cost half as much as complex ones.
    parts = np.ascontiguousarray(lateral).view(np.float64)
    total: FloatArray = np.zeros(())
    step = max(1, CHUNK // size)
    for start in range(0, spread.size, step):
        part = slice(start, start + step)
        total = total + np.tensordot(factors(spread[part]), parts[part], axes=(0, 0))
    return np.ascontiguousarray(total).view(np.complex128)
