"""Bodies, rollers and pressures that many tests share. Lengths are in units of a Hertz half-width, E* is 1."""

from __future__ import annotations

from collections.abc import Callable

import pytest
import xarray as xr

from contactstudy import FiniteLengthSpace, HalfSpace, Material
from contactstudy.verification import problems


@pytest.fixture(scope="session")
def unit_material() -> Material:
    """Contact modulus 1 and Poisson's ratio 0.3."""
    return problems.unit_material(0.3)


@pytest.fixture(scope="session")
def half_space(unit_material: Material) -> HalfSpace:
    return HalfSpace(material=unit_material)


@pytest.fixture(scope="session")
def short_body(unit_material: Material) -> FiniteLengthSpace:
    """Eight half-widths long."""
    return FiniteLengthSpace(length=8.0, material=unit_material)


@pytest.fixture(scope="session")
def on_cells() -> Callable[..., xr.DataArray]:
    """Make a DataArray on cell centres from a function of (x, y)."""
    return problems.on_cells


@pytest.fixture(scope="session")
def strip_pressure(on_cells: Callable[..., xr.DataArray]) -> Callable[..., xr.DataArray]:
    """Hertz line pressure of half-width and peak 1, uniform along x over a whole body."""

    def build(length: float, cells: tuple[int, int], window: float = 2.0) -> xr.DataArray:
        return on_cells(problems.strip, (0.0, length), (-window, window), cells)

    return build


@pytest.fixture(scope="session")
def cylinder_gap(on_cells: Callable[..., xr.DataArray]) -> Callable[..., xr.DataArray]:
    """Gap of a sharp-ended cylinder over a whole body, for which half-width and peak pressure 1 are Hertz' line."""

    def build(length: float, cells: tuple[int, int], window: float = 2.0) -> xr.DataArray:
        return on_cells(lambda x, y: y**2 + 0 * x, (0.0, length), (-window, window), cells)

    return build
