"""Units on labelled input: known ones are converted to SI, others refused."""

from __future__ import annotations

import xarray as xr

from contactstudy import checks
from contactstudy.errors import InvalidInputError

LENGTHS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "micrometer": 1e-6, "nm": 1e-9}
"""Metres per unit."""

PRESSURES = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "N/mm2": 1e6, "N/mm^2": 1e6, "N mm-2": 1e6, "bar": 1e5}
"""Pascals per unit."""


def in_si(name: str, array: xr.DataArray, unit: str) -> xr.DataArray:
    """Return an array with its values in `unit`, "m" or "Pa", and its positions in metres.

    Values and positions that do not say their unit are taken to be in these.

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
    factors = {
        axis: _factor(f"{name}.{axis}", array[axis], "m") for axis in ("x", "y", "x_width") if axis in array.coords
    }
    moved = {axis: array[axis] * factor for axis, factor in factors.items() if factor != 1}
    own = _factor(name, array, unit)
    converted = array.assign_coords(moved) if moved else array
    return converted if own == 1 else converted * own


def _factor(name: str, array: xr.DataArray, unit: str) -> float:
    """Factor that takes the values of an array to `unit`; 1 where it does not say its unit."""
    known = LENGTHS if unit == "m" else PRESSURES
    said = array.attrs.get("units")
    if said is None:
        return 1.0
    if not isinstance(said, str) or said.strip() not in known:
        raise InvalidInputError(
            f"{name}.attrs['units']", said, f"one of {', '.join(known)}", f"without it {unit} is meant"
        )
    return known[said.strip()]
