"""Registries of bodies: from the words of a study to the body.

A new body becomes available to studies by one line: an entry in :data:`BODIES`.
"""

from __future__ import annotations

from collections.abc import Callable

from contactstudy.bodies.material import Material
from contactstudy.bodies.models import MODELS, Body, FiniteLengthSpace, HalfSpace, QuarterSpace
from contactstudy.errors import InvalidInputError


def _half_space(material: Material, length: float, model: str) -> Body:
    if model != MODELS[0]:
        raise InvalidInputError("model", model, f"{MODELS[0]!r} for a half-space, which has no free end")
    return HalfSpace(material=material)


BODIES: dict[str, Callable[[Material, float, str], Body]] = {
    "finite-length": lambda material, length, model: FiniteLengthSpace(length=length, material=material, model=model),
    "quarter-space": lambda material, length, model: QuarterSpace(material=material, model=model),
    "half-space": _half_space,
}
"""Makers of a body from its material, the length between the free ends and the model of these, by name."""

ROLLER_BODIES: dict[str, str | None] = {"rigid": None, "finite-length": "free", "half-space": "none"}
"""How a roller's ends are treated, by the name of the body that it is; None for a rigid one."""
