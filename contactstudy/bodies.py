"""The elastic bodies: where they have free end faces.

Axes are those of the whole package: x along the roller's axis, y the rolling and sliding direction, z into the
body from its loaded top ``z = 0``. No body has a boundary in y or at depth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy import checks
from contactstudy.material import Material


@dataclass(frozen=True, kw_only=True)
class Body:
    """An elastic body below ``z = 0``; use one of its kinds.

    Parameters
    ----------
    material : Material
        What the body is made of.
    """

    material: Material

    def __post_init__(self) -> None:
        """Check the material."""
        checks.instance("material", self.material, Material, "a Material")

    @property
    def extent(self) -> tuple[float, float]:
        """Smallest and largest x inside the body, metres (infinite where it has no end)."""
        return (-np.inf, np.inf)


@dataclass(frozen=True, kw_only=True)
class HalfSpace(Body):
    """Elastic half-space ``z >= 0``: no free end.

    Examples
    --------
    >>> HalfSpace(material=Material(210e9, 0.3)).extent
    (-inf, inf)
    """


@dataclass(frozen=True, kw_only=True)
class QuarterSpace(Body):
    """Elastic body ``x >= 0``, ``z >= 0`` with one free end face at ``x = 0``.

    Examples
    --------
    >>> QuarterSpace(material=Material(210e9, 0.3)).extent
    (0.0, inf)
    """

    @property
    def extent(self) -> tuple[float, float]:
        """Smallest and largest x inside the body, metres."""
        return (0.0, np.inf)


@dataclass(frozen=True, kw_only=True)
class FiniteLengthSpace(Body):
    """Elastic body ``0 <= x <= length``, ``z >= 0`` with free end faces I at ``x = 0`` and II at ``x = length``.

    Parameters
    ----------
    length : float
        Distance between the free ends (``L_f``), metres.
    material : Material
        What the body is made of.

    Raises
    ------
    InvalidInputError
        If the length is not a positive number.

    Examples
    --------
    >>> FiniteLengthSpace(length=16e-3, material=Material(210e9, 0.3)).extent
    (0.0, 0.016)
    """

    length: float

    def __post_init__(self) -> None:
        """Check length and material."""
        super().__post_init__()
        object.__setattr__(self, "length", checks.positive("length", self.length, "metres"))

    @property
    def extent(self) -> tuple[float, float]:
        """Smallest and largest x inside the body, metres."""
        return (0.0, self.length)
