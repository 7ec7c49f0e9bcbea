"""Edge factors per lamina from real pressures: what ISO/TS 16281 calls stress riser functions."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import cell_size, dimension_along, single_case
from contactstudy.analysis.between_columns import Columns, power_means
from contactstudy.analysis.provenance import solved_case
from contactstudy.analysis.stated import SIDES, pressure_errors
from contactstudy.arrays.across import largest_across
from contactstudy.arrays.required import require
from contactstudy.arrays.units import required_in_si
from contactstudy.arrays.variables import UNBOUNDED, describe
from contactstudy.bodies import hertz
from contactstudy.case.case import Case
from contactstudy.checks import FloatArray
from contactstudy.contact.slice_model import slice_model
from contactstudy.profiles.base import local_radius

LIFE_POWER = 9 / 2
"""Power of a lamina's load that its risk of fatigue follows: the life exponent 4 of a line contact times the slope 9/8
of Weibull's distribution."""

OF_COLUMNS = "from the stated errors of the pressure and the distance of its columns"


def lamina_factors(result: xr.Dataset, *, laminae: int = 30) -> xr.Dataset:
    """Factors on the loads of the lamina model that make their Hertz pressures those of a solved contact.

    Parameters
    ----------
    result : Dataset
        A result of :func:`contactstudy.solve` for the roller on the inner raceway, or on the outer one.
    laminae : int
        Number of laminae; the standard asks for at least 30.

    Returns
    -------
    Dataset
        Along `slice`: `position` (m, middle, from end I of the body), `width` (m); `load_per_length` (N/m) of the
        lamina model under the same load and tilt; `hertz_load_per_length` (N/m), the one whose line contact has the
        solved pressure; `stress_riser`, the latter over the former: ``f_i[k]`` from the inner raceway, ``f_e[k]`` from
        the outer one; with `hertz_load_per_length_error` and `stress_riser_error`, which follow from the stated errors
        of the peak pressures and from the distance of the columns; and `edge_factor`, the standard's approximation.
        No error is known of what the lamina model alone says.

    Raises
    ------
    InvalidInputError
        If the result does not say its case, or `laminae` is no whole number above 1.

    Notes
    -----
    Within a lamina the pressure varies. Its load is the mean that gives the same life,
    ``(mean of (pi p**2 R / E*)**(9/2))**(2/9)`` with the largest pressure p of each cross-section, so the life does not
    depend on the number of laminae. At a sharp end, where the pressure is singular, the outermost factor is
    infinite. The factor is NaN where the lamina model has no load; `hertz_load_per_length` still counts there.

    The standard defines its functions by the Hertz pressures of the laminae (equations 58 and 59), and recommends
    contact calculations for them in general. Its text was not available: that, and everything else of it here, is
    second-hand, from what public programs quote of it.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller, profiles, solve
    >>> body = FiniteLengthSpace(length=0.6e-3, material=Material(210e9, 0.3))
    >>> roller = Roller(radius=5e-3, length=0.5e-3, profile=profiles.Lundberg(0.2e-6))
    >>> factors = lamina_factors(solve(Case(body=body, roller=roller, max_pressure=1.5e9), stresses=False))
    >>> factors.edge_factor[:2].values.round(2).tolist()
    [2.33, 1.13]
    >>> bool(factors.stress_riser[0] < 1 < factors.stress_riser[1])  # between free ends the ends carry less
    True
    """
    require(result, "tilt", argument="result")
    result = required_in_si(result, "pressure", argument="result")
    one = single_case(result)
    case, count = solved_case(one), checks.count("laminae", laminae, least=2)
    sliced = slice_model(replace(case, load_position=None, tilt=float(one["tilt"])), slices=count)
    start, stop = case.contact_range
    borders = np.linspace(start, stop, count + 1)
    load, error, _ = hertz_loads(one, case, borders)
    carried = sliced["load_per_length"].values
    with np.errstate(divide="ignore", invalid="ignore"):
        riser = np.where(carried > 0, load / carried, np.nan)
        riser_error = np.where(carried > 0, error / carried, np.nan)
    values = {
        "position": 0.5 * (borders[1:] + borders[:-1]),
        "width": np.full(count, (stop - start) / count),
        "load_per_length": carried,
        "hertz_load_per_length": load,
        "hertz_load_per_length_error": error,
        "stress_riser": riser,
        "stress_riser_error": riser_error,
        "edge_factor": sliced["edge_factor"].values,
    }
    found = xr.Dataset(
        {name: ("slice", array) for name, array in values.items()}, coords={"slice": np.arange(1, count + 1)}
    )
    for name in ("load_per_length", "edge_factor"):
        found[name].attrs["comment"] = sliced[name].attrs["comment"]
    known = not np.isnan(error).any()
    for name in ("hertz_load_per_length", "stress_riser"):
        found[f"{name}_error"].attrs["comment"] = OF_COLUMNS if known else UNBOUNDED
    return describe(found, "stress riser of every lamina from solved pressures")


class HertzLoads(NamedTuple):
    """Load per length of every lamina whose line contact has the solved pressure, N/m.

    Attributes
    ----------
    load : array
        Infinite at a singular end.
    error : array
        From the stated errors of the pressure, and from the distance of its columns.
    common : array
        The part of it from the stated errors. What the columns put into one lamina they leave out of the next, so this
        part alone tells how well a life of all laminae is known.
    """

    load: FloatArray
    error: FloatArray
    common: FloatArray


def hertz_loads(result: xr.Dataset, case: Case, borders: FloatArray) -> HertzLoads:
    """Return loads per length of laminae between borders from the solved pressure, and their errors."""
    pressure = result["pressure"].transpose(dimension_along(result["pressure"], "x"), ...)
    x = dimension_along(pressure, "x")
    place, top = result[x].values, largest_across(pressure.values)
    half = 0.5 * np.broadcast_to(cell_size(pressure, "x").values, place.shape)
    middle = case.roller_middle
    under = np.abs(place - middle) <= 0.5 * case.roller.length
    radius = np.full(place.size, case.roller.radius)
    radius[under] = local_radius(case.roller.profile, place[under] - middle, case.roller.length, case.roller.radius)
    line = hertz.line_load(1.0, 1.0, case.modulus) * top**2 * radius
    columns = Columns(np.stack([place - half, place + half], axis=-1), place, line)
    load, left_open = power_means(columns, borders, LIFE_POWER)
    common = _of_pressure(result, load, line, columns.shares(borders))
    error = common + left_open
    for end, side in ((0, "first"), (-1, "last")):
        if np.isinf(float(result.get(f"peak_pressure_{side}", 0.0))):
            load[end] = error[end] = common[end] = np.inf
    return HertzLoads(load, error, common)


def _of_pressure(result: xr.Dataset, load: FloatArray, line: FloatArray, weights: FloatArray) -> FloatArray:
    """Errors of loads per length from those of the pressure, which are stated of the largest on either half."""
    half = load.size // 2
    errors = []
    for parts, side, relative in zip(
        (slice(load.size - half), slice(half, None)), SIDES, pressure_errors(result), strict=True
    ):
        endless = np.isinf(float(result.get(f"peak_pressure_{side}", 0.0)))
        largest = load[parts] if endless else line[weights[parts].any(axis=0)].max()
        error = np.zeros(load.size)
        # The load goes with the square of the pressure, whose error is that of its largest.
        error[parts] = 2 * relative * np.sqrt(load[parts] * largest)
        errors.append(error)
    return np.maximum(*errors)
