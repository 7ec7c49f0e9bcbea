"""Labelled arrays: units and names from the one table of variables, and values and grid of an array on cell centres."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.grid import SPACING_TOLERANCE, Grid, uniform_range
from contactstudy.arrays.vocabulary import AXES as AXES
from contactstudy.arrays.vocabulary import COORDINATES as COORDINATES
from contactstudy.arrays.vocabulary import RULES as RULES
from contactstudy.arrays.vocabulary import STRESSES as STRESSES
from contactstudy.arrays.vocabulary import VARIABLES as VARIABLES
from contactstudy.arrays.vocabulary import Variable as Variable
from contactstudy.checks import MAX_MAGNITUDE, REAL_KINDS, FloatArray, factor_to
from contactstudy.errors import InvalidInputError
from contactstudy.versions import version_of

DERIVED = "follows from the other parameters"  # comment of a coordinate that a study does not sweep
ERROR_KIND = "error_kind"  # attribute of a number: kind of its error, one of the two values below
ESTIMATED, NOT_ESTIMATED = "estimated", "not estimated"  # whether ``<name>_error`` has the error
UNKNOWN_ERROR = f"error {NOT_ESTIMATED}"  # remark on a number in tables and figures

_AFFIXES = sorted((tuple(pattern.split("{name}")) for pattern in RULES), key=lambda pair: -len("".join(pair)))
"""Prefix and suffix of each rule, the longest first: `peak_gap_x` is the position of a peak, not a peak."""


def specification(name: str, base: Variable | None = None, *, coordinate: bool = False) -> Variable | None:
    """Specification of a variable or coordinate by its name; None if the name is unknown."""
    entry = (COORDINATES if coordinate else VARIABLES).get(name)
    if entry is not None:
        return _fill_templates(entry, base or Variable((), "", "", "value"))
    for prefix, suffix in _AFFIXES:
        base_name = name.removeprefix(prefix).removesuffix(suffix)
        if name == f"{prefix}{base_name}{suffix}" and base_name:
            of = base or specification(base_name) or specification(base_name, coordinate=True)
            return of and _fill_templates(RULES[f"{prefix}{{name}}{suffix}"], of)
    return None


def _fill_templates(row: Variable, base: Variable) -> Variable:
    """Row of the table whose names in braces are replaced by the texts of `base`."""
    fields = {"name": "", "variable": base.long_name, "units": base.units, "symbol": base.symbol or base.long_name}
    dims = base.dims if row.dims == ("{name}",) else row.dims
    symbol = row.symbol
    if "{symbol}" in symbol:
        symbol = symbol.format(**fields) if base.symbol else ""
    long_name = row.long_name.format(**fields)
    fields["variable"] = ", ".join(filter(None, (base.long_name, base.comment)))
    return Variable(dims, row.units.format(**fields), symbol, long_name, row.comment.format(**fields))


def variable_of(name: str, attributes: Mapping[Any, Any], *, coordinate: bool = False) -> Variable:
    """Specification of a variable from its attributes, completed by the table."""
    entry = specification(name, coordinate=coordinate) or Variable((), "", "", name)
    return entry._replace(
        units=str(attributes.get("units", entry.units)), long_name=str(attributes.get("long_name", entry.long_name))
    )


def labels(name: str, base: Variable | None = None, *, coordinate: bool = False) -> dict[str, str]:
    """Attributes of a variable or coordinate by its name; empty if the name is unknown."""
    entry = specification(name, base, coordinate=coordinate)
    return entry.attrs if entry else {}


def name_array(name: str, array: xr.DataArray, base: Variable | None = None) -> xr.DataArray:
    """Return `array` with a name of the table and its unit and meaning."""
    renamed = array.rename(name)
    renamed.attrs = labels(name, base)
    return renamed


def package_version() -> str:
    """Version of the installed package."""
    return version_of("contactstudy")


def without_error(dataset: xr.Dataset, *names: str) -> xr.Dataset:
    """Return `dataset` with the error kind "not estimated" on the named variables, if present."""
    result = dataset.copy()
    for name in names:
        if name in result:
            result[name].attrs[ERROR_KIND] = NOT_ESTIMATED
    return result


def describe(dataset: xr.Dataset, title: str | None = None) -> xr.Dataset:
    """Return `dataset` with units and meanings from the table; existing attributes remain."""
    result = dataset.copy()
    for name, variable in result.variables.items():
        variable.attrs = labels(str(name), coordinate=name in result.coords) | variable.attrs
        if ERROR_KIND not in variable.attrs and (error := result.variables.get(f"{name}_error")) is not None:
            variable.attrs[ERROR_KIND] = ESTIMATED if error.notnull().any() else NOT_ESTIMATED
    if title is not None:
        conventions = {"Conventions": "CF-1.11", "source": f"contactstudy {package_version()}"}
        result.attrs = conventions | result.attrs | {"title": title}
    for name in result.coords:
        # CF: a coordinate has all values, without a fill value.
        result[name].encoding["_FillValue"] = None
    return result


def require(dataset: object, *names: str, argument: str = "dataset") -> None:
    """Raise unless a Dataset holds the variables that are needed."""
    expected = f"a Dataset with {', '.join(names)}" if names else "an xarray.Dataset"
    if not isinstance(dataset, xr.Dataset):
        raise InvalidInputError(argument, type(dataset).__name__, expected)
    missing = [name for name in names if name not in dataset]
    if not missing:
        return
    status = dataset.get("status")
    if status is not None and status.ndim == 0 and str(status.item()) != "ok":
        reason = str(dataset["message"].item()) if "message" in dataset else ""
        raise InvalidInputError(argument, f"a {status.item()} case", "a solved case", reason)
    entry = VARIABLES.get(missing[0])
    if entry is None:
        checks.known_name("variable", missing[0], map(str, dataset.data_vars))
    hint = f"{missing[0]} is missing"
    if entry is not None and entry.dims:
        level = "fields" if "z" in entry.dims else "surface"
        hint += f"; a study keeps it at level {level!r}"
    raise InvalidInputError(argument, sorted(map(str, dataset.data_vars)), expected, hint)


POSITIONS = ("x", "y", "z", "x_field", "y_field", "x_width")  # coordinates in metres


def in_si(name: str, values: Any, unit: str) -> Any:
    """Return a DataArray with its values in `unit` of SI and its positions in metres; other values are unchanged."""
    if not isinstance(values, xr.DataArray):
        return values
    factors = {axis: _factor(f"{name}.{axis}", values[axis], "m") for axis in POSITIONS if axis in values.coords}
    coordinates = {
        axis: (values[axis] * factor).assign_attrs(units="m") for axis, factor in factors.items() if factor != 1
    }
    scale = _factor(name, values, unit)
    converted = values.assign_coords(coordinates) if coordinates else values
    return converted if scale == 1 else (converted * scale).assign_attrs(units=unit)


def require_in_si(dataset: xr.Dataset, *names: str, argument: str = "dataset", normalized: bool = False) -> xr.Dataset:
    """Return a Dataset that must hold some variables, with these and all positions in SI."""
    require(dataset, *names, argument=argument)
    units = {name: VARIABLES[name].units for name in names}
    for name, unit in (units | {axis: "m" for axis in POSITIONS if axis in dataset.coords}).items():
        stated_unit = dataset[name].attrs.get("units", unit)
        if not unit or stated_unit == unit:  # without unit: depends on another variable
            continue
        if stated_unit == "1":
            if name in names and not normalized:
                hint = "lengths over a and pressures over p0, as from analysis.normalized, are for figures and files"
                raise InvalidInputError(argument, f"{name} without unit", f"in SI, {name} in {unit}", hint)
            continue
        converted = dataset[name].variable * factor_to(unit, f"{argument}.{name}.attrs['units']", stated_unit)
        converted.attrs = {**dataset[name].attrs, "units": unit}
        dataset = dataset.assign_coords({name: converted}) if name in POSITIONS else dataset.assign({name: converted})
    return dataset


def _factor(name: str, array: xr.DataArray, unit: str) -> float:
    """Factor that takes the values of an array to `unit`; 1 without a unit."""
    stated_unit = array.attrs.get("units")
    return 1.0 if stated_unit is None else factor_to(unit, f"{name}.attrs['units']", stated_unit)


def index_of(dataset: xr.Dataset | xr.DataArray, name: str, value: object, argument: str = "selection") -> int:
    """Return the index of a value of a swept parameter along its dimension."""
    if name not in dataset.indexes:
        swept = dataset["status"].dims if isinstance(dataset, xr.Dataset) and "status" in dataset else ()
        raise InvalidInputError(argument, name, f"a swept parameter: {', '.join(map(str, swept)) or 'none'}")
    labels = dataset.indexes[name]
    indices = [index for index, label in enumerate(labels) if _equals(value, label)]
    if not indices:
        raise InvalidInputError(f"{argument}[{name!r}]", value, f"one of {', '.join(map(str, labels))}")
    return indices[0]


def _equals(value: object, label: object) -> bool:
    """Whether a value, or the text of a value, equals a label."""
    if isinstance(label, str):
        return str(value) == label
    try:
        return math.isclose(float(str(value)), float(str(label)), rel_tol=1e-9)
    except ValueError:
        return bool(value == label)


def selection_of(texts: Iterable[str]) -> dict[str, str]:
    """Values of swept parameters by name, each given as ``NAME=VALUE``."""
    selection = {}
    for text in texts:
        name, separator, value = text.partition("=")
        if not separator:
            raise InvalidInputError("select", text, "NAME=VALUE with the name and a value of a swept parameter")
        selection[name] = value
    return selection


def labelled_cells(
    name: str, array: xr.DataArray, *, extent: tuple[float, float] = (-np.inf, np.inf), infinite: bool = False
) -> tuple[FloatArray, Grid]:
    """Values (x, y) and grid of a DataArray on cell centres; `x_width`, or else the body's end, gives the edges."""
    # A DataArray without the dimension `bounds` cannot contain `x_bounds`.
    checks.instance(name, array, xr.DataArray, "an xarray.DataArray with dimensions (x, y)")
    if set(array.dims) != {"x", "y"}:
        raise InvalidInputError(f"{name}.dims", array.dims, "('x', 'y')")
    for axis in ("x", "y"):
        if axis not in array.coords:
            raise InvalidInputError(f"{name}.coords", list(array.coords), f"with {axis} (cell centres, metres)")
    y_range, cells_y = uniform_range("y", array["y"].values)
    grid = _grid(array, extent, y_range, cells_y)
    try:
        if array.dtype.kind not in REAL_KINDS:
            raise TypeError
        values = np.ascontiguousarray(array.transpose("x", "y").values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInputError(f"{name}.dtype", array.dtype, "real numbers") from None
    is_invalid = ~(np.abs(values) <= MAX_MAGNITUDE)
    if infinite:
        is_invalid &= values != np.inf
    if is_invalid.any():
        i, j = np.argwhere(is_invalid)[0]
        raise InvalidInputError(
            name,
            f"{values[i, j]} at x = {grid.x[i]:g}, y = {grid.y[j]:g}",
            f"finite everywhere, of a size up to {MAX_MAGNITUDE:g}",
            f"{is_invalid.sum()} values are not",
        )
    return values, grid


def cell_coordinates(grid: Grid) -> dict[str, tuple[tuple[str, ...], FloatArray]]:
    """Coordinates `x_bounds` (CF conventions) and `x_width` of cells of different widths; empty for uniform cells."""
    if grid.uniform:
        return {}
    edges = grid.x_edges
    return {"x_bounds": (("x", "bounds"), np.stack([edges[:-1], edges[1:]], axis=1)), "x_width": (("x",), grid.widths)}


def _grid(array: xr.DataArray, extent: tuple[float, float], y_range: tuple[float, float], cells_y: int) -> Grid:
    """Grid of an array whose cells along y are known."""
    if "x_width" in array.coords:
        widths = checks.coordinates("x_width", array["x_width"].values)
        centres = checks.coordinates("x", array["x"].values)
        lower_edges, upper_edges = centres - 0.5 * widths, centres + 0.5 * widths
        gap_widths = np.abs(upper_edges[:-1] - lower_edges[1:])
        gap_indices = np.flatnonzero(gap_widths > SPACING_TOLERANCE * (upper_edges - lower_edges)[:-1])
        if gap_indices.size:
            index = int(gap_indices[0])
            borders = f"one cell ends at {upper_edges[index]:g} m, the next begins at {lower_edges[index + 1]:g} m"
            raise InvalidInputError("x_width", borders, "such that cells meet")
        edges = np.concatenate([lower_edges[:1], 0.5 * (upper_edges[:-1] + lower_edges[1:]), upper_edges[-1:]])
        return Grid.between(edges, y_range, cells_y)
    try:
        x_range, cells_x = uniform_range("x", array["x"].values)
    except InvalidInputError as error:
        centres = checks.coordinates("x", array["x"].values)
        if centres.size < 2 or not np.isfinite(extent[0]):
            raise InvalidInputError(
                error.parameter, error.value, error.allowed, "cells of different widths need a coordinate x_width (x)"
            ) from None
        # The cells follow each other from the body's end.
        positions = [extent[0]]
        for centre in centres:
            positions.append(2 * centre - positions[-1])
            if not positions[-2] < centre:
                raise InvalidInputError(
                    "x",
                    f"a cell centre at {centre:g} m",
                    "the middle of a cell that follows the others from the body's end",
                    "add a coordinate x_width (x) for cells of different widths",
                ) from None
        return Grid.between(positions, y_range, cells_y)
    return Grid(x_range=x_range, y_range=y_range, cells_x=cells_x, cells_y=cells_y)
