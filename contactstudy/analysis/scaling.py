"""Results in units of the Hertz line contact: lengths over its half-width a, stresses over its peak pressure p0."""

from __future__ import annotations

import xarray as xr

from contactstudy.arrays.required import require
from contactstudy.arrays.variables import COORDINATES, Variable, variable_of

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
    return dataset.assign_coords(coordinates).assign(variables)
