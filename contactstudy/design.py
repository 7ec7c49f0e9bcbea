"""Profiles that minimise a measure in the worst of several loads and tilts, with errors."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from types import MappingProxyType

import numpy as np
import xarray as xr
from scipy import optimize

from contactstudy import checks
from contactstudy.arrays.variables import describe
from contactstudy.case.case import Case
from contactstudy.case.gridding import check_accuracy
from contactstudy.checks import FloatArray
from contactstudy.errors import BoundWarning, ContactStudyError, InvalidInputError, MagnitudeWarning, WindowError
from contactstudy.profiles.base import Profile, unit_of
from contactstudy.solution import solve

__all__ = ["BoundWarning", "best_profile"]

LOGGER = logging.getLogger(__name__)

# A variable of the result, or a function of the result that returns a number, or a number and its error
Measure = str | Callable[[xr.Dataset], object]
MIN_DIFFERENCE = 1e-9  # Fraction of a parameter's range below which two designs are equal
SCAN_COUNT, SPREAD_COUNT = 7, 8  # Designs of the first scan: of one parameter; of more, times powers of two
# Fractions of the range: accuracy of the optimum, and size of the first simplex. Speed and accuracy
OPTIMUM_TOLERANCE, SIMPLEX_SIZE = 0.01, 0.15
FLAT_RANGE_TOLERANCE = 0.02  # Accuracy of the end of a flat range, as a fraction of the parameter's range
MAX_EXCESS_RATIO = 20.0  # Bound, in errors, on the difference from the optimum in the search for an end
# Advice for a scan without a finite measure
REMEDY = (
    "a pressure or stress is infinite at a sharp end of the contact: widen the bounds until the ends drop enough, take "
    "a profile with rounded ends, or a finite measure, such as 'end_load_last'"
)


@dataclass(frozen=True, eq=False)
class Design:
    """Evaluated design."""

    fractions: FloatArray  # (parameter), fractions of the ranges
    values: FloatArray  # (case), measure; infinite if invalid
    errors: FloatArray  # (case), errors of the measure

    @property
    def value(self) -> float:
        """Largest measure of the cases."""
        return float(self.values.max())

    @property
    def error(self) -> float:
        """Largest error of the cases whose error interval contains the largest measure."""
        if not np.isfinite(self.value):
            return np.inf
        candidates = self.values + self.errors >= self.value - self.errors[int(self.values.argmax())]
        return float(self.errors[candidates].max())


@dataclass(eq=False, kw_only=True)
class Evaluations:
    """Evaluates at most `max_designs` designs."""

    cases: list[Case]
    profile: Callable[..., Profile]
    ranges: dict[str, tuple[float, float]]  # low, high; if low is positive, fractions divide the logarithm
    measure: Measure
    accuracy: float  # of the contacts; relative error of a measure without an error
    settings: Mapping[str, object]  # further arguments of solve
    max_designs: int  # bound on the number of designs
    designs: list[Design] = field(default_factory=list)
    units: str = ""  # from the first result
    last_error: ContactStudyError | None = None  # of the last invalid design

    @property
    def remaining(self) -> int:
        """Number of designs that may still be evaluated."""
        return self.max_designs - len(self.designs)

    @property
    def best(self) -> Design:
        """Design of the least measure."""
        return min(self.designs, key=lambda design: design.value)

    def __call__(self, fractions: FloatArray) -> Design:
        """Return the design at the fractions of the ranges; solve it unless an earlier design has these fractions."""
        clipped = np.clip(np.asarray(fractions, dtype=np.float64), 0.0, 1.0)
        for earlier_design in self.designs:
            if np.abs(earlier_design.fractions - clipped).max() <= MIN_DIFFERENCE:
                return earlier_design
        design = self._solve_design(clipped)
        self.designs.append(design)
        LOGGER.info("%s: %.5g", self.parameters(clipped), design.value)
        return design

    def parameters(self, fractions: FloatArray) -> dict[str, float]:
        """Return the parameters at fractions of their ranges."""
        parameters = {}
        for (name, (low, high)), fraction in zip(self.ranges.items(), fractions.tolist(), strict=True):
            value = low * (high / low) ** fraction if low > 0 else low + (high - low) * fraction
            parameters[name] = float(np.clip(value, low, high))
        return parameters

    def _solve_design(self, fractions: FloatArray) -> Design:
        """Solve every case of a design."""
        measures = np.full((len(self.cases), 2), np.inf)
        try:
            parameters = self.parameters(fractions)
            try:
                profile = self.profile(**parameters)
            except TypeError as error:
                allowed = "of the keywords that profile takes"
                raise InvalidInputError("bounds", list(parameters), allowed, str(error)) from None
            cases = [replace(case, roller=replace(case.roller, profile=profile)) for case in self.cases]
            with warnings.catch_warnings():
                if self.designs:  # only the first design emits warnings of magnitudes
                    warnings.simplefilter("ignore", MagnitudeWarning)
                for index, case in enumerate(cases):
                    measures[index] = self._measure_case(case)
        except (InvalidInputError, WindowError) as error:
            if isinstance(error, InvalidInputError) and error.parameter in ("measure", "bounds"):
                raise
            # The bounds may contain invalid profiles, or profiles without contact.
            self.last_error = error
        return Design(fractions, measures[:, 0], measures[:, 1])

    def _measure_case(self, case: Case) -> tuple[float, float]:
        """Measure of one case and its error."""
        uniform = bool({"grid", "roughness"} & self.settings.keys())
        result = solve(case, accuracy=None if uniform else self.accuracy, **self.settings)  # type: ignore[arg-type]
        if isinstance(self.measure, str):
            scalars = [str(name) for name, variable in result.data_vars.items() if variable.ndim == 0]
            if self.measure not in scalars:
                if self.measure in result:
                    remedy = f"an array; give a function, such as lambda result: result.{self.measure}.max()"
                    raise InvalidInputError("measure", self.measure, "a scalar of the result, or a function", remedy)
                checks.known_name("measure", self.measure, scalars)
            value_and_error: object = result[self.measure]
            self.units = str(result[self.measure].attrs.get("units", ""))
            if f"{self.measure}_error" in result:
                value_and_error = (value_and_error, result[f"{self.measure}_error"])
        else:
            value_and_error = self.measure(result)
        value, error = _split_measure(value_and_error)
        if np.isnan(value):
            raise InvalidInputError("measure", value, "a number in every case", f"NaN for {case!r}")
        return value, self.accuracy * abs(value) if error is None or np.isnan(error) else error


def _split_measure(measure: object) -> tuple[float, float | None]:
    """Split the return value of a measure into number and error."""
    try:
        number, error = measure if isinstance(measure, tuple) else (measure, None)
        if isinstance(number, str) or isinstance(error, str):
            raise TypeError
        return float(number), None if error is None else float(error)
    except (TypeError, ValueError):
        shape = getattr(measure, "shape", ())
        number = f"an array of shape {shape}" if shape else measure
        raise InvalidInputError("measure", number, "a function that returns a number, or (number, error)") from None


def min_designs(parameters: int) -> int:
    """Return the minimum number of designs of a search: the first scan and one more."""
    return (SCAN_COUNT if parameters == 1 else SPREAD_COUNT * 2 ** (parameters - 2)) + 1


def search_optimum(evaluations: Evaluations) -> Design:
    """Return the best design; the search reserves evaluations for the ends of the flat range."""
    parameters = len(evaluations.ranges)
    if parameters == 1:
        scanned_fractions = np.linspace(0.0, 1.0, SCAN_COUNT)[:, None]
    else:
        from scipy.stats.qmc import Sobol

        scanned_fractions = Sobol(parameters, scramble=False).random(min_designs(parameters) - 1)
    start_design = min((evaluations(fractions) for fractions in scanned_fractions), key=lambda design: design.value)
    if not np.isfinite(start_design.value):
        if evaluations.last_error is not None:
            raise evaluations.last_error
        allowed = "such that the measure is finite somewhere within them"
        raise InvalidInputError("bounds", evaluations.ranges, allowed, REMEDY)
    # The search replaces an infinite measure by 1e3 times the least measure.
    measure_cap = 1e3 * max(abs(start_design.value), np.finfo(np.float64).tiny)

    def evaluate_finite_measure(fractions: FloatArray) -> float:
        return min(evaluations(np.atleast_1d(fractions)).value, measure_cap)

    # Evaluations per parameter that are reserved for the ends of the flat range
    budget = max(evaluations.remaining - 4 * parameters, 1)
    if parameters > 1:  # Nelder and Mead's simplex tolerates errors and kinks.
        simplex = np.tile(start_design.fractions, (parameters + 1, 1))
        # The simplex points away from the nearer bound, within the range.
        simplex[1:] += np.diag(np.where(start_design.fractions > 0.5, -SIMPLEX_SIZE, SIMPLEX_SIZE))
        tolerances = {"xatol": OPTIMUM_TOLERANCE, "fatol": start_design.error}
        options = tolerances | {"initial_simplex": simplex, "maxfev": budget}
        start, bounds = start_design.fractions, [(0.0, 1.0)] * parameters
        optimize.minimize(evaluate_finite_measure, start, method="Nelder-Mead", bounds=bounds, options=options)
    elif budget > 1:  # Brent's method, between the neighbours of the best design; the method takes two or more designs.
        middle, step = float(start_design.fractions[0]), 1 / (SCAN_COUNT - 1)
        bracket = (max(middle - step, 0.0), min(middle + step, 1.0))
        options = {"xatol": OPTIMUM_TOLERANCE, "maxiter": budget}
        optimize.minimize_scalar(evaluate_finite_measure, bounds=bracket, method="bounded", options=options)
    return evaluations.best


def find_flat_ranges(evaluations: Evaluations, best: Design) -> FloatArray:
    """Return the fractions (2, parameter) between which a parameter alone changes the measure less than the errors."""
    directions = list(product(range(len(evaluations.ranges)), (0.0, 1.0)))
    ends = [
        _find_flat_end(evaluations, best, *direction, limit=evaluations.remaining // (len(directions) - index))
        for index, direction in enumerate(directions)
    ]
    return np.reshape(ends, (-1, 2)).T


def _find_flat_end(evaluations: Evaluations, best: Design, parameter: int, bound: float, *, limit: int) -> float:
    """End of the flat range towards one bound, with at most `limit` further designs."""
    origin = float(best.fractions[parameter])
    if abs(origin - bound) <= MIN_DIFFERENCE:
        return bound

    def line_fractions() -> list[float]:
        """Fractions of the designs that differ from the best in this parameter alone."""
        fractions = np.array([design.fractions for design in evaluations.designs])
        on_line = (np.abs(np.delete(fractions - best.fractions, parameter, axis=1)) <= MIN_DIFFERENCE).all(axis=1)
        return [float(fraction) for fraction in fractions[on_line, parameter]]

    def excess(fraction: float) -> float:
        """Difference of a design from the best beyond the errors of both."""
        fractions = best.fractions.copy()
        fractions[parameter] = fraction
        design = evaluations(fractions)
        if not np.isfinite(design.value):
            return MAX_EXCESS_RATIO * best.error
        return float(min(design.value - best.value - design.error - best.error, MAX_EXCESS_RATIO * best.error))

    # Earlier designs on this line, outwards from the best; the first worse design ends the flat range.
    flat_end, worse_end = origin, bound
    earlier_fractions = [fraction for fraction in line_fractions() if (fraction - origin) * (bound - origin) > 0]
    for fraction in sorted(earlier_fractions, key=lambda fraction: abs(fraction - origin)):
        if excess(fraction) > 0:
            worse_end = fraction
            break
        flat_end = fraction
    else:
        if abs(flat_end - bound) <= MIN_DIFFERENCE or limit < 1:
            return flat_end
        limit -= 1
        if excess(bound) <= 0:
            return bound
    if abs(worse_end - flat_end) <= FLAT_RANGE_TOLERANCE or limit < 1:
        return flat_end
    flat_limit, report = optimize.brentq(
        excess, flat_end, worse_end, xtol=FLAT_RANGE_TOLERANCE, rtol=1e-3, maxiter=limit, full_output=True, disp=False
    )
    if report.converged:
        return float(flat_limit)
    low, high = sorted((flat_end, worse_end))
    flat_fractions = [fraction for fraction in line_fractions() if low <= fraction <= high and excess(fraction) <= 0]
    return max(flat_fractions, key=lambda fraction: abs(fraction - origin))


BOUND_TOLERANCE = 0.01  # Fraction of a range between an optimum at a bound and the bound
# Default settings: the default measure needs no stresses
NO_STRESSES: Mapping[str, object] = MappingProxyType({"stresses": False})


def best_profile(
    cases: Case | Sequence[Case],
    profile: Callable[..., Profile],
    *,
    bounds: Mapping[str, tuple[float, float]],
    measure: Measure = "peak_pressure",
    accuracy: float = 0.01,
    settings: Mapping[str, object] = NO_STRESSES,
    evaluations: int = 60,
) -> xr.Dataset:
    """Find the parameters of a profile that minimise the largest measure over several cases.

    Parameters
    ----------
    cases : Case or sequence of Case
        Bodies, loads, tilts, ..., with rollers of any profile, which the designs replace.
    profile : callable
        Profile from the parameters, by keyword: a class such as `profiles.FullCrown`, or a function.
    bounds : mapping of str to tuple of float
        Least and largest value of each parameter; if both are positive, equal steps are equal ratios.
    measure : str or callable
        A scalar of the result of :func:`contactstudy.solve`; or a function that returns a number, or number and error.
    accuracy : float
        Accuracy of every contact, see :func:`contactstudy.solve`, and relative error of a measure without an error.
    settings : mapping
        Further arguments of `solve`: a measure of stresses needs ``{"y": ..., "z": ...}``.
    evaluations : int
        Bound on the number of designs, at least 8; with two, three, ... parameters at least 9, 17, ... The ends of the
        flat range take at least four designs per parameter, if the first scan leaves enough.

    Returns
    -------
    Dataset
        Along `parameter`: `optimum`; `flat_from` and `flat_to`, between which that parameter alone changes the measure
        by less than the errors of both values; `lower_bound` and `upper_bound`, and whether the optimum equals one
        of the bounds, `at_bound`; the coordinate `parameter_units`, empty for a user's function. `measure` of the
        optimum in its worst case and `measure_error`. Along `evaluation` every design: `design` (evaluation,
        parameter), `design_measure`, `design_measure_error`, and `case_measure` (evaluation, case) with the
        coordinates `case_load` (N), `case_tilt` (rad) and `case_load_position` (m; NaN where the tilt is prescribed).
        ``profile(**result.optimum.to_series())`` is the profile.

    Raises
    ------
    InvalidInputError
        If an argument is out of range, the measure is unknown or infinite within the bounds, or no profile is valid.

    Warns
    -----
    BoundWarning
        If the optimum equals a bound. The optimum may be local: the result contains all designs.

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
    if not callable(profile):
        raise InvalidInputError("profile", profile, "a class of profiles, or a function that returns a profile")
    if not (isinstance(measure, str) or callable(measure)):
        raise InvalidInputError("measure", measure, "the name of a variable, or a function of the result")
    if not isinstance(bounds, Mapping) or not bounds:
        raise InvalidInputError("bounds", bounds, 'such as {"crown_radius": (0.5, 5.0)}')
    ranges = {}
    for name, pair in bounds.items():
        low, high = checks.coordinates(f"bounds[{name!r}]", pair, "SI")[[0, -1]] if np.size(pair) == 2 else (0.0, 0.0)
        if not low < high:
            raise InvalidInputError(f"bounds[{name!r}]", pair, "two numbers, the least and the largest value")
        ranges[str(name)] = float(low), float(high)
    case_list = [cases] if isinstance(cases, Case) else list(cases) if isinstance(cases, Iterable) else []
    for case in case_list or (cases,):
        checks.instance("cases", case, Case, "a Case, or a sequence of Cases")
    load_positions = [np.nan if case.load_position is None else case.load_position for case in case_list]
    case_coordinates = {
        "case_load": ("case", [case.normal_load for case in case_list]),  # raises for a prescribed approach
        "case_tilt": ("case", [case.tilt for case in case_list]),
        "case_load_position": ("case", load_positions),
    }
    search = Evaluations(
        cases=case_list,
        profile=profile,
        ranges=ranges,
        measure=measure,
        accuracy=check_accuracy(accuracy),
        settings=dict(settings),
        max_designs=checks.count("evaluations", evaluations, minimum=min_designs(len(ranges))),
    )
    best = search_optimum(search)
    result = _label_designs(search, *find_flat_ranges(search, best)).assign_coords(case_coordinates)
    for name in result["parameter"].values[result["at_bound"].values]:
        parameter_result = result.sel(parameter=name)
        value, low, high = (float(parameter_result[key]) for key in ("optimum", "lower_bound", "upper_bound"))
        message = f"the best {name} = {value:.4g} lies at a bound ({low:g} to {high:g})"
        hint = "widen the bounds if such a roller can be manufactured"
        warnings.warn(f"{message}; {hint}", BoundWarning, stacklevel=2)
    return result


