"""Checks against numbers that were published, with what is known about those that disagree.

* Johnson, *Contact Mechanics* (1985): the shear stresses below point and line contacts that every designer uses.
* Michell, *Proc. London Math. Soc.* 32 (1900) 35; Timoshenko and Goodier, *Theory of Elasticity*, force at the vertex
  of a wedge: the exact solution of a quarter plane loaded at its corner. A quarter space under a long line load on its
  edge must agree with it.
* Guilbault, *J. Tribology* 133 (2011) 031402, quoted second-hand: errors of the largest edge displacement of a mirrored
  load against his finite elements, -21.90 % for Poisson's ratio 0.3 and -11.30 % for 0.15. They depend on the load's
  proportions, which are not known here: the exact solution gives -21 % to -31 % for 0.3. A narrow load that fits both
  numbers was chosen, so the check says only that one load explains both, within a percentage point. With his factor he
  states -9.55 % and +0.60 %; the formula of the factor as it is known here, which cannot be compared with the paper,
  gives -7.5 % and -0.2 %, and the published errors themselves ask for factors of 1.32 and 1.27 where the formula has
  1.39 and 1.28. That part is therefore not checked. No single factor can be right: at the edge itself the exact ratio
  is 3.363 along the edge and between 2 and 3.363 along the normal, where a mirrored load has 2.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contactstudy.arrays.invariants import maximum_shear
from contactstudy.bodies.models import HalfSpace, QuarterSpace
from contactstudy.checks import FloatArray
from contactstudy.fields.stress import stress_field
from contactstudy.fields.surface import surface_displacement
from contactstudy.verification.check import Check, Curve, compare, compare_fields
from contactstudy.verification.problems import (
    cell_means,
    components,
    on_cells,
    strip_integral,
    unit_material,
)

POISSON = 0.3
"""Of every body here, unless a check states another."""

MIRROR_ERRORS = {0.3: -0.2190, 0.15: -0.1130}
"""Guilbault's errors of the largest edge displacement under a mirrored load, by Poisson's ratio."""


def johnson_checks() -> Iterator[Check]:
    """Largest shear below point and line contacts, and the largest tension around a point contact."""
    body = HalfSpace(material=unit_material(POISSON))
    circle = on_cells(lambda x, y: np.sqrt(np.maximum(1 - x**2 - y**2, 0)), (-1.25, 1.25), (-1.25, 1.25), (120, 120))
    long_strip = cell_means(strip_integral, (0, 400), (-1.25, 1.25), (80, 160))
    z = np.linspace(0.3, 1.0, 141)
    for case, pressure, x, largest, depth in (
        ("circular Hertz pressure", circle, 0.0, 0.310, 0.48),
        ("line contact's pressure", long_strip, 200.0, 0.300, 0.78),
    ):
        shear = maximum_shear(stress_field(body, pressure, x=[x], y=[0.0], z=z)).values.ravel()
        source = f"Johnson (1985) 4.2, 3.4: {largest:.3f} p0 at {depth:g}a"
        yield compare(case, "largest shear on the axis / p0", source, float(shear.max()), largest, 1e-3)
        yield compare(case, "its depth / a", source, float(z[shear.argmax()]), depth, 0.015)
    around = np.linspace(1.0, 1.3, 31)
    radial = stress_field(body, circle, x=around, y=[0.0], z=[0.0])["sigma_xx"].max()
    tension = (1 - 2 * POISSON) / 3
    source = "Johnson (1985) 3.43: (1 - 2 nu) p0 / 3 at the edge"
    yield compare("circular Hertz pressure", "largest radial tension / p0", source, float(radial), tension, 5e-3)


def wedge_stress(angle: FloatArray) -> FloatArray:
    """Radial stress ``sigma_r r / P`` in a quarter plane under a force P at its corner, at angles from the loaded face.

    Examples
    --------
    >>> round(float(wedge_stress(np.array(0.5 * np.pi))), 3)
    -2.141
    """
    return np.asarray((8 * np.cos(angle) - 4 * np.pi * np.sin(angle)) / (np.pi**2 - 4))


def wedge_checks() -> Iterator[Check]:
    """Line load on the edge of a quarter space."""
    poisson, cell, width = 0.3, 0.01, 60.0
    body = QuarterSpace(material=unit_material(poisson))
    pressure = on_cells(lambda x, y: (x < cell) / cell + 0 * y, (0, 4 * cell), (-width, width), (4, 12))
    x, z = np.array([0.0, 0.5, 1.0, 2.0]), np.array([1.0, 1.5, 2.0])
    stress = stress_field(body, pressure, x=x, y=[0.0], z=z).isel(y=0)
    distance, angle = np.hypot(x[:, None], z), np.arctan2(z, x[:, None])
    radial = wedge_stress(angle) / distance
    zero = np.zeros_like(radial)
    exact = {
        "sigma_xx": radial * np.cos(angle) ** 2,
        "sigma_yy": poisson * radial,
        "sigma_zz": radial * np.sin(angle) ** 2,
        "tau_xy": zero,
        "tau_xz": radial * np.cos(angle) * np.sin(angle),
        "tau_yz": zero,
    }
    yield compare_fields(
        "line load P on the edge of a quarter space, a and more away",
        "six stresses a / P",
        "Michell (1900); Timoshenko and Goodier, wedge",
        components(stress),
        components(exact),
        0.02,
        curve=Curve("z / a", "sigma_zz a / P, x = 0", z, stress["sigma_zz"].values[0], exact["sigma_zz"][0]),
    )


def mirror_checks() -> Iterator[Check]:
    """Errors of a mirrored load, the quick fix whose errors were published."""
    half_width = 0.03  # of the load, over its length along the normal to the edge
    for poisson, expected in MIRROR_ERRORS.items():
        material = unit_material(poisson)
        load = on_cells(
            lambda x, y: np.sqrt(np.maximum(1 - (y / half_width) ** 2, 0)) * (x < 1),
            (0, 1.125),
            (-1.25 * half_width, 1.25 * half_width),
            (288, 33),
        )
        exact, mirror = (
            float(surface_displacement(QuarterSpace(material=material, model=model), load)[0].max())
            for model in ("exact", "mirror")
        )
        yield compare(
            f"narrow load up to the edge, half-width 0.03 of its length, nu = {poisson:g}",
            "error of the largest edge displacement of a mirrored load",
            "Guilbault (2011), second-hand: against finite elements",
            mirror / exact - 1,
            expected,
            0.01,
        )


def checks() -> Iterator[Check]:
    """Every check of a published number."""
    for family in (johnson_checks, wedge_checks, mirror_checks):
        yield from family()
