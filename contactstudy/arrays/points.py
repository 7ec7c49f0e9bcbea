"""Points of a field."""

from __future__ import annotations

from typing import NamedTuple

from contactstudy.checks import FloatArray


class Points(NamedTuple):
    """Positions of a field: the tensor product of `x`, `y` and `z`, metres."""

    x: FloatArray
    y: FloatArray
    z: FloatArray
