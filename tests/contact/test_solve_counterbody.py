"""Two elastic bodies: limits, exchange of the bodies, resultants, and transfer of loads between their grids."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from scipy import optimize

from contactstudy import (
    Case,
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    InvalidInputError,
    Material,
    QuarterSpace,
    Roller,
    choose_grid,
    profiles,
    roller_stress,
    solve,
    solve_contact,
    stress_field,
    surface_displacement,
)
from contactstudy.bodies.models import Counterbody
from contactstudy.contact import ContactSettings
from contactstudy.verification.problems import on_cells
from tests.closed_forms import solve_sliding_line_contact
from tests.reference_line import compute_line_slope

STEEL, ALUMINIUM = Material(210e9, 0.3), Material(70e9, 0.33)
HALF_WIDTH = 130e-6
FILLET = profiles.Cylinder(fillet_radius=2 * HALF_WIDTH)


def make_ellipsoid_gap(
    body, counterbody: Counterbody, cells: int, length: float, radius_x: float = 40e-3
) -> xr.DataArray:
    """Gap of an ellipsoid over the first `length` of a body, infinite outside the counterbody."""
    grid = Grid(x_range=(0.0, length), y_range=(-3 * HALF_WIDTH, 3 * HALF_WIDTH), cells_x=cells, cells_y=48)
    x = grid.x[:, None]
    mid_x = counterbody.start + 0.5 * counterbody.body.length
    gap = (x - mid_x) ** 2 / (2 * radius_x) + grid.y**2 / 10e-3
    is_under_counterbody = (x > counterbody.start) & (x < counterbody.start + counterbody.body.length)
    return xr.DataArray(np.where(is_under_counterbody, gap, np.inf), coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))


def test_two_half_spaces_equal_combined_modulus():
    rigid_case = Case(
        body=HalfSpace(material=Material(STEEL.young / 2, 0.3)),
        roller=Roller(radius=5e-3, length=8 * HALF_WIDTH),
        max_pressure=1e9,
    )
    elastic_case = Case(
        body=HalfSpace(material=STEEL),
        roller=Roller(radius=5e-3, length=8 * HALF_WIDTH, material=STEEL, ends="none"),
        max_pressure=1e9,
    )
    assert elastic_case.modulus == pytest.approx(rigid_case.modulus)
    rigid_pressure, elastic_pressure = (
        solve(case, stresses=False).pressure.values for case in (rigid_case, elastic_case)
    )
    assert np.abs(rigid_pressure - elastic_pressure).max() < 1e-9 * rigid_pressure.max()


def test_equal_half_spaces_do_not_couple_friction():
    roller = Roller(radius=5e-3, length=8 * HALF_WIDTH, material=STEEL, ends="none", profile=FILLET)
    cases = [
        Case(body=HalfSpace(material=STEEL), roller=roller, max_pressure=1e9, friction=0.5, coupled=coupled)
        for coupled in (False, True)
    ]
    grid = choose_grid(cases[0])
    results = [solve(case, grid, stresses=False).pressure.values for case in cases]
    assert np.abs(results[0] - results[1]).max() < 1e-6 * results[0].max()


@pytest.mark.parametrize(
    ("body_material", "roller_material"),
    [
        (Material(1.0, 0.0), None),
        (Material(1.0, 0.1), Material(3.0, 0.4)),
        (Material(3.0, 0.4), Material(1.0, 0.1)),
        (STEEL, ALUMINIUM),
    ],
)
def test_friction_moves_contact_of_different_materials(body_material: Material, roller_material: Material | None):
    """Bodies with mirrored ends are in plane strain; the sign of the centre depends on the sign of the coupling."""
    friction, radius, load = 0.5, 1.0, 2e-4 * body_material.plane_strain_modulus
    exact_line = solve_sliding_line_contact(load, radius, friction, body_material, roller_material)
    window_scale = exact_line.half_width + abs(exact_line.centre)
    gap = on_cells(
        lambda x, y: y**2 / (2 * radius) + 0 * x, (0.0, 1.0), (-1.5 * window_scale, 1.5 * window_scale), (4, 256)
    )

    def make_plane_strain_body(material: Material) -> FiniteLengthSpace:
        return FiniteLengthSpace(length=1.0, material=material, model="mirror")

    counterbody = None if roller_material is None else Counterbody(make_plane_strain_body(roller_material))
    computed = solve_contact(
        make_plane_strain_body(body_material),
        gap,
        load=load,
        friction=friction,
        counterbody=counterbody,
        settings=ContactSettings(coupled=True),
    ).pressure.isel(x=1)
    assert abs(exact_line.centre) > 0.03 * exact_line.half_width
    expected = exact_line.pressure(computed.y.values)
    assert np.abs(computed.values - expected).max() < 0.04 * expected.max()  # in the cell at the steep edge
    assert np.median(np.abs(computed.values - expected)[expected > 0]) < 5e-4 * expected.max()
    centroid, expected_centroid = (np.average(computed.y, weights=weights) for weights in (computed.values, expected))
    assert centroid == pytest.approx(expected_centroid, abs=1e-3 * exact_line.half_width)


def compute_flexibility(body: FiniteLengthSpace, grid: Grid) -> np.ndarray:
    """Displacement of every cell under unit pressure on every cell: array (x, y, x, y)."""
    unit_pressures = np.eye(grid.cells_x * grid.cells_y).reshape(-1, *grid.shape)
    columns = [
        surface_displacement(
            body, xr.DataArray(unit_pressure, coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
        ).values
        for unit_pressure in unit_pressures
    ]
    return np.array(columns).reshape(*grid.shape, *grid.shape)


@pytest.mark.parametrize("start", [-2, 1])
def test_two_finite_bodies_match_quadratic_programming(start: int):
    """Non-negative least squares (Lawson and Hanson) minimise the energy with the sum of both flexibilities."""
    cells_per_length, y_range, load = 2, (-1.5, 1.5), 1.5
    body = FiniteLengthSpace(length=8.0, material=Material(1.0, 0.3))
    counterbody = FiniteLengthSpace(length=6.0, material=Material(2.0, 0.25))
    grid, counter_grid = (
        Grid(
            x_range=(0.0, variant.length), y_range=y_range, cells_x=round(cells_per_length * variant.length), cells_y=9
        )
        for variant in (body, counterbody)
    )
    compliance = compute_flexibility(body, grid)
    shift = cells_per_length * start
    first_column, last_column = max(0, shift), min(grid.cells_x, shift + counter_grid.cells_x)
    counter_range = slice(first_column - shift, last_column - shift)
    compliance[first_column:last_column, :, first_column:last_column] += compute_flexibility(counterbody, counter_grid)[
        counter_range, :, counter_range
    ]
    gap = on_cells(lambda x, y: (x - start - 3) ** 2 / 40 + y**2 / 2, (0.0, 8.0), y_range, grid.shape)
    gap = gap.where((gap.x > start) & (gap.x < start + 6), np.inf)
    computed = solve_contact(
        body, gap, load=load, counterbody=Counterbody(counterbody, start), settings=ContactSettings(tolerance=1e-8)
    )

    # The reference lines of the prescribed tilt rotate under the load.
    transferred_load = Counterbody(counterbody, start).transfer_load(grid, computed.pressure.values)
    surface_pressures = (
        computed.pressure,
        xr.DataArray(transferred_load, coords={"x": counter_grid.x, "y": counter_grid.y}, dims=("x", "y")),
    )
    slopes = [
        compute_line_slope(variant, surface_pressure, variant.length)
        for variant, surface_pressure in zip((body, counterbody), surface_pressures, strict=True)
    ]
    gap = gap - sum(slopes) * gap.x

    can_touch = np.isfinite(gap.values).ravel()
    matrix = compliance.reshape(can_touch.size, -1)[np.ix_(can_touch, can_touch)]
    # A penalty far above the entries of the flexibility prescribes the load.
    penalty, area = 1e6, grid.cell_area
    factor = np.linalg.cholesky(matrix + penalty * area)
    right_hand_side = penalty * load - gap.values.ravel()[can_touch]
    pressure, _ = optimize.nnls(factor.T, np.linalg.solve(factor, right_hand_side), maxiter=10_000)
    expected = np.zeros(can_touch.size)
    expected[can_touch] = pressure * load / (pressure.sum() * area)
    np.testing.assert_allclose(computed.pressure.values.ravel(), expected, atol=1e-5 * expected.max())


@pytest.mark.parametrize("start", [1, 2])
def test_exchanged_bodies_have_equal_pressure_and_approach(start: int):
    long_body = FiniteLengthSpace(length=8 * HALF_WIDTH, material=STEEL)
    short_body = FiniteLengthSpace(length=6 * HALF_WIDTH, material=ALUMINIUM)
    short_counterbody = Counterbody(short_body, start * HALF_WIDTH)
    long_counterbody = Counterbody(long_body, -start * HALF_WIDTH)
    columns = slice(4 * start, 4 * start + 24)
    gap = make_ellipsoid_gap(long_body, short_counterbody, 32, long_body.length)
    exchanged_gap = gap.isel(x=columns).assign_coords(x=gap.x[columns] - start * HALF_WIDTH)
    settings = ContactSettings(coupled=True, tolerance=1e-8)
    contact = solve_contact(long_body, gap, load=100.0, friction=0.4, counterbody=short_counterbody, settings=settings)
    exchanged_contact = solve_contact(
        short_body, exchanged_gap, load=100.0, friction=-0.4, counterbody=long_counterbody, settings=settings
    )
    pressure = contact.pressure.values[columns]
    assert np.abs(pressure - exchanged_contact.pressure.values).max() < 2e-6 * pressure.max()
    assert float(contact.approach) == pytest.approx(float(exchanged_contact.approach), rel=1e-6)


@pytest.mark.parametrize("load_position", [4.0, 4.8])
def test_equal_flush_bodies_have_equal_displacements(load_position: float):
    body = FiniteLengthSpace(length=8 * HALF_WIDTH, material=STEEL)
    position = load_position * HALF_WIDTH
    roller = Roller(radius=5e-3, length=8 * HALF_WIDTH, material=STEEL)
    case = Case(body=body, roller=roller, max_pressure=1.5e9, load_position=position)
    rigid_case = Case(
        body=FiniteLengthSpace(length=8 * HALF_WIDTH, material=Material(STEEL.young / 2, 0.3)),
        roller=Roller(radius=5e-3, length=8 * HALF_WIDTH),
        max_pressure=1.5e9,
        load_position=position,
    )
    elastic_result, rigid_result = (solve(variant, stresses=False, accuracy=0.05) for variant in (case, rigid_case))
    peak_pressure = float(rigid_result.pressure.max())
    np.testing.assert_allclose(elastic_result.pressure.values, rigid_result.pressure.values, atol=1e-6 * peak_pressure)
    assert float(elastic_result.approach) == pytest.approx(float(rigid_result.approach), rel=1e-6)
    assert float(elastic_result.tilt) == pytest.approx(float(rigid_result.tilt), rel=1e-5, abs=1e-9)
    if load_position == 4.0:
        np.testing.assert_allclose(elastic_result.pressure, elastic_result.pressure[::-1], atol=1e-6 * peak_pressure)
    else:
        assert abs(float(rigid_result.tilt)) > 1e-5


@pytest.mark.parametrize("distance", [-1.5, 1.0])
def test_stiff_roller_equals_rigid_roller(distance: float):
    body = FiniteLengthSpace(length=9 * HALF_WIDTH, material=STEEL)
    pressures = [
        solve(
            Case(
                body=body,
                roller=Roller(radius=5e-3, length=7 * HALF_WIDTH, material=material, profile=FILLET),
                load=2e2,
                end_distance=distance * HALF_WIDTH,
            ),
            Grid(x_range=(0.0, body.length), y_range=(-3 * HALF_WIDTH, 3 * HALF_WIDTH), cells_x=72, cells_y=64),
            stresses=False,
        ).pressure.values
        for material in (None, Material(1e7 * STEEL.young, 0.3))
    ]
    np.testing.assert_allclose(pressures[1], pressures[0], atol=1e-5 * pressures[0].max())


def test_tilted_steel_roller_converges():
    # The initial guess overlaps deeply, so that many cells enter the contact at once.
    case = Case(
        body=FiniteLengthSpace(length=4.2e-3, material=STEEL),
        roller=Roller(radius=5e-3, length=4e-3, material=STEEL, profile=profiles.FullCrown(2.0)),
        load=1225.0,
        tilt=1e-3,
    )
    result = solve(case, choose_grid(case, cells_x=8, cells_y=12), stresses=False)
    assert bool(result.converged)
    assert float(result.penetration_error) < 1e-6
    assert int(result.iterations) < 110


def test_ends_between_cell_edges_change_little():
    """The error of roller ends inside cells decreases with the cell size and is small away from the fillet's peak."""
    body = FiniteLengthSpace(length=14 * HALF_WIDTH, material=STEEL)
    roller = Roller(radius=5e-3, length=10 * HALF_WIDTH, material=STEEL, profile=FILLET)
    case = Case(body=body, roller=roller, max_pressure=1.5e9)

    def solve_mid_pressure(cells: int) -> float:
        grid = Grid(x_range=(0.0, body.length), y_range=choose_grid(case).y_range, cells_x=cells, cells_y=32)
        return float(solve(case, grid, stresses=False).pressure.sel(x=0.5 * body.length, method="nearest").max())

    aligned_pressure = solve_mid_pressure(112)  # 16 cells lie between the body's end and the roller's end
    errors = [abs(solve_mid_pressure(cells) / aligned_pressure - 1) for cells in (58, 115)]
    assert errors[1] < 0.6 * errors[0]
    assert errors[1] < 0.005


