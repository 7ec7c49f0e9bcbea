"""Selection of the values of a study's parameters that a figure shows, and their text in titles."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np
import xarray as xr

from contactstudy.arrays.engineering import format_quantity, unit_for
from contactstudy.arrays.variables import index_of
from contactstudy.errors import InvalidInputError
from contactstudy.plots.style import SYMBOLS, escape_dollars

Array = TypeVar("Array", xr.DataArray, xr.Dataset)


def select_one(array: Array, axes: tuple[str, ...], selection: Mapping[str, Any]) -> Array:
    """Array, or Dataset, over the dimensions `axes`, with the selected value of every other dimension."""
    swept = [str(dim) for dim in array.dims if dim not in axes]
    for name in selection:
        if name not in swept:
            raise InvalidInputError("selection", name, f"of {', '.join(swept) or 'nothing'}")
    for dim in swept:
        if dim in selection:
            array = array.isel({dim: index_of(array, dim, selection[dim])})
        elif array.sizes[dim] == 1:
            array = array.isel({dim: 0})
        else:
            raise InvalidInputError(
                "selection", dict(selection), f"with a value of {dim}", f"the study has {array.sizes[dim]} of them"
            )
    return array


def most_solved(array: xr.DataArray, axes: tuple[str, ...], selection: Mapping[str, Any]) -> dict[str, Any]:
    """Values of the parameters other than `axes`: selected values, or the first with most solved cases."""
    dims = [str(dim) for dim in array.dims if str(dim) not in axes]
    choices = [[selection[dim]] if dim in selection else list(array[dim].values) for dim in dims]
    combinations = [dict(zip(dims, values, strict=True)) for values in itertools.product(*choices)]
    return max(combinations, key=lambda values: int(np.isfinite(select_one(array, axes, values)).sum()))


def scale_of(array: xr.DataArray) -> tuple[float, str]:
    """Size in SI, and name, of the unit that suits a figure's axis; an empty name for a pure number."""
    max_magnitude = float(abs(array).where(np.isfinite(array)).max())
    return unit_for(max_magnitude, str(array.attrs.get("units", "1")))


def scale_values(array: xr.DataArray, name: str) -> tuple[xr.DataArray, str]:
    """Values and label of a parameter or quantity: stresses in MPa or GPa, lengths in µm or mm."""
    text = SYMBOLS.get(name) or str(array.attrs.get("long_name", name.replace("_", " ")))
    if text.startswith("z of "):
        text = f"depth of {text.removeprefix('z of ')}"
    factor, unit = scale_of(array)
    return (array if factor == 1.0 else array / factor), f"{text} ({unit})" if unit else text


def describe_value(name: str, value: Any, units: str, count: int = 1) -> str:
    """Text of one value of a parameter, with the number of values in the study if several."""
    is_number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    text = format_quantity(float(value), units or "1") if is_number else escape_dollars(value)
    symbol = "$p_0$" if name == "max_pressure" else name.replace("_over_a", "/a").replace("_", " ")
    return f"{symbol} = {text}" + (f", one of {count} values" if count > 1 else "")
