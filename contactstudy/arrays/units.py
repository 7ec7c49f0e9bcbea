"""Units on labelled input: known ones are converted to SI, others refused."""

from __future__ import annotations

import xarray as xr

from contactstudy.errors import InvalidInputError

LENGTHS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "micrometer": 1e-6, "nm": 1e-9}
"""Metres per unit."""

PRESSURES = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "N/mm2": 1e6, "N/mm^2": 1e6, "N mm-2": 1e6, "bar": 1e5}
"""Pascals per unit."""


def factor_to_si(name: str, array: xr.DataArray, unit: str) -> float:
    """Factor that takes the values of an array to `unit`, "m" or "Pa"; 1 where it does not say its unit.

    Raises
    ------
    InvalidInputError
        If its attribute ``units`` is none that is known.

    Examples
    --------
    >>> factor_to_si("gap", xr.DataArray([1.0], attrs={"units": "mm"}), "m")
    0.001
    """
    known = LENGTHS if unit == "m" else PRESSURES
    said = array.attrs.get("units")
    if said is None:
        return 1.0
    if not isinstance(said, str) or said.strip() not in known:
        raise InvalidInputError(
            f"{name}.attrs['units']", said, f"one of {', '.join(known)}", f"without it {unit} is meant"
        )
    return known[said.strip()]
