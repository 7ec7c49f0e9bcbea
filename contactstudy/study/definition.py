"""Definition of a study in Python or in a TOML file."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.provenance import STUDY_ATTRIBUTE, attribute
from contactstudy.arrays.engineering import html_table
from contactstudy.checks import IntArray, factor_to
from contactstudy.errors import InvalidInputError, StudyFileError
from contactstudy.study.parameters import PARAMETERS, REQUIRED, check_parameters, check_points
from contactstudy.study.plan import LEVELS, Axis, Plan, format_list, format_value, label
from contactstudy.study.profile_tables import resolve_files

KEYS = ("name", "description", "level", "base", "sweep", "zip", "cases", "exclude")  # of a study file
MAX_CASES = 1_000_000  # Combinations of one study, at most: half a gigabyte of identities and groups


def _list_tables(name: str, value: object) -> list[Mapping[str, Any]]:
    """Return a list of tables from a table or a list of tables."""
    entries = [value] if isinstance(value, Mapping) else list(value) if isinstance(value, (list, tuple)) else None
    if entries is None or not all(isinstance(entry, Mapping) for entry in entries):
        raise InvalidInputError(name, value, "a table of parameters, or a list of such tables")
    return entries


@dataclass(frozen=True, kw_only=True)
class Study:
    """A parametric study: cases to solve, and the arrays to retain.

    Parameters
    ----------
    name : str
        Letters, digits, ``_ - .``; the default folder is named after it.
    base : mapping
        Parameters that all cases share, see :data:`contactstudy.study.parameters.PARAMETERS`.
    sweep : mapping of lists
        Parameters that are combined each with each; every one becomes a dimension. For evenly spaced numbers a mapping
        ``{"start": ..., "stop": ..., "count": ...}`` replaces the list.
    zip : mapping of lists, or list of such mappings
        Parameters that change together: lists of equal length; every mapping becomes one dimension.
    cases : list of mappings
        Explicit cases, each added to `base`, in addition to the product.
    exclude : list of mappings
        Combinations to leave out: every named parameter has the value, or one of the values; a profile has its label.
    level : {"summary", "surface", "fields"}
        Retained results: numbers; also pressure, gap, ...; also stresses.
    description : str
        For the reader.

    Raises
    ------
    InvalidInputError
        If a key is unknown, a value is of a wrong type, or a required parameter is missing in all cases. :meth:`plan`
        lists impossible combinations as skipped, with the reason.

    Examples
    --------
    >>> study = Study(
    ...     name="ends",
    ...     base={"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 1e-3, "max_pressure": 1.5e9},
    ...     sweep={"e_over_a": [0, 1, 2], "friction": [0.0, 0.1]},
    ...     exclude=[{"e_over_a": [1, 2], "friction": 0.1}],
    ... )
    >>> [case.name for case in study.plan()]
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
        lines = [self._headline, self.description, *(f"{meaning}: {text}" for meaning, text in self._rows())]
        return "\n  ".join(filter(None, lines))

    def _repr_html_(self) -> str:
        return f"<b>{escape(self._headline)}</b><br>{escape(self.description)}{html_table([('', self._rows())])}"

    @property
    def _headline(self) -> str:
        return f"Study {self.name}: {self.size} cases before exclusions, keeping {self.level}"

    def _rows(self) -> Iterator[tuple[str, str]]:
        """Rows of text: parameters in the units of engineers, swept parameters first."""
        columns = [(name, "swept", values) for name, values in self.sweep.items()]
        columns += [(name, "together", values) for group in self.zip for name, values in group.items()]
        for name, axis_kind, values in columns:
            yield f"{name} ({axis_kind})", format_list([format_value(name, value) for value in values])
        if self.cases:
            yield "cases", f"{len(self.cases)} explicit cases"
        for name, value in self.base.items():
            yield name, format_value(name, value)
        if self.exclude:
            yield "exclude", f"{len(self.exclude)} rules"

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not re.fullmatch(r"[A-Za-z0-9][\w.-]*", self.name):
            raise InvalidInputError("name", self.name, "a word of letters, digits and _ - .")
        checks.known_name("level", self.level, LEVELS)
        checks.instance("description", self.description, str, "text")
        for key in ("base", "sweep"):
            checks.instance(key, getattr(self, key), Mapping, "a table of parameters")
        store = object.__setattr__
        store(self, "base", check_parameters(self.base, "base"))
        store(self, "sweep", {name: self._check_values("sweep", name, values) for name, values in self.sweep.items()})
        zipped_groups = []
        for group in _list_tables("zip", self.zip):
            columns = {name: self._check_values("zip", name, values) for name, values in group.items()}
            lengths = {name: len(column) for name, column in columns.items()}
            if len(set(lengths.values())) > 1:
                raise InvalidInputError("zip", lengths, "lists of equal length")
            zipped_groups.append(columns)
        store(self, "zip", tuple(group for group in zipped_groups if group))
        store(self, "cases", tuple(check_parameters(case, "cases") for case in _list_tables("cases", self.cases)))
        store(self, "exclude", tuple(self._check_rule(rule) for rule in _list_tables("exclude", self.exclude)))
        names = [*self.sweep, *(name for group in self.zip for name in group)]
        for name in names:
            if names.count(name) > 1:
                raise InvalidInputError("zip", name, "a parameter that is not swept or zipped already")
        given = {*self.base, *names, *(name for case in self.cases for name in case)}
        if missing := ["one of " * (len(group) > 1) + ", ".join(group) for group in REQUIRED if not given & {*group}]:
            allowed = f"such that cases have {'; '.join(missing)}"
            raise InvalidInputError("parameters", sorted(given), allowed, "give it in base, sweep, zip or cases")

    @staticmethod
    def _check_values(section: str, name: str, values: object) -> list[Any]:
        """Values of a swept parameter as a list that is not empty."""
        checks.known_name(section, str(name), PARAMETERS)
        argument = f"{section}.{name}"
        if isinstance(values, Mapping) and set(values) == {"start", "stop", "count"}:
            values = check_points(argument, values)
        if isinstance(values, np.ndarray):
            values = values.tolist()
        if isinstance(values, (str, bytes, Mapping)) or not isinstance(values, Sequence) or not values:
            allowed = "a list of at least one value, or for numbers a table with start, stop and count"
            raise InvalidInputError(argument, values, allowed)
        column = [PARAMETERS[name].normalize(value) for value in values]
        if section == "sweep":
            entries = [label(value) for value in column]
            if duplicates := [entry for entry in entries if entries.count(entry) > 1]:
                raise InvalidInputError(argument, duplicates[0], "a list of different values", "it appears twice")
        return column

    @staticmethod
    def _check_rule(rule: Mapping[str, Any]) -> dict[str, list[Any]]:
        if not rule:
            raise InvalidInputError("exclude", rule, "a table with at least one parameter")
        excluded: dict[str, list[Any]] = {}
        for name, values in rule.items():
            checks.known_name("exclude", str(name), PARAMETERS)
            rule_values = values if isinstance(values, (list, tuple)) else [values]
            excluded[name] = [
                value
                if isinstance(value, str) and not isinstance(PARAMETERS[name].default, str)
                else label(PARAMETERS[name].normalize(value))
                for value in rule_values
            ]
        return excluded

    @classmethod
    def from_toml(cls, path: str | Path) -> Study:
        """Read a study file; paths of measured profiles are relative to its folder.

        Parameters
        ----------
        path : str or Path
            TOML file with the keys :data:`KEYS`; `name` defaults to the file's name.

        Raises
        ------
        StudyFileError
            If the file cannot be read or is not TOML.
        InvalidInputError
            If a key is unknown or a value is of a wrong type.
        """
        path = Path(path)
        try:
            content = checks.read_tables(path, tomllib.loads)
        except (OSError, ValueError) as error:  # ValueError: invalid TOML or UTF-8, or a number of thousands of digits
            reason = error.strerror if isinstance(error, OSError) and error.strerror else error
            raise StudyFileError(f"study file {path}: {reason}") from error
        return cls.from_mapping({"name": path.stem} | resolve_files(content, path.parent))

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
        """Study whose cases are the entries of a table, or a selection of an opened study.

        Parameters
        ----------
        table : Dataset
            Variables and coordinates named after parameters. Variables along one dimension change together, dimensions
            are combined each with each; variables along several dimensions have a value for each combination, numbers
            without a dimension are shared. NaN and an empty text leave a parameter out. Known `units` are converted,
            others refused. An opened study, or a selection of it, makes a study of its cases.
        name, level, description : str, optional
            See the class. An opened study provides the defaults.
        base : mapping, optional
            Further parameters that all cases share; of an opened study, parameters to change.

        Raises
        ------
        InvalidInputError
            If a variable is not a parameter, a unit does not fit, or the class refuses a value.

        Examples
        --------
        >>> import xarray as xr
        >>> table = xr.Dataset({"max_pressure": ("case", [1000.0, 1500.0], {"units": "MPa"})}, {"friction": [0.0, 0.1]})
        >>> base = {"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 10e-3, "e_over_a": 2}
        >>> study = Study.from_dataset(table, "table", base=base)
        >>> [case.name for case in study.plan()][:2]
        ['max_pressure=1e+09 friction=0', 'max_pressure=1e+09 friction=0.1']
        """
        allowed = "an xarray.Dataset of parameters, such as a pandas table's .to_xarray(), or an opened study"
        checks.instance("table", table, xr.Dataset, allowed)
        arguments = {"name": name, "level": level, "description": description}
        arguments = {key: value for key, value in arguments.items() if value is not None}
        if STUDY_ATTRIBUTE in table.attrs and "case_id" in table:
            study = cls.from_mapping(attribute(table, STUDY_ATTRIBUTE))
            content = content_of_selection(study, table, base or {})
        else:
            content = content_of_table(table, base or {})
        return cls(**({"name": "table"} | content | arguments))

    def to_json(self) -> str:
        """Content of the study as JSON; :meth:`from_mapping` takes the result of ``json.loads``."""
        return json.dumps({key: getattr(self, key) for key in KEYS}, indent=1)

    @property
    def size(self) -> int:
        """Number of combinations and explicit cases, before any is excluded."""
        return self._full_plan.products + len(self.cases)

    @property
    def _full_plan(self) -> Plan:
        """Plan of all combinations and explicit cases, before any is excluded."""
        axes: list[Axis] = [tuple({name: value} for value in values) for name, values in self.sweep.items()]
        for group in self.zip:
            axes.append(tuple(dict(zip(group, row, strict=True)) for row in zip(*group.values(), strict=True)))
        explicit = tuple(self.cases)
        return Plan(name=self.name, level=self.level, base=self.base, axes=tuple(axes), explicit=explicit)

    def plan(self) -> Plan:
        """Cases of the study, in order; solves nothing.

        Raises
        ------
        StudyFileError
            If there are more than :data:`MAX_CASES`.
        """
        if self.size > MAX_CASES:
            limit = f"above the maximum of {MAX_CASES}: sweep fewer values, or divide the study into several studies"
            raise StudyFileError(f"study {self.name!r} has {self.size} combinations, {limit}")
        full_plan = self._full_plan
        is_excluded = np.zeros(self.size, dtype=bool)
        unknown_messages = []
        for rule in self.exclude:
            is_matching = np.ones(is_excluded.size, dtype=bool)
            for name, allowed in rule.items():
                labels, codes = self._labels(full_plan, name)
                is_matching &= np.array([text in allowed for text in labels])[codes]
                used_labels = [labels[code] for code in np.unique(codes)]
                unknown_messages += [
                    f"exclude.{name} = {value!r}: no case has this value, so it excludes nothing"
                    for value in allowed
                    if value not in used_labels
                ]
            is_excluded |= is_matching
        return replace(full_plan, chosen=np.flatnonzero(~is_excluded), unknown=tuple(dict.fromkeys(unknown_messages)))

    def _labels(self, full_plan: Plan, name: str) -> tuple[list[Any], IntArray]:
        """Labels of a parameter, and the index of the label of each combination and of each explicit case."""
        shared = self.base.get(name, PARAMETERS[name].default)
        values, codes = [shared], np.zeros(full_plan.products, dtype=np.int64)
        for index, axis in enumerate(full_plan.axes):
            if name in axis[0]:
                values = [step[name] for step in axis]
                codes = np.unravel_index(np.arange(full_plan.products), full_plan.shape)[index]
        explicit = [case.get(name, shared) for case in self.cases]
        all_codes = np.concatenate([codes, len(values) + np.arange(len(explicit))])
        return [label(value) for value in (*values, *explicit)], all_codes


def content_of_table(table: xr.Dataset, base: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a study whose cases are the entries of a table, in SI."""
    columns: dict[str, xr.Variable] = {}
    for name, array in ((str(key), variable) for key, variable in table.variables.items()):
        if name not in PARAMETERS:
            # The dimension of a parameter may have a number instead of values.
            is_parameter_dim = any(name in other.dims for key, other in table.variables.items() if key in PARAMETERS)
            if name not in table.indexes or not is_parameter_dim:
                checks.known_name("variable of the table", name, PARAMETERS)
            continue
        if PARAMETERS[name].check is check_points and array.dims:
            raise InvalidInputError(name, array.dims, "a list in base: it is one value of a case")
        stated_unit, unit = array.attrs.get("units"), PARAMETERS[name].units
        is_si = stated_unit is None or stated_unit == unit
        factor = 1.0 if is_si else factor_to(unit, f"{name}.attrs['units']", stated_unit)
        columns[name] = array if factor == 1.0 else array * factor
    shared = {name: _python_value(array.values[()]) for name, array in columns.items() if not array.dims}
    for name in {*base} & {*columns}:
        raise InvalidInputError("base", name, "a parameter that the table does not have")
    content: dict[str, Any] = {"base": {**base, **{name: value for name, value in shared.items() if value is not None}}}
    if any(array.ndim and (array.ndim > 1 or None in map(_python_value, array.values)) for array in columns.values()):
        varying = {name: array for name, array in columns.items() if array.dims}
        used_dims = {dim for array in varying.values() for dim in array.dims}
        sizes = {dim: size for dim, size in table.sizes.items() if dim in used_dims}
        values = [map(_python_value, array.set_dims(sizes).transpose(*sizes).values.flat) for array in varying.values()]
        return content | {"cases": [dict(zip(varying, row, strict=True)) for row in zip(*values, strict=True)]}
    groups: dict[str, dict[str, list[Any]]] = {}
    for name, array in columns.items():
        if array.dims:
            groups.setdefault(str(array.dims[0]), {})[name] = [_python_value(value) for value in array.values]
    return content | _content_of_axes(groups.values())


def _python_value(value: Any) -> Any:
    """Return a value of an array as a Python object; None for a missing value."""
    python_value = value.item() if isinstance(value, np.generic) else value
    missing = python_value is None or python_value == "" or (isinstance(python_value, float) and np.isnan(python_value))
    return None if missing else python_value


def content_of_selection(study: Study, table: xr.Dataset, base: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a study of the cases in a selection of its Dataset; as a product if the selection allows."""
    plan = study.plan()
    identities = np.char.encode(table["case_id"].values.ravel().astype(np.str_))
    selected_indices = np.flatnonzero(np.isin(plan.ids, identities)).tolist()
    if not selected_indices:
        raise InvalidInputError("table", f"{table['case_id'].size} cases", f"with cases of the study {study.name!r}")
    content: dict[str, Any] = {
        "name": study.name,
        "level": study.level,
        "description": study.description,
        "base": {**study.base, **base},
    }
    cases = [plan.varying(index) for index in selected_indices]
    for name in base:
        if any(name in case for case in cases):
            raise InvalidInputError("base", name, "a parameter that is not swept")
    if study.cases or not plan.axes:
        return content | {"cases": cases if study.cases else []}
    steps = [np.unique(column) for column in np.unravel_index(plan.chosen[selected_indices], plan.shape)]
    selected_product = np.ravel_multi_index(np.ix_(*steps), plan.shape).ravel()
    if np.isin(selected_product, plan.chosen).sum() != len(selected_indices):
        return content | {"cases": cases}
    groups = [
        {name: [axis[step][name] for step in axis_steps] for name in axis[0]}
        for axis, axis_steps in zip(plan.axes, steps, strict=True)
    ]
    return content | _content_of_axes(groups) | {"exclude": list(study.exclude)}


def _content_of_axes(axes: Iterable[Mapping[str, list[Any]]]) -> dict[str, Any]:
    """Return the keys `sweep` and `zip` of a product; parameters of one axis change together."""
    swept = {name: values for axis in axes if len(axis) == 1 for name, values in axis.items()}
    return {"sweep": swept, "zip": [axis for axis in axes if len(axis) > 1]}
