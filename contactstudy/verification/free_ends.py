"""Checks of bodies with free ends: exact limits of a quarter space, published numbers, finite elements (scikit-fem).

* Hetenyi, *J. Appl. Mech.* 37 (1970) 70, and Keer, Lee and Mura, *Int. J. Solids Struct.* 19 (1983) 497: overlapping.
  Far from a load P at the edge the equivalent loads act like point loads: ``H = P + (2 / pi) V`` on the top and
  ``V = (2 / pi) H`` on the end, so ``H = P / (1 - 4 / pi**2)``. The displacement along the edge is ``2 H / P`` times
  the displacement of the half-space.
* Johnson, *Contact Mechanics* (1985): largest shear stresses below point and line contacts.
* Michell, *Proc. London Math. Soc.* 32 (1900) 35; Timoshenko and Goodier, *Theory of Elasticity*: wedge.
* Guilbault, *J. Tribology* 133 (2011) 031402: see docs/explanation/verification.md.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from scipy.interpolate import make_interp_spline

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.models import FiniteLengthSpace, HalfSpace, QuarterSpace
from contactstudy.checks import FloatArray
from contactstudy.contact.solve import solve_contact
from contactstudy.fields.stress import stress_field
from contactstudy.fields.surface import surface_displacement
from contactstudy.kernels.load import Load
from contactstudy.overlapping.equations import EquationSet, axial_modes
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.stress import maximum_shear, von_mises
from contactstudy.verification.problems import (
    CONTACT_CASES,
    CONTACT_FILE,
    LOAD_CASES,
    STRESS_FILE,
    Check,
    Curve,
    LoadCase,
    Reference,
    components,
    load_reference,
    on_cells,
    on_grid,
    point_pressure,
    strip,
    strip_means,
    unit_material,
)

NORMAL_RATIOS = {0.0: 2.0, 0.3: 2.4727}  # Displacement ratio along the inward normal, by Poisson's ratio
# ``kappa``: at the distance d the edge adds ``kappa (1 - nu**2) P / (2 pi E d)`` to the deflection at a load
EXTRA_DEFLECTION = {0.0: 1.3677, 0.3: 1.8452, 0.5: 2.7561}
# Resultant of the equivalent load on the top for a unit load, without images
TOP_RESULTANT = 1 / (1 - 4 / np.pi**2)
END_RESULTANT = -2 / np.pi * TOP_RESULTANT  # Resultant on the end plane: tension
EXACT_LIMIT = "exact limit of the quarter space"  # Source of closed forms
COMPUTED_LIMIT = "limit of the quarter space, computed apart from the solver"  # Source of numbers without a closed form


def _scaled_displacement(poisson: float, grid: Grid, cell: tuple[int, int], distance: FloatArray) -> FloatArray:
    """Displacement under a unit load on a cell, over the displacement of a half-space at the same distance."""
    body = QuarterSpace(material=unit_material(poisson))
    return np.asarray(surface_displacement(body, point_pressure(grid, *cell)).values * np.pi * distance)


def edge_load_checks() -> Iterator[Check]:
    """Displacement under a point load on the edge."""
    for poisson in (0.0, 0.3, 0.5):
        # The error is proportional to the cell's size over the distance: two distances give the limit.
        grid = Grid(x_range=(0.0, 0.16), y_range=(-4.1, 4.1), cells_x=8, cells_y=41)
        distance = np.abs(grid.y)[None, :]
        ratio = _scaled_displacement(poisson, grid, (0, 20), distance)[0, 20:]
        # Displacement along the edge under a point load on the edge, over the half-space's; for every Poisson's ratio
        yield Reference(f"point load on the edge, nu = {poisson:g}", EXACT_LIMIT).compare(
            "u_z along the edge over the half-space's", 2 * ratio[20] - ratio[10], 3.362954, 0.01
        )
    for poisson, expected in NORMAL_RATIOS.items():
        grid = Grid(x_range=(0.0, 8.2), y_range=(-0.45, 0.45), cells_x=82, cells_y=9)
        ratio = _scaled_displacement(poisson, grid, (0, 4), grid.x[:, None])[:, 4]
        yield Reference(f"point load on the edge, nu = {poisson:g}", COMPUTED_LIMIT).compare(
            "u_z along the inward normal over the half-space's", 2 * ratio[80] - ratio[40], expected, 0.01
        )


def extra_deflection_checks() -> Iterator[Check]:
    """Deflection at a point load at a distance from the edge."""
    for poisson, expected in EXTRA_DEFLECTION.items():
        grid = Grid(x_range=(0.0, 4.8), y_range=(-0.45, 0.45), cells_x=48, cells_y=9)
        load = point_pressure(grid, 40, 4)
        material = unit_material(poisson)
        quarter_displacement, half_space_displacement = (
            float(surface_displacement(body, load)[40, 4])
            for body in (QuarterSpace(material=material), HalfSpace(material=material))
        )
        case = f"point load at 40 cells from the edge, nu = {poisson:g}"
        kappa = (quarter_displacement - half_space_displacement) * 2 * np.pi * grid.x[40]
        quantity = "kappa, the edge's deflection over (1 - nu^2) P / (2 pi E d)"
        yield Reference(case, COMPUTED_LIMIT).compare(quantity, kappa, expected, 5e-4)


def resultant_checks() -> Iterator[Check]:
    """Resultants of the equivalent loads, from transforms between the lateral wavenumber and 1 / distance."""
    lateral, distance, settings = 1e-7, 1.0, Resolution()
    for poisson in (0.0, 0.3, 0.5):
        (modes,) = axial_modes(np.inf, lateral, 1e-4, settings)
        system = EquationSet.build(modes, lateral, poisson, 1e-4, settings)
        spectrum = modes.load_weights * modes.cosine(np.array([distance]))[:, 0]
        solution = system.solve(system.source(Load.NORMAL, spectrum))
        spectra = system.spectrum_on_top(solution) / modes.weights
        low_rays = np.abs(modes.ray) < 3e-3  # small compared with 1 / distance; the lateral wavenumber is even smaller
        top_resultant = 1 + 0.5 * np.pi * float(np.interp(1e-3, np.abs(modes.ray[low_rays]), spectra.real[low_rays]))
        end_resultant = -0.5 * np.pi * float(np.interp(1e-3, system.depth, solution / system.scale))
        case = f"equivalent loads of a unit load, nu = {poisson:g}"
        yield Reference(case, EXACT_LIMIT).compare("resultant on the top", top_resultant, TOP_RESULTANT, 5e-3)
        yield Reference(case, EXACT_LIMIT).compare("resultant on the end", end_resultant, END_RESULTANT, 5e-3)


def corner_checks() -> Iterator[Check]:
    """Stresses at the corner under a uniform pressure: ``sigma_z = -p, sigma_x = 0``, plane strain along the edge."""
    poisson, width = 0.3, 60.0
    body = QuarterSpace(material=unit_material(poisson))
    pressure = on_cells(lambda x, y: (x < 5) + 0 * y, (0, 6), (-width, width), (48, 12))
    stress = stress_field(body, pressure, x=[0.05], y=[0.0], z=[0.05]).isel(x=0, y=0, z=0)
    case = "uniform pressure on a long strip up to the edge, 0.05 from the corner"
    in_plane = [stress[name] for name in ("sigma_xx", "sigma_zz", "tau_xz")]
    yield Reference(case, f"uniaxial compression, {EXACT_LIMIT}").compare(
        "sigma_xx, sigma_zz, tau_xz / p", in_plane, [0.0, -1.0, 0.0], 0.02
    )
    source, expected = f"p sqrt(1 - nu + nu^2), {EXACT_LIMIT}", np.sqrt(1 - poisson + poisson**2)
    yield Reference(case, source).compare("von Mises stress / p", von_mises(stress), expected, 0.02)


def antiplane_checks() -> Iterator[Check]:
    """Check that a traction uniform along y needs no equivalent load on the end: the mirror image frees the end."""
    (modes,) = axial_modes(np.inf, 1e-9, 1e-2, Resolution())
    system = EquationSet.build(modes, 1e-9, 0.3, 1e-2, Resolution())
    spectrum = modes.load_weights * modes.cosine(np.array([1.0]))[:, 0]
    near_surface = system.depth > 1e-3  # deeper than a wavelength along y the residual traction does not vanish
    under_traction, under_pressure = (
        system.source(load, spectrum)[near_surface] for load in (Load.ALONG_Y, Load.NORMAL)
    )
    computed = under_traction / np.abs(under_pressure).max()
    quantity = "equivalent load on the end, over that for an equal pressure"
    case = "traction along y that does not vary along y"
    yield Reference(case, EXACT_LIMIT).compare(quantity, computed, 0.0, 1e-4)


POISSON = 0.3  # Poisson's ratio of every body below, unless a check states another value
# Guilbault's errors of the largest edge displacement by the mirrored-load method, by Poisson's ratio
MIRROR_ERRORS = {0.3: -0.2190, 0.15: -0.1130}


def johnson_checks() -> Iterator[Check]:
    """Largest shear below point and line contacts, and the largest tension around a point contact."""
    body = HalfSpace(material=unit_material(POISSON))
    circle = on_cells(lambda x, y: np.sqrt(np.maximum(1 - x**2 - y**2, 0)), (-1.25, 1.25), (-1.25, 1.25), (120, 120))
    long_strip = strip_means((0, 400), (-1.25, 1.25), (80, 160))
    z = np.linspace(0.3, 1.0, 141)
    for case, pressure, x, max_shear, depth in (
        ("circular Hertz pressure", circle, 0.0, 0.310, 0.48),
        ("line contact's pressure", long_strip, 200.0, 0.300, 0.78),
    ):
        shear = maximum_shear(stress_field(body, pressure, x=[x], y=[0.0], z=z, inside_cells=pressure)).values.ravel()
        source = f"Johnson (1985) 4.2, 3.4: {max_shear:.3f} p0 at {depth:g}a"
        yield Reference(case, source).compare("largest shear on the axis / p0", shear.max(), max_shear, 1e-3)
        yield Reference(case, source).compare("depth of the largest shear / a", z[shear.argmax()], depth, 0.015)
    x_outside = np.linspace(1.0, 1.3, 31)
    radial = stress_field(body, circle, x=x_outside, y=[0.0], z=[0.0], inside_cells=circle)["sigma_xx"].max()
    tension = (1 - 2 * POISSON) / 3
    source = "Johnson (1985) 3.43: (1 - 2 nu) p0 / 3 at the edge"
    yield Reference("circular Hertz pressure", source).compare("largest radial tension / p0", radial, tension, 5e-3)


def wedge_stress(angle: FloatArray) -> FloatArray:
    """Radial stress ``sigma_r r / P`` in a quarter plane, force P at its corner, at angles from the loaded face."""
    return np.asarray((8 * np.cos(angle) - 4 * np.pi * np.sin(angle)) / (np.pi**2 - 4))


def wedge_checks() -> Iterator[Check]:
    """Line load on the edge of a quarter space."""
    poisson, cell, width = 0.3, 0.01, 60.0
    body = QuarterSpace(material=unit_material(poisson))
    pressure = on_cells(lambda x, y: (x < cell) / cell + 0 * y, (0, 4 * cell), (-width, width), (4, 12))
    x, z = np.array([0.0, 0.5, 1.0, 2.0]), np.array([1.0, 1.5, 2.0])
    stress = stress_field(body, pressure, x=x, y=[0.0], z=z, inside_cells=pressure).isel(y=0)
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
    curve = Curve(("z / a", "sigma_zz a / P, x = 0"), z, stress["sigma_zz"].values[0], exact["sigma_zz"][0])
    case = "line load P on the edge of a quarter space, a and more away"
    reference = Reference(case, "Michell (1900); Timoshenko and Goodier, wedge")
    yield reference.compare("six stresses a / P", components(stress), components(exact), 0.02, curve=curve)


def mirror_checks() -> Iterator[Check]:
    """Compare errors of the mirrored-load method with published errors."""
    half_width = 0.03  # half-width of the load over its length along the normal to the edge
    for poisson, expected in MIRROR_ERRORS.items():
        material = unit_material(poisson)
        y_range = (-1.25 * half_width, 1.25 * half_width)
        load = on_cells(lambda x, y: strip(x, y / half_width) * (x < 1), (0, 1.125), y_range, (288, 33))
        exact, mirror = (
            float(surface_displacement(QuarterSpace(material=material, model=model), load)[0].max())
            for model in ("exact", "mirror")
        )
        case = f"narrow load up to the edge, half-width 0.03 of its length, nu = {poisson:g}"
        source = "Guilbault (2011), second-hand: against finite elements"
        quantity = "error of the largest edge displacement of a mirrored load"
        yield Reference(case, source).compare(quantity, mirror / exact - 1, expected, 0.01)


FINITE_ELEMENTS = "finite elements (scikit-fem), own error {:.0e} {}"  # Source of the references, with error and unit
QUICK_STRESSES = ("full_sliding", "eccentric_sliding", "thin", "plate_sliding")  # Load cases of the quick level
# Cells over the loaded width, and more cells for a load that changes along x right at a free end: cells along x are
# twice as wide, and the pressure's steps between cells affect the stress 0.02a below the top
CELLS_Y, FINER_CELLS_Y = 128, {"wedge_sliding": 256}
CONTACT_CELLS = 16  # Cells per half-width along x in contacts


def create_pressure(case: LoadCase, cells_y: int = CELLS_Y) -> xr.DataArray:
    """Load of a case on cells: along x a quarter of the number along y, but at least 32."""
    cells_x = max(32, round(0.25 * cells_y * case.length))
    return on_cells(lambda x, y: case.pressure(x[:, 0], y[0]), (0, case.length), (-1, 1), (cells_x, cells_y))


def stress_checks(name: str) -> Iterator[Check]:
    """Stresses under a prescribed load at all stored depths: largest and median difference of six components."""
    case, stored = LOAD_CASES[name], load_reference(STRESS_FILE, name)
    points: dict[str, Any] = {axis: stored[axis].values.astype(float) for axis in "xyz"}
    body = FiniteLengthSpace(length=case.length, material=unit_material(case.poisson))
    load = create_pressure(case, FINER_CELLS_Y.get(name, CELLS_Y))
    stress = stress_field(body, load, friction=case.friction, **points, inside_cells=load)
    computed, expected = components(stress), components(stored.transpose("x", "y", "z"))
    label = f"{name}: L = {case.length:g}a, f = {case.friction:g}, nu = {case.poisson:g}, {case.g}"
    profiles = (fields["sigma_yy"].sel(x=0.0, y=0.75).values for fields in (stress, stored))
    curve = Curve(("z / a", "sigma_yy / p0, x = 0, y = 0.75a"), points["z"], *profiles)
    quantity = f"six stresses / p0, z >= {float(stored['z'].min()):g}a"
    source = FINITE_ELEMENTS.format(stored.attrs["error_estimate"], "p0")
    yield Reference(label, source).compare(quantity, computed, expected, 1e-3, curve=curve)
    source = FINITE_ELEMENTS.format(stored.attrs["error_estimate_median"], "p0")
    yield Reference(label, source).compare(quantity, computed, expected, 2e-4, median=True)


def displacement_checks(name: str) -> Iterator[Check]:
    """Displacement of the top under a symmetric load, relative to its middle."""
    case, expected = LOAD_CASES[name], load_reference(STRESS_FILE, name)["displacement_z_young"]
    young = unit_material(case.poisson).young
    # The cell centres lie on the reference's points along y; along x the solution is interpolated between centres.
    body = FiniteLengthSpace(length=case.length, material=unit_material(case.poisson))
    grid = Grid(x_range=(0.0, case.length), y_range=(-1.3125, 1.3125), cells_x=round(32 * case.length), cells_y=105)
    displacement = surface_displacement(body, on_grid(case.pressure(grid.x, grid.y), grid), case.friction)
    in_body = expected.sel(x=slice(0.5 * grid.dx, case.length - 0.5 * grid.dx))
    interpolated = displacement.interp(x=in_body["x"], y=in_body["y"], method="cubic")
    middle = float(displacement.interp(x=0.5 * case.length, y=0.0, method="cubic"))
    label, error = f"{name}: L = {case.length:g}a, {case.g}, f = {case.friction:g}", expected.attrs["error_estimate"]
    reference, computed = Reference(label, FINITE_ELEMENTS.format(error, "p0 a")), young * (interpolated - middle)
    yield reference.compare("E u_z / (p0 a), relative to the middle", computed, in_body, 1e-3)


def contact_checks(name: str) -> Iterator[Check]:
    """Contact of a roller: pressure along its middle line, averaged over the cells."""
    case, stored = CONTACT_CASES[name], load_reference(CONTACT_FILE, name)
    grid = Grid(
        x_range=(0.0, case.length), y_range=(-1.75, 1.75), cells_x=round(CONTACT_CELLS * case.length), cells_y=113
    )
    body = FiniteLengthSpace(length=case.length, material=unit_material(case.poisson))
    contact = solve_contact(body, on_grid(case.gap(grid.x, grid.y), grid), load=case.load)
    facing = contact["pressure"].sel(x=slice(case.start, case.stop))
    x = facing["x"].values
    edges = np.append(x - 0.5 * grid.dx, x[-1] + 0.5 * grid.dx)
    expected = _cell_means(stored["x"].values, stored["pressure"].sel(y=0).values, edges)
    computed = facing.sel(y=0, method="nearest").values
    source = FINITE_ELEMENTS.format(float(np.median(stored["pressure_error"].sel(y=0))), "p0 (median)")
    label = f"{name}: contact, L = {case.length:g}a, roller from {case.distance:g}a"
    label += f", crown {case.crown:g}" if case.crown else ""
    curve = Curve(("x / a", "p / p0 at y = 0"), x, computed, expected)
    # At a sharp end inside the face neither solution resolves the pressure: wider tolerance within a / 2.
    is_singular = case.distance > 0 and not case.crown
    reference, quantity, tolerance = Reference(label, source), "pressure / p0 at y = 0", 0.05 if is_singular else 0.01
    inner_quantity = f"{quantity}, away from the last cell"
    yield reference.compare(inner_quantity, computed[1:-1], expected[1:-1], tolerance, curve=curve)
    if is_singular:
        near = CONTACT_CELLS // 2
        far_quantity = f"{quantity}, 0.5a and more from the roller's end"
        yield reference.compare(far_quantity, computed[near:-near], expected[near:-near], 0.01)
        line_load = _cell_means(stored["x"].values, stored["line_load"].values, edges)
        computed_load, expected_load = (facing[:near].sum() * grid.cell_area, line_load[:near].sum() * grid.dx)
        yield reference.compare("load on the roller's last 0.5a / (p0 a^2)", computed_load, expected_load, 0.03)
    else:
        yield reference.compare(f"{quantity} in the last cell", computed[[0, -1]], expected[[0, -1]], 0.03)


def _cell_means(nodes: FloatArray, values: FloatArray, edges: FloatArray) -> FloatArray:
    """Means over cells of a function that is linear between its nodes."""
    integral = make_interp_spline(nodes, values, k=1).antiderivative()
    return np.asarray(np.diff(integral(edges)) / np.diff(edges))


def finite_element_checks(*, full: bool) -> Iterator[Check]:
    """Every check against finite elements; without `full` only with some of the load cases."""
    names = [name for name in LOAD_CASES if full or name in QUICK_STRESSES]
    for name in names:
        yield from stress_checks(name)
    for name in names:
        if LOAD_CASES[name].symmetric:
            yield from displacement_checks(name)
    for name in CONTACT_CASES:
        yield from contact_checks(name)


# Checks of the groups of the suite
QUARTER_SPACE = (edge_load_checks, extra_deflection_checks, resultant_checks, corner_checks, antiplane_checks)
PUBLISHED = (johnson_checks, wedge_checks, mirror_checks)
