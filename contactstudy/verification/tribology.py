"""Checks of stick and slip, flash temperature and wear: closed forms, Kalker's coefficients, published numbers.

* Kalker, *Three-Dimensional Elastic Bodies in Rolling Contact* (1990), table E.3: creep coefficients at vanishing
  creepage, where the traction at the trailing edge is singular; two grids are extrapolated with a first-order error.
* Bentall and Johnson, *Int. J. Mech. Sci.* 9 (1967) 389, recomputed by the program CONTACT: unlike rollers.
* A traction curve by CONTACT, 48 x 44 cells, whose error explains the difference (docs/explanation/rolling.md).
* Spence, *J. Elasticity* 5 (1975) 297: a sphere pressed with friction sticks within the same part of the contact at any
  load, so the load is raised in steps. By the program CONTACT the part is half of the radius at this friction.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from scipy import special

from contactstudy.arrays.grid import Grid
from contactstudy.bodies import Body, Counterbody, FiniteLengthSpace, HalfSpace, Material
from contactstudy.case import Case, Roller, choose_grid
from contactstudy.case.motion import Motion, Rolling, Shift, Sliding
from contactstudy.checks import FloatArray
from contactstudy.contact import ContactSettings
from contactstudy.contact.rolling.fastsim import POISSONS, TABLE
from contactstudy.contact.solve import solve_contact
from contactstudy.heat import ThermalProperties, flash_temperature
from contactstudy.heat.flash import MovingBody, SourceOperator
from contactstudy.profiles import FullCrown
from contactstudy.solution import solve
from contactstudy.verification import closed_forms
from contactstudy.verification.problems import Check, Curve, Reference, on_cells, on_grid
from contactstudy.wear import wear_in, worn_profile

LINE_CELLS = 52  # Cells along y over 2.6 half-widths of a line contact: 20 per half-width


def material(shear: float, poisson: float) -> Material:
    """Material of a shear modulus, Pa."""
    return Material(2 * shear * (1 + poisson), poisson)


def solve_pair(
    bodies: Sequence[Body], gap: xr.DataArray, load: float, friction: float, motion: Motion, **settings: Any
) -> xr.Dataset:
    """Contact of two elastic bodies with friction."""
    counterbody, solver = Counterbody(bodies[1]), ContactSettings(**settings)
    return solve_contact(
        bodies[0], gap, load=load, friction=friction, counterbody=counterbody, motion=motion, settings=solver
    )


def line_contact(
    body_material: Material, roller_material: Material, motion: Rolling, friction: float, *, coupled: bool = False
) -> xr.Dataset:
    """Contact of two cylinders of radius 2, with half-width 1, in plane strain, by the mirror model of the ends."""
    modulus = 1 / (1 / body_material.plane_strain_modulus + 1 / roller_material.plane_strain_modulus)
    gap = on_cells(lambda x, y: 0.5 * y**2 + 0 * x, (0, 1), (-1.3, 1.3), (2, LINE_CELLS))
    materials = (body_material, roller_material)
    bodies = [FiniteLengthSpace(length=1.0, material=solid, model="mirror") for solid in materials]
    return solve_pair(bodies, gap, 0.25 * np.pi * modulus, friction, motion, coupled=coupled)


def carter_checks() -> Iterator[Check]:
    """Like cylinders in steady rolling."""
    steel, friction = material(1.0, 0.28), 0.3
    for stick in (0.2, 0.6, 0.9):
        creepage = friction * (1 - stick)
        result = line_contact(steel, steel, Rolling(longitudinal_creepage=creepage), friction).isel(x=0)
        case = f"like cylinders rolling, stick zone {stick:g} of the contact"
        reference = Reference(case, "Carter (1926); Johnson (1985) 8.44 to 8.46")
        step = float(result["y"][1] - result["y"][0])
        sliding = friction * float(result["pressure"].sum()) * step
        force = float(result["traction_y"].sum()) * step / sliding
        yield reference.compare("force over full sliding's", force, 1 - stick**2, 1e-3)
        width = 0.5 * float(result["stick"].sum()) * step
        yield reference.compare("half-width of the stick zone / a", width, stick, 0.5 * step + 1e-9)
        in_contact = np.abs(result["y"].values) < 0.9
        y = result["y"].values[in_contact]
        peak = 2 * sliding / np.pi
        computed, expected = result["traction_y"].values[in_contact] / peak, closed_forms.carter_traction(y, stick)
        # The traction has a vertical slope where slip begins, between two cells.
        is_smooth = np.abs(y - (1 - 2 * stick)) > 2 * step
        curve = Curve(("y / a", "q / (f p0)"), y, computed, expected)
        quantity = "traction / (f p0), two cells from where slip begins"
        yield reference.compare(quantity, computed[is_smooth], expected[is_smooth], 0.01, curve=curve)


def slope_checks(*, full: bool) -> Iterator[Check]:
    """Compare the initial slope of the traction curve, in plane stress (thin disc) and plane strain (long body)."""
    young, poisson, friction, creepage = 2.6, 0.3, 0.3, 0.015
    steel = material(1.0, poisson)
    for length, cells, case, modulus in (
        (0.1, 2, "like discs rolling, L = 0.1 a", 0.5 * young),
        (48.0, 96, "like cylinders rolling, L = 48 a", 0.5 * young / (1 - poisson**2)),
    )[: None if full else 1]:
        gap = on_cells(lambda x, y: 0.5 * y**2 + 0 * x, (0, length), (-1.3, 1.3), (cells, LINE_CELLS))
        body = FiniteLengthSpace(length=length, material=steel)
        load = 0.25 * np.pi * 0.5 * steel.plane_strain_modulus * length
        motions = (Rolling(longitudinal_creepage=index * creepage) for index in (1, 2))
        results = [solve_pair((body, body), gap, load, friction, motion).isel(x=cells // 2) for motion in motions]
        step = float(gap["y"][1] - gap["y"][0])
        forces = [step * float(result["traction_y"].sum()) for result in results]
        half_width = np.sqrt(4 * step * float(results[0]["pressure"].sum()) / (np.pi * modulus))
        slope = (4 * forces[0] - forces[1]) / (2 * creepage)
        expected, reference = 0.5 * np.pi * modulus * half_width, Reference(case, "Carter (1926); Johnson (1985) 8.46")
        yield reference.compare("initial slope of the force per length", slope, expected, 5e-3, relative=True)


def spence_checks() -> Iterator[Check]:
    """Press a rigid sphere with friction, without any shift."""
    half_space, edge, cells, steps = HalfSpace(material=material(1.0, 0.0)), 1.25, 40, 9
    gap = on_cells(lambda x, y: 0.05 * (x**2 + y**2), (-edge, edge), (-edge, edge), (cells, cells))
    load = 4 / 3 * half_space.material.plane_strain_modulus * 0.1
    result: xr.Dataset | None = None
    for ratio in np.linspace(0.2, 1.0, steps):  # equal steps of the radius
        settings = ContactSettings(coupled=True, after=result, tolerance=1e-5)
        force = load * ratio**3
        result = solve_contact(half_space, gap, load=force, friction=0.2986, motion=Shift(), settings=settings)
    assert result is not None
    areas = [float(result["stick"].sum()), float((result["pressure"] > 0).sum())]
    reference = Reference("rigid sphere pressed on a plane, f = 0.2986", "Spence (1975) by CONTACT")
    ratio = np.sqrt(areas[0] / areas[1])
    yield reference.compare("radius of the stick zone over the contact's", ratio, 0.5, edge / cells)


def shift_checks() -> Iterator[Check]:
    """Shift a sphere on a plane."""
    shear, poisson, radius, load, friction, load_fraction = 200e6, 0.42, 0.05, 9.1954, 0.4, 0.875
    rubber = material(shear, poisson)
    edge, cells = 1.25e-3, 76
    gap = on_cells(lambda x, y: (x**2 + y**2) / (2 * radius), (-edge, edge), (-edge, edge), (cells, cells))
    half_space, motion = HalfSpace(material=rubber), Shift(force_y=load_fraction * friction * load)
    result = solve_pair((half_space, half_space), gap, load, friction, motion)
    reference = Reference("sphere shifted on a plane, 7/8 of full sliding's force", "Cattaneo (1938); Mindlin (1949)")
    expected = closed_forms.mindlin_shift(load_fraction, load, friction, 1e-3, shear, poisson=poisson)
    yield reference.compare("shift", result["shift_y"], expected, 3e-3, relative=True)
    step = 2 * edge / cells
    stick = step * np.sqrt(float(result["stick"].sum()) / np.pi)
    yield reference.compare("radius of the stick zone / a", stick / 1e-3, 0.5, 0.5 * step / 1e-3)


def ellipse_gap(along_x: float, along_y: float, load: float, solid: Material, cells: tuple[int, int]) -> xr.DataArray:
    """Gap of two like bodies whose contact under a load is an ellipse of given semi-axes (Johnson 3.61, 4.26)."""
    modulus = 0.5 * solid.plane_strain_modulus
    peak = 1.5 * load / (np.pi * along_x * along_y)
    long_axis, short_axis = max(along_x, along_y), min(along_x, along_y)
    e_squared = 1 - (short_axis / long_axis) ** 2
    if e_squared == 0:
        long_factor = short_factor = np.pi * peak / (4 * modulus * long_axis)
    else:
        k, e = special.ellipk(e_squared), special.ellipe(e_squared)
        scale = peak * short_axis / (modulus * e_squared * long_axis**2)
        long_factor, short_factor = scale * (k - e), scale * ((long_axis / short_axis) ** 2 * e - k)
    factor_x, factor_y = (long_factor, short_factor) if along_x >= along_y else (short_factor, long_factor)
    x_range = along_x * cells[0] / (cells[0] - 2)
    y_range = along_y * cells[1] / (cells[1] - 6)  # rolling needs cells ahead
    return on_cells(lambda x, y: factor_x * x**2 + factor_y * y**2, (-x_range, x_range), (-y_range, y_range), cells)


def rolling_ellipse(
    half_x: float, half_y: float, load: float, metal: Material, friction: float, motion: Rolling, cells: tuple[int, int]
) -> xr.Dataset:
    """Two like bodies that touch on an ellipse, in steady rolling."""
    body, gap = HalfSpace(material=metal), ellipse_gap(half_x, half_y, load, metal, cells)
    return solve_pair((body, body), gap, load, friction, motion, tolerance=1e-5)


# Ratio of the half-widths along and across rolling, and Poisson's ratio; further pairs at the full level
KALKER_PAIRS = ((1.0, 0.25), (1.0, 0.5), (0.5, 0.0), (5.0, 0.25))
WHOLE_RANGE = (0.1, 0.3, 1.0, 1 / 0.4, 10.0)
# Numbers of cells along either axis of the two grids; along rolling for an ellipse of 10 to 1, to limit the time
KALKER_CELLS, LONG_CELLS = (34, 62), (62, 118)
CREEPAGE = 1e-6  # Creepage so small that only a few cells slip


def kalker_checks(*, full: bool) -> Iterator[Check]:
    """Kalker's creep coefficients."""
    published = {
        (ratio, poisson): coefficients
        for ratio, *columns in TABLE
        for poisson, coefficients in zip(POISSONS, zip(*columns, strict=True), strict=True)
    }
    further_pairs = [pair for pair in published if full and pair[0] in WHOLE_RANGE and pair not in KALKER_PAIRS]
    motions = Rolling(longitudinal_creepage=CREEPAGE), Rolling(lateral_creepage=CREEPAGE), Rolling(spin=-CREEPAGE)
    for ratio, poisson in (*KALKER_PAIRS, *further_pairs):
        table = published[ratio, poisson]
        counts = KALKER_CELLS if ratio < 10 else LONG_CELLS
        across, steel = 1.0 / ratio, material(1.0, poisson)
        coefficients = []
        for count in counts:
            cells = (count if ratio < 10 else KALKER_CELLS[0], count)
            forces = []
            for motion in motions:
                result = rolling_ellipse(across, 1.0, 0.01, steel, 1.0, motion=motion, cells=cells)
                force = float(result["force_y" if motion.longitudinal_creepage else "force_x"])
                forces.append(force / (CREEPAGE * across * (np.sqrt(across) if motion.spin else 1.0)))
            coefficients.append(forces)
        # The error is of first order in the cell: count - 6 cells span the contact, with three cells beyond either end.
        coarse_count, fine_count = (count - 6 for count in counts)
        coarse, fine = np.array(coefficients)[:, :2]
        extrapolated = (fine_count * fine - coarse_count * coarse) / (fine_count - coarse_count)
        case = f"vanishing creepage, a/b = {ratio:g}, Poisson's ratio {poisson:g}"
        reference = Reference(case, "Kalker (1990), table E.3")
        for name, computed, expected in zip(("c11", "c22"), extrapolated, table[:2], strict=True):
            yield reference.compare(f"{name}, extrapolated", computed, expected, 0.015, relative=True)
        # Under spin the traction is largest at the leading edge, where the error falls faster.
        yield reference.compare("c23", coefficients[1][2], table[2], 0.015, relative=True)


