"""Singular ends in figures: figures omit the unbounded pressure and mark the end."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy.analysis.axes import cell_widths, dimension_along, positions
from contactstudy.checks import BoolArray, FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

OMITTED_DISTANCE = 0.05  # From a singular end, over the Hertz half-width, within which figures omit the pressure

SINGULAR_MARK: dict[str, Any] = {"marker": "^", "markersize": 7, "markerfacecolor": "none", "linestyle": "none"}
SINGULAR_LABEL = "singular: unbounded"
MARK_HEIGHT = 0.965  # Height of a mark over the height of the axes


def singular_ends(case: xr.Dataset) -> list[float]:
    """Positions of the roller's ends with a singular pressure, metres."""
    pressure = case["pressure"]
    x = dimension_along(pressure, "x")
    initial_gap = case["initial_gap"] if "initial_gap" in case else xr.zeros_like(pressure)
    is_finite = initial_gap.where(np.isfinite(initial_gap)).notnull()
    under_roller = np.flatnonzero(is_finite.any([dim for dim in initial_gap.dims if dim != x]).values)
    if not under_roller.size:
        return []
    centres = positions(pressure, "x").values
    half_widths = 0.5 * cell_widths(pressure, "x").values
    first, last = under_roller[0], under_roller[-1]
    borders = {"first": centres[first] - half_widths[first], "last": centres[last] + half_widths[last]}
    return [
        float(border)
        for end, border in borders.items()
        if f"end_pressure_{end}" in case and np.isinf(float(case[f"end_pressure_{end}"]))
    ]


def near_singular(case: xr.Dataset, ends: list[float], x: FloatArray) -> BoolArray:
    """Whether positions along x lie within `OMITTED_DISTANCE` of a singular end."""
    near_end = np.zeros(x.size, dtype=bool)
    if "hertz_half_width" in case:
        for end in ends:
            near_end |= np.abs(x - end) < OMITTED_DISTANCE * float(case["hertz_half_width"])
    return near_end


def cap_field(case: xr.Dataset, field: xr.DataArray) -> tuple[xr.DataArray, float]:
    """Field clipped to its largest value away from singular ends, and this bound; infinite without singular ends."""
    ends = singular_ends(case) if "pressure" in case else []
    if not ends:
        return field, np.inf
    x = dimension_along(field, "x")
    is_regular = ~near_singular(case, ends, positions(field, "x").values)
    bound = float(field.isel({x: np.flatnonzero(is_regular)}).max()) if is_regular.any() else np.nan
    if not np.isfinite(bound):
        return field, np.inf
    return field.clip(max=bound).assign_attrs(field.attrs), bound


def mark_at_top(ax: Axes, x: list[float], color: Any) -> None:
    """Mark unbounded values at the top of the axes."""
    if x:
        ax.plot(x, [MARK_HEIGHT] * len(x), transform=ax.get_xaxis_transform(), color=color, **SINGULAR_MARK)
