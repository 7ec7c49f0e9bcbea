"""Bodies, rollers and pressures that many tests share. Lengths are in units of a Hertz half-width, E* is 1."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from contactstudy import FiniteLengthSpace, HalfSpace, Material

Array = np.ndarray


@pytest.fixture(scope="session")
def unit_material() -> Material:
    """Contact modulus 1 and Poisson's ratio 0.3."""
    return Material(young=1 - 0.3**2, poisson=0.3)


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

    def build(
        function: Callable[[Array, Array], Array],
        x_range: tuple[float, float],
        y_range: tuple[float, float],
        cells: tuple[int, int],
    ) -> xr.DataArray:
        x, y = (
            low + (high - low) * (np.arange(count) + 0.5) / count
            for (low, high), count in zip((x_range, y_range), cells, strict=True)
        )
        values = np.broadcast_to(function(x[:, None], y[None, :]), (x.size, y.size))
        return xr.DataArray(values, coords={"x": x, "y": y}, dims=("x", "y"))

    return build


@pytest.fixture(scope="session")
def strip_pressure(on_cells: Callable[..., xr.DataArray]) -> Callable[..., xr.DataArray]:
    """Hertz line pressure of half-width and peak 1, uniform along x over a whole body."""

    def build(length: float, cells: tuple[int, int], window: float = 2.0) -> xr.DataArray:
        return on_cells(
            lambda x, y: np.sqrt(np.maximum(1 - y**2, 0.0)) + 0 * x, (0.0, length), (-window, window), cells
        )

    return build


@pytest.fixture(scope="session")
def cylinder_gap(on_cells: Callable[..., xr.DataArray]) -> Callable[..., xr.DataArray]:
    """Gap of a sharp-ended cylinder over a whole body, for which half-width and peak pressure 1 are Hertz' line."""

    def build(length: float, cells: tuple[int, int], window: float = 2.0) -> xr.DataArray:
        return on_cells(lambda x, y: y**2 + 0 * x, (0.0, length), (-window, window), cells)

    return build


LINE_LOAD = 0.5 * np.pi
"""Load per length of the line contact of half-width and peak pressure 1."""
