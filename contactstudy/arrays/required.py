"""What a Dataset must hold to be worked on."""

from __future__ import annotations

import xarray as xr

from contactstudy.arrays.vocabulary import VARIABLES
from contactstudy.errors import InvalidInputError


def require(dataset: object, *names: str, argument: str = "dataset") -> None:
    """Raise unless a Dataset holds the variables that are needed.

    Parameters
    ----------
    dataset : object
        What was given.
    *names : str
        Variables that it must hold.
    argument : str
        Name of the argument, for error messages.

    Raises
    ------
    InvalidInputError
        If it is not a Dataset, it is a case of a study that was not solved, or a variable is missing.

    Examples
    --------
    >>> require(xr.Dataset({"gap": 0.0}), "gap")
    >>> require(xr.Dataset({"gap": 0.0}), "pressure")
    Traceback (most recent call last):
    contactstudy.errors.InvalidInputError: dataset = ['gap']: must be a Dataset with pressure; pressure is missing; ...
    """
    wanted = f"a Dataset with {', '.join(names)}" if names else "an xarray.Dataset"
    if not isinstance(dataset, xr.Dataset):
        raise InvalidInputError(argument, type(dataset).__name__, wanted)
    missing = [name for name in names if name not in dataset]
    if not missing:
        return
    status = dataset.get("status")
    if status is not None and status.ndim == 0 and str(status.item()) != "ok":
        reason = str(dataset["message"].item()) if "message" in dataset else ""
        raise InvalidInputError(argument, f"a {status.item()} case", "a solved case", reason)
    hint = f"{missing[0]} is missing"
    known = VARIABLES.get(missing[0])
    if known is not None and known.dims:
        level = "fields" if "z" in known.dims else "surface"
        hint += f"; a study keeps it at level {level!r}"
    raise InvalidInputError(argument, sorted(map(str, dataset.data_vars)), wanted, hint)


def require_si(dataset: xr.Dataset, *names: str) -> None:
    """Raise if variables are over a or p0: where lengths and pressures meet the half-width, that is another number.

    Examples
    --------
    >>> pressure = xr.DataArray([0.5], dims="x", attrs={"units": "1"})
    >>> require_si(xr.Dataset({"pressure": pressure}), "pressure")
    Traceback (most recent call last):
    contactstudy.errors.InvalidInputError: dataset = 'pressure without unit': must be in SI, pressure in Pa; ...
    """
    for name in names:
        units = VARIABLES[name].units
        if dataset[name].attrs.get("units", units) == "1" != units:
            hint = "lengths over a and pressures over p0, as from analysis.normalized, are for figures and files"
            raise InvalidInputError("dataset", f"{name} without unit", f"in SI, {name} in {units}", hint)
