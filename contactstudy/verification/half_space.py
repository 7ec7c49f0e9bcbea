"""Checks of the half-space against closed forms: Hertz contacts, and stresses under prescribed loads."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.models import HalfSpace
from contactstudy.contact.solve import solve_contact
from contactstudy.fields.stress import stress_field
from contactstudy.fields.surface import surface_displacement
from contactstudy.verification import closed_forms
from contactstudy.verification.check import Check, Curve, compare, compare_fields
from contactstudy.verification.load_cases import LINE_LOAD
from contactstudy.verification.problems import (
    cell_means,
    components,
    on_cells,
    point_pressure,
    strip_integral,
    unit_material,
)

POISSON = 0.3
"""Of every body here, unless a check states another."""


def _body() -> HalfSpace:
    """Half-space of the unit material."""
    return HalfSpace(material=unit_material(POISSON))


def contact_checks() -> Iterator[Check]:
    """Hertz point, elliptic and line contact."""
    body = _body()
    gap = on_cells(lambda x, y: 0.5 * (x**2 + y**2), (-1.5, 1.5), (-1.5, 1.5), (129, 129))
    contact = solve_contact(body, gap, 4 / 3)
    _, peak, approach = closed_forms.hertz_point(4 / 3, 1.0, 1.0)
    case, source = "Hertz point contact, 129 x 129 cells", "Hertz; Johnson (1985) 4.22 to 4.24"
    middle = contact["pressure"].sel(y=0, method="nearest")
    exact = peak * np.sqrt(np.maximum(1 - middle["x"].values ** 2, 0))
    curve = Curve("x / a", "p / p0", middle["x"].values, middle.values / peak, exact / peak)
    found = float(contact["pressure"].max())
    yield compare(case, "peak pressure", source, found, peak, 2e-4, relative=True, curve=curve)
    yield compare(case, "approach", source, float(contact["approach"]), approach, 1e-4, relative=True)

    long_radius, short_radius = 4.0, 1.0
    ellipse = closed_forms.hertz_ellipse(4 / 3, long_radius, short_radius, 1.0)
    window = (1.25 * ellipse.long, 1.25 * ellipse.short)
    gap = on_cells(
        lambda x, y: x**2 / (2 * long_radius) + y**2 / (2 * short_radius),
        (-window[0], window[0]),
        (-window[1], window[1]),
        (129, 129),
    )
    contact = solve_contact(body, gap, 4 / 3)
    case = f"Hertz elliptic contact, radii 4 to 1, axes {ellipse.long / ellipse.short:.2f} to 1"
    source = "Hertz; Johnson (1985) 4.26 to 4.32"
    found = float(contact["pressure"].max())
    yield compare(case, "peak pressure", source, found, ellipse.max_pressure, 2e-4, relative=True)
    yield compare(case, "approach", source, float(contact["approach"]), ellipse.approach, 1e-4, relative=True)
    touched = contact["pressure"].max("y") > 0
    half_length = 0.5 * float(touched.sum()) * float(gap["x"].diff("x")[0])
    yield compare(case, "long semi-axis over its value", source, half_length / ellipse.long, 1.0, 0.015)

    gap = on_cells(lambda x, y: y**2 + 0 * x, (0, 60), (-2, 2), (240, 129))
    contact = solve_contact(body, gap.where(abs(gap["x"] - 30) < 28, np.inf), 56 * LINE_LOAD)
    middle = contact["pressure"].sel(x=30, method="nearest")
    load = float(middle.sum()) * 4 / 129
    half_width, peak = closed_forms.hertz_line(load, 0.5, 1.0)
    exact = peak * np.sqrt(np.maximum(1 - (middle["y"].values / half_width) ** 2, 0))
    curve = Curve("y / a", "p / p0", middle["y"].values, middle.values, exact)
    yield compare(
        "Hertz line contact, middle of a roller of length 56a",
        "peak pressure under the load per length there",
        "Hertz; Johnson (1985) 4.45",
        float(middle.max()),
        peak,
        2e-4,
        relative=True,
        curve=curve,
    )


def circle_checks() -> Iterator[Check]:
    """Stresses under a circular Hertz pressure, at rest and sliding."""
    body = _body()
    circle = on_cells(lambda x, y: np.sqrt(np.maximum(1 - x**2 - y**2, 0)), (-1.25, 1.25), (-1.25, 1.25), (120, 120))
    z = np.linspace(0, 3, 31)
    stress = stress_field(body, circle, x=[0.0], y=[0.0], z=z).isel(x=0, y=0)
    axial, radial = closed_forms.hertz_circle_axis(z, 1.0, 1.0, POISSON)
    yield compare_fields(
        "circular Hertz pressure, on the axis",
        "sigma_zz, sigma_xx / p0",
        "Johnson (1985) 3.45",
        [stress["sigma_zz"], stress["sigma_xx"]],
        [axial, radial],
        2e-4,
        curve=Curve("z / a", "sigma_xx / p0", z, stress["sigma_xx"].values, radial),
    )
    x, y, z = np.array([0.0, 0.5, 1.2]), np.linspace(-1.5, 1.5, 13), np.array([0.1, 0.25, 0.5, 1.0, 2.0])
    stress = stress_field(body, circle, 0.25, x=x, y=y, z=z)
    at_x, at_y, at_z = np.meshgrid(x, y, z, indexing="ij")
    exact = closed_forms.hertz_circle(at_x, at_y, at_z, 1.0, 1.0, POISSON, 0.25)
    yield compare_fields(
        "circular Hertz pressure, sliding, f = 0.25, z >= 0.1a",
        "six stresses / p0",
        "Hamilton (1983); Hamilton and Goodman (1966)",
        components(stress),
        components(exact),
        3e-3,
        curve=Curve(
            "y / a", "tau_yz / p0, x = 0, z = 0.25a", y, stress["tau_yz"].values[0, :, 1], exact["tau_yz"][0, :, 1]
        ),
    )


def line_checks() -> Iterator[Check]:
    """Stresses in the middle of a long strip under a line contact's pressure, on the top and below."""
    length, cells_y, half_window = 2000.0, 160, 1.25
    pressure = cell_means(strip_integral, (0, length), (-half_window, half_window), (80, cells_y))
    cell = 2 * half_window / cells_y
    # Edges and middles of cells and points between them, but for the last cell in contact and its very border.
    edges = -1.25 + cell * np.arange(1, cells_y)
    on_top = np.unique(np.round(np.concatenate([edges, edges + 0.5 * cell, edges + 0.37 * cell]), 9))
    beside = np.abs(on_top) - 1
    on_top = on_top[(beside < -cell + 1e-9) | (beside > 0.1 * cell)]
    anywhere = np.linspace(-2, 2, 33)
    deeper = np.array([0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.5, 2.5, 4.0])
    source = "McEwen (1949); Smith and Liu (1953)"
    for friction in (0.0, 0.3):
        for where, y, z, tolerance in (
            ("z = 0, beside the contact's last cell", on_top, np.zeros(1), 5e-3),
            ("z = 0.02a and 0.05a", on_top, np.array([0.02, 0.05]), 2e-3),
            ("z >= 0.1a", anywhere, deeper, 1e-3),
        ):
            stress = stress_field(_body(), pressure, friction, x=[0.5 * length], y=y, z=z).isel(x=0)
            exact = closed_forms.hertz_strip(y[:, None], z, 1.0, 1.0, POISSON, friction)
            depth = min(2, z.size - 1)
            curve = Curve(
                "y / a",
                f"sigma_yy / p0, z = {z[depth]:g}a",
                y,
                stress["sigma_yy"].values[:, depth],
                exact["sigma_yy"][:, depth],
            )
            yield compare_fields(
                f"line contact's pressure on a strip of length 2000a, f = {friction:g}, {where}",
                "six stresses / p0",
                source,
                components(stress),
                components(exact),
                tolerance,
                curve=curve,
            )


