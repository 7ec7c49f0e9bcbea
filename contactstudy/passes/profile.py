"""A worn profile as one that other cases can take."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.required import require
from contactstudy.case.case import Case
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import checked_drop
from contactstudy.profiles.measured import Measured

OVERHANG_POINTS = 33
"""Points of the unworn profile where the roller overhangs the body."""


def worn_profile(case: Case, worn: xr.Dataset, distance: float | None = None) -> Measured:
    """Profile of a worn roller.

    Parameters
    ----------
    case : Case
        The case that wore.
    worn : Dataset
        What `wear_in` returned for it.
    distance : float, optional
        One of its distances, metres; default: the last.

    Returns
    -------
    Measured
        Points at the middles of the columns and at the roller's ends, where the depth is that of the nearest column.

    Raises
    ------
    InvalidInputError
        If the result has no such distance.

    Examples
    --------
    >>> import numpy as np
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller
    >>> body = FiniteLengthSpace(length=0.6e-3, material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.6e-3), max_pressure=1.5e9)
    >>> x = 1e-4 * (np.arange(6) + 0.5)
    >>> depth = xr.DataArray([[0.0] * 6, [2e-6, 1e-6, 1e-6, 1e-6, 1e-6, 2e-6]], dims=("distance", "x"))
    >>> worn = xr.Dataset({"wear_depth": depth}, {"distance": [0.0, 1e3], "x": x})
    >>> (1e6 * worn_profile(case, worn).drop(np.array([-3e-4, 0.0]), 0.6e-3)).round(6).tolist()
    [2.0, 1.0]
    """
    checks.instance("case", case, Case, "a Case")
    require(worn, "wear_depth", argument="worn")
    known = worn["distance"].values
    at = known.size - 1
    if distance is not None:
        wanted = checks.not_negative("distance", distance, "metres")
        at = int(np.abs(known - wanted).argmin())
        if not np.isclose(known[at], wanted, rtol=1e-9, atol=0.0):
            raise InvalidInputError("distance", wanted, f"one of those of the result, such as {known[at]:g} m")
    half = 0.5 * case.roller.length
    x = worn["x"].values - (case.roller_start + half)
    under = (x > -half) & (x < half)
    places, depth = x[under], worn["wear_depth"].values[at, under]
    points, depths = _to_the_ends(case, places, depth)
    drops = checked_drop(case.roller.profile, points, case.roller.length) + depths
    # A profile may drop without end at the very ends: the last column's drop stands in for it.
    finite = np.isfinite(drops)
    drops = np.interp(points, points[finite], drops[finite])
    return Measured((half + points).tolist(), drops.tolist(), largest_spike=float(max(drops.max(), half)))


def _to_the_ends(case: Case, places: FloatArray, depth: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Add the roller's ends, and points between them and the body where it overhangs, unworn."""
    half = 0.5 * case.roller.length
    parts = [(places, depth)]
    for side in (-1, 1):
        met = case.contact_range[0 if side < 0 else 1] - (case.roller_start + half)
        if side * met >= half * (1 - 1e-9):
            added = (np.array([side * half]), depth[[0 if side < 0 else -1]])
        else:
            beyond = np.linspace(met, side * half, OVERHANG_POINTS)
            added = (np.sort(beyond), np.zeros(OVERHANG_POINTS))
        parts = [added, *parts] if side < 0 else [*parts, added]
    return np.concatenate([each[0] for each in parts]), np.concatenate([each[1] for each in parts])
