"""Plan of a study: its cases in a stable order, their identities, groups and positions among its dimensions.

Properties are computed at first use; identities and groups are arrays, and a case's parameters follow from its number.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import islice, repeat
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pandas as pd

from contactstudy.arrays.engineering import format_quantity
from contactstudy.case.magnitudes import describe_unusual, list_unusual_magnitudes
from contactstudy.checks import IntArray
from contactstudy.errors import ContactStudyError
from contactstudy.study.case_setup import build_setup
from contactstudy.study.parameters import (
    PARAMETERS,
    add_default_accuracy,
    hash_fragments,
    identity_fragment,
    without_defaults,
)
from contactstudy.study.profile_tables import format_profile
from contactstudy.study.settings import RUN

LEVELS = ("summary", "surface", "fields")  # Arrays that a study retains: none; arrays on (x, y); also the stresses
MAX_LISTED = 12  # Largest number of values of a swept parameter that are all shown
MAX_CUBE_CELLS = 4  # Entries of the parameter cube per explicit case; cases of a sparser cube are listed along `case`
BYTES_PER_CASE, BYTES_PER_CELL, BYTES_PER_POINT = 700, 4 * 8, 7 * 4  # sizes before compression
GROUPED_PARAMETERS = ("friction", "entrainment_speed")  # Parameters in which cases of a group differ
LOCAL_PARAMETERS = frozenset(  # Parameters that do not change the operator of the surface. Speed
    {"tilt", "load_offset", "profile", "body_edge", "accuracy", "tolerance", "stresses", *GROUPED_PARAMETERS}
)

Axis = tuple[dict[str, Any], ...]  # One factor of a study's product of parameters: the parameters of each step


@dataclass(frozen=True)
class Cube:
    """Dimensions of a study's Dataset."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    labels: dict[str, tuple[str, list[Any]]]  # dimension and values of each coordinate
    indices: IntArray  # number of each case in the flattened cube


def cube_of_axes(axes: Sequence[Axis], chosen: IntArray) -> Cube:
    """Cube of a product, one dimension per axis; zipped parameters are named after the first with distinct values."""
    if not axes:
        return Cube(("case",), (1,), {"case": ("case", [0])}, chosen)
    dims, shape, labels = [], [], {}
    for axis in axes:
        columns = {name: [label(entry[name]) for entry in axis] for name in axis[0]}
        distinct_names = [name for name, column in columns.items() if len(set(column)) == len(column)]
        dim = distinct_names[0] if distinct_names else "_and_".join(columns)
        if not distinct_names:
            labels[dim] = (dim, list(range(len(axis))))
        for name, column in columns.items():
            labels[name] = (dim, column)
        dims.append(dim)
        shape.append(len(axis))
    return Cube(tuple(dims), tuple(shape), labels, chosen)


def cube_of_cases(cases: Sequence[Mapping[str, Any]]) -> Cube:
    """Cube of explicit cases over the parameters that differ, or along `case` if sparse."""
    names = dict.fromkeys(name for case in cases for name in case)
    columns = {name: [label(case.get(name)) for case in cases] for name in names}
    steps = {name: {value: step for step, value in enumerate(dict.fromkeys(columns[name]))} for name in names}
    steps_of = {name: numbers for name, numbers in steps.items() if len(numbers) > 1}
    shape = tuple(map(len, steps_of.values()))
    is_complete = not any(None in numbers for numbers in steps_of.values())
    if steps_of and is_complete and math.prod(shape) <= MAX_CUBE_CELLS * len(cases):
        multi_index = tuple([numbers[value] for value in columns[name]] for name, numbers in steps_of.items())
        indices = np.ravel_multi_index(multi_index, shape)
        if len(np.unique(indices)) == len(cases):
            return Cube(tuple(steps_of), shape, {name: (name, list(steps_of[name])) for name in steps_of}, indices)
    labels = {"case": ("case", list(range(len(cases))))} | {name: ("case", columns[name]) for name in steps_of}
    return Cube(("case",), (len(cases),), labels, np.arange(len(cases)))


@dataclass(frozen=True, kw_only=True)
class PlannedCase:
    """One case of a study before it is solved."""

    index: int  # number in the plan
    id: str
    parameters: dict[str, Any]  # checked, without defaults
    name: str  # swept parameters in words
    position: tuple[int, ...]  # in the study's Dataset
    group: int  # number of the group, whose cases share a contact
    reason: str = ""  # why the plan skips the case, or empty


