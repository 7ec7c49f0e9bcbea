"""Cases of a study for the page: scalars of all cases in memory, fields of a case on demand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import xarray as xr

from contactstudy.analysis import single_case
from contactstudy.analysis.provenance import STUDY_ATTRIBUTE, attribute
from contactstudy.arrays.engineering import format_quantity
from contactstudy.arrays.variables import STRESSES, require, variable_of
from contactstudy.errors import InvalidInputError
from contactstudy.explorer.images import CaseFields
from contactstudy.explorer.server import study_title
from contactstudy.study import collect
from contactstudy.study.folder import Folder

CaseIndex = tuple[int, ...]  # Index of a case along the study's dimensions
FIELDS = ("pressure", "gap", "initial_gap", "von_mises", *STRESSES)  # Fields that a loaded case keeps in memory
STATUS = {  # Sentence for each status without figures
    "failed": "This case failed.",
    "skipped": "This case cannot be solved.",
    "excluded": "The study leaves this case out.",
    "missing": "This case is not solved yet.",
}

MAX_CACHED_CASES = 16  # Largest number of loaded cases in memory. Speed
SUBJECTS: dict[str, tuple[str, ...]] = {  # numbers in order; a name with a final underscore is a prefix
    "pressure": ("peak_pressure", "peak_pressure_first", "peak_pressure_last", "peak_pressure_x", "peak_pressure_y"),
    "stresses": ("peak_von_mises", "peak_von_mises_z", "peak_von_mises_x", "peak_von_mises_y", "peak_"),
    "film": (
        *("central_film", "least_film", "end_film_ratio", "least_film_ratio", "least_film_middle"),
        *("least_film_first", "least_film_last", "asperity_load_share"),
    ),
    "ends": (
        *("end_pressure_over_p0", "end_pressure_over_p0_first", "end_pressure_over_p0_last"),
        *("end_pressure_first", "end_pressure_last", "end_load_first", "end_load_last"),
        *("end_intensity", "end_intensity_first", "end_intensity_last"),
        *("end_exponent", "end_exponent_first", "end_exponent_last"),
    ),
    "load and approach": (
        *("normal_load", "hertz_max_pressure", "hertz_half_width", "approach", "tilt", "load_position"),
        *("contact_length", "contact_width", "half_width_middle"),
    ),
    "friction": (
        *("force_y", "force_x", "moment_z", "longitudinal_creepage", "lateral_creepage", "spin", "shift_y", "shift_x"),
        *("sticking_part", "friction_work"),
    ),
    "further numbers": (),  # all that the other subjects lack
    "cells and iteration": ("end_traction_residual", "converged", "iterations", "friction_steps"),
    "solution": ("seconds",),
}


@dataclass(frozen=True, eq=False)
class Cases:
    """Cases of a study: scalars over the parameters with several values, and fields of one case on demand."""

    scalars: xr.Dataset
    load: Callable[[CaseIndex], CaseFields]
    title: str

    @property
    def dims(self) -> tuple[str, ...]:
        """Swept parameters with several values."""
        return tuple(map(str, self.scalars["status"].dims))

    def choices(self, dim: str) -> list[str]:
        """Values of a swept parameter as distinct texts."""
        values = self.scalars[dim].values
        units = str(self.scalars[dim].attrs.get("units", "1"))
        columns = [
            [f"{name}={value}" for value in entry.values]
            for name, entry in self.scalars.coords.items()
            if entry.dims == (dim,) and name != dim and "comment" not in entry.attrs
        ]
        if dim == "case" and columns:
            texts = [", ".join(entries) for entries in zip(*columns, strict=True)]
        else:
            texts = [
                str(value) if isinstance(value, (bool, np.bool_, str)) else format_quantity(float(value), units, 6)
                for value in values
            ]
        return texts if len(set(texts)) == len(texts) else [f"{i}: {text}" for i, text in enumerate(texts, start=1)]

    def first_solved(self) -> dict[str, int]:
        """Index of the first solved case, by swept parameter."""
        solved = np.argwhere(np.isin(self.scalars["status"].values, ("ok", "stale")))
        index = solved[0].tolist() if len(solved) else [0] * len(self.dims)
        return dict(zip(self.dims, index, strict=True))

    def status(self, index: CaseIndex) -> tuple[str, str]:
        """Status of a case, and its reason."""
        entry = self.scalars[["status", "message"]].isel(dict(zip(self.dims, index, strict=True)))
        return str(entry["status"].item()), str(entry["message"].item())


def status_sentence(status: str, reason: str) -> str:
    """Return the reason why a case has no figures, as a sentence."""
    return f"{STATUS.get(status, f'This case is {status}.')} {reason}".rstrip()


def open_cases(study: xr.Dataset | str | Path) -> Cases:
    """Return the cases of an opened study, of a result, or of a study's folder."""
    if not isinstance(study, xr.Dataset):
        cases = _cases_of_folder(Path(study))
    else:
        cases = _cases_of_study(study) if "status" in study else _case_of_result(study)
    return replace(cases, load=lru_cache(maxsize=MAX_CACHED_CASES)(cases.load))


