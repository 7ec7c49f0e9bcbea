"""One case as plain arrays: what all its figures need of it is found once, and not again at each step of a slider."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import xarray as xr

from contactstudy.analysis import positions
from contactstudy.analysis.axes import dimension_along
from contactstudy.checks import BoolArray, FloatArray
from contactstudy.plots.singular import near_singular, singular_ends


class Looked:
    """A case that is looked at.

    Parameters
    ----------
    dataset : Dataset
        A single case, in memory.
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        self.dataset = dataset

    @property
    def has_pressure(self) -> bool:
        """Whether its surfaces are kept."""
        return "pressure" in self.dataset

    @cached_property
    def has_stress(self) -> bool:
        """Whether its stresses are kept."""
        return "von_mises" in self.dataset and not bool(self.dataset["von_mises"].isnull().all())

    @cached_property
    def hertz(self) -> tuple[float, float] | None:
        """Half-width and pressure of Hertz' line contact; None if they are not known."""
        if "hertz_half_width" not in self.dataset:
            return None
        return float(self.dataset["hertz_half_width"]), float(self.dataset["hertz_max_pressure"])

    @cached_property
    def cells(self) -> tuple[FloatArray, FloatArray]:
        """Positions of the cells along x and y."""
        x, y = (positions(self.dataset["pressure"], axis).values for axis in "xy")
        return x, y

    @cached_property
    def pressure(self) -> FloatArray:
        """Pressure over x and y."""
        return _values(self.dataset["pressure"], "xy")

    @cached_property
    def along(self) -> FloatArray:
        """Largest pressure across the contact, over x."""
        return np.asarray(self.pressure.max(axis=1))

    @cached_property
    def ends(self) -> list[float]:
        """Positions of the ends at which the pressure is singular."""
        return singular_ends(self.dataset)

    def near(self, x: FloatArray) -> BoolArray:
        """Positions that are too near to a singular end to be drawn."""
        return near_singular(self.dataset, self.ends, x)

    @cached_property
    def most_pressure(self) -> float:
        """Largest pressure that is drawn."""
        return _largest(self.pressure, self.near(self.cells[0]))

    @cached_property
    def points(self) -> dict[str, FloatArray]:
        """Positions of the stresses along each axis."""
        return {axis: positions(self.dataset["von_mises"], axis).values for axis in "xyz"}

    @cached_property
    def stress(self) -> FloatArray:
        """Von Mises stress over x, y and z."""
        return _values(self.dataset["von_mises"], "xyz")

    @cached_property
    def most_stress(self) -> float:
        """Largest von Mises stress that is drawn."""
        x = self.points["x"]
        return _largest(self.stress, self.near(x) if self.has_pressure else np.zeros(x.size, dtype=bool))


def _values(array: xr.DataArray, axes: str) -> FloatArray:
    """Values of a field with its axes in this order."""
    return np.asarray(array.transpose(*(dimension_along(array, axis) for axis in axes)).values)


def _largest(values: FloatArray, near: BoolArray) -> float:
    """Largest value away from singular ends, or of all if nothing is away from them."""
    kept = values[~near] if near.any() and not near.all() else values
    return float(np.nanmax(kept, initial=0.0))
