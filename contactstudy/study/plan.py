"""From a study to the list of its cases, in a stable order."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from contactstudy.arrays.engineering import quantity
from contactstudy.case.doubts import doubts
from contactstudy.errors import ContactStudyError
from contactstudy.study.cube import Axis, Cube, cube_of_axes, cube_of_cases
from contactstudy.study.identity import fragment, identity_of
from contactstudy.study.parameters import PARAMETERS, completed, counted
from contactstudy.study.profile_words import profile_in_words, profile_label
from contactstudy.study.setup import Described, check_cells, setup_of

Level = str
LEVELS: tuple[Level, ...] = ("summary", "surface", "fields")
"""What a file keeps: scalars; also everything on (x, y); also the stresses."""

ENDS_EFFORT = 15.0
"""Effort of a case with free ends over one without, roughly; for forecasts of time only."""

BYTES_PER_CELL, BYTES_PER_POINT = 4 * 8, 7 * 4


@dataclass(frozen=True)
class PlannedCase:
    """One case of a study before it is solved.

    Parameters
    ----------
    id : str
        Identity, see :func:`~contactstudy.study.identity.case_id`.
    parameters : dict
        Checked parameters without defaults.
    name : str
        Swept parameters in words, for messages.
    position : tuple of int
        Place in the study's Dataset.
    reason : str
        Why the case is skipped; empty if it can be solved.
    operator : str
        Equal for cases that share the solver's preparation.
    cells, points : int
        Sizes of grid and stress field.
    described : dict
        End distance over the half-width, friction, gamma and profile; empty for a skipped case.
    doubts : tuple of str
        Questions on values of a size that is mostly a mistake in the unit.
    """

    id: str
    parameters: dict[str, Any]
    name: str
    position: tuple[int, ...]
    reason: str = ""
    operator: str = ""
    cells: int = 0
    points: int = 0
    described: Described = field(default_factory=dict)
    doubts: tuple[str, ...] = ()

    def size(self, level: Level) -> int:
        """Bytes of the case's file before compression."""
        fields = BYTES_PER_POINT * self.points if level == "fields" else 0
        return 20_000 + (BYTES_PER_CELL * self.cells if level != "summary" else 0) + fields

    @property
    def cost(self) -> float:
        """Expected effort in arbitrary units; free ends take most of it."""
        freed = self.parameters.get("body") != "half-space" and "model" not in self.parameters
        ends = ENDS_EFFORT if freed else 1.0
        return ends * (self.cells + 0.1 * self.points)


@dataclass(frozen=True)
class Plan:
    """The cases of a study, in order, and where each lies among its dimensions.

    Parameters
    ----------
    name : str
        Name of the study.
    level : {"summary", "surface", "fields"}
        What is kept.
    cases : tuple of PlannedCase
        Every case that is not excluded, skipped ones included.
    cube : Cube
        Dimensions and labels.
    unknown : tuple of str
        What the study excludes but no case has.
    """

    name: str
    level: Level
    cases: tuple[PlannedCase, ...]
    cube: Cube
    unknown: tuple[str, ...] = ()

    @property
    def skipped(self) -> tuple[PlannedCase, ...]:
        """Cases that cannot be solved, each with its reason."""
        return tuple(case for case in self.cases if case.reason)

    @property
    def unique(self) -> tuple[PlannedCase, ...]:
        """Cases to solve, each once, even if the study names it twice."""
        return tuple({case.id: case for case in self.cases if not case.reason}.values())

    @property
    def doubts(self) -> tuple[str, ...]:
        """Questions on values of a size that is mostly a mistake in the unit, each once, with the number of cases."""
        counts = Counter(question for case in self.unique for question in case.doubts)
        return tuple(f"{question} ({number} case{'s' * (number > 1)})" for question, number in counts.items())

    @property
    def size(self) -> int:
        """Bytes of all files before compression: an upper bound."""
        return sum(case.size(self.level) for case in self.unique)


def label(name: str, value: Any) -> Any:
    """Value of a parameter as it stands on a dimension."""
    if name == "profile":
        return profile_label(value)
    if isinstance(value, list):
        return f"{len(value)} points {value[0]:g} to {value[-1]:g}"
    return value


def in_words(name: str, value: Any) -> str:
    """Return a parameter as ``name=value``."""
    shown = label(name, value)
    return f"{name}={shown:g}" if isinstance(shown, float) else f"{name}={shown}"


