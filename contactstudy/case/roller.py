"""A roller, rigid or elastic, and its height over the tangent plane."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from contactstudy import checks
from contactstudy.arrays.engineering import format_quantity
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import Body, FiniteLengthSpace, HalfSpace
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles import Cylinder, Profile, local_radius
from contactstudy.profiles.base import check_drop, describe_profile

ROUNDING = 1e-9  # Distance from a roller's end over a cell's width that counts as zero. Rounding.


def snap_to_ends(x: FloatArray, half_length: float, width: float) -> FloatArray:
    """Move distances of cells' centres from mid-length onto the roller's ends if within rounding."""
    is_at_end = np.abs(np.abs(x) - half_length) <= ROUNDING * width
    return np.where(is_at_end, np.copysign(half_length, x), x)


@dataclass(frozen=True, kw_only=True)
class Roller:
    """A roller with its axis along x, rigid or elastic.

    Parameters
    ----------
    radius : float
        Radius at mid-length (``Ra``), metres.
    length : float
        Length ``L_c`` from end to end, metres.
    profile : Profile
        Departure of the generatrix from the cylinder.
    material : Material, optional
        Material of the roller; default: rigid.
    ends : {"free", "none"}
        Model of an elastic roller: a body of its length with free ends, or a half-space.
    reference_depth : float, optional
        Distance (m) from the contact to the line in an elastic roller to which approach and tilt refer, such as its
        axis. Default: the roller's length with free ends; else infinite.

    Raises
    ------
    InvalidInputError
        If a value is out of range, or the profile does not fit the length.

    Examples
    --------
    >>> roller = Roller(radius=5e-3, length=10e-3, profile=Cylinder(fillet_radius=0.2e-3))
    >>> roller.clearance(np.array([0.0]), np.array([0.0, 1e-4])).tolist()
    [[0.0, 1e-06]]
    """

    radius: float = field(metadata=checks.number(checks.positive, "metres"))
    length: float = field(metadata=checks.number(checks.positive, "metres"))
    profile: Profile = field(default_factory=Cylinder)
    material: Material | None = None
    ends: str = "free"
    reference_depth: float | None = field(default=None, metadata=checks.number(checks.positive, "metres"))

    def __post_init__(self) -> None:
        """Check the geometry, and evaluate the profile to reveal its errors before a study."""
        checks.store_numbers(self)
        checks.instance("profile", self.profile, Profile, "a profile from contactstudy.profiles")
        checks.instance("material", self.material, Material | None, "a Material, or None for a rigid roller")
        checks.known_name("ends", self.ends, ("free", "none"))
        if self.reference_depth is not None and self.material is None:
            allowed = "None for a rigid roller"
            raise InvalidInputError("reference_depth", self.reference_depth, allowed, "or give a material")
        positions = np.array([0.0, 0.25 * self.length])
        local_radius(self.profile, positions, self.length, self.radius)
        if np.isinf(check_drop(self.profile, positions, self.length)).all():
            raise InvalidInputError("profile", self.profile, "a profile whose drop is finite but at the very ends")

    def __repr__(self) -> str:
        drop = float(self.profile.drop(np.array([0.5 * self.length]), self.length)[0])
        material = "rigid" if self.material is None else f"E = {format_quantity(self.material.young, 'Pa')}"
        if self.material is not None and self.ends == "none":
            material += ", as a half-space"
        sizes = f"R = {format_quantity(self.radius, 'm')}, L = {format_quantity(self.length, 'm')}"
        return f"Roller({sizes}, {describe_profile(self.profile)}, end drop {format_quantity(drop, 'm')}, {material})"

    @staticmethod
    def combined_radius(first: float, second: float) -> float:
        """Radius, metres, of a roller on a flat body with the gap of two curved bodies with parallel axes.

        ``1 / R = 1 / R1 + 1 / R2``, for a contact that is narrow compared with both radii.

        Parameters
        ----------
        first, second : float
            Radii of curvature at the contact, metres: positive if convex (roller, inner raceway, cam, tooth flank),
            negative if hollow (outer raceway).

        Raises
        ------
        InvalidInputError
            If a radius is 0 or not finite, or a hollow radius is not the larger radius: no gap remains.

        Examples
        --------
        >>> [round(1e3 * Roller.combined_radius(6e-3, raceway), 3) for raceway in (30e-3, -42e-3)]
        [5.0, 7.0]
        """
        curvature = 0.0
        for name, value in (("first", first), ("second", second)):
            radius = checks.finite(name, value, "metres")
            if radius == 0:
                raise InvalidInputError(name, radius, "a radius (metres), negative if hollow")
            curvature += 1 / radius
        if not curvature > 0:
            allowed = "such that a hollow radius is the larger one"
            raise InvalidInputError("first, second", (first, second), allowed, "no gap would remain")
        return 1 / curvature

    @property
    def body(self) -> Body | None:
        """Elastic roller as a body in coordinates from its end I; None for a rigid roller."""
        if self.material is None:
            return None
        if self.ends == "free":
            return FiniteLengthSpace(length=self.length, material=self.material, reference_depth=self.reference_depth)
        return HalfSpace(material=self.material, reference_depth=self.reference_depth)

    def clearance(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Height (x, y) of the roller over the tangent plane of its cylinder, metres; infinite beyond its ends.

        The circle is the parabola ``y**2 / (2 radius)``, as in Hertz' theory, with the local radius of a taper.
        `x` and `y` are distances from the roller's mid-length and from its centre line, metres.
        """
        is_under_roller = np.abs(x) <= self.length / 2
        drop = np.full(x.shape, np.inf)
        drop[is_under_roller] = check_drop(self.profile, x[is_under_roller], self.length)
        radius = local_radius(self.profile, x, self.length, self.radius)
        return np.asarray(drop[:, None] + y[None, :] ** 2 / (2 * radius[:, None]))
