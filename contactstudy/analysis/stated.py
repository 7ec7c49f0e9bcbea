"""What a result states of the accuracy of its pressure, on either half of the contact."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, attribute

SIDES = ("first", "last")
"""Halves of the contact, nearer to end I and to end II."""


def pressure_errors(result: xr.Dataset) -> tuple[float, float]:
    """Error of the largest pressure over itself, on either half; NaN on cells of one's own.

    The half of a singular end has no largest pressure: there it is the accuracy that was asked for.

    Examples
    --------
    >>> halves = {"peak_pressure_first": 2.0, "peak_pressure_last": 1.0}
    >>> errors = {"peak_pressure_first_error": 0.02, "peak_pressure_last_error": np.inf}
    >>> pressure_errors(xr.Dataset(halves | errors)), pressure_errors(xr.Dataset(halves))
    ((0.01, inf), (nan, nan))
    """
    settled = float(attribute(result, INPUTS_ATTRIBUTE).get("settings", {}).get("accuracy", np.nan))
    errors = []
    for side in SIDES:
        peak, error = (float(result.get(f"peak_pressure_{side}{kind}", np.nan)) for kind in ("", "_error"))
        known = np.isfinite(peak) and peak > 0 and not np.isnan(error)
        errors.append(error / peak if known else settled)
    return errors[0], errors[1]


def singular_ends(result: xr.Dataset) -> tuple[bool, bool]:
    """Whether the pressure has no limit at the end nearer to end I, and at the other.

    Examples
    --------
    >>> singular_ends(xr.Dataset({"end_pressure_first": np.inf, "end_pressure_last": 1.0}))
    (True, False)
    """
    first, last = (bool(np.isinf(float(result.get(f"end_pressure_{side}", 0.0)))) for side in SIDES)
    return first, last
