"""Checks against closed forms of a half-space, limits of a finite-length space, equilibrium and reciprocity."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import STRESSES
from contactstudy.bodies.models import FiniteLengthSpace, HalfSpace, QuarterSpace
from contactstudy.checks import FloatArray
from contactstudy.contact.solve import solve_contact
from contactstudy.fields.loads import sliding
from contactstudy.fields.stress import end_traction_residual, stress_field
from contactstudy.fields.surface import surface_displacement
from contactstudy.kernels.load import Load
from contactstudy.overlapping.equations import EquationSet, axial_modes
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.verification import closed_forms
from contactstudy.verification.problems import (
    LINE_LOAD,
    Check,
    Curve,
    Reference,
    components,
    on_cells,
    point_pressure,
    quartic,
    strip,
    strip_means,
    unit_material,
)

POISSON = 0.3  # Poisson's ratio of every body here, unless a check states another value


def _half_space() -> HalfSpace:
    """Half-space of the unit material."""
    return HalfSpace(material=unit_material(POISSON))


def _finite_body(length: float) -> FiniteLengthSpace:
    """Body of the unit material with two free ends."""
    return FiniteLengthSpace(length=length, material=unit_material(POISSON))


def hertz_checks() -> Iterator[Check]:
    """Hertz point, elliptic and line contact."""
    gap = on_cells(lambda x, y: 0.5 * (x**2 + y**2), (-1.5, 1.5), (-1.5, 1.5), (129, 129))
    contact = solve_contact(_half_space(), gap, load=4 / 3)
    _, peak, approach = closed_forms.hertz_point(4 / 3, 1.0, 1.0)
    reference = Reference("Hertz point contact, 129 x 129 cells", "Hertz; Johnson (1985) 4.22 to 4.24")
    line = contact["pressure"].sel(y=0, method="nearest")
    exact = peak * np.sqrt(np.maximum(1 - line["x"].values ** 2, 0))
    curve = Curve(("x / a", "p / p0"), line["x"].values, line.values / peak, exact / peak)
    yield reference.compare("peak pressure", contact["pressure"].max(), peak, 2e-4, relative=True, curve=curve)
    yield reference.compare("approach", contact["approach"], approach, 1e-4, relative=True)

    long_radius, short_radius = 4.0, 1.0
    ellipse = closed_forms.hertz_ellipse(4 / 3, long_radius, short_radius, 1.0)
    x_range, y_range = ((-1.25 * axis, 1.25 * axis) for axis in (ellipse.long, ellipse.short))
    gap = on_cells(lambda x, y: x**2 / (2 * long_radius) + y**2 / (2 * short_radius), x_range, y_range, (129, 129))
    contact = solve_contact(_half_space(), gap, load=4 / 3)
    case = f"Hertz elliptic contact, radii 4 to 1, axes {ellipse.long / ellipse.short:.2f} to 1"
    reference = Reference(case, "Hertz; Johnson (1985) 4.26 to 4.32")
    yield reference.compare("peak pressure", contact["pressure"].max(), ellipse.max_pressure, 2e-4, relative=True)
    yield reference.compare("approach", contact["approach"], ellipse.approach, 1e-4, relative=True)
    in_contact = contact["pressure"].max("y") > 0
    half_length = 0.5 * float(in_contact.sum()) * float(gap["x"].diff("x")[0])
    yield reference.compare("long semi-axis over its value", half_length / ellipse.long, 1.0, 0.015)

    gap = on_cells(lambda x, y: y**2 + 0 * x, (0, 60), (-2, 2), (240, 129))
    contact = solve_contact(_half_space(), gap.where(abs(gap["x"] - 30) < 28, np.inf), load=56 * LINE_LOAD)
    line = contact["pressure"].sel(x=30, method="nearest")
    load = float(line.sum()) * 4 / 129
    half_width, peak = closed_forms.hertz_line(load, 0.5, 1.0)
    exact = peak * np.sqrt(np.maximum(1 - (line["y"].values / half_width) ** 2, 0))
    curve = Curve(("y / a", "p / p0"), line["y"].values, line.values, exact)
    reference = Reference("Hertz line contact, middle of a roller of length 56a", "Hertz; Johnson (1985) 4.45")
    quantity = "peak pressure under the load per length there"
    yield reference.compare(quantity, line.max(), peak, 2e-4, relative=True, curve=curve)


def circle_checks() -> Iterator[Check]:
    """Stresses under a circular Hertz pressure, at rest and sliding."""
    circle = on_cells(lambda x, y: np.sqrt(np.maximum(1 - x**2 - y**2, 0)), (-1.25, 1.25), (-1.25, 1.25), (120, 120))
    z = np.linspace(0, 3, 31)
    stress = stress_field(_half_space(), circle, x=[0.0], y=[0.0], z=z, inside_cells=circle).isel(x=0, y=0)
    axial, radial = closed_forms.hertz_circle_axis(z, 1.0, 1.0, POISSON)
    curve = Curve(("z / a", "sigma_xx / p0"), z, stress["sigma_xx"].values, radial)
    computed = [stress["sigma_zz"], stress["sigma_xx"]]
    reference = Reference("circular Hertz pressure, on the axis", "Johnson (1985) 3.45")
    yield reference.compare("sigma_zz, sigma_xx / p0", computed, [axial, radial], 2e-4, curve=curve)
    x, y, z = np.array([0.0, 0.5, 1.2]), np.linspace(-1.5, 1.5, 13), np.array([0.1, 0.25, 0.5, 1.0, 2.0])
    stress = stress_field(_half_space(), circle, friction=0.25, x=x, y=y, z=z, inside_cells=circle)
    at_x, at_y, at_z = np.meshgrid(x, y, z, indexing="ij")
    exact = closed_forms.hertz_circle(at_x, at_y, at_z, 1.0, 1.0, poisson=POISSON, friction=0.25)
    profiles = stress["tau_yz"].values[0, :, 1], exact["tau_yz"][0, :, 1]
    curve = Curve(("y / a", "tau_yz / p0, x = 0, z = 0.25a"), y, *profiles)
    source = "Hamilton (1983); Hamilton and Goodman (1966)"
    reference = Reference("circular Hertz pressure, sliding, f = 0.25, z >= 0.1a", source)
    yield reference.compare("six stresses / p0", components(stress), components(exact), 3e-3, curve=curve)


def line_checks() -> Iterator[Check]:
    """Stresses in the middle of a long strip under a line contact's pressure, on the top and below."""
    body, length, cells_y, half_window = _half_space(), 2000.0, 160, 1.25
    pressure = strip_means((0, length), (-half_window, half_window), (80, cells_y))
    cell = 2 * half_window / cells_y
    # Points at edges and middles of cells and in between, except in the last cell in contact and at its border.
    edges = -1.25 + cell * np.arange(1, cells_y)
    surface_y = np.unique(np.round(np.concatenate([edges, edges + 0.5 * cell, edges + 0.37 * cell]), 9))
    distance = np.abs(surface_y) - 1
    surface_y = surface_y[(distance < -cell + 1e-9) | (distance > 0.1 * cell)]
    subsurface_y = np.linspace(-2, 2, 33)
    depths = np.array([0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.5, 2.5, 4.0])
    source = "McEwen (1949); Smith and Liu (1953)"
    for friction in (0.0, 0.3):
        for label, y, z, tolerance in (
            ("z = 0, beside the contact's last cell", surface_y, np.zeros(1), 5e-3),
            ("z = 0.02a and 0.05a", surface_y, np.array([0.02, 0.05]), 2e-3),
            ("z >= 0.1a", subsurface_y, depths, 1e-3),
        ):
            stress = stress_field(
                body, pressure, friction=friction, x=[0.5 * length], y=y, z=z, inside_cells=pressure
            ).isel(x=0)
            exact = closed_forms.hertz_strip(y[:, None], z, 1.0, 1.0, POISSON, friction=friction)
            depth = min(2, z.size - 1)
            labels = "y / a", f"sigma_yy / p0, z = {z[depth]:g}a"
            curve = Curve(labels, y, stress["sigma_yy"].values[:, depth], exact["sigma_yy"][:, depth])
            reference = Reference(
                f"line contact's pressure on a strip of length 2000a, f = {friction:g}, {label}", source
            )
            computed, expected = components(stress), components(exact)
            yield reference.compare("six stresses / p0", computed, expected, tolerance, curve=curve)


