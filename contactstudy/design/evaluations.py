"""Designs that were looked at: the measure of each in every case, and its error."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass, field, replace

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.case.case import Case
from contactstudy.case.doubts import unquestioned
from contactstudy.checks import FloatArray
from contactstudy.errors import ContactStudyError, InvalidInputError, WindowError
from contactstudy.profiles.base import Profile
from contactstudy.solution import solve

LOGGER = logging.getLogger(__name__)

Measure = str | Callable[[xr.Dataset], object]
"""A variable of the result, or a function of it: a number, or a number and its error."""

SAME = 1e-9
"""Part of a parameter's range by which two designs differ if they are not one. Accuracy."""


@dataclass(frozen=True, eq=False)
class Range:
    """Range of a parameter, as the search sees it: from 0 to 1.

    Attributes
    ----------
    low, high : float
        Bounds.
    """

    low: float
    high: float

    @property
    def logarithmic(self) -> bool:
        """Whether equal steps are equal ratios: where both bounds are positive."""
        return self.low > 0

    def value(self, part: float) -> float:
        """Return the parameter at a part of the range."""
        if self.logarithmic:
            return float(np.clip(self.low * (self.high / self.low) ** part, self.low, self.high))
        return float(np.clip(self.low + (self.high - self.low) * part, self.low, self.high))


@dataclass(frozen=True, eq=False)
class Design:
    """One design.

    Attributes
    ----------
    parts : array (parameter)
        Its parameters as parts of their ranges.
    values, errors : array (case)
        Measure in every case and its error; infinite where the pressure is, or where the profile cannot be.
    """

    parts: FloatArray
    values: FloatArray
    errors: FloatArray

    @property
    def value(self) -> float:
        """Measure in the worst case."""
        return float(self.values.max())

    @property
    def error(self) -> float:
        """Error of that: the largest one of the cases that may be the worst."""
        if not np.isfinite(self.value):
            return np.inf
        may_be = self.values + self.errors >= self.value - self.errors[int(self.values.argmax())]
        return float(self.errors[may_be].max())


@dataclass(eq=False)
class Evaluations:
    """Evaluates designs, each once.

    Attributes
    ----------
    cases : list of Case
        The loads and tilts; their profile is replaced.
    profile : callable
        Makes a profile from the parameters.
    ranges : dict
        Range of each parameter, by name.
    measure : str or callable
        What is to be least.
    accuracy : float
        Of the contacts; also the relative error of a measure that has none of its own.
    settings : mapping
        Further arguments of `solve`.
    known : list of Design
        What was looked at.
    units : str
        Of the measure, once a result has said it.
    refused : ContactStudyError or None
        Why a design could not be.
    """

    cases: list[Case]
    profile: Callable[..., Profile]
    ranges: dict[str, Range]
    measure: Measure
    accuracy: float
    settings: Mapping[str, object]
    known: list[Design] = field(default_factory=list)
    units: str = ""
    refused: ContactStudyError | None = None

    def __call__(self, parts: FloatArray) -> Design:
        """Return the design at these parts of the ranges."""
        wanted = np.clip(np.asarray(parts, dtype=np.float64), 0.0, 1.0)
        for design in self.known:
            if np.abs(design.parts - wanted).max() <= SAME:
                return design
        design = self._evaluated(wanted)
        self.known.append(design)
        LOGGER.info("%s: %.5g", self.parameters(wanted), design.value)
        return design

    def parameters(self, parts: FloatArray) -> dict[str, float]:
        """Return the parameters at parts of their ranges."""
        return {name: each.value(float(part)) for (name, each), part in zip(self.ranges.items(), parts, strict=True)}

    def _evaluated(self, parts: FloatArray) -> Design:
        """Solve every case of a design."""
        pairs = np.full((len(self.cases), 2), np.inf)
        try:
            profile = self._made(self.parameters(parts))
            # The bounds are questioned once, at the first design, and not at each.
            with unquestioned() if self.known else nullcontext():
                cases = [replace(case, roller=replace(case.roller, profile=profile)) for case in self.cases]
            for index, case in enumerate(cases):
                pairs[index] = self._measured(case)
        except (InvalidInputError, WindowError) as error:
            if isinstance(error, InvalidInputError) and error.parameter in ("measure", "bounds"):
                raise
            # Within the bounds there may be profiles that do not exist, or do not carry the load.
            self.refused = error
        return Design(parts, pairs[:, 0], pairs[:, 1])

    def _made(self, parameters: dict[str, float]) -> Profile:
        """Make a profile."""
        try:
            return self.profile(**parameters)
        except TypeError as error:
            raise InvalidInputError(
                "bounds", list(parameters), "of the keywords that profile takes", str(error)
            ) from None

    def _measured(self, case: Case) -> tuple[float, float]:
        """Measure of one case and its error."""
        given = bool({"grid", "roughness"} & self.settings.keys())
        result = solve(case, accuracy=None if given else self.accuracy, **self.settings)  # type: ignore[arg-type]
        if isinstance(self.measure, str):
            scalars = [str(name) for name, each in result.data_vars.items() if each.ndim == 0]
            if self.measure not in scalars:
                if self.measure in result:
                    hint = f"an array; a function makes a number of it: lambda result: result.{self.measure}.max()"
                    raise InvalidInputError("measure", self.measure, "a scalar of the result, or a function", hint)
                checks.known_name("measure", self.measure, scalars)
            found: object = result[self.measure]
            self.units = str(result[self.measure].attrs.get("units", ""))
            if f"{self.measure}_error" in result:
                found = (found, result[f"{self.measure}_error"])
        else:
            found = self.measure(result)
        number, error = _number_and_error(found)
        if np.isnan(number):
            raise InvalidInputError("measure", number, "a number in every case", f"it is none for {case!r}")
        return number, self.accuracy * abs(number) if error is None or np.isnan(error) else error


def _number_and_error(found: object) -> tuple[float, float | None]:
    """Take what a measure returned apart: a number, or a number and its error."""
    try:
        value, error = found if isinstance(found, tuple) else (found, None)
        if isinstance(value, str) or isinstance(error, str):
            raise TypeError
        return float(value), None if error is None else float(error)
    except (TypeError, ValueError):
        shape = getattr(found, "shape", ())
        shown = f"an array of shape {shape}" if shape else found
        raise InvalidInputError("measure", shown, "a function that returns a number, or (number, error)") from None
