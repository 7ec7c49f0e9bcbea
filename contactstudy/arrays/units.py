"""Units on labelled input: known ones are converted to SI, others refused."""

from __future__ import annotations

from typing import Any

import xarray as xr

from contactstudy import checks
from contactstudy.arrays.required import require
from contactstudy.arrays.vocabulary import VARIABLES
from contactstudy.errors import InvalidInputError
from contactstudy.unit_sizes import factor_to

POSITIONS = ("x", "y", "z", "x_field", "y_field", "x_width")
"""Coordinates in metres."""


def in_si(name: str, array: xr.DataArray, unit: str) -> xr.DataArray:
    """Return an array with its values in `unit`, and its positions in metres.

    The unit is one of :data:`contactstudy.unit_sizes.KNOWN`. Values and positions that do not say their unit are taken
    to be in these.

    Raises
    ------
    InvalidInputError
        If it is no DataArray, or an attribute ``units`` is none that is known.

    Examples
    --------
    >>> in_si("gap", xr.DataArray([1.0], attrs={"units": "mm"}), "m").values.tolist()
    [0.001]
    """
    checks.instance(name, array, xr.DataArray, "an xarray.DataArray with dimensions (x, y)")
    factors = {axis: _factor(f"{name}.{axis}", array[axis], "m") for axis in POSITIONS if axis in array.coords}
    moved = {axis: (array[axis] * factor).assign_attrs(units="m") for axis, factor in factors.items() if factor != 1}
    own = _factor(name, array, unit)
    converted = array.assign_coords(moved) if moved else array
    return converted if own == 1 else (converted * own).assign_attrs(units=unit)


def required_in_si(dataset: xr.Dataset, *names: str, argument: str = "dataset", normalized: bool = False) -> xr.Dataset:
    """Return a Dataset that must hold some variables, with these and all positions in SI.

    Parameters
    ----------
    dataset : Dataset
        What was given.
    *names : str
        Variables that it must hold.
    argument : str
        Name of the argument, for error messages.
    normalized : bool
        Whether variables may also be over a or p0; they stay so.

    Raises
    ------
    InvalidInputError
        If a variable is missing, is over a or p0, where another number is needed, or has a unit that is not known.

    Examples
    --------
    >>> pressure = xr.DataArray([0.5], dims="x", attrs={"units": "MPa"})
    >>> required_in_si(xr.Dataset({"pressure": pressure}), "pressure").pressure.values.tolist()
    [500000.0]
    >>> required_in_si(xr.Dataset({"pressure": pressure.assign_attrs(units="1")}), "pressure")
    Traceback (most recent call last):
    contactstudy.errors.InvalidInputError: dataset = 'pressure without unit': must be in SI, pressure in Pa; ...
    """
    require(dataset, *names, argument=argument)
    changed: dict[str, xr.DataArray] = {}
    for name in names:
        units, array = VARIABLES[name].units, dataset[name]
        said = array.attrs.get("units", units)
        if not units:  # that of another variable
            continue
        if said == "1" != units and not normalized:
            hint = "lengths over a and pressures over p0, as from analysis.normalized, are for figures and files"
            raise InvalidInputError(argument, f"{name} without unit", f"in SI, {name} in {units}", hint)
        factor = 1.0 if said in ("1", units) else factor_to(units, f"{argument}.{name}.attrs['units']", said)
        if factor != 1:
            changed[name] = (array * factor).assign_attrs({**array.attrs, "units": units})
    for axis in POSITIONS:
        if axis in dataset.coords and dataset[axis].attrs.get("units", "m") not in ("m", "1"):
            place = dataset[axis]
            factor = factor_to("m", f"{argument}.{axis}.attrs['units']", place.attrs["units"])
            changed[axis] = (place * factor).assign_attrs({**place.attrs, "units": "m"})
    positions = {name: each.variable for name, each in changed.items() if name in POSITIONS}
    values = {name: each.variable for name, each in changed.items() if name not in POSITIONS}
    return dataset.assign_coords(positions).assign(values) if changed else dataset


def numbers_in_si(name: str, values: Any, unit: str) -> Any:
    """Return numbers in a unit of SI: a DataArray that says its unit is converted, all else stays as it is.

    Examples
    --------
    >>> depths = xr.DataArray([0.1], attrs={"units": "mm"})
    >>> numbers_in_si("z", [0.1], "m"), numbers_in_si("z", depths, "m").values.tolist()
    ([0.1], [0.0001])
    """
    if not isinstance(values, xr.DataArray):
        return values
    factor = _factor(name, values, unit)
    return values if factor == 1 else values * factor


def _factor(name: str, array: xr.DataArray, unit: str) -> float:
    """Factor that takes the values of an array to `unit`; 1 where it does not say its unit."""
    said = array.attrs.get("units")
    return 1.0 if said is None else factor_to(unit, f"{name}.attrs['units']", said)
