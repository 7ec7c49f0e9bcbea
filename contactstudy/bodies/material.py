"""Isotropic linear-elastic material."""

from __future__ import annotations

from dataclasses import dataclass, field

from contactstudy import checks
from contactstudy.arrays.engineering import format_quantity
from contactstudy.errors import InvalidInputError


@dataclass(frozen=True)
class Material:
    """Isotropic linear-elastic material.

    Parameters
    ----------
    young : float
        Young's modulus, Pa.
    poisson : float
        Poisson's ratio, in (-1, 0.5].

    Raises
    ------
    InvalidInputError
        If a value is outside its range.

    See Also
    --------
    contactstudy.materials : Some materials, each with its source.

    Examples
    --------
    >>> steel = Material(young=210e9, poisson=0.3)
    >>> round(steel.shear_modulus / 1e9, 2), round(steel.plane_strain_modulus / 1e9, 2)
    (80.77, 230.77)
    """

    young: float = field(metadata=checks.number(checks.positive, "Pa"))
    poisson: float = field(metadata=checks.number(checks.finite))

    def __post_init__(self) -> None:
        checks.store_numbers(self)
        if not -1 < self.poisson <= 0.5:
            raise InvalidInputError("poisson", self.poisson, "in (-1, 0.5]")

    def __repr__(self) -> str:
        return f"Material(E = {format_quantity(self.young, 'Pa')}, nu = {self.poisson:g})"

    @property
    def shear_modulus(self) -> float:
        """Shear modulus ``G = E / (2 (1 + nu))``, Pa."""
        return self.young / (2 * (1 + self.poisson))

    @property
    def plane_strain_modulus(self) -> float:
        """Plane-strain modulus ``E* = E / (1 - nu**2)``, Pa: the contact modulus against a rigid roller."""
        return self.young / (1 - self.poisson**2)


def contact_modulus(material: Material, counter_material: Material | None = None) -> float:
    """Contact modulus ``1 / E* = (1 - nu1**2) / E1 + (1 - nu2**2) / E2``, Pa; a counterbody of None is rigid."""
    modulus = material.plane_strain_modulus
    return modulus if counter_material is None else 1 / (1 / modulus + 1 / counter_material.plane_strain_modulus)


def dundurs_parameter(material: Material, counter_material: Material | None = None) -> float:
    """Return Dundurs' ``beta`` of a body and its counterbody, which is rigid if None."""
    materials = (material, counter_material)
    compliances = [(1 + entry.poisson) * (1 - 2 * entry.poisson) / entry.young for entry in materials if entry]
    return 0.5 * (compliances[0] - sum(compliances[1:])) * contact_modulus(material, counter_material)
