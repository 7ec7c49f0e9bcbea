"""The best parameters of a profile for given loads and tilts: evaluated designs, the optimum, and its flat range."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
import xarray as xr
from scipy import optimize

from contactstudy import checks
from contactstudy.arrays.variables import describe, numbers_in_si
from contactstudy.case.case import Case, small_tilt
from contactstudy.case.gridding import check_accuracy
from contactstudy.checks import FloatArray
from contactstudy.errors import BoundWarning, ContactStudyError, InvalidInputError, MagnitudeWarning, WindowError
from contactstudy.profiles.base import Profile, unit_of
from contactstudy.solution import solve

LOGGER = logging.getLogger(__name__)

# A variable of the result, or a function of the result: a number, or a number and its error
Measure = str | Callable[[xr.Dataset], object]
RESOLUTION = 1e-9  # Part of a parameter's range within which two designs count as one
SCAN, SPREAD = 7, 8  # Designs of the first scan: along one parameter, and per further parameter in powers of two
# Parts of the range: accuracy of the optimum, and size of the first simplex. Speed and accuracy
CLOSE, SIMPLEX = 0.01, 0.15
END_ACCURACY = 0.02  # Accuracy of the end of a flat range, as a part of the parameter's range
CUT = 20.0  # Errors at which a difference from the optimum is cut off in the search for an end
# Advice where no design of the scan has a finite measure
SHARP = (
    "a pressure or stress is infinite at a sharp end of the contact: widen the bounds until the ends drop enough, take "
    "a profile with rounded ends, or a measure that is finite there, such as 'end_load_last'"
)


@dataclass(frozen=True, eq=False)
class Range:
    """Range of a parameter, mapped to parts from 0 to 1."""

    low: float  # if both bounds are positive, equal steps of the part are equal ratios
    high: float

    def value(self, part: float) -> float:
        """Return the parameter at a part of the range."""
        ratio = self.low > 0
        value = self.low * (self.high / self.low) ** part if ratio else self.low + (self.high - self.low) * part
        return float(np.clip(value, self.low, self.high))


@dataclass(frozen=True, eq=False)
class Design:
    """One evaluated design."""

    parts: FloatArray  # (parameter), parts of the ranges
    values: FloatArray  # (case), measure; infinite if invalid
    errors: FloatArray  # (case)

    @property
    def value(self) -> float:
        """Measure in the worst case."""
        return float(self.values.max())

    @property
    def error(self) -> float:
        """Largest error of the cases whose error interval reaches the worst case."""
        if not np.isfinite(self.value):
            return np.inf
        candidates = self.values + self.errors >= self.value - self.errors[int(self.values.argmax())]
        return float(self.errors[candidates].max())


@dataclass(eq=False, kw_only=True)
class Evaluations:
    """Evaluates designs, each once, and at most `most` designs."""

    cases: list[Case]
    profile: Callable[..., Profile]
    ranges: dict[str, Range]
    measure: Measure
    accuracy: float  # of the contacts; relative error of a measure without an error
    settings: Mapping[str, object]  # further arguments of solve
    most: int  # bound on the number of designs
    designs: list[Design] = field(default_factory=list)
    units: str = ""  # from the first result
    refused: ContactStudyError | None = None  # of the last invalid design

    @property
    def remaining(self) -> int:
        """Number of further designs."""
        return self.most - len(self.designs)

    @property
    def best(self) -> Design:
        """Design of the least measure."""
        return min(self.designs, key=lambda design: design.value)

    def evaluated(self, parts: FloatArray) -> Design | None:
        """Return an earlier design at these parts of the ranges, if there is one."""
        return next((design for design in self.designs if np.abs(design.parts - parts).max() <= RESOLUTION), None)

    def __call__(self, parts: FloatArray) -> Design:
        """Return the design at these parts of the ranges."""
        clipped = np.clip(np.asarray(parts, dtype=np.float64), 0.0, 1.0)
        design = self.evaluated(clipped)
        if design is None:
            design = self._solved(clipped)
            self.designs.append(design)
            LOGGER.info("%s: %.5g", self.parameters(clipped), design.value)
        return design

    def parameters(self, parts: FloatArray) -> dict[str, float]:
        """Return the parameters at parts of their ranges."""
        return {name: self.ranges[name].value(float(part)) for name, part in zip(self.ranges, parts, strict=True)}

    def _solved(self, parts: FloatArray) -> Design:
        """Solve every case of a design."""
        pairs = np.full((len(self.cases), 2), np.inf)
        try:
            parameters = self.parameters(parts)
            try:
                profile = self.profile(**parameters)
            except TypeError as error:
                allowed = "of the keywords that profile takes"
                raise InvalidInputError("bounds", list(parameters), allowed, str(error)) from None
            cases = [replace(case, roller=replace(case.roller, profile=profile)) for case in self.cases]
            with warnings.catch_warnings():
                if self.designs:  # the first design has warned of magnitudes
                    warnings.simplefilter("ignore", MagnitudeWarning)
                for index, case in enumerate(cases):
                    pairs[index] = self._measured(case)
        except (InvalidInputError, WindowError) as error:
            if isinstance(error, InvalidInputError) and error.parameter in ("measure", "bounds"):
                raise
            # The bounds may contain invalid profiles, or profiles that do not carry the load.
            self.refused = error
        return Design(parts, pairs[:, 0], pairs[:, 1])

    def _measured(self, case: Case) -> tuple[float, float]:
        """Measure of one case and its error."""
        uniform = bool({"grid", "roughness"} & self.settings.keys())
        result = solve(case, accuracy=None if uniform else self.accuracy, **self.settings)  # type: ignore[arg-type]
        if isinstance(self.measure, str):
            scalars = [str(name) for name, variable in result.data_vars.items() if variable.ndim == 0]
            if self.measure not in scalars:
                if self.measure in result:
                    hint = f"an array; a function makes a number of it: lambda result: result.{self.measure}.max()"
                    raise InvalidInputError("measure", self.measure, "a scalar of the result, or a function", hint)
                checks.known_name("measure", self.measure, scalars)
            measured: object = result[self.measure]
            self.units = str(result[self.measure].attrs.get("units", ""))
            if f"{self.measure}_error" in result:
                measured = (measured, result[f"{self.measure}_error"])
        else:
            measured = self.measure(result)
        number, error = _number_and_error(measured)
        if np.isnan(number):
            raise InvalidInputError("measure", number, "a number in every case", f"NaN for {case!r}")
        return number, self.accuracy * abs(number) if error is None or np.isnan(error) else error


def _number_and_error(measured: object) -> tuple[float, float | None]:
    """Split the return value of a measure into number and error."""
    try:
        value, error = measured if isinstance(measured, tuple) else (measured, None)
        if isinstance(value, str) or isinstance(error, str):
            raise TypeError
        return float(value), None if error is None else float(error)
    except (TypeError, ValueError):
        shape = getattr(measured, "shape", ())
        value = f"an array of shape {shape}" if shape else measured
        raise InvalidInputError("measure", value, "a function that returns a number, or (number, error)") from None


def fewest(parameters: int) -> int:
    """Least number of designs of a search: the first scan and one more."""
    return (SCAN if parameters == 1 else SPREAD * 2 ** (parameters - 2)) + 1


def optimum(evaluations: Evaluations) -> Design:
    """Return the best design of the search; some evaluations are left for the ends of the flat range."""
    count = len(evaluations.ranges)
    if count == 1:
        scan = np.linspace(0.0, 1.0, SCAN)[:, None]
    else:
        from scipy.stats.qmc import Sobol

        scan = Sobol(count, scramble=False).random(fewest(count) - 1)
    first = min((evaluations(parts) for parts in scan), key=lambda design: design.value)
    if not np.isfinite(first.value):
        if evaluations.refused is not None:
            raise evaluations.refused
        bounds = {name: (limits.low, limits.high) for name, limits in evaluations.ranges.items()}
        raise InvalidInputError("bounds", bounds, "such that the measure is finite somewhere within them", SHARP)
    # Factor on the least measure that replaces an infinite measure in the search
    ceiling = 1e3 * max(abs(first.value), np.finfo(np.float64).tiny)

    def bounded(parts: FloatArray) -> float:
        return min(evaluations(np.atleast_1d(parts)).value, ceiling)

    # Evaluations per parameter that are reserved for the ends of the flat range
    most = max(evaluations.remaining - 4 * count, 1)
    if count > 1:  # Nelder and Mead's simplex tolerates errors and kinks.
        corners = np.tile(first.parts, (count + 1, 1))
        # Away from the nearer bound, so that no corner is cut off.
        corners[1:] += np.diag(np.where(first.parts > 0.5, -SIMPLEX, SIMPLEX))
        options = {"initial_simplex": corners, "xatol": CLOSE, "fatol": first.error, "maxfev": most}
        optimize.minimize(bounded, first.parts, method="Nelder-Mead", bounds=[(0.0, 1.0)] * count, options=options)
    elif most > 1:  # Brent's method, between the neighbours of the best design; it takes two designs or more.
        start, step = float(first.parts[0]), 1 / (SCAN - 1)
        between = (max(start - step, 0.0), min(start + step, 1.0))
        options = {"xatol": CLOSE, "maxiter": most}
        optimize.minimize_scalar(bounded, bounds=between, method="bounded", options=options)
    return evaluations.best


def flat_range(evaluations: Evaluations, best: Design, parameter: int) -> tuple[float, float]:
    """Return the part of the range within which a parameter alone changes the measure by less than the errors."""
    sides = 2 * (len(evaluations.ranges) - parameter)
    low = _flat_end(evaluations, best, parameter, 0.0, most=evaluations.remaining // sides)
    return low, _flat_end(evaluations, best, parameter, 1.0, most=evaluations.remaining // (sides - 1))


def _flat_end(evaluations: Evaluations, best: Design, parameter: int, bound: float, *, most: int) -> float:
    """End of the flat part towards one bound, from at most `most` further designs."""
    centre = float(best.parts[parameter])
    if abs(centre - bound) <= RESOLUTION:
        return bound

    def parts_at(part: float) -> FloatArray:
        parts = best.parts.copy()
        parts[parameter] = part
        return parts

    def excess(part: float) -> float:
        """Difference of a design from the best beyond the errors of both."""
        design = evaluations(parts_at(part))
        if not np.isfinite(design.value):
            return CUT * best.error
        return float(min(design.value - best.value - design.error - best.error, CUT * best.error))

    # Earlier designs on this line, from the best on; the first worse one ends the flat part.
    inside, outside = centre, None
    for part in sorted(_parts_on_line(evaluations, best, parameter), key=lambda part: abs(part - centre)):
        if (part - centre) * (bound - centre) <= 0:
            continue
        if excess(part) > 0:
            outside = part
            break
        inside = part
    if outside is None:
        if evaluations.evaluated(parts_at(bound)) is None:
            if most < 1:
                return inside
            most -= 1
        if excess(bound) <= 0:
            return bound
        outside = bound
    if abs(outside - inside) <= END_ACCURACY or most < 1:
        return inside
    end, state = optimize.brentq(
        excess, inside, outside, xtol=END_ACCURACY, rtol=1e-3, maxiter=most, full_output=True, disp=False
    )
    if state.converged:
        return float(end)
    low, high = sorted((inside, outside))
    within = [part for part in _parts_on_line(evaluations, best, parameter) if low <= part <= high]
    return max((part for part in within if excess(part) <= 0), key=lambda part: abs(part - centre))


def _parts_on_line(evaluations: Evaluations, best: Design, parameter: int) -> list[float]:
    """Parts of the designs that differ from the best in this parameter alone."""
    further = np.delete(np.array([design.parts for design in evaluations.designs]), parameter, axis=1)
    aligned = (np.abs(further - np.delete(best.parts, parameter)) <= RESOLUTION).all(axis=1)
    return [float(design.parts[parameter]) for design, on in zip(evaluations.designs, aligned, strict=True) if on]


AT_BOUND = 0.01  # Part of a range within which an optimum counts as lying at the bound
# Default settings: a measure of the contact needs no stresses
NO_STRESSES: Mapping[str, object] = MappingProxyType({"stresses": False})


def best_profile(
    case: Case,
    profile: Callable[..., Profile],
    *,
    bounds: Mapping[str, tuple[float, float]],
    measure: Measure = "peak_pressure",
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
    >>> bounds = {"amplitude": (0.02e-6, 1e-6)}
    >>> best = best_profile(case, profiles.Lundberg, bounds=bounds, accuracy=0.05, evaluations=9)
    >>> bool(best.flat_from[0] <= best.optimum[0] <= best.flat_to[0])
    True
    """
    checks.instance("case", case, Case, "a Case")
    if not callable(profile):
        raise InvalidInputError("profile", profile, "a class of profiles, or a function that makes one")
    if not (isinstance(measure, str) or callable(measure)):
        raise InvalidInputError("measure", measure, "the name of a variable, or a function of the result")
    if not isinstance(bounds, Mapping) or not bounds:
        raise InvalidInputError("bounds", bounds, 'such as {"crown_radius": (0.5, 5.0)}')
    ranges = {}
    for name, pair in bounds.items():
        low, high = checks.coordinates(f"bounds[{name!r}]", pair, "SI")[[0, -1]] if np.size(pair) == 2 else (0.0, 0.0)
        if not low < high:
            raise InvalidInputError(f"bounds[{name!r}]", pair, "two numbers, the least and the largest value")
        ranges[str(name)] = Range(float(low), float(high))
    designs = Evaluations(
        cases=_cases(case, loads, max_pressures, tilts),
        profile=profile,
        ranges=ranges,
        measure=measure,
        accuracy=check_accuracy(accuracy),
        settings=dict(settings),
        most=checks.count("evaluations", evaluations, minimum=fewest(len(ranges))),
    )
    best = optimum(designs)
    ends = [flat_range(designs, best, index) for index in range(len(ranges))]
    result = _dataset(designs, ends)
    for name in result["parameter"].values[result["at_bound"].values]:
        column = result.sel(parameter=name)
        value, low, high = (float(column[key]) for key in ("optimum", "lower_bound", "upper_bound"))
        warnings.warn(
            f"the best {name} = {value:.4g} lies at a bound ({low:g} to {high:g}); widen the bounds if a roller can be "
            "made so",
            BoundWarning,
            stacklevel=2,
        )
    return result


