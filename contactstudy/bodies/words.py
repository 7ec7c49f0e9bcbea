"""Materials and bodies in words, as a reader wants to check them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from contactstudy.arrays.engineering import quantity

if TYPE_CHECKING:
    from contactstudy.bodies.material import Material
    from contactstudy.bodies.models import Body


def material_words(material: Material) -> str:
    """Material in one line.

    Examples
    --------
    >>> from contactstudy import Material
    >>> material_words(Material(210e9, 0.3))
    "E = 210 GPa, Poisson's ratio 0.3"
    """
    return f"E = {quantity(material.young, 'Pa')}, Poisson's ratio {material.poisson:g}"


def material_rows(material: Material) -> Iterator[tuple[str, str]]:
    """Constants of a material, those that contact needs among them."""
    yield "Young's modulus E", quantity(material.young, "Pa")
    yield "Poisson's ratio", f"{material.poisson:g}"
    yield "shear modulus G", quantity(material.shear_modulus, "Pa")
    yield "plane-strain modulus E*", quantity(material.plane_strain_modulus, "Pa")


def body_words(body: Body) -> str:
    """Kind of a body in one line.

    Examples
    --------
    >>> from contactstudy import FiniteLengthSpace, Material
    >>> body_words(FiniteLengthSpace(length=16e-3, material=Material(210e9, 0.3)))
    'two free ends, 16 mm apart'
    """
    low, high = body.extent
    if math.isinf(low):
        return "half-space, no free end"
    model = getattr(body, "model", "exact")
    note = "" if model == "exact" else f", ends by the comparison model {model!r}"
    if math.isfinite(high):
        return f"two free ends, {quantity(high, 'm')} apart{note}"
    return f"one free end, at x = 0{note}"
