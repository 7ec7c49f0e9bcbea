"""The roller that is pressed into the body."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from contactstudy import checks
from contactstudy.arrays.engineering import quantity
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import Body, FiniteLengthSpace, HalfSpace
from contactstudy.case.words import roller_as_html
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles import Cylinder, Profile, local_radius
from contactstudy.profiles.base import checked_drop, in_words


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
        How the generatrix departs from the cylinder.
    material : Material, optional
        What the roller is made of; default: it is rigid.
    ends : str
        How an elastic roller's ends are treated: "free", as a body of its own length, or "none", as a half-space.

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

    radius: float
    length: float
    profile: Profile = field(default_factory=Cylinder)
    material: Material | None = None
    ends: str = "free"

    def __post_init__(self) -> None:
        """Check the geometry; a profile is tried once, so that it fails here and not in mid-study."""
        checks.store(self, radius=checks.positive("radius", self.radius, "metres"))
        checks.store(self, length=checks.positive("length", self.length, "metres"))
        checks.instance("profile", self.profile, Profile, "a profile from contactstudy.profiles")
        if self.material is not None:
            checks.instance("material", self.material, Material, "a Material, or None for a rigid roller")
        checks.instance("ends", self.ends, str, "a name")
        checks.known_name("ends", self.ends, ("free", "none"))
        tried = np.array([0.0, 0.25 * self.length])
        local_radius(self.profile, tried, self.length, self.radius)
        if np.isinf(checked_drop(self.profile, tried, self.length)).all():
            raise InvalidInputError("profile", self.profile, "a profile whose drop is finite but at the very ends")

    def __repr__(self) -> str:
        drop = float(self.profile.drop(np.array([0.5 * self.length]), self.length)[0])
        made = "rigid" if self.material is None else f"E = {quantity(self.material.young, 'Pa')}"
        if self.material is not None and self.ends == "none":
            made += ", as a half-space"
        sizes = f"R = {quantity(self.radius, 'm')}, L = {quantity(self.length, 'm')}"
        return f"Roller({sizes}, {in_words(self.profile)}, end drop {quantity(drop, 'm')}, {made})"

    def _repr_html_(self) -> str:
        return roller_as_html(self)

    @staticmethod
    def combined_radius(first: float, second: float) -> float:
        """Radius that a roller on a flat body has when it stands for two curved bodies with parallel axes.

        The gap between them is that of a roller with ``1 / R = 1 / R1 + 1 / R2`` on a plane, as far as the contact is
        narrow against both radii.

        Parameters
        ----------
        first, second : float
            Radii of curvature where they touch, metres: positive if convex, as of a roller, an inner raceway, a cam or
            a tooth's flank; negative if hollow, as of an outer raceway.

        Returns
        -------
        float
            Radius, metres.

        Raises
        ------
        InvalidInputError
            If a radius is 0 or not finite, or a hollow one is not the larger: the bodies would fit without a gap.

        Examples
        --------
        >>> [round(1e3 * Roller.combined_radius(6e-3, raceway), 3) for raceway in (30e-3, -42e-3)]
        [5.0, 7.0]
        """
        sizes = {"first": checks.finite("first", first, "metres"), "second": checks.finite("second", second, "metres")}
        for name, radius in sizes.items():
            if radius == 0:
                raise InvalidInputError(name, radius, "a radius (metres), negative if hollow")
        curvature = sum(1 / radius for radius in sizes.values())
        if not curvature > 0:
            raise InvalidInputError(
                "first, second", (first, second), "such that a hollow radius is the larger one", "no gap would be left"
            )
        return 1 / curvature

    @property
    def body(self) -> Body | None:
        """The roller as an elastic body seen from its own end I; None if it is rigid."""
        if self.material is None:
            return None
        if self.ends == "free":
            return FiniteLengthSpace(length=self.length, material=self.material)
        return HalfSpace(material=self.material)

    def clearance(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Height of the roller over the plane that its cylinder touches.

        The circle is taken as the parabola ``y**2 / (2 radius)``, as in Hertz' theory, with the local radius of a
        tapered roller.

        Parameters
        ----------
        x, y : array
            Distances from the roller's mid-length and from its centre line, metres.

        Returns
        -------
        array of shape (x.size, y.size)
            Metres; infinite beyond the roller's ends, where it cannot touch.
        """
        inside = np.abs(x) <= self.length / 2
        drop = np.full(x.shape, np.inf)
        drop[inside] = checked_drop(self.profile, x[inside], self.length)
        radius = local_radius(self.profile, x, self.length, self.radius)
        return np.asarray(drop[:, None] + y[None, :] ** 2 / (2 * radius[:, None]))
