"""Line contacts that pass over elastic-plastic bodies."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from contactstudy import FiniteLengthSpace, HalfSpace, Material
from contactstudy.verification.closed_forms import hertz_strip

STEEL = Material(1000.0, 0.3)
"""Young's modulus is a thousand times the peak pressure of the contacts."""


@pytest.fixture(scope="session")
def steel_half_space() -> HalfSpace:
    return HalfSpace(material=STEEL)


@pytest.fixture(scope="session")
def steel_between_ends() -> FiniteLengthSpace:
    return FiniteLengthSpace(length=8.0, material=STEEL)


@pytest.fixture(scope="session")
def line_contact() -> Callable[..., xr.Dataset]:
    """Make Hertz' line contact of half-width and peak pressure 1; weaker towards the ends of a given length."""

    def make_contact(friction: float = 0.0, length: float | None = None, positions: int = 9) -> xr.Dataset:
        y = np.linspace(-4, 4, 97)
        z = np.linspace(0.05, 1.95, 20)
        stresses = hertz_strip(y[:, None], z, 1.0, 1.0, 0.3, friction)
        x = np.zeros(1) if length is None else (np.arange(positions) + 0.5) * length / positions
        distribution = np.ones(1) if length is None else 1 - 0.3 * np.abs(2 * x / length - 1) ** 2
        fields = {name: (("x", "y", "z"), distribution[:, None, None] * values) for name, values in stresses.items()}
        return xr.Dataset(fields, {"x": x, "y": y, "z": z})

    return make_contact