def test_all_bodies_support_elastic_roller():
    roller = Roller(radius=5e-3, length=4 * HALF_WIDTH, material=ALUMINIUM, profile=FILLET)
    for body in (HalfSpace(material=STEEL), QuarterSpace(material=STEEL)):
        assert bool(solve(Case(body=body, roller=roller, max_pressure=1e9), stresses=False, accuracy=0.1).converged)


def test_grid_edges_contain_ends_of_elastic_roller():
    body = FiniteLengthSpace(length=14e-3, material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=10e-3, material=STEEL), max_pressure=1.5e9)
    grid = choose_grid(case, cells_x=2, cells_y=4)
    end_distance_in_cells = 2e-3 / grid.dx
    assert abs(end_distance_in_cells - round(end_distance_in_cells)) < 0.02


def test_roller_stresses_have_opposite_traction():
    body = FiniteLengthSpace(length=4 * HALF_WIDTH, material=STEEL)
    roller = Roller(radius=5e-3, length=4 * HALF_WIDTH, material=STEEL)
    case = Case(body=body, roller=roller, max_pressure=1e9, friction=0.3)
    points = {"x": [0.0, 2 * HALF_WIDTH], "y": [0.4 * HALF_WIDTH], "z": [0.5 * HALF_WIDTH]}
    pressure = solve(case, choose_grid(case, cells_x=3, cells_y=8), stresses=False).pressure
    body_stresses = stress_field(body, pressure, friction=case.friction, inside_cells=pressure, **points)
    roller_stresses = roller_stress(case, pressure, **points)
    mirrored_stresses = roller_stress(case, pressure, **(points | {"y": [-0.4 * HALF_WIDTH]}))
    assert np.abs(roller_stresses.tau_yz.values - body_stresses.tau_yz.values).max() > 1e7
    np.testing.assert_allclose(mirrored_stresses.von_mises.values, body_stresses.von_mises.values, rtol=1e-5)


