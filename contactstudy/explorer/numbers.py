"""Numbers of a study's cases in the order in which an engineer looks for them, by subject."""

from __future__ import annotations

import xarray as xr

from contactstudy.arrays.variables import variable_of

SUBJECTS: dict[str, tuple[str, ...]] = {
    "pressure": ("peak_pressure", "peak_pressure_first", "peak_pressure_last", "peak_pressure_x", "peak_pressure_y"),
    "stresses": ("peak_von_mises", "peak_von_mises_z", "peak_von_mises_x", "peak_von_mises_y", "peak_"),
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
    "cells and iteration": ("end_traction_residual", "converged", "iterations", "friction_steps"),
    "how it was solved": ("seconds",),
}
"""Subjects with their numbers in order; a name that ends in an underscore stands for all that begin with it."""

OTHER = "other numbers"
"""Subject of all that is in none; it stands before the cells."""

ORDER = [*list(SUBJECTS)[:-2], OTHER, *list(SUBJECTS)[-2:]]


def by_subject(scalars: xr.Dataset) -> dict[str, dict[str, str]]:
    """Names of the numbers that can be drawn over a swept parameter, by their subject and meaning.

    Examples
    --------
    >>> values = {name: ("friction", [1.0, 2.0]) for name in ("seconds", "peak_von_mises", "peak_pressure")}
    >>> [list(group.values()) for group in by_subject(xr.Dataset(values)).values()]
    [['peak_pressure'], ['peak_von_mises'], ['seconds']]
    """
    known = [
        str(name)
        for name, entry in scalars.data_vars.items()
        if entry.dtype.kind == "f" and not str(name).endswith("_error") and bool(entry.notnull().any())
    ]
    meanings = [variable_of(name, scalars[name].attrs).long_name for name in known]
    groups: dict[str, dict[str, str]] = {}
    for (subject, _), name, meaning in sorted(
        (_place(name), name, meaning) for name, meaning in zip(known, meanings, strict=True)
    ):
        # Every text must be another one, in all groups together.
        text = meaning if meanings.count(meaning) == 1 else f"{meaning}, {name}"
        groups.setdefault(ORDER[subject], {})[text] = name
    return groups


def _place(name: str) -> tuple[int, int]:
    """Subject of a number and its place there."""
    for subject, names in SUBJECTS.items():
        for at, known in enumerate(names):
            if name == known or (known.endswith("_") and name.startswith(known)):
                return ORDER.index(subject), at
    return ORDER.index(OTHER), 0
