"""The cases of a study as the page needs them: scalars of all in memory, surfaces of one when it is looked at."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contactstudy.analysis import single_case
from contactstudy.analysis.provenance import STUDY_ATTRIBUTE, attribute
from contactstudy.arrays.engineering import quantity
from contactstudy.arrays.required import require
from contactstudy.errors import InvalidInputError
from contactstudy.explorer.looked import Looked
from contactstudy.study.lazy_fields import Place
from contactstudy.study.opened import summaries
from contactstudy.study.store import load_variables

LOOKED_AT = ("pressure", "gap", "initial_gap", "von_mises")
"""Variables that the page draws."""

NOT_SOLVED = {
    "failed": "This case failed.",
    "skipped": "This case cannot be solved.",
    "excluded": "The study leaves this case out.",
    "missing": "This case is not solved yet.",
}
"""What a case's status means, for the reader of a page without figures."""

KEPT = 64
"""Cases that stay in memory. Speed."""


@dataclass(frozen=True, eq=False)
class Cases:
    """Cases of a study.

    Parameters
    ----------
    scalars : Dataset
        Scalars over the swept parameters.
    load : callable
        Takes the place of a case; returns it, or raises InvalidInputError.
    title : str
        Name of the study.
    """

    scalars: xr.Dataset
    load: Callable[[Place], Looked]
    title: str

    @property
    def dims(self) -> tuple[str, ...]:
        """Swept parameters with more than one value."""
        status = self.scalars["status"]
        return tuple(str(dim) for dim in status.dims if status.sizes[dim] > 1)

    def choices(self, dim: str) -> list[str]:
        """Values of a swept parameter as they are shown, all different."""
        values = self.scalars[dim].values
        units = str(self.scalars[dim].attrs.get("units", "1"))
        together = [
            str(name)
            for name, entry in self.scalars.coords.items()
            if entry.dims == (dim,) and name != dim and "comment" not in entry.attrs
        ]
        found = []
        for at, value in enumerate(values):
            text = shown(value, units)
            if dim == "case" and together:
                text = ", ".join(f"{name}={self.scalars[name].values[at]}" for name in together)
            found.append(text)
        return found if len(set(found)) == len(found) else [f"{at + 1}: {text}" for at, text in enumerate(found)]

    def place(self, chosen: dict[str, int]) -> Place:
        """Place of the case with these values of the swept parameters, by their number."""
        return tuple(chosen.get(str(dim), 0) for dim in self.scalars["status"].dims)

    def first_solved(self) -> dict[str, int]:
        """Place of the first case that is solved, by swept parameter."""
        solved = np.argwhere(np.isin(self.scalars["status"].values, ("ok", "stale")))
        place = solved[0] if len(solved) else np.zeros(self.scalars["status"].ndim, dtype=int)
        return {str(dim): int(at) for dim, at in zip(self.scalars["status"].dims, place, strict=True)}

    def state(self, place: Place) -> str:
        """Status of a case with its reason."""
        at = dict(zip(self.scalars["status"].dims, place, strict=True))
        status, message = (str(self.scalars[name].isel(at).item()) for name in ("status", "message"))
        return f"{status}: {message}" if message else status


def sentence(state: str) -> str:
    """Why there is nothing to draw of a case, from its status with its reason.

    Examples
    --------
    >>> sentence("skipped: profile: must fit the length"), sentence("missing")
    ('This case cannot be solved. profile: must fit the length', 'This case is not solved yet.')
    """
    status, _, reason = state.partition(": ")
    return f"{NOT_SOLVED.get(status, f'This case is {status}.')} {reason}".rstrip()


def shown(value: Any, units: str) -> str:
    """Value of a swept parameter in the units of engineers.

    Examples
    --------
    >>> shown(1.5e9, "Pa"), shown("cylinder", ""), shown(0.1, "1")
    ('1.5 GPa', 'cylinder', '0.1')
    """
    if isinstance(value, (bool, np.bool_, str)):
        return str(value)
    return quantity(float(value), units, 6)


def of_folder(folder: str | Path) -> Cases:
    """Cases in a study's folder, read from their files one by one when they are looked at."""
    scalars, files = summaries(folder)

    @lru_cache(maxsize=KEPT)
    def load(place: Place) -> Looked:
        if place not in files:
            raise InvalidInputError("case", place, "one that is solved")
        return Looked(load_variables(files[place], LOOKED_AT))

    return Cases(scalars, load, _title(scalars, Path(folder).name))


def of_dataset(opened: xr.Dataset) -> Cases:
    """Cases of an opened study; a result of one case is a study of that one.

    Raises
    ------
    InvalidInputError
        If the Dataset is neither.
    """
    if "status" not in opened:
        require(opened, "pressure")
        one = single_case(opened)
        made = one[[name for name, entry in one.data_vars.items() if entry.ndim == 0]].reset_coords(drop=True)
        made = made.assign(status=xr.DataArray("ok"), message=xr.DataArray(""))
        looked = Looked(one)
        return Cases(made, lambda place: looked, str(opened.attrs.get("title", "result")))
    dims = opened["status"].dims
    kept = [name for name, entry in opened.data_vars.items() if set(entry.dims) <= set(dims)]
    scalars = opened[kept]
    scalars = scalars.drop_vars([name for name in scalars.coords if not set(scalars[name].dims) <= set(dims)])
    names = [name for name in opened.data_vars if name in LOOKED_AT or name in scalars]

    @lru_cache(maxsize=KEPT)
    def load(place: Place) -> Looked:
        at = dict(zip(dims, place, strict=True))
        if str(opened["status"].isel(at).item()) not in ("ok", "stale"):
            raise InvalidInputError("case", place, "one that is solved")
        one = opened[names].isel(at)
        words = [name for name in one.data_vars if one[name].dtype.kind in "UO"]
        return Looked(single_case(one.drop_vars(words)).compute())

    return Cases(scalars.load(), load, _title(opened, "study"))


def _title(dataset: xr.Dataset, name: str) -> str:
    """Name of a study, from what its Dataset says of it."""
    study = attribute(dataset, STUDY_ATTRIBUTE)
    said = str(study.get("name", name))
    return f"{said}: {study['description']}" if study.get("description") else said
