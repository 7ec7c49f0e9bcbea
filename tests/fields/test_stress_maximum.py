"""The largest stress in a body against closed forms, closer points, finer cells and the mirrored case."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, Grid, HalfSpace, Material, Roller, profiles, solve, stress_field
from contactstudy.checks import FloatArray
from contactstudy.fields.loads import TopLoad, sliding
from contactstudy.fields.positions import field_positions
from contactstudy.fields.stress import contact_stresses
from contactstudy.fields.stress_maximum import Border, StressMaximum, place_search
from contactstudy.kernels.load import Load
from contactstudy.stress import von_mises_of
from contactstudy.verification import closed_forms as ref
from tests.closed_forms import compute_hertz_surface_stress, compute_sliding_surface_stress

STEEL = Material(210e9, 0.3)
RADIUS, PRESSURE = 5e-3, 2e9
HALF_WIDTH = 4 * PRESSURE * RADIUS / (2 * STEEL.plane_strain_modulus)
NO_POSITIONS = np.zeros(0)


def make_circle_pressure() -> tuple[Grid, FloatArray]:
    """Hertz pressure on a circle of radius 1."""
    grid = Grid(x_range=(-1.25, 1.25), y_range=(-1.25, 1.25), cells_x=72, cells_y=72)
    return grid, np.sqrt(np.maximum(1 - grid.x[:, None] ** 2 - grid.y**2, 0.0))


def find_maximum(grid: Grid, pressure: FloatArray, friction: float) -> StressMaximum:
    """Largest stress of a half-space; the requested point is far from its position."""
    body = HalfSpace(material=Material(1.0, 0.3))
    positions = field_positions(body, grid, [1.2], [1.2], [2.0])
    loads = sliding(pressure, friction)
    search = place_search(body, loads, grid)
    return contact_stresses(body, loads, search, positions, end_yz=(NO_POSITIONS, NO_POSITIONS)).maximum


def test_stress_maximum_below_circle_matches_closed_form() -> None:
    grid, pressure = make_circle_pressure()
    computed = find_maximum(grid, pressure, 0.0)
    z = np.linspace(0.3, 0.7, 4001)
    radial, axial = ref.hertz_circle_axis(z, 1.0, 1.0, 0.3)
    exact_von_mises = np.abs(axial - radial)
    assert computed.value == pytest.approx(exact_von_mises.max(), rel=2e-3)
    assert abs(computed.value - exact_von_mises.max()) <= computed.error + 2e-3 * computed.value
    assert computed.position[2] == pytest.approx(z[exact_von_mises.argmax()], abs=0.03)
    assert computed.position[:2] == pytest.approx((0.0, 0.0), abs=0.1)


def test_high_friction_moves_stress_maximum_to_top() -> None:
    grid, pressure = make_circle_pressure()
    computed = find_maximum(grid, pressure, 0.5)
    y = np.linspace(-0.95, 0.95, 381)
    radial, hoop = compute_hertz_surface_stress(np.abs(y), 1.0, 1.0, 0.3)
    hertz_pressure, zeros = np.sqrt(1 - y**2), np.zeros_like(y)
    traction = compute_sliding_surface_stress(zeros, y, 1.0, 0.5, 0.3)
    components = (
        hoop + traction["sigma_xx"],
        radial + traction["sigma_yy"],
        -hertz_pressure,
        zeros,
        zeros,
        0.5 * hertz_pressure,
    )
    exact_von_mises = von_mises_of(*components)
    assert computed.position[2] == 0.0
    assert abs(computed.value - exact_von_mises.max()) <= computed.error == 0.02 * computed.value
    assert abs(computed.position[1]) < 1


def test_stress_maximum_does_not_depend_on_point_order() -> None:
    """Polynomials through two positions that differ by rounding would have large errors."""
    grid, pressure = make_circle_pressure()
    body = HalfSpace(material=Material(1.0, 0.3))
    x = np.array([0.4, -0.4, np.nextafter(0.4, 1.0), 0.1, 0.1 + 1e-12])
    positions = field_positions(body, grid, x, [0.2, -0.2, 0.2 + 1e-15], [0.5, 0.3, 0.5 + 1e-15])
    loads = sliding(pressure, 0.0)
    search = place_search(body, loads, grid)
    computed = contact_stresses(body, loads, search, positions, end_yz=(NO_POSITIONS, NO_POSITIONS)).maximum
    assert computed.value == pytest.approx(find_maximum(grid, pressure, 0.0).value, rel=1e-3)
    for strip_end in (5.0, 1.0):
        # Positions from both ends of the contact coincide at its middle, up to rounding.
        strip = np.where((grid.x > -strip_end) & (grid.x < strip_end), 1.0, 0.0)[:, None] * np.sqrt(
            np.maximum(1 - grid.y**2, 0)
        )
        rising_pressure = strip * (1 + 0.01 * grid.x[:, None])
        assert find_maximum(grid, rising_pressure, 0.0).value < 0.8


def test_stress_maximum_without_pressure_is_zero() -> None:
    grid, pressure = make_circle_pressure()
    computed = find_maximum(grid, 0 * pressure, 0.0)
    assert (computed.value, computed.error) == (0.0, 0.0)
    assert np.isnan(computed.position).all()


def make_sharp_roller(friction: float = 0.0, distance: float = 0.5, tilt: float = 0.0) -> Case:
    """A roller with an edge radius of 0.4 half-widths: the largest stress lies at a depth of 0.03 half-widths."""
    body = FiniteLengthSpace(length=20 * HALF_WIDTH, material=STEEL)
    roller = Roller(
        radius=RADIUS, length=(20 - 2 * distance) * HALF_WIDTH, profile=profiles.Cylinder(fillet_radius=0.05e-3)
    )
    return Case(body=body, roller=roller, max_pressure=PRESSURE, friction=friction, tilt=tilt)


def find_maximum_position(result: xr.Dataset) -> list[float]:
    return [float(result[f"peak_von_mises_{axis}"]) for axis in "xyz"]


def test_stress_maximum_does_not_depend_on_positions() -> None:
    friction = 0.1
    case = make_sharp_roller(friction)
    distant_result = solve(case, accuracy=0.02, x=[0.0, 5 * HALF_WIDTH], y=[0.0], z=[0.5 * HALF_WIDTH])
    near_result = solve(
        case, accuracy=0.02, x=HALF_WIDTH * np.linspace(0, 8, 9), y=[0.0], z=HALF_WIDTH * np.linspace(0, 3, 4)
    )
    peak_von_mises = float(distant_result.peak_von_mises)
    assert float(near_result.peak_von_mises) == pytest.approx(peak_von_mises, rel=2e-3)
    x, y, z = find_maximum_position(distant_result)
    step = 0.01 * HALF_WIDTH
    offsets = 2 * step * np.arange(-2.0, 3.0)
    depths = z + 0.4 * step * np.arange(-4.0, 5.0)
    adjacent_stress = stress_field(
        case.body,
        distant_result.pressure,
        friction=friction,
        x=x + offsets,
        y=y + offsets,
        z=depths,
        inside_cells=distant_result.pressure,
    )
    assert float(adjacent_stress.von_mises.max()) == pytest.approx(peak_von_mises, rel=3e-3)
    assert peak_von_mises / float(distant_result.von_mises.max()) > 1.4


@pytest.mark.slow
def test_stress_maximum_error_covers_finer_cells() -> None:
    coarse_result, fine_result = (
        solve(make_sharp_roller(0.4), accuracy=accuracy, x=[0.0], y=[0.0], z=[HALF_WIDTH]) for accuracy in (0.02, 0.004)
    )
    error = abs(float(coarse_result.peak_von_mises - fine_result.peak_von_mises))
    assert error <= float(coarse_result.peak_von_mises_error) < 0.04 * float(fine_result.peak_von_mises)


@pytest.mark.slow
def test_opposite_tilt_mirrors_stress_maximum() -> None:
    tilted_result, mirrored_result = (
        solve(make_sharp_roller(tilt=tilt), accuracy=0.02, x=[0.0], y=[0.0], z=[HALF_WIDTH]) for tilt in (1e-3, -1e-3)
    )
    assert float(tilted_result.peak_von_mises) == pytest.approx(float(mirrored_result.peak_von_mises), rel=1e-3)
    assert find_maximum_position(tilted_result)[0] == pytest.approx(
        20 * HALF_WIDTH - find_maximum_position(mirrored_result)[0], abs=0.02 * HALF_WIDTH
    )
    assert abs(find_maximum_position(tilted_result)[0] - 10 * HALF_WIDTH) > 5 * HALF_WIDTH


def test_stress_maximum_near_free_end_exceeds_pressure_peak() -> None:
    """The pressure is highest at mid-length, 20 a away, and increases steeply near the end of the body."""
    pressure, half_width = 0.75 * PRESSURE, 1.5 * HALF_WIDTH
    profile = profiles.FujiwaraKawase.for_pressure(
        pressure, radius=RADIUS, modulus=0.5 * STEEL.plane_strain_modulus, edge_drop=10e-6, k2=0.5
    )
    length = 10e-3
    roller = Roller(radius=RADIUS, length=length, profile=profile, material=STEEL, ends="none")
    case = Case(body=FiniteLengthSpace(length=length, material=STEEL), roller=roller, max_pressure=pressure)
    computed = solve(case, accuracy=0.05, x=[0.5 * length], y=[0.0], z=[half_width])
    x, z = half_width * np.linspace(0.2, 2, 37), half_width * np.linspace(0.1, 1, 19)
    end_stresses = stress_field(case.body, computed.pressure, x=x, y=[0.0], z=z, inside_cells=computed.pressure)
    axial_pressure = computed.pressure.max("y")
    assert float(axial_pressure.sel(x=half_width, method="nearest")) < 0.97 * float(axial_pressure.max())
    assert float(computed.peak_von_mises) == pytest.approx(float(end_stresses.von_mises.max()), rel=3e-3)
    assert min(find_maximum_position(computed)[0], length - find_maximum_position(computed)[0]) < 2 * half_width


def test_given_cells_and_singular_ends_omit_error() -> None:
    body = HalfSpace(material=STEEL)
    case = Case(body=body, roller=Roller(radius=RADIUS, length=8 * HALF_WIDTH), max_pressure=PRESSURE)
    grid_result = solve(
        case,
        Grid(
            x_range=(-HALF_WIDTH, 9 * HALF_WIDTH), y_range=(-1.5 * HALF_WIDTH, 1.5 * HALF_WIDTH), cells_x=20, cells_y=20
        ),
        x=[0.0],
        y=[0.0],
        z=[HALF_WIDTH],
    )
    assert np.isnan(float(grid_result.peak_von_mises_error))
    assert "given cells" in grid_result.peak_von_mises_error.attrs["comment"]
    refined_result = solve(case, accuracy=0.05, x=[0.0], y=[0.0], z=[HALF_WIDTH])
    assert np.isinf(float(refined_result.peak_von_mises))
    assert np.isnan(find_maximum_position(refined_result)).all()


FREE_ENDS = {"sharp": (1.2e-3, 1.8e9, 0.3, None), "crowned": (1e-3, 1.5e9, 0.3, profiles.FullCrown(1.0))}
"""Length, pressure, friction and profile of rollers that are flush with the body."""


@pytest.mark.slow
@pytest.mark.parametrize(("length", "pressure", "friction", "profile"), FREE_ENDS.values(), ids=FREE_ENDS)
def test_stress_maximum_at_free_end_is_on_top(
    length: float, pressure: float, friction: float, profile: profiles.Profile | None
) -> None:
    material = Material(208e9, 0.3)
    roller = Roller(radius=4e-3, length=length, profile=profile or profiles.Cylinder())
    body = FiniteLengthSpace(length=length, material=material)
    case = Case(body=body, roller=roller, max_pressure=pressure, friction=friction)
    a = case.hertz_half_width
    result = solve(case, accuracy=0.03, x=[0.5 * length], y=[0.0], z=[a])
    columns = (result.x.values > 0.05 * a) & (result.x.values < a)
    x, z = result.x.values[columns], a * np.array([0.0, 0.02, 0.05, 0.1, 0.2, 0.4])
    dense_stress = stress_field(
        body, result.pressure, friction=friction, x=x, y=result.y.values, z=z, inside_cells=result.pressure
    )
    is_inside = result.pressure.sel(x=dense_stress.x, y=dense_stress.y) > 0.3 * float(result.pressure.max())
    max_stress = float(dense_stress.von_mises.where(is_inside).max())
    assert float(result.peak_von_mises) == pytest.approx(max_stress, rel=5e-3)
    assert find_maximum_position(result)[2] == 0.0
    assert min(find_maximum_position(result)[0], length - find_maximum_position(result)[0]) < a
    assert float(result.peak_von_mises_error) < 0.04 * float(result.peak_von_mises)


@pytest.mark.slow
def test_requested_points_do_not_increase_error() -> None:
    length = 1.2e-3
    body = FiniteLengthSpace(length=length, material=Material(208e9, 0.3))
    case = Case(body=body, roller=Roller(radius=4e-3, length=length), max_pressure=1.8e9)
    result_without_points = solve(case, accuracy=0.003, x=[0.5 * length], y=[0.0], z=[15e-6])
    peak_x = float(result_without_points.peak_von_mises_x)
    depths = [0.0, 1e-7, 3e-7, 1e-6, 2e-6, 15e-6]
    result_with_points = solve(case, accuracy=0.003, x=[peak_x, length - peak_x], y=[0.0], z=depths)
    assert float(result_with_points.peak_von_mises) >= float(result_with_points.von_mises.sel(z=0.0).max())
    assert float(result_with_points.peak_von_mises_error) == pytest.approx(
        float(result_without_points.peak_von_mises_error), rel=0.1
    )
    assert float(result_with_points.peak_von_mises) == pytest.approx(
        float(result_without_points.peak_von_mises), rel=3e-3
    )


def test_friction_moves_stress_maximum_on_top() -> None:
    """The stress on the top depends mainly on the friction: the search must include the cell with the largest sum."""
    length = 1e-3
    crown = profiles.Lundberg.for_pressure(1.5e9, radius=RADIUS, modulus=STEEL.plane_strain_modulus, delta=0.6)
    body = FiniteLengthSpace(length=length + 8 * HALF_WIDTH, material=STEEL)
    roller = Roller(radius=RADIUS, length=length, profile=crown)
    computed = [
        solve(
            Case(body=body, roller=roller, max_pressure=1.5e9, friction=friction),
            accuracy=0.05,
            x=[0.5 * length],
            y=[0.0],
            z=[HALF_WIDTH],
        )
        for friction in (0.3, 0.5)
    ]
    assert [find_maximum_position(friction_result)[2] for friction_result in computed] == [0.0, 0.0]
    low_friction_peak, high_friction_peak = (float(friction_result.peak_von_mises) for friction_result in computed)
    assert high_friction_peak / low_friction_peak == pytest.approx(5 / 3, rel=0.05)


@pytest.mark.slow
def test_overshooting_polynomials_keep_sampled_maximum() -> None:
    """The polynomials overshoot to 1.094 GPa near their outermost points; the stress in the body is 1.067 GPa."""
    profile = profiles.Lundberg.for_pressure(1.5e9, radius=5e-3, modulus=STEEL.plane_strain_modulus)
    body, roller = FiniteLengthSpace(length=2e-3, material=STEEL), Roller(radius=5e-3, length=2e-3, profile=profile)
    case = Case(body=body, roller=roller, max_pressure=1.5e9, tilt=0.8e-3, friction=0.1)
    computed = solve(case, accuracy=0.005, y=[0.0], z=[1e-5])
    x, y, z = (float(computed[f"peak_von_mises_{axis}"]) for axis in "xyz")
    stress_at_maximum = stress_field(
        body, computed.pressure, friction=0.1, x=[x], y=[y], z=[z], inside_cells=computed.pressure
    ).von_mises.item()
    assert float(computed["peak_von_mises"]) == pytest.approx(stress_at_maximum, rel=5e-3)
    fine_result = solve(case, accuracy=0.003, x=[1e-3], y=[0.0], z=[1e-5])
    assert abs(float(computed["peak_von_mises"] - fine_result["peak_von_mises"])) <= float(
        computed["peak_von_mises_error"]
    )


@pytest.mark.slow
def test_disagreeing_polynomials_have_large_error() -> None:
    """The search includes points beyond the roller's end, where polynomials through the outermost points reach 0.80
    p0."""
    material = Material(210e9, 0.318)
    a = 2 * 1e9 * RADIUS / material.plane_strain_modulus
    length, distance = 42.835 * a, 3.451 * a
    case = Case(
        body=FiniteLengthSpace(length=length + 2 * distance, material=material),
        roller=Roller(radius=RADIUS, length=length, profile=profiles.Lundberg(0.482 * a**2 / RADIUS)),
        end_distance=distance,
        tilt=2 * 1.197 * a**2 / (length * RADIUS),
        max_pressure=1e9,
    )
    stop = distance + length
    fine_result = solve(
        case, x=stop - a * np.linspace(0.6, 1.4, 17), y=[0.0], z=a * np.linspace(0.5, 0.75, 11), accuracy=0.002
    )
    coarse_result = solve(case, x=[stop], y=[0.0], z=[0.0])
    peak, error = float(fine_result["peak_von_mises"]), float(fine_result["peak_von_mises_error"])
    assert peak == pytest.approx(float(fine_result["von_mises"].max()), abs=error)
    assert error < 6e-3 * peak
    assert peak == pytest.approx(float(coarse_result["peak_von_mises"]), rel=6e-3)


@pytest.mark.parametrize("position", [-0.1, 0.0, 0.3, 0.6, 0.9])
@pytest.mark.parametrize("row", [12, 15])
def test_border_of_square_root_is_exact(position: float, row: int) -> None:
    """Cell means of Carter's square root place the border, also where both cells have the same pressure."""
    centres = np.arange(32) - 15.5
    pressure = np.sqrt(np.maximum(13.0**2 - centres**2, 0.0))
    border = centres[row] - position  # the bound exceeds the traction by the root of the distance from the border
    integral = np.maximum(np.arange(33) - 16 - border, 0.0) ** 1.5 / 24
    integral[: row + 1] = 0.0  # zero up to the cell of the border
    ratio = 1.0 - np.diff(integral)
    loads = {Load.NORMAL: TopLoad(pressure[None]), Load.ALONG_Y: TopLoad(0.3 * (pressure * ratio)[None])}
    inside = np.ones((1, 32), bool)
    result = Border(loads, (STEEL, STEEL), inside)
    assert np.flatnonzero(result.represents).tolist() == [row + 1]
    expected = np.sqrt(np.interp(border, centres, pressure**2))
    assert result.traction[1, 0, row + 1] == pytest.approx(0.3 * expected, rel=1e-9)