def rectangle_checks() -> Iterator[Check]:
    """Uniform pressure on a rectangle."""
    body, half_x, half_y = _half_space(), 1.0, 0.5
    pressure = on_cells(lambda x, y: np.ones_like(x + y), (-half_x, half_x), (-half_y, half_y), (12, 8))
    z = np.array([0.2, 0.5, 1.0, 2.0, 5.0])
    stress = stress_field(body, pressure, x=[half_x], y=[half_y], z=z).isel(x=0, y=0)
    reference = Reference("uniform pressure on a rectangle 2 x 1, below its corner", "Love (1929); Newmark (1935)")
    expected = closed_forms.below_rectangle_corner(z, 2 * half_x, 2 * half_y)
    yield reference.compare("sigma_zz / p", stress["sigma_zz"], expected, 1e-9)
    x, y = np.array([-0.4, 0.3, 1.5]), np.array([-0.9, 0.1, 0.4])
    stress = stress_field(body, pressure, friction=0.3, x=x, y=y, z=z)
    at_x, at_y, at_z = np.meshgrid(x, y, z, indexing="ij")
    exact = closed_forms.rectangle(at_x, at_y, at_z, half_x, half_y, poisson=POISSON, friction=0.3)
    yield Reference(
        "uniform pressure and traction (f = 0.3) on a rectangle 2 x 1",
        "Boussinesq and Cerruti, integrated by Gauss quadrature",
    ).compare("six stresses / p", components(stress), components(exact), 1e-8)
    displacement = surface_displacement(body, pressure)
    centres = displacement["x"].values[:, None], displacement["y"].values
    exact_displacement = closed_forms.rectangle_displacement(*centres, half_x, half_y, 1.0)
    reference = Reference("uniform pressure on a rectangle 2 x 1", "Love (1929); Johnson 3.25")
    yield reference.compare("E* u_z / (p a)", displacement, exact_displacement, 1e-9)