# Force over the force of full sliding, by the longitudinal creepage
CONTACT_CURVE = {4e-4: 0.2588, 1.2e-3: 0.6482, 2.0e-3: 0.8816, 2.8e-3: 0.9832}


def contact_program_checks() -> Iterator[Check]:
    """Numbers of the program CONTACT."""
    steel, load, friction = material(82e9, 0.28), 106.7e3, 0.33
    for creepage, expected in CONTACT_CURVE.items():
        motion = Rolling(longitudinal_creepage=creepage)
        result = rolling_ellipse(12.61e-3, 6.304e-3, load, steel, friction, motion=motion, cells=(44, 48))
        case = f"traction curve of an ellipse 2 to 1, creepage {creepage:g}"
        reference = Reference(case, "CONTACT, 48 x 44 cells, which are 1.4 % off")
        computed = result["force_y"] / (friction * load)
        yield reference.compare("force over full sliding's", computed, expected, 0.016, relative=True)
    soft_material = material(23e9, 0.31)
    modulus = 1 / (1 / soft_material.plane_strain_modulus + 1 / steel.plane_strain_modulus)
    # Creepages are proportional to the half-width over the pair's radius: 0.1 mm / 25 mm in the reference, 1 here.
    scale = 0.1 / 25
    for position, expected in ((0.0, 4.294e-4), (-0.75, 2.108e-4)):
        force = position * 0.05 * 0.25 * np.pi * modulus
        result = line_contact(soft_material, steel, Rolling(force_y=force), 0.05, coupled=True)
        case = f"unlike cylinders rolling, f = 0.05, force {position:g} of full sliding's"
        reference = Reference(case, "Bentall and Johnson (1967) by CONTACT")
        yield reference.compare("creepage", scale * result["longitudinal_creepage"], expected, 0.015, relative=True)