def _label_designs(evaluations: Evaluations, flat_from: FloatArray, flat_to: FloatArray) -> xr.Dataset:
    """Label the optimum, the ends of the flat ranges (fractions), and every design."""
    best, designs, names = evaluations.best, evaluations.designs, list(evaluations.ranges)
    optimum = best.fractions
    lower_bounds, upper_bounds = np.transpose(list(evaluations.ranges.values()))
    # An entirely flat range does not bound the optimum.
    is_flat = (flat_from < BOUND_TOLERANCE) & (flat_to > 1 - BOUND_TOLERANCE)

    def parameters(fractions: FloatArray) -> list[float]:
        return list(evaluations.parameters(fractions).values())

    arrays: dict[str, tuple[object, object]] = {
        "optimum": ("parameter", parameters(optimum)),
        "flat_from": ("parameter", parameters(np.minimum(flat_from, optimum))),
        "flat_to": ("parameter", parameters(np.maximum(flat_to, optimum))),
        "lower_bound": ("parameter", lower_bounds),
        "upper_bound": ("parameter", upper_bounds),
        "at_bound": ("parameter", (np.minimum(optimum, 1 - optimum) < BOUND_TOLERANCE) & ~is_flat),
        "measure": ((), best.value),
        "measure_error": ((), best.error),
        "design": (("evaluation", "parameter"), [parameters(design.fractions) for design in designs]),
        "design_measure": ("evaluation", [design.value for design in designs]),
        "design_measure_error": ("evaluation", [design.error for design in designs]),
        "case_measure": (("evaluation", "case"), [design.values for design in designs]),
    }
    result = xr.Dataset(
        arrays,
        coords={
            "parameter": names,
            "parameter_units": ("parameter", [unit_of(evaluations.profile, name) for name in names]),
            "evaluation": np.arange(1, len(designs) + 1),
            "case": np.arange(1, len(evaluations.cases) + 1),
        },
    )
    if evaluations.units:
        for name in ("measure", "measure_error", "design_measure", "design_measure_error", "case_measure"):
            result[name].attrs["units"] = evaluations.units
    measure = evaluations.measure
    result.attrs["measure"] = measure if isinstance(measure, str) else getattr(measure, "__name__", repr(measure))
    return describe(result, "best parameters of a profile")