def point_checks() -> Iterator[Check]:
    """Stresses far from a small loaded cell."""
    grid = Grid(x_range=(-0.06, 0.06), y_range=(-0.06, 0.06), cells_x=3, cells_y=3)
    positions: dict[str, Any] = {"x": [-3.0, 0.4, 2.0], "y": [-1.0, 0.0, 2.5], "z": [0.8, 2.0, 4.0]}
    x, y, z = np.meshgrid(*positions.values(), indexing="ij")
    pressure = point_pressure(grid, 1, 1)
    case = "load on one cell of 0.04a, 0.9a and more away"
    for friction, reference in (
        (0.0, Reference(case, "Boussinesq (1885); Johnson 3.2")),
        (1.0, Reference(f"{case}, f = 1", "Boussinesq and Cerruti; Johnson 3.2, 3.6")),
    ):
        computed = components(stress_field(_half_space(), pressure, friction=friction, **positions))
        exact = components(closed_forms.point_load(x, y, z, POISSON, 1.0, tangential=friction))
        scale = np.abs(exact).max()
        yield reference.compare("six stresses over the largest", computed / scale, exact / scale, 1e-3)


def plane_checks() -> Iterator[Check]:
    """Stresses in a thick and in a thin body under a line contact's pressure from end to end."""
    y, z = np.linspace(-2, 2, 17), np.array([0.1, 0.2, 0.35, 0.5, 1.0, 2.0, 4.0])
    source = "McEwen (1949); Smith and Liu (1953), "
    for length, cells, poisson, plane_state, component, tolerance in (
        (1000.0, 100, POISSON, "plane strain, in the middle", "sigma_xx", 3e-3),
        (0.05, 2, 0.0, "plane stress", "sigma_yy", 2e-3),
    ):
        body = _finite_body(length)
        pressure = strip_means((0, length), (-1.25, 1.25), (cells, 160))
        x = [0.5 * length] if cells > 2 else [0.0, 0.3 * length, 0.5 * length]
        for friction in (0.0, 0.3):
            stress = stress_field(body, pressure, friction=friction, x=x, y=y, z=z, inside_cells=pressure)
            exact = closed_forms.hertz_strip(y[:, None], z, 1.0, 1.0, poisson, friction=friction)
            computed = stress[component].isel(x=-1, z=3).values
            curve = Curve(("y / a", f"{component} / p0, z = 0.5a"), y, computed, exact[component][:, 3])
            case = f"strip load on a body of length {length:g}a, f = {friction:g}, z >= 0.1a"
            reference, expected = Reference(case, source + plane_state), components(exact)[:, None]
            yield reference.compare("six stresses / p0", components(stress), expected, tolerance, curve=curve)


def plate_contact_checks() -> Iterator[Check]:
    """Contact of a cylinder with the edge of a thin plate: the line contact with ``E`` instead of ``E*``."""
    length, material = 0.05, unit_material(POISSON)
    gap = on_cells(lambda x, y: y**2 + 0 * x, (0, length), (-2, 2), (2, 129))
    contact = solve_contact(FiniteLengthSpace(length=length, material=material), gap, load=LINE_LOAD * length)
    pressure = contact["pressure"].mean("x")
    half_width, peak = closed_forms.hertz_line(LINE_LOAD, 0.5, material.young)
    exact = peak * np.sqrt(np.maximum(1 - (gap["y"].values / half_width) ** 2, 0))
    curve = Curve(("y / a", "p / p0"), gap["y"].values, pressure.values, exact)
    reference = Reference(
        "rigid cylinder on a body of length 0.05a", "Hertz with plane stress modulus E; Johnson (1985) 4.45"
    )
    yield reference.compare("peak pressure", pressure.max(), peak, 1e-3, relative=True, curve=curve)