def test_stresses_of_rigid_roller_raise_error(short_body):
    case = Case(body=short_body, roller=Roller(radius=100.0, length=8.0), load=0.1)
    pressure = solve(case, stresses=False, accuracy=0.1).pressure
    with pytest.raises(InvalidInputError, match="rigid"):
        roller_stress(case, pressure)


@given(st.floats(-0.5, 1.0), st.floats(0.6, 2.0), st.integers(4, 40))
def test_transfer_preserves_loads(start: float, length: float, cells: int):
    counterbody = Counterbody(FiniteLengthSpace(length=length, material=STEEL), start)
    grid = Grid(x_range=(0.0, 1.7), y_range=(-1.0, 1.0), cells_x=cells, cells_y=2)
    is_facing = (grid.x > start) & (grid.x < start + length)
    load = np.random.default_rng(cells).random(grid.shape) * is_facing[:, None]
    transferred_load = counterbody.transfer_load(grid, load)
    resultant = transferred_load.sum() * counterbody.grid_on_body(grid).cell_area
    assert resultant == pytest.approx(load.sum() * grid.cell_area, rel=1e-12)


def test_transfer_of_aligned_cells_is_identity():
    counterbody = Counterbody(FiniteLengthSpace(length=1.0, material=STEEL), 0.5)
    overlap = counterbody.overlap(Grid(x_range=(0.0, 2.0), y_range=(-1.0, 1.0), cells_x=16, cells_y=2))
    np.testing.assert_allclose(overlap, np.eye(16)[4:12] / 8, atol=1e-12)


@pytest.mark.parametrize(
    "arguments", [{"material": "steel"}, {"material": STEEL, "ends": "loose"}, {"material": STEEL, "ends": 1}]
)
def test_invalid_rollers_raise_error(arguments):
    with pytest.raises(InvalidInputError):
        Roller(radius=5e-3, length=1e-3, **arguments)


def test_counterbody_requires_position():
    with pytest.raises(InvalidInputError, match="counterbody"):
        Counterbody(QuarterSpace(material=STEEL))


def test_invalid_counterbody_raises_error(short_body):
    gap = make_ellipsoid_gap(short_body, Counterbody(short_body), 16, 8.0)
    with pytest.raises(InvalidInputError, match="counterbody"):
        solve_contact(short_body, gap, load=1.0, counterbody=STEEL)
