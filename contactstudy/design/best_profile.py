"""The best parameters of a profile for given loads and tilts."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import describe, numbers_in_si
from contactstudy.case.case import Case, small_tilt
from contactstudy.case.gridding import check_accuracy
from contactstudy.checks import FloatArray
from contactstudy.design.search import Evaluations, Measure, Range, fewest, flat_range, optimum
from contactstudy.errors import BoundWarning, InvalidInputError
from contactstudy.profiles.base import Profile, unit_of

AT_BOUND = 0.01  # Part of a range within which an optimum counts as lying at the bound
# Default settings: a measure of the contact needs no stresses
NO_STRESSES: Mapping[str, object] = MappingProxyType({"stresses": False})


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
        Body and roller of any profile, with the default load and tilt.
    profile : callable
        Profile from the parameters, by keyword: a class such as `profiles.FullCrown`, or a function.
    bounds : mapping of str to tuple of float
        Least and largest value of each parameter; if both are positive, equal steps are equal ratios.
    measure : str or callable
        A scalar variable of the result of :func:`contactstudy.solve`; or a function of the result that returns a
        number, or a number and its error.
    loads, max_pressures : sequence of float, optional
        Loads (N), or peak pressures of the Hertz line contact instead (Pa).
    tilts : sequence of float, optional
        Radians; each is combined with every load.
    accuracy : float
        Accuracy of every contact, see :func:`contactstudy.solve`, and relative error of a measure without an error.
    settings : mapping
        Further arguments of `solve`: a measure of stresses needs ``{"y": ..., "z": ...}``.
    evaluations : int
        Bound on the number of designs, at least 8; with two, three, ... parameters at least 9, 17, ... The ends of the
        flat range take at least four of them for each parameter, if the first scan leaves as many.

    Returns
    -------
    Dataset
        Along `parameter`: `optimum`; `flat_from` and `flat_to`, between which that parameter alone changes the measure
        by less than the errors of both values; `lower_bound` and `upper_bound`, and whether the optimum lies at one of
        them, `at_bound`; the coordinate `parameter_units`, empty for a user's function or class. `measure` of the
        optimum in its worst case and `measure_error`. Along `evaluation` every design: `design` (evaluation,
        parameter), `design_measure`, `design_measure_error`, and `case_measure` (evaluation, case) with the
        coordinates `case_load` (N) and `case_tilt` (rad).
        ``profile(**result.optimum.to_series())`` is the profile.

    Raises
    ------
    InvalidInputError
        If an argument is out of range, the measure is unknown or infinite throughout the bounds, or no profile within
        the bounds is valid.

    Warns
    -----
    BoundWarning
        If the optimum lies at a bound. It may be a local one: the result contains every design.

    Examples
    --------
    >>> from contactstudy import HalfSpace, Material, Roller, profiles
    >>> body = HalfSpace(material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.3e-3), max_pressure=1.5e9)
    >>> best = best_profile(case, profiles.Lundberg, {"amplitude": (0.02e-6, 1e-6)}, accuracy=0.05, evaluations=9)
    >>> bool(best.flat_from[0] <= best.optimum[0] <= best.flat_to[0])
    True
    """
    checks.instance("case", case, Case, "a Case")
    if not callable(profile):
        raise InvalidInputError("profile", profile, "a class of profiles, or a function that makes one")
    if not (isinstance(measure, str) or callable(measure)):
        raise InvalidInputError("measure", measure, "the name of a variable, or a function of the result")
    ranges = _ranges(bounds)
    designs = Evaluations(
        cases=_cases(case, loads, max_pressures, _numbers("tilts", tilts, "radians")),
        profile=profile,
        ranges=ranges,
        measure=measure,
        accuracy=check_accuracy(accuracy),
        settings=dict(settings),
        most=checks.count("evaluations", evaluations, least=fewest(len(ranges))),
    )
    best = optimum(designs)
    ends = [flat_range(designs, best, index) for index in range(len(ranges))]
    result = _dataset(designs, ends)
    _warn_at_bounds(result)
    return result


