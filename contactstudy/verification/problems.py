"""Checks, their unit problems, and stored solutions of some problems by independent finite elements.

Lengths are in units of ``a`` and pressures in units of ``p0``: half-width and peak of a prescribed load, or of the
Hertz line contact of the same load per length, with ``E* = 1``, ``R = a / 2`` and the gap ``y**2``.
``python -m benchmarks.finite_elements.generate`` makes the files in ``data`` with scikit-fem, without a formula of the
solver: Fourier series along y, elements of high order in x and z.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import STRESSES
from contactstudy.bodies.material import Material
from contactstudy.checks import FloatArray

Range = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Curve:
    """Computed and expected curve of a check, for a figure."""

    labels: tuple[str, str]  # position and quantity
    positions: FloatArray
    computed: FloatArray
    expected: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Check:
    """One quantity compared with its reference."""

    case: str  # solved problem
    quantity: str  # compared quantity with its unit
    source: str  # source of the reference
    computed: float  # computed value; of a field, the value at the worst point
    expected: float
    difference: float  # between both, over `expected` if relative; for a field the largest or the median
    tolerance: float  # largest difference that passes
    curve: Curve | None = None  # for a figure

    @property
    def passed(self) -> bool:
        """Whether the difference is a number within the tolerance."""
        return bool(abs(self.difference) <= self.tolerance)


class Reference(NamedTuple):
    """A solved problem and the source of its expected values."""

    case: str
    source: str

    def compare(
        self,
        quantity: str,
        computed: ArrayLike,
        expected: ArrayLike,
        tolerance: float,
        *,
        relative: bool = False,
        median: bool = False,
        curve: Curve | None = None,
    ) -> Check:
        """Compare two numbers, or two fields where they differ most or by the median."""
        is_field = np.ndim(computed) > 0
        values, references = (np.ravel(array).astype(float) for array in np.broadcast_arrays(computed, expected))
        differences = np.abs(values - references)
        # argmax also finds a NaN, which exceeds every tolerance.
        is_median = median and not np.isnan(differences).any()
        index = np.argsort(differences)[differences.size // 2] if is_median else differences.argmax()
        value, reference = float(values[index]), float(references[index])
        kind = f", {'median' if median else 'largest'} difference" if is_field else ", relative" if relative else ""
        return Check(
            case=self.case,
            quantity=f"{quantity}{kind}",
            source=self.source,
            computed=value,
            expected=reference,
            difference=(value - reference) / (reference if relative else 1.0),
            tolerance=tolerance,
            curve=curve,
        )


def unit_material(poisson: float = 0.3) -> Material:
    """Material of contact modulus 1."""
    return Material(young=1 - poisson**2, poisson=poisson)


def on_cells(
    function: Callable[[FloatArray, FloatArray], FloatArray], x_range: Range, y_range: Range, cells: tuple[int, int]
) -> xr.DataArray:
    """Values of a function of (x, y) at cell centres; the function receives x as a column and y as a row."""
    grid = Grid(x_range=x_range, y_range=y_range, cells_x=cells[0], cells_y=cells[1])
    return on_grid(function(grid.x[:, None], grid.y[None, :]), grid)


def on_grid(values: FloatArray, grid: Grid) -> xr.DataArray:
    """Values on the cells of a grid, labelled."""
    return xr.DataArray(np.broadcast_to(values, grid.shape), coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))


def components(fields: Mapping[Any, ArrayLike]) -> FloatArray:
    """Six stresses as one array, components first."""
    return np.array([fields[name] for name in STRESSES])


def strip(x: FloatArray, y: FloatArray) -> FloatArray:
    """Hertz line pressure with the half-width 1 and the peak 1."""
    return np.asarray(np.sqrt(np.maximum(1 - y**2, 0.0)) + 0 * x)


def strip_means(x_range: Range, y_range: Range, cells: tuple[int, int]) -> xr.DataArray:
    """Means of `strip` over the cells, from its integral over y: exact resultants."""
    grid = Grid(x_range=x_range, y_range=y_range, cells_x=cells[0], cells_y=cells[1])
    edges = np.clip(np.linspace(*y_range, grid.cells_y + 1), -1.0, 1.0)
    return on_grid(np.diff(0.5 * (edges * np.sqrt(1 - edges**2) + np.arcsin(edges))) / grid.dy, grid)


def point_pressure(grid: Grid, row: int, column: int) -> xr.DataArray:
    """Pressure of a unit load on one cell."""
    values = np.zeros(grid.shape)
    values[row, column] = 1 / grid.cell_area
    return on_grid(values, grid)


LINE_LOAD = 0.5 * np.pi  # Load per length of the line contact of half-width and peak pressure 1


@dataclass(frozen=True)
class Linear:
    """A pressure that falls from 1 at ``x = 0`` with a constant slope, or is uniform."""

    slope: float = 0.0

    def __call__(self, x: FloatArray) -> FloatArray:
        """Shape along x."""
        return np.asarray(1 - self.slope * np.asarray(x, dtype=float))

    def __str__(self) -> str:
        return f"g(x) = 1 - {self.slope} x" if self.slope else "g(x) = 1"


@dataclass(frozen=True)
class Bump:
    """A squared cosine that is zero beyond `half_width` from its centre."""

    centre: float
    half_width: float

    def __call__(self, x: FloatArray) -> FloatArray:
        """Shape along x."""
        t = np.clip((np.asarray(x, dtype=float) - self.centre) / self.half_width, -1, 1)
        return np.asarray(np.cos(0.5 * np.pi * t) ** 2)

    def __str__(self) -> str:
        c, w = self.centre, self.half_width
        return f"g(x) = cos(pi (x - {c}) / {2 * w})^2 on |x - {c}| < {w}, else 0"


def quartic(y: FloatArray) -> FloatArray:
    """`(1 - y^2)^2` inside `|y| < 1`, zero outside."""
    return np.asarray(np.clip(1 - np.asarray(y, dtype=float) ** 2, 0, None) ** 2)


@dataclass(frozen=True)
class LoadCase:
    """A body with free ends at ``x = 0`` and ``x = length``, and the load ``p0 g(x) (1 - y**2)**2`` on its top."""

    length: float  # distance between the ends
    g: Callable[[FloatArray], FloatArray]  # shape of the load along x
    friction: float = 0.0  # traction along +y
    poisson: float = 0.3

    def pressure(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Pressure at the tensor product of points."""
        return np.outer(self.g(np.asarray(x)), quartic(y))

    @property
    def symmetric(self) -> bool:
        """Whether the load is even about mid-length."""
        x = np.linspace(0, self.length, 101)
        return bool(np.allclose(self.g(x), self.g(x)[::-1]))