def body_checks() -> Iterator[Check]:
    """Check that a body with far ends agrees with the body without these ends."""
    points: dict[str, Any] = {"y": [0.0, 0.5], "z": [0.1, 0.3, 1.0]}
    load = on_cells(lambda x, y: np.maximum(1 - (x - 20) ** 2 - y**2, 0), (0, 40), (-1.5, 1.5), (320, 24))
    finite_stress, half_space_stress = (
        stress_field(body, load, friction=0.2, x=[19.0, 20.0, 20.5], **points, inside_cells=load)
        for body in (_finite_body(40.0), _half_space())
    )
    reference = Reference("body of length 40a loaded over 2a in its middle, f = 0.2", "half-space under the same load")
    yield reference.compare("six stresses / p0", components(finite_stress), components(half_space_stress), 1e-3)
    at_x = [0.0, 0.1, 1.0, 2.5]
    for length, tolerance in ((20.0, 5e-3), (40.0, 1.25e-3)):
        fields = []
        for span, body in ((length, _finite_body(length)), (10.0, QuarterSpace(material=unit_material()))):
            load = on_cells(lambda x, y: strip(x, y) * (x < 2), (0, span), (-2, 2), (round(8 * span), 48))
            stress = stress_field(body, load, friction=0.2, x=at_x, **points, inside_cells=load)
            fields.append(components(stress))
        case = f"body of length {length:g}a loaded over 2a at one end, f = 0.2"
        source = "quarter space under the same load"
        yield Reference(case, source).compare("six stresses / p0", fields[0], fields[1], tolerance)


def free_end_checks() -> Iterator[Check]:
    """Residual traction of the solution on loaded ends."""
    for length in (8.0, 2.5):
        pressure = on_cells(strip, (0, length), (-2, 2), (round(16 * length), 64))
        grid = Grid.from_centres(pressure["x"].values, pressure["y"].values)
        for depths, label in (((0.02, 0.05), "z = 0.02a, 0.05a"), ((0.1, 0.3, 1.0, 5.0), "z >= 0.1a")):
            residual = end_traction_residual(
                _finite_body(length), sliding(pressure.values, 0.3), grid, grid.y[::5], np.array(depths)
            )
            case = f"strip load on both ends, L = {length:g}a, f = 0.3"
            yield Reference(case, "free ends").compare(f"traction on the ends / p0, {label}", residual, 0.0, 1e-4)


def equilibrium_checks() -> Iterator[Check]:
    """Divergence of the stress near an end, by central differences of sixth order, and resultants on a plane."""
    length, step = 4.0, 0.02
    pressure = on_cells(lambda x, y: quartic(y) + 0 * x, (0, length), (-1, 1), (64, 64))
    body, friction = _finite_body(length), 0.3
    offsets, weights = np.arange(-3, 4) * step, np.array([-1, 9, -45, 0, 45, -9, 1]) / (60 * step)
    centre = {"x": 0.3, "y": 0.4, "z": 0.6}
    slopes = {}
    for axis in "xyz":
        points: dict[str, Any] = {name: [value] for name, value in centre.items()} | {axis: centre[axis] + offsets}
        stress = stress_field(body, pressure, friction=friction, **points, inside_cells=pressure)
        slopes[axis] = {name: float(weights @ stress[name].values.ravel()) for name in STRESSES}
    rows = ("sigma_xx", "tau_xy", "tau_xz"), ("tau_xy", "sigma_yy", "tau_yz"), ("tau_xz", "tau_yz", "sigma_zz")
    divergence = [sum(slopes[axis][name] for axis, name in zip("xyz", row, strict=True)) for row in rows]
    max_slope = max(abs(value) for slopes_of_axis in slopes.values() for value in slopes_of_axis.values())
    case = "smooth strip load, f = 0.3, L = 4a"
    reference, quantity = Reference(f"{case}, 0.3a from the end", "equilibrium"), "divergence of the stress"
    yield reference.compare(f"{quantity} over its largest slope", np.array(divergence) / max_slope, 0.0, 2e-3)
    # The resultants on the plane z = 1 equal the load. Quadrature: Gauss points in x, graded cells in y; farther out
    # the stress is that of Flamant's plate, whose shear under a traction Q falls like 2 Q z / (pi y**2).
    node, weight = np.polynomial.legendre.leggauss(10)
    x = 0.5 * length * (node + 1)
    parameter = np.linspace(-5.0, 5.0, 101)
    y, dy = np.sinh(parameter), np.cosh(parameter) * (parameter[1] - parameter[0])
    cut_stress = stress_field(body, pressure, friction=friction, x=x, y=y, z=[1.0], inside_cells=pressure).isel(z=0)
    load = length * 16 / 15
    fraction_within = 1 - 4 / (np.pi * np.abs(y).max())
    for component, expected in (("sigma_zz", -load), ("tau_yz", -friction * load * fraction_within)):
        resultant = float(np.einsum("xy,x,y->", cut_stress[component].values, 0.5 * length * weight, dy))
        reference = Reference(f"{case}, cut at z = a", "equilibrium")
        yield reference.compare(f"resultant of {component} / (p0 a^2)", resultant, expected, 2e-3)


