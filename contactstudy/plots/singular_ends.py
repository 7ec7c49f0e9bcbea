"""Singular ends in figures: figures omit the unbounded pressure and mark the end."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy.analysis.axes import cell_edges, dimension_along, positions
from contactstudy.analysis.axial import under_roller
from contactstudy.checks import BoolArray, FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

OMITTED_DISTANCE = 0.05  # From a singular end, over the Hertz half-width, within which figures omit the pressure

SINGULAR_MARK: dict[str, Any] = {"marker": "^", "markersize": 7, "markerfacecolor": "none", "linestyle": "none"}
SINGULAR_LABEL = "singular: unbounded"
MARK_HEIGHT = 0.965  # Height of a mark over the height of the axes


def singular_ends(case: xr.Dataset) -> list[float]:
    """Positions of the roller's ends with a singular pressure, metres."""
    is_singular = [np.isinf(float(case.get(f"end_pressure_{end}", 0.0))) for end in ("first", "last")]
    if not any(is_singular) or "pressure" not in case:
        return []
    facing = under_roller(case).values
    lower_edges, upper_edges = (edges.values[facing] for edges in cell_edges(case["pressure"], "x"))
    ends = np.array([lower_edges[0], upper_edges[-1]])
    return [float(end) for end in ends[is_singular]]


def near_singular(case: xr.Dataset, x: FloatArray) -> BoolArray:
    """Whether positions along x lie within `OMITTED_DISTANCE` of a singular end."""
    distance = OMITTED_DISTANCE * float(case.get("hertz_half_width", 0.0))
    return np.asarray((np.abs(x[:, None] - singular_ends(case)) < distance).any(axis=1))


def cap_field(case: xr.Dataset, field: xr.DataArray) -> tuple[xr.DataArray, float]:
    """Field clipped to its largest value away from singular ends, and this bound; infinite without singular ends."""
    if not singular_ends(case):
        return field, np.inf
    x = dimension_along(field, "x")
    is_regular = ~near_singular(case, positions(field, "x").values)
    bound = float(field.isel({x: is_regular}).max()) if is_regular.any() else np.nan
    if not np.isfinite(bound):
        return field, np.inf
    return field.clip(max=bound).assign_attrs(field.attrs), bound


def mark_at_top(ax: Axes, x: list[float], color: Any) -> None:
    """Mark unbounded values at the top of the axes."""
    if x:
        ax.plot(x, [MARK_HEIGHT] * len(x), transform=ax.get_xaxis_transform(), color=color, **SINGULAR_MARK)