@dataclass(frozen=True)
class ContactCase:
    """A rigid roller centred over a body with two free ends: the gap is ``y**2 + crown (x - length / 2)**2``."""

    length: float  # distance between the ends
    distance: float  # e, from a free end to the roller's end; negative if the roller overhangs
    crown: float = 0.0  # half of the curvature of the generatrix over a / (2 R)
    poisson: float = 0.3

    @property
    def start(self) -> float:
        """First x under the roller."""
        return max(self.distance, 0.0)

    @property
    def stop(self) -> float:
        """Last x under the roller."""
        return self.length - self.start

    @property
    def load(self) -> float:
        """Load of the line contact of half-width and peak pressure 1 over the whole contact."""
        return LINE_LOAD * (self.stop - self.start)

    def gap_x(self, x: FloatArray) -> FloatArray:
        """Gap along the roller's generatrix."""
        return np.asarray(self.crown * (np.asarray(x, dtype=float) - 0.5 * self.length) ** 2)

    def gap(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Gap at the tensor product of points, infinite beyond the roller."""
        beyond_roller = (x < self.start) | (x > self.stop)
        return np.asarray(np.where(beyond_roller, np.inf, self.gap_x(x))[:, None] + y[None, :] ** 2)


@dataclass(frozen=True, kw_only=True)
class PassesCase:
    """Passes of Hertz' line contact of half-width and peak pressure 1 over an elastic-plastic half-plane."""

    shear_yield_stress: float  # k over the peak pressure
    friction: float  # coefficient of friction, in full sliding along +y
    passes: int
    kinematic_hardening: float = 0.0  # Prager's modulus over Young's modulus
    poisson: float = 0.3


@dataclass(frozen=True, kw_only=True)
class LubricatedCase:
    """A roller with Lundberg's profile, flush with both free ends; Barus oil of constant density; heights in a²/R."""

    length: float
    amplitude: float  # amplitude of the profile
    load_number: float  # Moes' M of the mean load per length
    lubricant_number: float  # Moes' L
    poisson: float = 0.3


# Loads whose stresses are stored, by name
LOAD_CASES: dict[str, LoadCase] = {
    "full": LoadCase(8.0, Linear()),
    "middle": LoadCase(8.0, Bump(4.0, 2.0)),
    "eccentric": LoadCase(8.0, Bump(1.5, 1.0)),
    "full_sliding": LoadCase(8.0, Linear(), friction=0.3),
    "eccentric_sliding": LoadCase(8.0, Bump(1.5, 1.0), friction=0.3),
    "thin": LoadCase(2.5, Linear()),
    "plate_sliding": LoadCase(0.5, Linear(), friction=0.3),
    "wedge_sliding": LoadCase(4.0, Linear(0.2), friction=0.2, poisson=0.1),
}
# Contacts that are stored, by name
CONTACT_CASES: dict[str, ContactCase] = {
    "flush": ContactCase(8.0, 0.0),
    "inside": ContactCase(8.0, 1.0),
    "crowned": ContactCase(8.0, 0.5, crown=0.15),
    "overhanging": ContactCase(8.0, -2.0, crown=0.03),
}
# Passes whose residual stresses and plastic strains are stored, on either side of the shakedown limits 4.0 k, 3.2 k
PASSES_CASES: dict[str, PassesCase] = {
    "settling": PassesCase(shear_yield_stress=1 / 3.6, friction=0.0, passes=2),
    "settling_sliding": PassesCase(shear_yield_stress=1 / 3.1, friction=0.2, passes=5),
    "flowing": PassesCase(shear_yield_stress=1 / 4.3, friction=0.0, passes=3),
    "flowing_sliding": PassesCase(shear_yield_stress=1 / 3.4, friction=0.2, passes=2),
}
# Films that are stored, by name
FILM_CASES: dict[str, LubricatedCase] = {
    "crowned": LubricatedCase(length=8.0, amplitude=0.25, load_number=10.0, lubricant_number=5.0)
}
# Files of the stored finite elements, one group for each case
STRESS_FILE, CONTACT_FILE = "finite_elements_stress.nc", "finite_elements_contact.nc"
PASSES_FILE, FILM_FILE = "finite_elements_passes.nc", "finite_elements_film.nc"


def data_file(name: str) -> Path:
    """Path of a data file: inside the installed package, or in the project's folder of an editable installation."""
    package_path = Path(str(files("contactstudy.verification"))) / "data" / name
    return package_path if package_path.exists() else Path(__file__).resolve().parents[2] / "data" / name


def load_reference(file: str, name: str) -> xr.Dataset:
    """Load the stored solution of a case; attributes of the Dataset or its variables hold the `error_estimate`."""
    return xr.load_dataset(data_file(file), group=name)