def in_engineers_words(name: str, value: Any) -> str:
    """Value of a study's parameter in the units of engineers.

    Examples
    --------
    >>> in_engineers_words("radius", 5e-3), in_engineers_words("field_y_over_a", [0.0])
    ('5 mm', '1 value, 0')
    """
    shown = profile_in_words(value) if name == "profile" and isinstance(value, dict) else value
    if isinstance(shown, (list, tuple)):
        ends = f"{shown[0]:g}" if len(shown) == 1 else f"{shown[0]:g} to {shown[-1]:g}"
        return f"{len(shown)} value{'s' if len(shown) > 1 else ''}, {ends}"
    if isinstance(shown, bool):
        return "yes" if shown else "no"
    if not isinstance(shown, (int, float)):
        return str(shown)
    return quantity(float(shown), PARAMETERS[name].units if name in PARAMETERS else "1")


def _excluded(values: Mapping[str, Any], rules: Iterable[Mapping[str, list[Any]]]) -> bool:
    """Whether every entry of some rule matches."""
    return any(all(label(name, values.get(name)) in allowed for name, allowed in rule.items()) for rule in rules)


class Combination(NamedTuple):
    """One case before it is planned: all its values, those that are its own, and its place in a product."""

    values: dict[str, Any]
    own: dict[str, Any]
    position: tuple[int, ...]


def combinations(
    base: Mapping[str, Any],
    axes: tuple[Axis, ...],
    cases: tuple[Mapping[str, Any], ...],
    exclude: tuple[Mapping[str, list[Any]], ...],
    defaults: Mapping[str, Any],
) -> tuple[list[Combination], tuple[str, ...]]:
    """Expand a study: the product of its axes, then the explicit cases, without the excluded ones.

    All values are checked already; rules of `exclude` hold lists of labels, and see `defaults` where a case says
    nothing. Also returned is what of them no combination has.
    """
    chosen: list[Combination] = []
    if axes or not cases:
        for position in itertools.product(*(range(len(axis.entries)) for axis in axes)):
            swept: dict[str, Any] = {}
            for axis, index in zip(axes, position, strict=True):
                swept |= axis.entries[index]
            chosen.append(Combination({**base, **swept}, swept, position))
    chosen += [Combination({**base, **case}, dict(case), ()) for case in cases]
    seen = [{**defaults, **entry.values} for entry in chosen]
    unknown = []
    for name, wanted in ((name, value) for rule in exclude for name, values in rule.items() for value in values):
        if all(label(name, values.get(name)) != wanted for values in seen):
            unknown.append(f"exclude.{name} = {wanted!r}: no case has this value, so nothing is left out by it")
    kept = [entry for entry, values in zip(chosen, seen, strict=True) if not _excluded(values, exclude)]
    return kept, tuple(dict.fromkeys(unknown))


def make_plan(
    name: str,
    level: Level,
    kept: list[Combination],
    axes: tuple[Axis, ...],
    explicit: bool,
    unknown: tuple[str, ...] = (),
) -> Plan:
    """Lay out the combinations of a study along its axes, or along what differs if it has explicit cases."""
    if explicit:
        cube, positions = cube_of_cases([entry.values for entry in kept], label)
    else:
        cube = cube_of_axes(axes, label)
        positions = [entry.position if cube.dims != ("case",) or axes else (0,) for entry in kept]
    planner = Planner()
    planned = [
        planner.planned(entry.values, entry.own, position) for entry, position in zip(kept, positions, strict=True)
    ]
    return Plan(name, level, tuple(planned), cube, unknown)


class Planner:
    """Makes planned cases of checked parameters; what one value says is worked out once for all cases that share it."""

    def __init__(self) -> None:
        # By name and identity of the value, which is kept beside so that the identity stays its own.
        self._known: dict[tuple[str, int], tuple[Any, str, str]] = {}

    def _said(self, name: str, value: Any) -> tuple[Any, str, str]:
        """Return a value, its part of the identity, and the value in words."""
        key = (name, id(value))
        if key not in self._known:
            self._known[key] = (value, fragment(name, value), in_words(name, value))
        return self._known[key]

    def planned(self, values: Mapping[str, Any], swept: Mapping[str, Any], position: tuple[int, ...]) -> PlannedCase:
        """Return a case with its identity, its size, and why it cannot be solved if so."""
        given = values
        values = completed(values)
        fragments = {name: self._said(name, value)[1] for name, value in values.items()}
        identity = identity_of(fragments)
        words = " ".join(self._said(name, value)[2] for name, value in swept.items()) or "the only case"
        parameters = {name: counted(name, value) for name, value in values.items() if fragments[name]}
        try:
            setup = setup_of(parameters)
            # Values at their default do not count for the identity, but they were said.
            check_cells(given)
        except ContactStudyError as error:
            return PlannedCase(identity, parameters, words, position, reason=str(error))
        cells = math.prod(setup.shape)
        return PlannedCase(
            identity,
            parameters,
            words,
            position,
            operator=setup.operator,
            cells=cells,
            points=setup.points,
            described=setup.described,
            doubts=doubts(setup.case),
        )