STEEL_HEAT = ThermalProperties(conductivity=46.0, density=7850.0, specific_heat=470.0)
UNIT_PROPERTIES = {"conductivity": 1.0, "density": 1.0, "specific_heat": 1.0}
EVERYWHERE = -np.inf, np.inf


def solve_rise(grid: Grid, heat: FloatArray, speed: float, ends: tuple[float, float], depth: float = 0.0) -> FloatArray:
    """Temperature rise of a body with unit properties."""
    body = MovingBody(ThermalProperties(**UNIT_PROPERTIES), speed, ends)
    return SourceOperator(body, grid, slice(0, grid.cells_x), depth)(np.broadcast_to(heat, grid.shape))


def fast_checks() -> Iterator[Check]:
    """Two like bodies in a fast line contact, which share the heat so that their surface temperatures are equal."""
    body = FiniteLengthSpace(length=1e-3, material=Material(210e9, 0.3))
    case = Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9, friction=0.05)
    a, speed, sliding = case.hertz_half_width, 200.0, 1.0
    grid = Grid(x_range=(0.0, 1e-3), y_range=(-1.5 * a, 1.5 * a), cells_x=4, cells_y=96)
    pressure = 1.5e9 * np.sqrt(np.maximum(1 - (grid.y / a) ** 2, 0)) + 0 * grid.x[:, None]
    fields = {"pressure": (("x", "y"), pressure), "traction_y": (("x", "y"), 0.05 * pressure)}
    result = xr.Dataset(fields, coords={"x": grid.x, "y": grid.y})
    motion = Sliding(body_speed=-speed - 0.5 * sliding, roller_speed=-speed + 0.5 * sliding)
    heated = flash_temperature(replace(case, motion=motion), result, body=STEEL_HEAT, roller=STEEL_HEAT)
    factor, lag = closed_forms.fast_line()
    heat = 0.05 * 1.5e9 * sliding
    expected = 0.5 * heat * np.sqrt(STEEL_HEAT.diffusivity * a / (np.pi * speed)) / STEEL_HEAT.conductivity * factor
    reference = Reference("fast line contact of like bodies", "Blok (1937); Jaeger (1942)")
    yield reference.compare("largest rise", heated.max_temperature_rise, expected, 5e-3, relative=True)
    yield reference.compare("distance behind the middle / a", -heated.max_temperature_rise_y / a, lag, 0.02)
    reference, quantity = reference._replace(source="symmetry"), "part of the heat in the body"
    yield reference.compare(quantity, heated.body_heat_share, 0.5, 2e-3)
    difference = abs(heated.temperature_rise - heated.roller_temperature_rise).where(result.pressure > 0)
    difference_over_rise = difference.max() / heated.max_temperature_rise
    name = "difference of the contact temperatures, over the rise"
    yield reference._replace(source="shared heat").compare(name, difference_over_rise, 0.0, 1e-6)
    motion = Sliding(body_speed=-400.0, roller_speed=-100.0)
    heated = flash_temperature(replace(case, motion=motion), result, body=STEEL_HEAT, roller=STEEL_HEAT)
    source = "shares go with the root of the speed; Blok (1937)"
    reference = Reference("fast line contact, the body four times as fast", source)
    yield reference.compare(quantity, heated.body_heat_share, 2 / 3, 5e-3)


