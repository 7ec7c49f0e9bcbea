"""Results in units of the Hertz line contact: lengths over its half-width a, stresses over its peak pressure p0."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from contactstudy.analysis.axes import no_positions, position_name, single_case
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, attribute, solved_case
from contactstudy.arrays.required import require
from contactstudy.arrays.units import POSITIONS, required_in_si
from contactstudy.arrays.variables import COORDINATES, Variable, labels, variable_of
from contactstudy.case.case import Case
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import in_words

SCALES = {"m": (1, 0), "m2": (2, 0), "Pa": (0, 1), "N/m": (1, 1), "N": (2, 1), "N m": (3, 1)}
"""Powers of a and of p0 in each unit: a length is divided by a, a load by p0 a**2, and so on."""

KEPT = ("hertz_half_width", "hertz_max_pressure")
"""The scales themselves stay in SI, so that the way back is known."""


def _over(powers: tuple[int, int]) -> str:
    """Name of a scale, such as ``p0 a**2``."""
    a, p0 = powers
    return " ".join(["p0"] * p0 + ([f"a**{a}"] if a > 1 else ["a"] * a))


def normalized(dataset: xr.Dataset) -> xr.Dataset:
    """Lengths over a, stresses over p0, loads over p0 a**2: variables and positions of a result without unit.

    Parameters
    ----------
    dataset : Dataset
        With `hertz_half_width` and `hertz_max_pressure`: a result, an opened study, or what the functions of
        :mod:`contactstudy.analysis` make of it with the two scales added.

    Returns
    -------
    Dataset
        The same variables; those with a unit in `SCALES` are divided, their units become ``1``, and their names say
        by what they were divided. `hertz_half_width` and `hertz_max_pressure` stay in SI. So do swept parameters, and
        positions that all cases of a study share in metres although their a differ: use the coordinates
        ``x_over_a`` and its like there.

    Raises
    ------
    InvalidInputError
        If a scale is missing.

    Examples
    --------
    >>> pressure = xr.DataArray([2.0e9], dims="x", coords={"x": [1e-4]}, attrs={"units": "Pa"})
    >>> one = xr.Dataset({"pressure": pressure, "hertz_half_width": 5e-5, "hertz_max_pressure": 1e9})
    >>> scaled = normalized(one)
    >>> float(scaled.pressure[0]), float(scaled.x[0]), scaled.pressure.attrs["units"]
    (2.0, 2.0, '1')
    """
    require(dataset, *KEPT)
    # Variables, not arrays: there is nothing to align, and the positions change themselves.
    half_width, pressure = (dataset[name].variable for name in KEPT)

    def scaled(array: xr.DataArray, known: Variable) -> xr.Variable:
        powers = SCALES[known.units]
        result = array.variable / (half_width ** powers[0] * pressure ** powers[1])
        # Dimensions of the study come first, as they do in the result.
        result = result.transpose(*(dim for dim in result.dims if dim not in array.dims), *array.dims)
        result.attrs = {**array.attrs, "units": "1", "long_name": f"{known.long_name}, over {_over(powers)}"}
        return result

    variables, coordinates = {}, {}
    for name, array in dataset.data_vars.items():
        known = variable_of(str(name), array.attrs)
        if known.units in SCALES and name not in KEPT:
            variables[name] = scaled(array, known)
    for name, coordinate in dataset.coords.items():
        known = variable_of(str(name), coordinate.attrs, coordinate=True)
        shared = name in dataset.dims and half_width.ndim > 0
        if name in COORDINATES and known.units == "m" and not shared:
            coordinates[name] = scaled(coordinate, known)
            coordinates[name].attrs |= labels(f"{name}_over_a", coordinate=True)  # the words of positions_over_a
    return dataset.assign_coords(coordinates).assign(variables)


def positions_over_a(dataset: xr.Dataset) -> xr.Dataset:
    """Positions over a as dimensions, so that ``.sel(x_over_a=1, method="nearest")`` selects by them.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`; or an opened study whose cases share positions, in metres or over a.

    Returns
    -------
    Dataset
        The same values in SI along ``x_over_a``, ``y_over_a``, ``z_over_a``, and the like for stresses at positions of
        their own; metres are the coordinates ``x``, ``y``, ``z``. A result of `solve` also has the coordinates
        `e_over_a`, `friction`, `gamma` and `profile`, as an opened study has them, as far as its case has one number
        for them: several on the same cells can be joined along one of them. :func:`single_case` goes back.

    Raises
    ------
    InvalidInputError
        If there is no half-width, there are no positions, those over a differ between the cases, or `x` itself is
        over a.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller, solve
    >>> body = FiniteLengthSpace(length=0.5e-3, material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.3e-3), max_pressure=1.5e9)
    >>> result = positions_over_a(solve(case, stresses=False))
    >>> row = result.pressure.sel(x_over_a=3.8, method="nearest").sel(y_over_a=slice(-0.5, 0.5))
    >>> row.dims, round(float(row.e_over_a), 2), round(float(row.gamma), 2)
    (('y_over_a',), 1.54, 0.1)
    """
    dataset = required_in_si(dataset, "hertz_half_width")
    half_width = dataset["hertz_half_width"]
    if half_width.size == 1:
        dataset = single_case(dataset)
        half_width = dataset["hertz_half_width"]
        dataset = dataset.assign_coords(_of_case(dataset))
    for dim in map(str, dataset.dims):
        name = position_name(dim)
        over = f"{name}_over_a"
        if name not in POSITIONS or dim == over:
            continue
        if dataset[dim].attrs.get("units") == "1":
            raise InvalidInputError(dim, "over a", "in metres", "results of analysis.normalized are over a already")
        if half_width.ndim == 0:
            if dim not in dataset.coords:
                raise no_positions(dataset, name)
            values = dataset[dim].variable / half_width.variable
        elif over in dataset.coords and dataset[over].dims == (dim,):
            values = dataset[over].variable
        else:
            allowed = f"with the same {over} in all cases"
            raise InvalidInputError("dataset", f"{dim} of {half_width.size} cases", allowed, "select one case")
        values.attrs = labels(over, coordinate=True)
        dataset = dataset.assign_coords({over: values}).swap_dims({dim: over})
    return dataset


def _of_case(result: xr.Dataset) -> dict[str, Any]:
    """Coordinates that say which case a result is of, as far as one number or word says it."""
    if "case" not in attribute(result, INPUTS_ATTRIBUTE):
        return {}
    case = solved_case(result)
    values = _described(case, float(result["hertz_half_width"]))
    return {name: ((), value, labels(name, coordinate=True)) for name, value in values.items() if name not in result}


def _described(case: Case, half_width: float) -> dict[str, float | str]:
    """Return e/a, friction, gamma and profile of a case; what it has none of is left out."""
    low, high = case.body.extent
    found: dict[str, float | str] = {}
    if np.isfinite(low):
        found["e_over_a"] = case.roller_start / half_width
    if isinstance(case.friction, float):
        found["friction"] = case.friction
    if np.isfinite(high - low):
        found["gamma"] = (high - low) / case.roller.radius
    return found | {"profile": in_words(case.roller.profile)}
