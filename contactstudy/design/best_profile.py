"""The best parameters of a profile for given loads and tilts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.units import numbers_in_si
from contactstudy.arrays.variables import describe
from contactstudy.caller import warn
from contactstudy.case.case import Case, small_tilt
from contactstudy.case.settings import check_accuracy
from contactstudy.checks import FloatArray
from contactstudy.design.evaluations import Design, Evaluations, Measure, Range
from contactstudy.design.search import fewest, flat_range, optimum
from contactstudy.errors import BoundWarning, InvalidInputError
from contactstudy.interrupts import BriefInterrupt
from contactstudy.profiles.base import Profile, unit_of

AT_BOUND = 0.01
"""Part of a range by which an optimum is away from its bound if it is one of its own. Accuracy."""

NO_STRESSES: Mapping[str, object] = MappingProxyType({"stresses": False})
"""The default settings: a measure of the contact needs no stresses."""


def best_profile(
    case: Case,
    profile: Callable[..., Profile],
    bounds: Mapping[str, tuple[float, float]],
    measure: Measure = "peak_pressure",
    *,
    loads: Sequence[float] | FloatArray | None = None,
    max_pressures: Sequence[float] | FloatArray | None = None,
    tilts: Sequence[float] | FloatArray | None = None,
    accuracy: float = 0.01,
    settings: Mapping[str, object] = NO_STRESSES,
    evaluations: int = 60,
) -> xr.Dataset:
    """Find the parameters of a profile for which a measure is least in the worst of several loads and tilts.

    Parameters
    ----------
    case : Case
        Body and roller; its profile is replaced, and its load and tilt count where no others are given.
    profile : callable
        Makes the profile from the parameters, by keyword: a class such as `profiles.FullCrown`, or a function.
    bounds : mapping of str to tuple of float
        Least and largest value of each parameter that is sought. Where both are positive, equal ratios are equal steps.
    measure : str or callable
        A scalar variable of the result of :func:`contactstudy.solve`; or a function of the result that returns a
        number, or a number and its error.
    loads, max_pressures : sequence of float, optional
        Loads (N), or peak pressures of the Hertz line contact instead (Pa).
    tilts : sequence of float, optional
        Radians; each goes with every load.
    accuracy : float
        Of every contact, see :func:`contactstudy.solve`. A measure without an error of its own is taken to err by this
        part of itself.
    settings : mapping
        Further arguments of `solve`: a measure of stresses needs ``{"y": ..., "z": ...}``.
    evaluations : int
        Number of designs after which the search ends, at least 8; with two, three, ... parameters at least 9, 17, ...
        The ends of the flat part are sought after that, with some 3 to 6 designs for each parameter.

    Returns
    -------
    Dataset
        Along `parameter`: `optimum`; `flat_from` and `flat_to`, between which that parameter, alone, changes the
        measure by less than the errors of both values; `lower_bound` and `upper_bound`, and whether the optimum lies at
        one of them, `at_bound`; the coordinate `parameter_units`, empty for a function or class of one's own. `measure`
        of the optimum in its worst case and `measure_error`. Along `evaluation` everything that was looked at: `design`
        (evaluation, parameter), `design_measure`, `design_measure_error`, and `case_measure` (evaluation, case) with
        the coordinates `case_load` (N) and `case_tilt` (rad).
        ``profile(**found.optimum.to_series())`` is the profile.

    Raises
    ------
    InvalidInputError
        If an argument is out of range, the measure is unknown or nowhere finite within the bounds, or no profile within
        them can be.

    Warns
    -----
    BoundWarning
        If the optimum lies at a bound: beyond it may be a better one.

    Notes
    -----
    One parameter is scanned and then sought by Brent's method, several are spread (Sobol) and then sought by Nelder and
    Mead's simplex, both of SciPy. What the bounds allow but cannot be counts as infinitely bad. There may be a better
    optimum than the one that is found; what was looked at is all in the result.

    Examples
    --------
    >>> from contactstudy import HalfSpace, Material, Roller, profiles
    >>> body = HalfSpace(material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.3e-3), max_pressure=1.5e9)
    >>> found = best_profile(case, profiles.Lundberg, {"amplitude": (0.02e-6, 1e-6)}, accuracy=0.05, evaluations=9)
    >>> bool(found.flat_from[0] <= found.optimum[0] <= found.flat_to[0])
    True
    """
    checks.instance("case", case, Case, "a Case")
    if not callable(profile):
        raise InvalidInputError("profile", profile, "a class of profiles, or a function that makes one")
    if not (isinstance(measure, str) or callable(measure)):
        raise InvalidInputError("measure", measure, "the name of a variable, or a function of the result")
    ranges = _ranges(bounds)
    looked_at = Evaluations(
        _cases(case, loads, max_pressures, _several("tilts", tilts, "radians")),
        profile,
        ranges,
        measure,
        check_accuracy(accuracy),
        dict(settings),
    )
    with BriefInterrupt():
        best = optimum(looked_at, checks.count("evaluations", evaluations, least=fewest(len(ranges))))
        ends = [flat_range(looked_at, best, index) for index in range(len(ranges))]
    # While the ends were sought, something may have turned out to be as good, within the errors.
    found = _dataset(looked_at, min(looked_at.known, key=lambda design: design.value), ends)
    _warn_at_bounds(found)
    return found


def _warn_at_bounds(found: xr.Dataset) -> None:
    """Warn of parameters whose best value is a bound."""
    for one in found["parameter"].values[found["at_bound"].values]:
        value, low, high = (float(found[name].sel(parameter=one)) for name in ("optimum", "lower_bound", "upper_bound"))
        warn(
            f"the best {one} = {value:.4g} lies at a bound ({low:g} to {high:g}): beyond it may be a better one; "
            "widen the bounds if a roller can be made so",
            BoundWarning,
        )


def _ranges(bounds: object) -> dict[str, Range]:
    """Range of every parameter."""
    if not isinstance(bounds, Mapping) or not bounds:
        raise InvalidInputError("bounds", bounds, 'such as {"crown_radius": (0.5, 5.0)}')
    ranges = {}
    for name, ends in bounds.items():
        low, high = checks.coordinates(f"bounds[{name!r}]", ends, "SI")[[0, -1]] if np.size(ends) == 2 else (0.0, 0.0)
        if not low < high:
            raise InvalidInputError(f"bounds[{name!r}]", ends, "two numbers, the least and the largest value")
        ranges[str(name)] = Range(float(low), float(high))
    return ranges


def _several(name: str, values: object, unit: str) -> list[float] | None:
    """Numbers, if any are given."""
    if values is None:
        return None
    numbers = numbers_in_si(name, values, "rad" if unit == "radians" else unit)
    return [float(value) for value in checks.coordinates(name, numbers, unit)]


def _cases(case: Case, loads: object, pressures: object, tilts: list[float] | None) -> list[Case]:
    """Every load with every tilt."""
    if loads is not None and pressures is not None:
        raise InvalidInputError("loads, max_pressures", (loads, pressures), "one of the two, the other None")
    if loads is not None:
        loaded = [replace(case, load=load, max_pressure=None) for load in _several("loads", loads, "N") or []]
    elif pressures is not None:
        loaded = [
            replace(case, load=None, max_pressure=pressure)
            for pressure in _several("max_pressures", pressures, "Pa") or []
        ]
    else:
        loaded = [case]
    return [replace(each, tilt=small_tilt(tilt)) for each in loaded for tilt in tilts or [case.tilt]]


def _dataset(looked_at: Evaluations, best: Design, ends: list[tuple[float, float]]) -> xr.Dataset:
    """Label the optimum and what was looked at."""
    names = list(looked_at.ranges)
    ranges = list(looked_at.ranges.values())
    known = looked_at.known
    values = looked_at.parameters(best.parts)
    flat = [
        (each.value(min(low, float(part))), each.value(max(high, float(part))))
        for each, (low, high), part in zip(ranges, ends, best.parts, strict=True)
    ]
    # Where all of a range is as good, its bounds say nothing.
    at_bound = [
        min(part, 1 - part) < AT_BOUND and not (low < AT_BOUND and high > 1 - AT_BOUND)
        for (low, high), part in zip(ends, best.parts, strict=True)
    ]
    arrays: dict[str, tuple[object, object]] = {
        "optimum": ("parameter", [values[name] for name in names]),
        "flat_from": ("parameter", [low for low, _ in flat]),
        "flat_to": ("parameter", [high for _, high in flat]),
        "lower_bound": ("parameter", [each.low for each in ranges]),
        "upper_bound": ("parameter", [each.high for each in ranges]),
        "at_bound": ("parameter", at_bound),
        "measure": ((), best.value),
        "measure_error": ((), best.error),
        "design": (("evaluation", "parameter"), [list(looked_at.parameters(each.parts).values()) for each in known]),
        "design_measure": ("evaluation", [each.value for each in known]),
        "design_measure_error": ("evaluation", [each.error for each in known]),
        "case_measure": (("evaluation", "case"), [each.values for each in known]),
    }
    result = xr.Dataset(
        arrays,
        coords={
            "parameter": names,
            "parameter_units": ("parameter", [unit_of(looked_at.profile, name) for name in names]),
            "evaluation": np.arange(1, len(known) + 1),
            "case": np.arange(1, len(looked_at.cases) + 1),
            "case_load": ("case", [each.normal_load for each in looked_at.cases]),
            "case_tilt": ("case", [each.tilt for each in looked_at.cases]),
        },
    )
    if looked_at.units:
        for name in ("measure", "measure_error", "design_measure", "design_measure_error", "case_measure"):
            result[name].attrs["units"] = looked_at.units
    measure = looked_at.measure
    result.attrs["measure"] = measure if isinstance(measure, str) else getattr(measure, "__name__", repr(measure))
    return describe(result, "best parameters of a profile")