def rectangle_checks() -> Iterator[Check]:
    """Uniform pressure on a rectangle."""
    body, half_x, half_y = _body(), 1.0, 0.5
    pressure = on_cells(lambda x, y: np.ones_like(x + y), (-half_x, half_x), (-half_y, half_y), (12, 8))
    z = np.array([0.2, 0.5, 1.0, 2.0, 5.0])
    stress = stress_field(body, pressure, x=[half_x], y=[half_y], z=z).isel(x=0, y=0)
    yield compare_fields(
        "uniform pressure on a rectangle 2 x 1, below its corner",
        "sigma_zz / p",
        "Love (1929); Newmark (1935)",
        stress["sigma_zz"],
        closed_forms.below_rectangle_corner(z, 2 * half_x, 2 * half_y),
        1e-9,
    )
    x, y = np.array([-0.4, 0.3, 1.5]), np.array([-0.9, 0.1, 0.4])
    stress = stress_field(body, pressure, 0.3, x=x, y=y, z=z)
    at_x, at_y, at_z = np.meshgrid(x, y, z, indexing="ij")
    exact = closed_forms.rectangle(at_x, at_y, at_z, half_x, half_y, POISSON, 0.3)
    yield compare_fields(
        "uniform pressure and traction (f = 0.3) on a rectangle 2 x 1",
        "six stresses / p",
        "Boussinesq and Cerruti, integrated by Gauss quadrature",
        components(stress),
        components(exact),
        1e-8,
    )
    sunk = surface_displacement(body, pressure)
    exact_sunk = closed_forms.rectangle_displacement(
        sunk["x"].values[:, None], sunk["y"].values[None, :], half_x, half_y, 1.0
    )
    yield compare_fields(
        "uniform pressure on a rectangle 2 x 1", "E* u_z / (p a)", "Love (1929); Johnson 3.25", sunk, exact_sunk, 1e-9
    )


def point_checks() -> Iterator[Check]:
    """Stresses of a small loaded cell, seen from far away."""
    grid = Grid((-0.06, 0.06), (-0.06, 0.06), 3, 3)
    at = {"x": np.array([-3.0, 0.4, 2.0]), "y": np.array([-1.0, 0.0, 2.5]), "z": np.array([0.8, 2.0, 4.0])}
    x, y, z = np.meshgrid(*at.values(), indexing="ij")
    pressure = point_pressure(grid, 1, 1)
    for friction, source in (
        (0.0, "Boussinesq (1885); Johnson 3.2"),
        (1.0, "Boussinesq and Cerruti; Johnson 3.2, 3.6"),
    ):
        stress = stress_field(_body(), pressure, friction, *at.values())
        exact = closed_forms.point_load(x, y, z, POISSON, 1.0, friction)
        scale = max(float(np.abs(value).max()) for value in exact.values())
        yield compare_fields(
            "load on one cell of 0.04a, 0.9a and more away" + (", f = 1" if friction else ""),
            "six stresses over the largest",
            source,
            components(stress) / scale,
            components(exact) / scale,
            1e-3,
        )


def checks() -> Iterator[Check]:
    """Every check of the half-space."""
    for family in (contact_checks, circle_checks, line_checks, rectangle_checks, point_checks):
        yield from family()
