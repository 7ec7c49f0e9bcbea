"""Analytic histories of a material point."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from contactstudy.arrays.variables import STRESSES


@pytest.fixture(scope="session")
def cycle() -> Callable[..., xr.Dataset]:
    """Make a history along y from components given as sequences; other components are zero."""

    def make_history(**components: object) -> xr.Dataset:
        values = {name: np.asarray(value, dtype=float) for name, value in components.items()}
        count = next(iter(values.values())).size
        zeros = np.zeros(count)
        y = np.linspace(-1, 1, count)
        return xr.Dataset({name: ("y", values.get(name, zeros)) for name in STRESSES}, coords={"y": y})

    return make_history


@pytest.fixture(scope="session")
def wave() -> np.ndarray:
    """One period of a sine of amplitude 1, with its extremes."""
    return np.sin(2 * np.pi * np.arange(48) / 48)
