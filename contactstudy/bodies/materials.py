"""Elastic constants of materials of rolling contacts, with their sources in `SOURCES`.

Moduli of steels differ by one or two percent between sources, and pressures by half of this difference. Prefer
the test certificate of the steel at hand.
"""

from __future__ import annotations

from contactstudy.bodies.material import Material

__all__ = ["BEARING_STEEL", "DUCTILE_IRON", "GEAR_STEEL", "SOURCES", "STRUCTURAL_STEEL"]

BEARING_STEEL = Material(young=207e9, poisson=0.3)
"""Hardened bearing steel such as 100Cr6 (AISI 52100): 207 GPa, 0.3."""

GEAR_STEEL = Material(young=206e9, poisson=0.3)
"""Steel of gears: 206 GPa, 0.3."""

DUCTILE_IRON = Material(young=173e9, poisson=0.3)
"""Cast iron with nodular graphite: 173 GPa, 0.3."""

STRUCTURAL_STEEL = Material(young=210e9, poisson=0.3)
"""Structural steel: 210 GPa, 0.3."""

SOURCES = {
    "BEARING_STEEL": "hardened bearing steel such as 100Cr6 (AISI 52100). The values behind the constants for steel of "
    "T. A. Harris, M. N. Kotzalas, Essential Concepts of Bearing Technology, 5th edition (2006), chapter 6: 0.0236 for "
    "the semi-axes of a point contact, 3.35e-3 for the half-width of a line contact",
    "DUCTILE_IRON": "cast iron with nodular graphite. ISO 6336-2, elasticity factor with steel, 181.4 (N/mm2)**0.5",
    "GEAR_STEEL": "steel of gears. ISO 6336-2, elasticity factor of steel on steel, 189.8 (N/mm2)**0.5",
    "STRUCTURAL_STEEL": "structural steel. EN 1993-1-1, 3.2.6",
}
"""Description and source of each material."""