def _cases_of_folder(folder: Path) -> Cases:
    """Cases in a study's folder; each file is read on demand."""
    scalars, results = collect(folder).squeeze(), Folder(folder).results()

    def load(index: CaseIndex) -> CaseFields:
        return CaseFields(results.case(str(scalars["case_id"].values[index]), FIELDS))

    return Cases(scalars, load, study_title(attribute(scalars, STUDY_ATTRIBUTE), folder.name))


def _case_of_result(result: xr.Dataset) -> Cases:
    """Return a result of one case as a study."""
    require(result, "pressure")
    case = single_case(result)
    scalars = case[[name for name, entry in case.data_vars.items() if entry.ndim == 0]].reset_coords(drop=True)
    scalars = scalars.assign(status=xr.DataArray("ok"), message=xr.DataArray(""))
    fields = CaseFields(case)
    return Cases(scalars, lambda index: fields, str(result.attrs.get("title", "result")))


def _cases_of_study(study: xr.Dataset) -> Cases:
    """Cases of an opened study."""
    study = study.squeeze([dim for dim in study["status"].dims if study.sizes[dim] == 1])
    dims = study["status"].dims
    scalars = study[[name for name, entry in study.data_vars.items() if set(entry.dims) <= set(dims)]]
    scalars = scalars.drop_vars([name for name in scalars.coords if not set(scalars[name].dims) <= set(dims)])

    def load(index: CaseIndex) -> CaseFields:
        entry = study.isel(dict(zip(dims, index, strict=True)))
        if str(entry["status"].item()) not in ("ok", "stale"):
            raise InvalidInputError("case", index, "a solved case")
        names = [name for name in study.data_vars if name in FIELDS or name in scalars]
        return CaseFields(single_case(entry[[name for name in names if entry[name].dtype.kind not in "UO"]]).compute())

    return Cases(scalars.load(), load, study_title(attribute(study, STUDY_ATTRIBUTE), "study"))


def numbers_by_subject(scalars: xr.Dataset) -> dict[str, dict[str, str]]:
    """Return the names of the numbers of all cases, by subject and meaning."""
    names = [
        str(name)
        for name, entry in scalars.data_vars.items()
        if entry.dtype.kind == "f" and not str(name).endswith("_error") and bool(entry.notnull().any())
    ]
    meanings = [variable_of(name, scalars[name].attrs).long_name for name in names]

    entries = [(subject, entry) for subject, members in SUBJECTS.items() for entry in members or ("",)]
    further = entries.index(("further numbers", ""))

    def rank(name: str) -> int:
        is_member = (name == entry or (entry.endswith("_") and name.startswith(entry)) for _, entry in entries)
        return next((index for index, member in enumerate(is_member) if member), further)

    groups: dict[str, dict[str, str]] = {}
    for index, name, meaning in sorted((rank(name), name, text) for name, text in zip(names, meanings, strict=True)):
        # The texts of all groups are distinct.
        text = meaning if meanings.count(meaning) == 1 else f"{meaning}, {name}"
        groups.setdefault(entries[index][0], {})[text] = name
    return groups