def band_checks() -> Iterator[Check]:
    """Uniform heat in a band, at all speeds."""
    grid = Grid(x_range=(0.0, 8.0), y_range=(-2, 2), cells_x=5, cells_y=64)
    band = np.where(np.abs(grid.y) < 1, 1.0, 0.0)
    for drift in (0.01, 0.3, 5.0, 100.0):
        rises = solve_rise(grid, band, 2 * drift, (0.0, 8.0))[2]
        exact = closed_forms.moving_band(grid.y, drift)
        curve = Curve(("y / a", "T lambda / (q a)"), grid.y, rises, exact)
        reference = Reference(f"band of uniform heat between two ends, Peclet number {drift:g}", "Jaeger (1942)")
        computed, expected = rises / exact.max(), exact / exact.max()
        yield reference.compare("rise over the largest", computed, expected, 5e-6, curve=curve)


def resting_checks() -> Iterator[Check]:
    """Check resting sources of heat on a half-space."""
    grid = Grid(x_range=(-1.2, 1.2), y_range=(-1.2, 1.2), cells_x=61, cells_y=61)
    source = "Carslaw and Jaeger (1959), 10.5"
    cells = Grid(x_range=(-1.5, 1.5), y_range=(-1.5, 1.5), cells_x=45, cells_y=45)
    square = np.where((np.abs(cells.x)[:, None] < 1) & (np.abs(cells.y) < 1), 1.0, 0.0)
    side = 0.5 * float(square[22].sum()) * cells.dy
    centre_rise = float(solve_rise(cells, square, 0.0, EVERYWHERE)[22, 22]) / side
    expected = 4 * float(np.arcsinh(1.0)) / np.pi
    reference = Reference("square of uniform heat at rest", source)
    yield reference.compare("rise in the middle", centre_rise, expected, 1e-5, relative=True)
    heat = np.sqrt(np.maximum(1 - grid.x[:, None] ** 2 - grid.y**2, 0))
    centre_rise, expected = float(solve_rise(grid, heat, 0.0, EVERYWHERE)[30, 30]), 0.25 * np.pi
    case = "circle of Hertz' pressure at rest, 61 x 61 cells"
    yield Reference(case, source).compare("rise in the middle", centre_rise, expected, 2e-3, relative=True)