def contact_condition_checks() -> Iterator[Check]:
    """Load, symmetry and conditions of a contact."""
    gap = on_cells(lambda x, y: y**2 + 0 * x, (0, 8), (-2, 2), (129, 65))
    contact = solve_contact(_finite_body(8.0), gap, load=8 * LINE_LOAD)
    pressure = contact["pressure"].values
    case = "rigid cylinder on a body of the same length, 8a"
    load = pressure.sum() * 32 / pressure.size
    yield Reference(case, "prescribed").compare("load", load, 8 * LINE_LOAD, 1e-9, relative=True)
    mirrored = [pressure[::-1], pressure[:, ::-1]]
    quantity = "pressure / p0 against its mirror images"
    yield Reference(case, "symmetry").compare(quantity, [pressure, pressure], mirrored, 1e-8)
    displacement = surface_displacement(_finite_body(8.0), contact["pressure"])
    height = ((gap + displacement) / float(displacement.max() - displacement.min())).values
    in_contact = pressure > 0
    approach = height[in_contact].mean()
    reference, scale = Reference(case, "conditions of contact"), "over the variation of the displacement"
    yield reference.compare(f"gap under pressure {scale}", height[in_contact], approach, 1e-5)
    overlap = min(0.0, float((height - approach)[~in_contact].min()))
    yield reference.compare(f"overlap outside the contact {scale}", overlap, 0.0, 1e-5)


def reciprocity_checks() -> Iterator[Check]:
    """Betti's theorem: each of two loads does the same work on the displacement of the other load."""
    for length in (8.0, 2.5):
        body, span, cells = _finite_body(length), (0, length), (48, 32)
        load = on_cells(lambda x, y: np.exp(-((x - 1) ** 2) - y**2), span, (-2, 2), cells)
        other_load = on_cells(lambda x, y: np.exp(-((x - 2) ** 2) - 2 * y**2), span, (-2, 2), cells)
        work = (load * surface_displacement(body, other_load)).sum()
        other_work = (other_load * surface_displacement(body, load)).sum()
        case, quantity = f"two loads on a body of length {length:g}a", "work of one on the other's displacement"
        yield Reference(case, "Betti").compare(quantity, work, other_work, 1e-9, relative=True)


def alternation_checks() -> Iterator[Check]:
    """Check that alternating between ends and top converges to the explicit solution."""
    settings = Resolution()
    modes = axial_modes(8.0, 2.0, 0.05, settings)[0]
    system = EquationSet.build(modes, 2.0, 0.3, 0.05, settings)
    source: FloatArray = system.source(
        Load.NORMAL, modes.load_weights * modes.cell_integrals(Load.NORMAL, np.array([0.0, 3.0]))[:, 0]
    )
    direct_solution, face_load = system.solve(source), source.copy()
    for _ in range(200):
        face_load = source + system.source(Load.NORMAL, modes.on_end * system.spectrum_on_top(system.scale * face_load))
    max_load, iterated_solution = np.abs(direct_solution).max(), system.scale * face_load
    case, iteration = "equivalent loads at one wavenumber, 200 alternations", "iteration of Hetenyi (1970) and Keer"
    computed, expected = direct_solution / max_load, iterated_solution / max_load
    yield Reference(case, iteration).compare("face loads over the largest", computed, expected, 1e-9)


# Checks of the groups of the suite
HALF_SPACE = (hertz_checks, circle_checks, line_checks, rectangle_checks, point_checks)
LIMITS = (plane_checks, plate_contact_checks, body_checks)
CONSISTENCY = (free_end_checks, equilibrium_checks, contact_condition_checks, reciprocity_checks, alternation_checks)
