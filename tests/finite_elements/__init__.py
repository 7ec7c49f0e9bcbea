"""Stresses of a finite-length space by independent finite elements, stored, and the load cases they belong to.

>>> for name in CASES:
...     reference = load(name)

`reference.case` has the body and the load, `p(x, y) = p0 g(x) h(y)` with `h(y) = (1 - y^2)^2` on `|y| < 1`
and `q = f p` along `+y`; `reference.stress` has `sigma_xx` and the other components on dims `(x, y, z)`.
Lengths are in units of `a`, half the width of the load, and stresses in units of `p0`.
`python -m tests.finite_elements.generate` makes the stored file anew.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray

Array = NDArray[np.float64]
DATA = Path(__file__).resolve().parents[2] / "data" / "finite_elements_stress.nc"


@dataclass(frozen=True)
class Uniform:
    """The same pressure from end to end."""

    def __call__(self, x: Array) -> Array:
        return np.ones_like(np.asarray(x, dtype=float))

    def __str__(self) -> str:
        return "g(x) = 1"


@dataclass(frozen=True)
class Linear:
    """A pressure that falls from 1 at `x = 0` with a constant slope."""

    slope: float

    def __call__(self, x: Array) -> Array:
        return 1 - self.slope * np.asarray(x, dtype=float)

    def __str__(self) -> str:
        return f"g(x) = 1 - {self.slope} x"


@dataclass(frozen=True)
class Bump:
    """A squared cosine, zero from `half_width` off its centre."""

    centre: float
    half_width: float

    def __call__(self, x: Array) -> Array:
        t = np.clip((np.asarray(x, dtype=float) - self.centre) / self.half_width, -1, 1)
        return np.asarray(np.cos(0.5 * np.pi * t) ** 2)

    def __str__(self) -> str:
        c, w = self.centre, self.half_width
        return f"g(x) = cos(pi (x - {c}) / {2 * w})^2 on |x - {c}| < {w}, else 0"


def profile_y(y: Array) -> Array:
    """`h(y)`: `(1 - y^2)^2` inside `|y| < 1`, zero outside."""
    return np.asarray(np.clip(1 - np.asarray(y, dtype=float) ** 2, 0, None) ** 2)


@dataclass(frozen=True)
class LoadCase:
    """A body with free ends at `x = 0` and `x = length`, and the load on its top."""

    length: float
    g: Callable[[Array], Array]
    friction: float = 0.0
    poisson: float = 0.3

    @property
    def h(self) -> Callable[[Array], Array]:
        return profile_y

    def pressure(self, x: Array, y: Array) -> Array:
        """Pressure at the tensor product of points, over `p0`."""
        return np.outer(self.g(np.asarray(x)), self.h(np.asarray(y)))

    @property
    def symmetric(self) -> bool:
        """Even about mid-length: only then have differences of the top's displacement a meaning."""
        x = np.linspace(0, self.length, 101)
        return bool(np.allclose(self.g(x), self.g(x)[::-1]))


CASES: dict[str, LoadCase] = {
    "full": LoadCase(8.0, Uniform()),
    "middle": LoadCase(8.0, Bump(4.0, 2.0)),
    "eccentric": LoadCase(8.0, Bump(1.5, 1.0)),
    "full_sliding": LoadCase(8.0, Uniform(), friction=0.3),
    "eccentric_sliding": LoadCase(8.0, Bump(1.5, 1.0), friction=0.3),
    "thin": LoadCase(2.5, Uniform()),
    "wedge_sliding": LoadCase(4.0, Linear(0.2), friction=0.2, poisson=0.1),
}


@dataclass(frozen=True)
class Reference:
    """A load case with its stored stresses.

    `stress` may also hold `displacement_z_young` on `(x, y)`: displacement of the top into the body times
    Young's modulus, less that of the point named in its attributes, over `p0 a`. `error` is the estimate of
    the largest error of any component at any point, over `p0`; `median_error` that of the median.
    """

    name: str
    case: LoadCase
    stress: xr.Dataset
    error: float
    median_error: float


def load(name: str, path: Path = DATA) -> Reference:
    """One stored case."""
    stress = xr.load_dataset(path, group=name)
    return Reference(
        name, CASES[name], stress, float(stress.attrs["error_estimate"]), float(stress.attrs["error_estimate_median"])
    )