def end_checks() -> Iterator[Check]:
    """Insulated ends, and the balance of heat."""
    edges = np.array([0.0, 0.2, 0.5, 1.0, 1.7])
    half_grid, full_grid = (
        Grid.from_edges(borders, (-1, 1), 20) for borders in (edges, np.concatenate([-edges[:0:-1], edges]))
    )
    heat = np.array([3.0, 2.0, 1.5, 1.0])[:, None] * (np.abs(half_grid.y) < 0.5)
    end_rise = solve_rise(half_grid, heat, 3.0, (0.0, np.inf))
    mirrored_rise = solve_rise(full_grid, np.concatenate([heat[::-1], heat]), 3.0, EVERYWHERE)[4:]
    scale = mirrored_rise.max()
    reference = Reference("heat beside an insulated end", "symmetry")
    yield reference.compare("rise over the largest", end_rise / scale, mirrored_rise / scale, 1e-9)
    for speed in (1.0, -4.0):
        outflow, power = compute_heat_flow(speed)
        case = f"heat in three cells between two ends, surface speed {speed:g}"
        reference = Reference(case, "conservation of energy")
        yield reference.compare("heat through planes before and behind, over the total", outflow / power, 1.0, 1e-6)


def compute_heat_flow(speed: float) -> tuple[float, float]:
    """Heat through planes before and behind some sources, by conduction and motion, and the heat of the sources, W."""
    grid = Grid(x_range=(0.0, 2.0), y_range=(-3, 3), cells_x=12, cells_y=60)
    heat = np.zeros(grid.shape)
    heat[2, 28:30], heat[7, 30] = 5.0, 1.0
    points, weights = np.polynomial.legendre.leggauss(40)
    nodes = 0.5 * (points + 1)
    stencil = np.array([-1, 9, -45, 0, 45, -9, 1]) / (60 * grid.dy)  # first derivative, sixth order
    outflow = 0.0
    for depth, weight in zip(40 * nodes**4, weights * 80 * nodes**3, strict=True):
        rises = grid.dx * solve_rise(grid, heat, speed, (0.0, 2.0), depth).sum(axis=0)
        for side, row in ((-1, 8), (1, 51)):
            outflow += side * weight * float(speed * rises[row] - stencil @ rises[row - 3 : row + 4])
    return outflow, float(heat.sum()) * grid.cell_area


