"""A study as its author writes it: in Python or in a TOML file, with the same meaning."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contactstudy import checks
from contactstudy.analysis.provenance import STUDY_ATTRIBUTE, attribute
from contactstudy.arrays.html_table import html_table
from contactstudy.errors import InvalidInputError
from contactstudy.study.cube import Axis
from contactstudy.study.errors import StudyFileError
from contactstudy.study.parameter import points
from contactstudy.study.parameters import PARAMETERS, REQUIRED, checked
from contactstudy.study.plan import LEVELS, Combination, Plan, combinations, in_engineers_words, label, make_plan
from contactstudy.study.profile_kinds import with_files_in

if TYPE_CHECKING:
    import xarray as xr

KEYS = ("name", "description", "level", "base", "sweep", "zip", "cases", "exclude")
"""Keys of a study file; each is also an argument of :class:`Study`."""

# Each case is a file and about two kilobytes of memory.
MOST_CASES = 1_000_000

LISTED = 12
"""Values of a swept parameter that are all shown."""


def _listed(name: str, values: object) -> list[Any]:
    """Values of a swept parameter as a list that is not empty."""
    if isinstance(values, Mapping) and set(values) == {"start", "stop", "count"}:
        values = points(name, values)
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if isinstance(values, (str, bytes, Mapping)) or not isinstance(values, Sequence):
        raise InvalidInputError(name, values, "a list of values, or for numbers a table with start, stop and count")
    if not values:
        raise InvalidInputError(name, values, "a list of at least one value")
    return list(values)


def _tables(name: str, value: object) -> list[Mapping[str, Any]]:
    """Return a table, or a list of tables, as a list of tables."""
    entries = [value] if isinstance(value, Mapping) else list(value) if isinstance(value, (list, tuple)) else None
    if entries is None or not all(isinstance(entry, Mapping) for entry in entries):
        raise InvalidInputError(name, value, "a table of parameters, or a list of such tables")
    return entries


def _shortened(texts: list[str]) -> str:
    """Values of a swept parameter; of many the first and the last."""
    return ", ".join(texts) if len(texts) <= LISTED else f"{len(texts)} values, {texts[0]} to {texts[-1]}"


@dataclass(frozen=True)
class Study:
    """A parametric study: which cases to solve, and what to keep of each.

    Parameters
    ----------
    name : str
        Letters, digits, ``_ - .``; the default folder is named after it.
    base : mapping
        Parameters that all cases share, see :data:`contactstudy.study.parameters.PARAMETERS`.
    sweep : mapping of lists
        Parameters that are combined each with each; every one becomes a dimension. For evenly spaced numbers a mapping
        ``{"start": ..., "stop": ..., "count": ...}`` stands for the list.
    zip : mapping of lists, or list of such mappings
        Parameters that change together: lists of equal length; every mapping becomes one dimension.
    cases : list of mappings
        Explicit cases, each on top of `base`, beside the product.
    exclude : list of mappings
        Combinations to leave out: a case is out if every named parameter has the value, or one of the values, given.
        A profile is named by its label.
    level : {"summary", "surface", "fields"}
        What is kept of each case: scalars; also pressure, gap, ...; also stresses.
    description : str
        For the reader.

    Raises
    ------
    InvalidInputError
        If a key is unknown (with the nearest known one), a value is of a wrong type, or what every case needs, such as
        a load, is given nowhere. Combinations that are impossible are no error: :meth:`plan` lists them as skipped,
        with the reason.

    Examples
    --------
    >>> study = Study(
    ...     name="ends",
    ...     base={"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 1e-3, "max_pressure": 1.5e9},
    ...     sweep={"e_over_a": [0, 1, 2], "friction": [0.0, 0.1]},
    ...     exclude=[{"e_over_a": [1, 2], "friction": 0.1}],
    ... )
    >>> [case.name for case in study.plan().cases]
    ['e_over_a=0 friction=0', 'e_over_a=0 friction=0.1', 'e_over_a=1 friction=0', 'e_over_a=2 friction=0']
    """

    name: str
    base: Mapping[str, Any] = field(default_factory=dict)
    sweep: Mapping[str, Any] = field(default_factory=dict)
    zip: Any = ()
    cases: Sequence[Mapping[str, Any]] = ()
    exclude: Sequence[Mapping[str, Any]] = ()
    level: str = "fields"
    description: str = ""

    def __repr__(self) -> str:
        lines = [f"Study {self.name}: {self.size} cases before exclusions, keeping {self.level}"]
        if self.description:
            lines.append(f"  {self.description}")
        lines += [f"  {meaning}: {text}" for meaning, text in self._rows()]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        head = escape(f"Study {self.name}: {self.size} cases before exclusions, keeping {self.level}")
        return f"<b>{head}</b><br>{escape(self.description)}{html_table([('', self._rows())])}"

    def _rows(self) -> Iterator[tuple[str, str]]:
        """Parameters, the swept ones first, in the units of engineers."""
        for name, values in self.sweep.items():
            yield f"{name} (swept)", _shortened([in_engineers_words(name, value) for value in values])
        for group in self.zip:
            for name, values in group.items():
                yield f"{name} (together)", _shortened([in_engineers_words(name, value) for value in values])
        if self.cases:
            yield "cases", f"{len(self.cases)} explicit ones"
        for name, value in self.base.items():
            yield name, in_engineers_words(name, value)
        if self.exclude:
            yield "exclude", f"{len(self.exclude)} rules"

    def __post_init__(self) -> None:
        """Check names and types, and bring every value into one form."""
        if not isinstance(self.name, str) or not re.fullmatch(r"[A-Za-z0-9][\w.-]*", self.name):
            raise InvalidInputError("name", self.name, "a word of letters, digits and _ - .")
        checks.instance("level", self.level, str, "text")
        checks.known_name("level", self.level, LEVELS)
        checks.instance("description", self.description, str, "text")
        for key in ("base", "sweep"):
            checks.instance(key, getattr(self, key), Mapping, "a table of parameters")
        set_ = object.__setattr__
        set_(self, "base", checked(self.base, "base"))
        set_(self, "sweep", {name: self._swept("sweep", name, values) for name, values in self.sweep.items()})
        zipped = []
        for group in _tables("zip", self.zip):
            columns = {name: self._swept("zip", name, values) for name, values in group.items()}
            lengths = {name: len(column) for name, column in columns.items()}
            if len(set(lengths.values())) > 1:
                raise InvalidInputError("zip", lengths, "lists of equal length")
            zipped.append(columns)
        set_(self, "zip", tuple(group for group in zipped if group))
        set_(self, "cases", tuple(checked(case, "cases") for case in _tables("cases", self.cases)))
        set_(self, "exclude", tuple(self._rule(rule) for rule in _tables("exclude", self.exclude)))
        names = [*self.sweep, *(name for group in self.zip for name in group)]
        for name in names:
            if names.count(name) > 1:
                raise InvalidInputError("zip", name, "a parameter that is not swept or zipped already")
        given = {*self.base, *names, *(name for case in self.cases for name in case)}
        if missing := ["one of " * (len(group) > 1) + ", ".join(group) for group in REQUIRED if not given & {*group}]:
            allowed = f"such that cases have {'; '.join(missing)}"
            raise InvalidInputError("parameters", sorted(given), allowed, "give it in base, sweep, zip or cases")

    @staticmethod
    def _swept(where: str, name: str, values: object) -> list[Any]:
        checks.known_name(where, str(name), PARAMETERS)
        column = [PARAMETERS[name].checked(value) for value in _listed(f"{where}.{name}", values)]
        if where == "sweep":
            seen = set()
            for value in column:
                entry = label(name, value)
                if entry in seen:
                    raise InvalidInputError(f"{where}.{name}", entry, "a list of different values", "it appears twice")
                seen.add(entry)
        return column

    @staticmethod
    def _rule(rule: Mapping[str, Any]) -> dict[str, list[Any]]:
        if not rule:
            raise InvalidInputError("exclude", rule, "a table with at least one parameter")
        wanted: dict[str, list[Any]] = {}
        for name, values in rule.items():
            checks.known_name("exclude", str(name), PARAMETERS)
            several = values if isinstance(values, (list, tuple)) else [values]
            wanted[name] = [
                value
                if isinstance(value, str) and not isinstance(PARAMETERS[name].default, str)
                else label(name, PARAMETERS[name].checked(value))
                for value in several
            ]
        return wanted

    @classmethod
    def from_toml(cls, path: str | Path) -> Study:
        """Read a study file.

        Parameters
        ----------
        path : str or Path
            TOML file with the keys :data:`KEYS`; `name` defaults to the file's name. Files with measured profiles are
            found from its folder.

        Raises
        ------
        StudyFileError
            If the file cannot be read or is not TOML.
        InvalidInputError
            If a key is unknown or a value is of a wrong type.
        """
        path = Path(path)
        try:
            content = tomllib.loads(path.read_text(encoding="utf-8-sig"))
        except (OSError, ValueError) as error:  # a ValueError is no TOML, no UTF-8, or a number of thousands of digits
            reason = error.strerror if isinstance(error, OSError) and error.strerror else error
            raise StudyFileError(f"study file {path}: {reason}") from error
        except RecursionError:
            raise StudyFileError(f"study file {path}: tables or lists are nested too deeply to be read") from None
        return cls.from_mapping({"name": path.stem} | with_files_in(content, path.parent))

    @classmethod
    def from_mapping(cls, content: Mapping[str, Any]) -> Study:
        """Study from a mapping with the keys :data:`KEYS`."""
        checks.instance("content of the study file", content, Mapping, f"a table with the keys {', '.join(KEYS)}")
        for key in content:
            checks.known_name("key of the study file", str(key), KEYS)
        return cls(**content)

    @classmethod
    def from_dataset(
        cls,
        table: xr.Dataset,
        name: str | None = None,
        *,
        base: Mapping[str, Any] | None = None,
        level: str | None = None,
        description: str | None = None,
    ) -> Study:
        """Study whose cases are the entries of a table, or a part of a study that was opened.

        Parameters
        ----------
        table : Dataset
            Variables and coordinates named after parameters. Those along one dimension change together, dimensions are
            combined each with each: coordinates of a grid are a product, columns along one dimension a list of cases.
            Those along two or more dimensions give each combination its own value. Numbers without a dimension are
            shared. NaN and an empty text leave a parameter out. An attribute `units` that is known is
            converted, any other is refused. Instead, what :func:`contactstudy.open_study` or
            :func:`contactstudy.study.collect` returns, or a selection of it: its cases again.
        name : str, optional
            See the class. An opened study keeps its own, and so its level and description.
        base : mapping, optional
            Further parameters that all cases share; of an opened study, those that shall be others.
        level, description : str, optional
            See the class.

        Raises
        ------
        InvalidInputError
            If a variable is no parameter, a unit does not fit, or a value is refused by the class.

        Examples
        --------
        >>> import xarray as xr
        >>> table = xr.Dataset(
        ...     {"max_pressure": ("case", [1000.0, 1500.0], {"units": "MPa"}), "tilt": ("case", [0.0, 1e-4])},
        ...     coords={"friction": [0.0, 0.1]},
        ... )
        >>> base = {"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 10e-3, "e_over_a": 2}
        >>> study = Study.from_dataset(table, "table", base=base)
        >>> [case.name for case in study.plan().cases][:2]
        ['friction=0 max_pressure=1e+09 tilt=0', 'friction=0 max_pressure=1.5e+09 tilt=0.0001']
        """
        from contactstudy.study.table import content_of_table, is_opened, part_of_study

        said = {"name": name, "level": level, "description": description}
        given = {key: value for key, value in said.items() if value is not None}
        if is_opened(table):
            study = cls.from_mapping(attribute(table, STUDY_ATTRIBUTE))
            content = part_of_study(study, table, base or {})
        else:
            content = content_of_table(table, base or {})
        return cls(**({"name": "table"} | content | given))

    def to_json(self) -> str:
        """Everything the study says, as JSON that :meth:`from_mapping` reads back after ``json.loads``."""
        return json.dumps({key: getattr(self, key) for key in KEYS}, indent=1)

    @property
    def size(self) -> int:
        """Number of combinations and explicit cases, before any is excluded."""
        axes = [len(values) for values in self.sweep.values()]
        axes += [len(next(iter(group.values()))) for group in self.zip]
        return (math.prod(axes) if axes or not self.cases else 0) + len(self.cases)

    def plan(self) -> Plan:
        """Cases of the study, in order; solves nothing.

        Returns
        -------
        Plan

        Raises
        ------
        StudyFileError
            If there are more than :data:`MOST_CASES`.
        """
        if self.size > MOST_CASES:
            raise StudyFileError(
                f"study {self.name!r} has {self.size} combinations, and {MOST_CASES} is the most that one study may "
                "have: sweep fewer values, or make several studies"
            )
        kept, unknown = self._expanded()
        return make_plan(self.name, self.level, kept, self.axes(), bool(self.cases), unknown)

    def axes(self) -> tuple[Axis, ...]:
        """Swept parameters, then those that change together."""
        axes = [Axis(tuple({name: value} for value in values)) for name, values in self.sweep.items()]
        for group in self.zip:
            rows = zip(*group.values(), strict=True)
            axes.append(Axis(tuple(dict(zip(group, row, strict=True)) for row in rows)))
        return tuple(axes)

    def combinations(self) -> list[Combination]:
        """Values of every case that is not excluded, in the order of the plan."""
        return self._expanded()[0]

    def _expanded(self) -> tuple[list[Combination], tuple[str, ...]]:
        """Return the cases that are not excluded, and what exclusions name but no case has."""
        rules = tuple({**rule} for rule in self.exclude)
        named = {name for rule in self.exclude for name in rule}
        defaults = {name: PARAMETERS[name].default for name in named if PARAMETERS[name].default is not None}
        return combinations(self.base, self.axes(), tuple(self.cases), rules, defaults)
