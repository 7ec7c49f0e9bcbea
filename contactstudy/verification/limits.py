"""Checks of the limits of a finite-length space: plane strain, plane stress, quarter space and half-space.

A thick body loaded alike along its axis is in plane strain in its middle. A thin one is a plate loaded on its edge, in
plane stress: the same stresses in its plane, none across, for every Poisson's ratio.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contactstudy.bodies.models import FiniteLengthSpace, HalfSpace, QuarterSpace
from contactstudy.contact.solve import solve_contact
from contactstudy.fields.stress import stress_field
from contactstudy.verification import closed_forms
from contactstudy.verification.check import Check, Curve, compare, compare_fields
from contactstudy.verification.load_cases import LINE_LOAD
from contactstudy.verification.problems import (
    cell_means,
    components,
    on_cells,
    strip,
    strip_integral,
    unit_material,
)

POISSON = 0.3
"""Of every body here."""


def plane_checks() -> Iterator[Check]:
    """Stresses in a thick and in a thin body under a line contact's pressure from end to end."""
    y, z = np.linspace(-2, 2, 17), np.array([0.1, 0.2, 0.35, 0.5, 1.0, 2.0, 4.0])
    source = "McEwen (1949); Smith and Liu (1953), "
    for length, cells, poisson, state, shown, tolerance in (
        (1000.0, 100, POISSON, "plane strain, in the middle", "sigma_xx", 3e-3),
        (0.05, 2, 0.0, "plane stress", "sigma_yy", 2e-3),
    ):
        body = FiniteLengthSpace(length=length, material=unit_material(POISSON))
        pressure = cell_means(strip_integral, (0, length), (-1.25, 1.25), (cells, 160))
        x = [0.5 * length] if cells > 2 else [0.0, 0.3 * length, 0.5 * length]
        for friction in (0.0, 0.3):
            stress = stress_field(body, pressure, friction, x=x, y=y, z=z)
            exact = closed_forms.hertz_strip(y[:, None], z, 1.0, 1.0, poisson, friction)
            at = {"x": len(x) - 1, "z": 3}
            yield compare_fields(
                f"strip load on a body of length {length:g}a, f = {friction:g}, z >= 0.1a",
                "six stresses / p0",
                source + state,
                components(stress),
                components(exact)[:, None],
                tolerance,
                curve=Curve("y / a", f"{shown} / p0, z = 0.5a", y, stress[shown].isel(at).values, exact[shown][:, 3]),
            )


def plate_contact_checks() -> Iterator[Check]:
    """Contact of a cylinder with the edge of a thin plate: the line contact with ``E`` instead of ``E*``."""
    length, material = 0.05, unit_material(POISSON)
    gap = on_cells(lambda x, y: y**2 + 0 * x, (0, length), (-2, 2), (2, 129))
    contact = solve_contact(FiniteLengthSpace(length=length, material=material), gap, LINE_LOAD * length)
    pressure = contact["pressure"].mean("x")
    half_width, peak = closed_forms.hertz_line(LINE_LOAD, 0.5, material.young)
    exact = peak * np.sqrt(np.maximum(1 - (gap["y"].values / half_width) ** 2, 0))
    yield compare(
        "rigid cylinder on a body of length 0.05a",
        "peak pressure",
        "Hertz with plane stress modulus E; Johnson (1985) 4.45",
        float(pressure.max()),
        peak,
        1e-3,
        relative=True,
        curve=Curve("y / a", "p / p0", gap["y"].values, pressure.values, exact),
    )


def body_checks() -> Iterator[Check]:
    """Bodies with ends that are far away."""
    points = {"y": [0.0, 0.5], "z": [0.1, 0.3, 1.0]}
    bump = on_cells(lambda x, y: np.maximum(1 - (x - 20) ** 2 - y**2, 0), (0, 40), (-1.5, 1.5), (320, 24))
    x = [19.0, 20.0, 20.5]
    finite = stress_field(FiniteLengthSpace(length=40.0, material=unit_material()), bump, 0.2, x, *points.values())
    half = stress_field(HalfSpace(material=unit_material()), bump, 0.2, x, *points.values())
    yield compare_fields(
        "body of length 40a loaded over 2a in its middle, f = 0.2",
        "six stresses / p0",
        "half-space under the same load",
        components(finite),
        components(half),
        1e-3,
    )
    at_x = [0.0, 0.1, 1.0, 2.5]
    for length, tolerance in ((20.0, 5e-3), (40.0, 1.25e-3)):
        fields = []
        for span, body in (
            (length, FiniteLengthSpace(length=length, material=unit_material())),
            (10.0, QuarterSpace(material=unit_material())),
        ):
            load = on_cells(lambda x, y: strip(x, y) * (x < 2), (0, span), (-2, 2), (round(8 * span), 48))
            stress = stress_field(body, load, 0.2, at_x, *points.values())
            fields.append(components(stress))
        finite_fields, quarter_fields = fields
        yield compare_fields(
            f"body of length {length:g}a loaded over 2a at one end, f = 0.2",
            "six stresses / p0",
            "quarter space under the same load",
            finite_fields,
            quarter_fields,
            tolerance,
        )


def checks() -> Iterator[Check]:
    """Every check of the limits."""
    for family in (plane_checks, plate_contact_checks, body_checks):
        yield from family()