STEEL = Material(210e9, 0.3)
COEFFICIENT = 1e-17
EXPLICIT_STEPS = 80  # Number of explicit steps, whose error is of first order


def sliding_wear_checks() -> Iterator[Check]:
    """Constant slip."""
    body = FiniteLengthSpace(length=0.6e-3, material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=0.4e-3), max_pressure=1.5e9)
    grid = choose_grid(case, cells_x=3, cells_y=6)
    name = "sharp roller inside the face, full sliding"
    distances = [0.0, 3e3, 2e5]
    result = wear_in(case, COEFFICIENT, distance=distances, grid=grid)
    expected_volume, reference = COEFFICIENT * case.normal_load * distances[2], Reference(name, "Archard (1953): k W s")
    yield reference.compare("worn volume", result.worn_volume[2], expected_volume, 1e-9, relative=True)
    load = result.line_load.values[2]
    is_facing = np.isfinite(case.gap(grid)).any(axis=1)
    ratio, reference = load[is_facing].max() / load[is_facing].min(), Reference(name, "a steady profile wears evenly")
    yield reference.compare("largest load per length over the smallest, worn in", ratio, 1.0, 1e-3)
    explicit = wear_explicitly(case, grid, distances[1])
    depth, explicit = result.wear_depth.values[1] / explicit.max(), explicit / explicit.max()
    curve = Curve(("x / mm", "worn depth over the largest"), 1e3 * grid.x, depth, explicit)
    reference = Reference(name, f"{EXPLICIT_STEPS} explicit steps")
    yield reference.compare("worn depth early on, over the largest", depth, explicit, 0.01, curve=curve)
    worn_roller = replace(case.roller, profile=worn_profile(case, result, distances[1]))
    worn_case = replace(case, roller=worn_roller)
    line_load = grid.dy * solve(worn_case, grid, stresses=False).pressure.sum("y").values
    load, reference = result.line_load.values[1], Reference(name, "the contact during the wear")
    quantity = "load per length of the worn profile, over the largest"
    yield reference.compare(quantity, line_load / load.max(), load / load.max(), 2e-3)


def wear_explicitly(case: Case, grid: Grid, distance: float) -> FloatArray:
    """Worn depth by many explicit steps."""
    gap = on_grid(case.gap(grid), grid)
    depth = np.zeros((grid.cells_x, 1))
    compliance = COEFFICIENT * distance / EXPLICIT_STEPS / (2 * np.pi * case.roller.radius)
    for _ in range(EXPLICIT_STEPS):
        pressure = solve_contact(case.body, gap + depth, load=case.normal_load)["pressure"].values
        depth = depth + compliance * grid.dy * pressure.sum(axis=1, keepdims=True)
    return depth[:, 0]


def rolling_wear_checks() -> Iterator[Check]:
    """Wear by the work of steady rolling."""
    body = FiniteLengthSpace(length=0.6e-3, material=STEEL)
    roller = Roller(radius=5e-3, length=0.4e-3, material=STEEL, profile=FullCrown(crown_radius=0.05))
    case = Case(body=body, roller=roller, max_pressure=1.5e9, friction=0.2, motion=Rolling(longitudinal_creepage=1e-3))
    grid = choose_grid(case, cells_x=3, cells_y=8, window=2.5)
    work = float(solve(case, grid, stresses=False).friction_work)
    result = wear_in(case, COEFFICIENT, distance=[100.0], grid=grid, law="work")
    source = "k times the frictional work of the unworn contact"
    reference = Reference("crowned roller rolling at a creepage, little worn", source)
    yield reference.compare("worn volume", result.worn_volume[-1], COEFFICIENT * work * 100.0, 2e-3, relative=True)


# Checks of the groups of the suite
HEAT = (fast_checks, band_checks, resting_checks, end_checks)
WEAR = (sliding_wear_checks, rolling_wear_checks)
