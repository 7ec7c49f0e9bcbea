"""The contacts that are timed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import xarray as xr

from benchmarks.performance.timing import nudge
from contactstudy import FiniteLengthSpace, HalfSpace, Material
from contactstudy.bodies import Body

FloatArray = npt.NDArray[np.float64]

STEEL = Material(210e9, 0.3)
HALF_WIDTH = 1e-4
RADIUS = 8e-3
# Peers get this multiple of the largest finite gap where the gap is infinite.
DISTANT_GAP = 10.0


@dataclass(frozen=True)
class Problem:
    """A rigid roller or sphere over a grid of cells, and its load.

    Attributes
    ----------
    body : Body
        Body under the roller.
    gap : array (x, y)
        Initial gap, metres; infinite beyond a roller's ends.
    size : tuple
        Window along x and y, metres.
    load : float
        Load, newtons.
    """

    body: Body
    gap: FloatArray
    size: tuple[float, float]
    load: float

    @property
    def contact_modulus(self) -> float:
        """``E / (1 - nu**2)``, Pa."""
        return self.body.material.young / (1 - self.body.material.poisson**2)

    @property
    def finite_gap(self) -> FloatArray:
        """Gap for codes without infinite gaps."""
        is_finite = np.isfinite(self.gap)
        return np.where(is_finite, self.gap, DISTANT_GAP * self.gap[is_finite].max())

    def make_gap_array(self, stretch: float = 1.0) -> xr.DataArray:
        """Gap with its coordinates; another `stretch` makes a grid whose operator is not cached."""
        cells_x, cells_y = self.gap.shape
        x = (np.arange(cells_x) + 0.5) * self.size[0] / cells_x * stretch
        y = (np.arange(cells_y) + 0.5 - cells_y / 2) * self.size[1] / cells_y * stretch
        return xr.DataArray(self.gap, coords={"x": x, "y": y}, dims=("x", "y"))

    def compute_changed_load(self) -> float:
        """Load that differs from every earlier load in its last digits."""
        return self.load * nudge()


def sphere(cells: int) -> Problem:
    """Sphere on a half-space, its Hertz contact half as wide as the square window."""
    half_width, radius = 1e-3, 50e-3
    size = 4 * half_width
    centres = (np.arange(cells) + 0.5 - cells / 2) * size / cells
    gap = (centres[:, None] ** 2 + centres**2) / (2 * radius)
    body = HalfSpace(material=STEEL)
    load = 4 / 3 * STEEL.young / (1 - STEEL.poisson**2) * half_width**3 / radius
    return Problem(body, gap, (size, size), load)


def roller(cells: tuple[int, int], length: float, *, free_ends: bool, overhang: float = 2.0) -> Problem:
    """Cylindrical roller with sharp ends.

    Parameters
    ----------
    cells : tuple of int
        Cells along x and y.
    length : float
        Window along x in Hertz half-widths; with free ends the length of the body.
    free_ends : bool
        Whether the body ends at the window's edges along x.
    overhang : float
        Distance of the window beyond either end of the roller, in half-widths.

    Returns
    -------
    Problem
    """
    size_x, size_y = length * HALF_WIDTH, 3.0 * HALF_WIDTH
    x = (np.arange(cells[0]) + 0.5) * size_x / cells[0] - size_x / 2
    y = (np.arange(cells[1]) + 0.5 - cells[1] / 2) * size_y / cells[1]
    roller_length = size_x - 2 * overhang * HALF_WIDTH
    gap_values = np.where(np.abs(x) <= roller_length / 2, 0.0, np.inf)
    gap = gap_values[:, None] + y**2 / (2 * RADIUS)
    body: Body = HalfSpace(material=STEEL)
    if free_ends:
        body = FiniteLengthSpace(length=size_x, material=STEEL)
    load_per_length = np.pi * HALF_WIDTH**2 * STEEL.young / (1 - STEEL.poisson**2) / (4 * RADIUS)
    return Problem(body, gap, (size_x, size_y), load_per_length * roller_length)
