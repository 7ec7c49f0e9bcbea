"""Singular ends in figures: the pressure grows without a limit there, so no height of it is drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy.analysis.axes import cell_size, dimension_along, positions
from contactstudy.checks import BoolArray, FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NOT_DRAWN = 0.05
"""Distance from a singular end, over the Hertz half-width, within which the pressure is not drawn."""

MARK: dict[str, Any] = {"marker": "^", "markersize": 7, "markerfacecolor": "none", "linestyle": "none"}
"""Stands for a value without a limit, at the top of the axes."""

MEANING = "singular: no largest value"

AT_TOP = 0.965
"""Height of the marks over that of the axes."""


def singular_ends(one: xr.Dataset) -> list[float]:
    """Positions of the roller's ends at which the pressure of a single case is singular, metres.

    Examples
    --------
    >>> pressure = xr.DataArray([[1.0], [2.0]], dims=("x", "y"), coords={"x": [0.5, 1.5], "y": [0.0]})
    >>> singular_ends(xr.Dataset({"pressure": pressure, "end_pressure_last": np.inf}))
    [2.0]
    """
    pressure = one["pressure"]
    x = dimension_along(pressure, "x")
    faces = one["initial_gap"] if "initial_gap" in one else xr.zeros_like(pressure)
    finite = faces.where(np.isfinite(faces)).notnull()
    facing = np.flatnonzero(finite.any([dim for dim in faces.dims if dim != x]).values)
    half = 0.5 * (cell_size(pressure, "x") + 0 * positions(pressure, "x")).values
    centres = positions(pressure, "x").values
    borders = {
        "first": centres[facing[0]] - half[facing[0]] if facing.size else np.nan,
        "last": centres[facing[-1]] + half[facing[-1]] if facing.size else np.nan,
    }
    return [
        float(border)
        for end, border in borders.items()
        if f"end_pressure_{end}" in one and np.isinf(float(one[f"end_pressure_{end}"]))
    ]


def near_singular(one: xr.Dataset, ends: list[float], x: FloatArray | None = None) -> BoolArray:
    """Positions along x, by default the cells', that are too near to a singular end to be drawn."""
    x = positions(one["pressure"], "x").values if x is None else x
    near = np.zeros(x.size, dtype=bool)
    if "hertz_half_width" in one:
        for end in ends:
            near |= np.abs(x - end) < NOT_DRAWN * float(one["hertz_half_width"])
    return near


def capped(one: xr.Dataset, field: xr.DataArray) -> tuple[xr.DataArray, float]:
    """Field no larger than it is away from singular ends, and that bound; infinite where there is none.

    Beside a singular end a stress grows with the points towards it, and would take all colours.
    """
    ends = singular_ends(one) if "pressure" in one else []
    if not ends:
        return field, np.inf
    x = dimension_along(field, "x")
    away = ~near_singular(one, ends, positions(field, "x").values)
    most = float(field.isel({x: np.flatnonzero(away)}).max()) if away.any() else np.nan
    if not np.isfinite(most):
        return field, np.inf
    return field.clip(max=most).assign_attrs(field.attrs), most


def mark_at_top(ax: Axes, x: list[float], color: Any) -> None:
    """Mark values without a limit at the top of the axes; those beyond the axes' ends are not seen."""
    if x:
        ax.plot(x, [AT_TOP] * len(x), transform=ax.get_xaxis_transform(), color=color, **MARK)
