"""A worn profile as one that other cases can take: the unworn one, and the worn depth on top of it."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.required import require
from contactstudy.case.case import GAP_NODES, Case
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import Sum
from contactstudy.profiles.measured import Measured

ROUNDING = 1e-9
"""Distance over another that is rounding. Accuracy."""

CORRECTIONS = 8
"""Rounds in which points are moved until the interpolation has the columns' depths as its means. Accuracy."""


def worn_profile(case: Case, worn: xr.Dataset, distance: float | None = None) -> Sum:
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
    Sum
        Of the unworn profile, as it was, and of the worn depth as a `Measured`, whose points are the middles of the
        columns and the roller's ends. Over columns of different widths its means are the depths that wore off.

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
    under = np.abs(x) <= half * (1 + ROUNDING)
    depth = worn["wear_depth"].values[at, under]
    points = depth
    profile = _measured(case, x[under], points)
    if "x_width" in worn.coords:
        nodes, weights = np.polynomial.legendre.leggauss(GAP_NODES)
        within = x[under][:, None] + 0.5 * worn["x_width"].values[under][:, None] * nodes
        for _ in range(CORRECTIONS):
            means = 0.5 * profile.drop(within.ravel(), case.roller.length).reshape(within.shape) @ weights
            points = np.maximum(points + depth - means, 0.0)
            profile = _measured(case, x[under], points)
    own = case.roller.profile
    return Sum((*(own.terms if isinstance(own, Sum) else (own,)), profile))


def _overhanging(length: float, step: float) -> FloatArray:
    """Distances from the body's end of unworn points on a part of the roller that overhangs; none without one."""
    if length <= ROUNDING * step:
        return np.zeros(0)
    # Steps that grow by a factor that a measured profile may have.
    count = max(1, int(np.ceil(np.log2(1 + length / step))))
    steps = 2.0 ** np.arange(count)
    return np.concatenate([[0.0], length * np.cumsum(steps) / steps.sum()])


def _measured(case: Case, places: FloatArray, depth: FloatArray) -> Measured:
    """Worn depth at distances from mid-length, continued to the roller's ends, as a profile."""
    half = 0.5 * case.roller.length
    start, stop = (end - (case.roller_start + half) for end in case.contact_range)
    # Where the roller overhangs the body nothing is worn off; else the last column reaches to the end.
    before = _overhanging(start + half, places[0] - start)
    behind = _overhanging(half - stop, stop - places[-1])
    left = np.column_stack([start - before[::-1], np.zeros(before.size)]) if before.size else [(-half, depth[0])]
    right = np.column_stack([stop + behind, np.zeros(behind.size)]) if behind.size else [(half, depth[-1])]
    # The middle of a uniform cell may lie right under an end.
    inside = np.abs(places) < half * (1 - ROUNDING)
    x, drops = np.concatenate([left, np.column_stack([places[inside], depth[inside]]), right]).T
    return Measured((half + x).tolist(), drops.tolist(), largest_spike=half)
