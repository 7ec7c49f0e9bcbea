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
