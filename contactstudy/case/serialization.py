"""Conversion of a case to JSON values and back; the dataclass fields are the keys.

Each dataclass becomes a mapping of ``kind`` (its class) and its fields, in SI units; fields equal to None are omitted.
A profile of a user's class becomes a `Sampled` profile.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, TypeVar

import numpy as np

from contactstudy import profiles
from contactstudy.bodies.lubricant import Lubricant
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import FiniteLengthSpace, HalfSpace, QuarterSpace
from contactstudy.case.case import Case
from contactstudy.case.motion import AxialFriction, Rolling, Shift, Sliding
from contactstudy.case.roller import Roller
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import Profile, Shape, Sum, check_drop, describe_profile

SAMPLE_COUNT = 401  # Samples of a user's profile, evenly spaced from end to end. Accuracy.
Component = TypeVar("Component")


@dataclass(frozen=True, repr=False)
class Sampled(Shape):
    """Samples of the drop of a user's profile, with linear interpolation."""

    label: str  # repr of the user's profile
    positions: tuple[float, ...]  # distances from mid-length over the roller's length
    drops: tuple[float | None, ...]  # metres; None where infinite

    def __repr__(self) -> str:
        return self.label

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        drops = np.array([np.inf if drop is None else drop for drop in self.drops])
        with np.errstate(invalid="ignore"):  # next to an infinite drop
            interpolated = np.interp(np.asarray(x) / length, self.positions, drops)
        return np.where(np.isnan(interpolated), np.inf, interpolated)


KINDS: dict[str, type[Any]] = {  # classes of a case and its components, by name
    kind.__name__: kind
    for kind in (
        *(Case, Roller, Lubricant, Material, HalfSpace, QuarterSpace, FiniteLengthSpace),
        *(AxialFriction, Sliding, Shift, Rolling, Sampled, Sum),
        *(getattr(profiles, name) for name in dir(profiles) if is_dataclass(getattr(profiles, name))),
    )
}


def to_dict(component: Any) -> dict[str, Any]:
    """JSON values, SI, of a case or a component, with ``kind``; a user's profile requires its roller."""
    return dict(_to_json(component, 0.0))


def _to_json(component: Any, length: float) -> Any:
    """JSON values of a component; `length` is the length (m) of a user's profile."""
    name = type(component).__name__
    if KINDS.get(name) is type(component):
        length = getattr(component, "effective_length", component.length if isinstance(component, Roller) else length)
        values = {entry.name: _to_json(getattr(component, entry.name), length) for entry in fields(component)}
        return {"kind": name, **{key: value for key, value in values.items() if value is not None}}
    if isinstance(component, Profile):
        positions = np.linspace(-0.5, 0.5, SAMPLE_COUNT)
        profile_drops = check_drop(component, positions * length, length)
        drops = tuple(float(drop) if np.isfinite(drop) else None for drop in profile_drops)
        return _to_json(Sampled(describe_profile(component), tuple(positions.tolist()), drops), length)
    if isinstance(component, (tuple, list)):
        return [_to_json(entry, length) for entry in component]
    if isinstance(component, (bool, np.bool_)):
        return bool(component)
    return component if component is None or isinstance(component, str) else float(component)


def tables_within(values: Any) -> Iterator[Mapping[str, Any]]:
    """Yield every table with a ``kind`` in JSON values, at any depth."""
    if isinstance(values, Mapping):
        if "kind" in values:
            yield values
        values = tuple(values.values())
    for entry in values if isinstance(values, (list, tuple)) else ():
        yield from tables_within(entry)


def from_dict(values: Mapping[str, Any], component_class: type[Component]) -> Component:
    """Case, or a component of the given class, from the values that `to_dict` returns."""
    name = component_class.__name__.lower()
    try:
        component = _from_json(values)
    except (TypeError, KeyError) as error:
        raise InvalidInputError(name, dict(values), f"values of a {name} of this version", str(error)) from None
    if not isinstance(component, component_class):
        raise InvalidInputError(name, dict(values), f"values of a {name}")
    return component


def _from_json(values: Any) -> Any:
    """Case, or a component of a case, from JSON values."""
    if isinstance(values, Mapping):
        arguments = {str(key): _from_json(value) for key, value in values.items() if key != "kind"}
        return KINDS[values["kind"]](**arguments)
    return tuple(_from_json(value) for value in values) if isinstance(values, list) else values