class Review(NamedTuple):
    """Result of setting up one case of each group, or of a sample of the groups."""

    reasons: dict[int, str]  # why a group cannot be solved
    doubts: Counter[str]  # warnings of values outside the usual range, with the number of groups
    checked: int  # groups that were set up
    groups: int
    cells: float  # mean per case
    points: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Plan(Sequence[PlannedCase]):
    """The cases of a study, in order."""

    name: str
    level: str  # retained arrays
    base: Mapping[str, Any]  # parameters of all cases
    axes: tuple[Axis, ...] = ()
    explicit: tuple[Mapping[str, Any], ...] = ()  # cases on top of the base
    # cases that are not excluded: numbers in the product, then of the explicit cases
    chosen: IntArray = field(default_factory=lambda: np.zeros(1, dtype=np.int64))
    unknown: tuple[str, ...] = ()  # excluded values that no case has

    def __len__(self) -> int:
        return len(self.chosen)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[case_index] for case_index in range(*index.indices(len(self)))]
        case_index = range(len(self))[index]
        return PlannedCase(
            index=case_index,
            id=self.ids[case_index].decode(),
            parameters=self.parameters(case_index),
            name=self.describe(case_index),
            group=int(self.groups[case_index]),
            position=tuple(map(int, np.unravel_index(self.cube.indices[case_index], self.cube.shape))),
            reason=self.reason(case_index),
        )

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of steps of each axis."""
        return tuple(len(axis) for axis in self.axes)

    @property
    def products(self) -> int:
        """Number of combinations of the axes."""
        return math.prod(self.shape) if self.axes or not self.explicit else 0

    def varying(self, index: int) -> dict[str, Any]:
        """Parameters of a case in addition to the base."""
        product_index = int(self.chosen[index])
        if product_index >= self.products:
            return dict(self.explicit[product_index - self.products])
        steps = np.unravel_index(product_index, self.shape) if self.shape else ()
        return {name: value for axis, step in zip(self.axes, steps, strict=True) for name, value in axis[step].items()}

    def values(self, index: int) -> dict[str, Any]:
        """Parameters of a case as the study gives them."""
        return {**self.base, **self.varying(index)}

    def parameters(self, index: int) -> dict[str, Any]:
        """Parameters of a case without defaults, but with the accuracy if the case gives no cells."""
        return without_defaults(add_default_accuracy(self.values(index)))

    def describe(self, index: int) -> str:
        """Swept parameters of a case, for messages."""
        labels = {name: label(value) for name, value in self.varying(index).items()}
        words = (f"{name}={text:g}" if isinstance(text, float) else f"{name}={text}" for name, text in labels.items())
        return " ".join(words) or "the only case"

    @cached_property
    def cube(self) -> Cube:
        """Dimensions of the study."""
        if self.explicit:
            return cube_of_cases([self.values(index) for index in range(len(self))])
        return cube_of_axes(self.axes, self.chosen)

    def spread(self, values: npt.NDArray[Any], fill: Any) -> npt.NDArray[Any]:
        """Values (case, ...) at the positions of the cases in the cube, with `fill` at empty positions."""
        table = np.full((math.prod(self.cube.shape), *values.shape[1:]), fill, dtype=values.dtype)
        table[self.cube.indices] = values
        return table.reshape((*self.cube.shape, *values.shape[1:]))

    def _fragments(self) -> Iterator[tuple[str, ...]]:
        """Parts of each case's canonical JSON, sorted by name; a default has an empty part."""
        product_indices = self.chosen[self.chosen < self.products]
        names = {name for axis in self.axes for name in axis[0]}
        columns: dict[str, Iterable[str]] = {}
        for name, value in add_default_accuracy({**self.base, **dict.fromkeys(names)}).items():
            if name not in names:
                columns[name] = repeat(identity_fragment(name, value))
        steps = np.unravel_index(product_indices, self.shape) if self.shape else ()
        for axis, column in zip(self.axes, steps, strict=True):
            for name in axis[0]:
                table = [identity_fragment(name, entry[name]) for entry in axis]
                columns[name] = map(table.__getitem__, column.tolist())
        yield from islice(zip(*(columns[name] for name in sorted(columns)), strict=False), product_indices.size)
        for index in self.chosen[product_indices.size :]:
            values = add_default_accuracy({**self.base, **self.explicit[index - self.products]})
            yield tuple(identity_fragment(name, values[name]) for name in sorted(values))

    @cached_property
    def ids(self) -> npt.NDArray[np.bytes_]:
        """Identities of the cases."""
        return np.fromiter(map(hash_fragments, self._fragments()), dtype="S64", count=len(self))

    def _classify(self, varying: Iterable[str], fixing: Iterable[str] = ()) -> IntArray:
        """Class of each case: `varying` parameters may differ in a class, but not with a `fixing` parameter."""
        varying_starts, fixing_starts = (tuple(f'"{name}":' for name in names) for names in (varying, fixing))

        def compute_key(fragments: tuple[str, ...]) -> int:
            ignored = () if any(text.startswith(fixing_starts) for text in fragments) else varying_starts
            return hash(tuple(text for text in fragments if text and not text.startswith(ignored)))

        keys = np.fromiter(map(compute_key, self._fragments()), dtype=np.int64, count=len(self))
        return np.asarray(pd.factorize(keys)[0], dtype=np.int64)

    @cached_property
    def groups(self) -> IntArray:
        """Group of each case: cases of a group differ only in friction in full sliding, or in the speed of a film."""
        return self._classify(GROUPED_PARAMETERS, fixing=("motion", "coupled"))

    @cached_property
    def operators(self) -> IntArray:
        """Number of the operator of each case: equal for cases that share body, load and cells."""
        return self._classify(LOCAL_PARAMETERS)

    @cached_property
    def review(self) -> Review:
        """Check of one case of each group, or of a sample of them."""
        _, first_cases = np.unique(self.groups, return_index=True)
        step = max(1, -(-len(first_cases) // RUN.checked_groups))
        sample = first_cases[::step].tolist()
        reasons, magnitude_warnings, sizes = {}, Counter[str](), []
        for index in sample:
            try:
                setup = build_setup(add_default_accuracy(self.values(index)))
            except ContactStudyError as error:
                reasons[int(self.groups[index])] = str(error)
                continue
            magnitude_warnings.update(list_unusual_magnitudes(setup.case))
            sizes.append((math.prod(setup.shape), setup.points))
        # The cases of a group differ in friction or speed: check all values, not only the first of each group.
        entries = [*(entry for axis in self.axes for entry in axis), *self.explicit]
        for name in GROUPED_PARAMETERS:
            for value in {entry[name] for entry in entries if name in entry}:
                if message := describe_unusual(name, value):
                    magnitude_warnings.setdefault(message, len(sample))
        cells, points = np.mean(sizes, axis=0).tolist() if sizes else (0.0, 0.0)
        return Review(reasons, magnitude_warnings, len(sample), len(first_cases), cells=cells, points=points)

    def reason(self, index: int) -> str:
        """Reason why the plan skips a case; empty for a case to solve."""
        return self.review.reasons.get(int(self.groups[index]), "")

    @cached_property
    def skipped(self) -> list[int]:
        """Numbers of the skipped cases."""
        return np.flatnonzero(np.isin(self.groups, list(self.review.reasons))).tolist()

    @cached_property
    def unique(self) -> list[int]:
        """Indices of the cases to solve; of equal cases only the first."""
        _, first_indices = np.unique(self.ids, return_index=True)
        return [int(index) for index in np.setdiff1d(first_indices, self.skipped)]

    @property
    def doubts(self) -> tuple[str, ...]:
        """Warnings of values outside the usual range, which suggest a wrong unit, with the number of contacts."""
        return tuple(f"{warning} ({count} contact{'s' * (count > 1)})" for warning, count in self.review.doubts.items())

    @property
    def size(self) -> float:
        """Estimated bytes of all batches before compression."""
        size = float(BYTES_PER_CASE)
        if self.level != "summary":
            size += BYTES_PER_CELL * self.review.cells
        if self.level == "fields":
            size += BYTES_PER_POINT * self.review.points
        return size * len(self.unique)


def label(value: Any) -> Any:
    """Value that represents a parameter's value in a coordinate."""
    if isinstance(value, dict):
        return format_profile(value)
    if isinstance(value, list):
        return f"{len(value)} points {value[0]:g} to {value[-1]:g}"
    return value


def format_list(texts: Sequence[str]) -> str:
    """Text of the values of a swept parameter; of more than twelve values the first and the last."""
    return ", ".join(texts) if len(texts) <= MAX_LISTED else f"{len(texts)} values, {texts[0]} to {texts[-1]}"


def format_value(name: str, value: Any) -> str:
    """Value of a study's parameter in the units of engineers."""
    value = format_profile(value, in_units=True) if isinstance(value, dict) else value
    if isinstance(value, (list, tuple)):
        range_text = f"{value[0]:g}" if len(value) == 1 else f"{value[0]:g} to {value[-1]:g}"
        return f"{len(value)} value{'s' if len(value) > 1 else ''}, {range_text}"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not isinstance(value, (int, float)):
        return str(value)
    return format_quantity(float(value), PARAMETERS[name].units if name in PARAMETERS else "1")
