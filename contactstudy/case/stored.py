"""A case as a table of plain numbers and words, which a file can hold, and back again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

from contactstudy import profiles
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import FiniteLengthSpace, HalfSpace, QuarterSpace
from contactstudy.case.case import Case
from contactstudy.case.doubts import unquestioned
from contactstudy.case.friction import AxialFriction
from contactstudy.case.motion import Rolling, Shift, Sliding
from contactstudy.case.roller import Roller
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import Profile, Shape, Sum, checked_drop, in_words

SAMPLES = 401
"""Points at which a profile of the user's own is kept."""


@dataclass(frozen=True, repr=False)
class Sampled(Shape):
    """What a file keeps of a profile that is not of this package: its drop at some points, with lines between.

    Parameters
    ----------
    says : str
        The profile's own repr.
    positions : tuple of float
        Distances from mid-length over the roller's length.
    drops : tuple of float or None
        Metres; None where infinite.

    Examples
    --------
    >>> Sampled("mine", (-0.5, 0.0, 0.5), (1e-6, 0.0, 1e-6)).drop(np.array([2.5e-3]), 10e-3).tolist()
    [5e-07]
    """

    says: str
    positions: tuple[float, ...]
    drops: tuple[float | None, ...]

    def __repr__(self) -> str:
        return self.says

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        drops = np.array([np.inf if drop is None else drop for drop in self.drops])
        with np.errstate(invalid="ignore"):  # beside an infinite drop
            found = np.interp(np.asarray(x) / length, self.positions, drops)
        return np.where(np.isnan(found), np.inf, found)


KINDS: dict[str, type[Any]] = {
    kind.__name__: kind
    for kind in (
        *(Case, Roller, Material, HalfSpace, QuarterSpace, FiniteLengthSpace),
        *(AxialFriction, Sliding, Shift, Rolling, Sampled, Sum),
        *(getattr(profiles, name) for name in profiles.__all__ if is_dataclass(getattr(profiles, name))),
    )
}
"""What a case consists of, by name."""


def case_table(case: Case) -> dict[str, Any]:
    """Table of a case: each part with its kind and its values, SI.

    Parameters
    ----------
    case : Case
        The case. A profile that is not of this package is kept at some points.

    Examples
    --------
    >>> body = HalfSpace(material=Material(210e9, 0.3))
    >>> table = case_table(Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9))
    >>> table["roller"]["profile"], table["body"]["material"]["young"]
    ({'kind': 'Cylinder', 'fillet_radius': 0.0}, 210000000000.0)
    """
    return dict(table_of(case, case.roller.length))


def table_of(part: Any, length: float = 0.0) -> Any:
    """Return a part of a case as plain values; a profile of the user's own over a length."""
    name = type(part).__name__
    if isinstance(part, profiles.EffectiveLength):
        length = part.effective_length  # what is within it is asked with this length
    if KINDS.get(name) is type(part):
        values = {entry.name: table_of(getattr(part, entry.name), length) for entry in fields(part)}
        return {"kind": name, **{key: value for key, value in values.items() if value is not None}}
    if isinstance(part, Profile):
        positions = np.linspace(-0.5, 0.5, SAMPLES)
        drops = checked_drop(part, positions * length, length)
        known = [float(drop) if np.isfinite(drop) else None for drop in drops]
        return table_of(Sampled(in_words(part), tuple(positions.tolist()), tuple(known)), length)
    if isinstance(part, (tuple, list)):
        return [table_of(entry, length) for entry in part]
    if isinstance(part, (bool, np.bool_)):
        return bool(part)
    return part if part is None or isinstance(part, str) else float(part)


def case_from(table: Mapping[str, Any]) -> Case:
    """Case from the table that :func:`case_table` makes.

    Raises
    ------
    InvalidInputError
        If the table is not of a case, or of another version that knows more.

    Examples
    --------
    >>> body = FiniteLengthSpace(length=1e-3, material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9)
    >>> case_from(case_table(case)) == case
    True
    """
    try:
        with unquestioned():  # that was done when it was made
            found = _from_table(table)
    except (TypeError, KeyError) as error:
        raise InvalidInputError("case", dict(table), "a table of a case of this version", str(error)) from None
    if not isinstance(found, Case):
        raise InvalidInputError("case", dict(table), "a table of a case")
    return found


def _from_table(entry: Any) -> Any:
    """Return a part of a case from plain values."""
    if isinstance(entry, Mapping):
        values = {str(key): _from_table(value) for key, value in entry.items() if key != "kind"}
        return KINDS[entry["kind"]](**values)
    return tuple(_from_table(value) for value in entry) if isinstance(entry, list) else entry