def _numbers(name: str, values: object, unit: str) -> list[float]:
    """Numbers in SI; none of None."""
    if values is None:
        return []
    numbers = numbers_in_si(name, values, "rad" if unit == "radians" else unit)
    return [float(value) for value in checks.coordinates(name, numbers, unit)]


def _cases(case: Case, loads: object, pressures: object, tilts: object) -> list[Case]:
    """Every load with every tilt."""
    if loads is not None and pressures is not None:
        raise InvalidInputError("loads, max_pressures", (loads, pressures), "one of the two, the other None")
    variants = [replace(case, load=load, max_pressure=None) for load in _numbers("loads", loads, "N")]
    variants += [replace(case, load=None, max_pressure=peak) for peak in _numbers("max_pressures", pressures, "Pa")]
    turned = [small_tilt(tilt) for tilt in _numbers("tilts", tilts, "radians")] or [case.tilt]
    return [replace(loaded, tilt=tilt) for loaded in variants or [case] for tilt in turned]


def _dataset(designs: Evaluations, ends: list[tuple[float, float]]) -> xr.Dataset:
    """Label the optimum and every design."""
    best, evaluated = designs.best, designs.designs
    names, ranges = list(designs.ranges), list(designs.ranges.values())
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
        "optimum": ("parameter", list(designs.parameters(best.parts).values())),
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