def _warn_at_bounds(result: xr.Dataset) -> None:
    """Warn of parameters whose best value is a bound."""
    for name in result["parameter"].values[result["at_bound"].values]:
        column = result.sel(parameter=name)
        value, low, high = (float(column[key]) for key in ("optimum", "lower_bound", "upper_bound"))
        warnings.warn(
            f"the best {name} = {value:.4g} lies at a bound ({low:g} to {high:g}); widen the bounds if a roller can be "
            "made so",
            BoundWarning,
            stacklevel=2,
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


def _numbers(name: str, values: object, unit: str) -> list[float] | None:
    """Numbers in SI, or None."""
    if values is None:
        return None
    numbers = numbers_in_si(name, values, "rad" if unit == "radians" else unit)
    return [float(value) for value in checks.coordinates(name, numbers, unit)]


def _cases(case: Case, loads: object, pressures: object, tilts: list[float] | None) -> list[Case]:
    """Every load with every tilt."""
    if loads is not None and pressures is not None:
        raise InvalidInputError("loads, max_pressures", (loads, pressures), "one of the two, the other None")
    if loads is not None:
        variants = [replace(case, load=load, max_pressure=None) for load in _numbers("loads", loads, "N") or []]
    elif pressures is not None:
        variants = [
            replace(case, load=None, max_pressure=pressure)
            for pressure in _numbers("max_pressures", pressures, "Pa") or []
        ]
    else:
        variants = [case]
    return [replace(loaded, tilt=small_tilt(tilt)) for loaded in variants for tilt in tilts or [case.tilt]]


def _dataset(designs: Evaluations, ends: list[tuple[float, float]]) -> xr.Dataset:
    """Label the optimum and every design."""
    best, evaluated = designs.best, designs.designs
    names, ranges = list(designs.ranges), list(designs.ranges.values())
    optimum_values = designs.parameters(best.parts)
    flat = [
        (limits.value(min(low, float(part))), limits.value(max(high, float(part))))
        for limits, (low, high), part in zip(ranges, ends, best.parts, strict=True)
    ]
    # A range that is flat throughout does not bound the optimum.
    at_bound = [
        min(part, 1 - part) < AT_BOUND and not (low < AT_BOUND and high > 1 - AT_BOUND)
        for (low, high), part in zip(ends, best.parts, strict=True)
    ]
    parameters = [list(designs.parameters(design.parts).values()) for design in evaluated]
    arrays: dict[str, tuple[object, object]] = {
        "optimum": ("parameter", [optimum_values[name] for name in names]),
        "flat_from": ("parameter", [low for low, _ in flat]),
        "flat_to": ("parameter", [high for _, high in flat]),
        "lower_bound": ("parameter", [limits.low for limits in ranges]),
        "upper_bound": ("parameter", [limits.high for limits in ranges]),
        "at_bound": ("parameter", at_bound),
        "measure": ((), best.value),
        "measure_error": ((), best.error),
        "design": (("evaluation", "parameter"), parameters),
        "design_measure": ("evaluation", [design.value for design in evaluated]),
        "design_measure_error": ("evaluation", [design.error for design in evaluated]),
        "case_measure": (("evaluation", "case"), [design.values for design in evaluated]),
    }
    result = xr.Dataset(
        arrays,
        coords={
            "parameter": names,
            "parameter_units": ("parameter", [unit_of(designs.profile, name) for name in names]),
            "evaluation": np.arange(1, len(evaluated) + 1),
            "case": np.arange(1, len(designs.cases) + 1),
            "case_load": ("case", [case.normal_load for case in designs.cases]),
            "case_tilt": ("case", [case.tilt for case in designs.cases]),
        },
    )
    if designs.units:
        for name in ("measure", "measure_error", "design_measure", "design_measure_error", "case_measure"):
            result[name].attrs["units"] = designs.units
    measure = designs.measure
    result.attrs["measure"] = measure if isinstance(measure, str) else getattr(measure, "__name__", repr(measure))
    return describe(result, "best parameters of a profile")
