from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    ConvergenceWarning,
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    InvalidInputError,
    Material,
    QuarterSpace,
    Roller,
    Rolling,
    Shift,
    WindowError,
    choose_grid,
    solve,
)
from contactstudy.profiles import Cylinder, Ellipsoid, FullCrown, Lundberg
from contactstudy.wear import wear_in, worn_profile

STEEL = Material(210e9, 0.3)
K = 1e-17


def create_case(length=0.6e-3, *, model="exact", **roller):
    body = FiniteLengthSpace(length=length, material=STEEL, model=model)
    return Case(body=body, roller=Roller(**{"radius": 5e-3, "length": 0.4e-3} | roller), max_pressure=1.5e9)


@pytest.fixture(scope="module")
def sharp_roller():
    """A rigid roller with sharp ends away from the ends of the body, and a coarse grid."""
    case = create_case()
    return case, choose_grid(case, cells_x=3, cells_y=8)


@pytest.fixture(scope="module")
def worn_result(sharp_roller):
    case, grid = sharp_roller
    return wear_in(case, K, distance=1e5, grid=grid)


def compute_ratio(line_load):
    is_loaded = line_load[line_load > 0]
    return is_loaded.max() / is_loaded.min()


def test_volume_obeys_archard_to_rounding(sharp_roller, worn_result):
    expected = K * sharp_roller[0].normal_load * worn_result.distance.values
    assert worn_result.worn_volume.values == pytest.approx(expected, rel=1e-12)
    assert float(worn_result.volume_error) < 1e-12
    volume = 2 * np.pi * 5e-3 * (worn_result.wear_depth.sum("x") * sharp_roller[1].dx)
    assert worn_result.worn_volume.values == pytest.approx(volume.values, rel=1e-12)


def test_constant_slip_makes_the_load_uniform(worn_result):
    load_ratios = [compute_ratio(line_load) for line_load in worn_result.line_load.values]
    assert load_ratios[0] > 2
    assert (np.diff(load_ratios) < 1e-6).all()
    assert load_ratios[-1] < 1.001


def test_wear_steps_increase(worn_result):
    assert worn_result.sizes["distance"] < 30
    assert (np.diff(worn_result.distance.values)[:-2] > 0).all()
    assert float(worn_result.next_step[-1]) > 100 * float(worn_result.next_step[0])


@pytest.mark.slow
def test_wear_error_bounds_difference_from_small_steps(sharp_roller):
    case, grid = sharp_roller
    coarse_wear, fine_wear = (
        wear_in(case, K, distance=[5e3], grid=grid, tolerance=tolerance) for tolerance in (0.03, 1e-4)
    )
    difference = float(
        abs(coarse_wear.wear_depth - fine_wear.wear_depth).isel(distance=-1).max() / fine_wear.wear_depth.max()
    )
    assert difference < 2 * float(coarse_wear.wear_error[-1])
    assert difference < 0.03
    assert difference > 5 * float(fine_wear.wear_error[-1])


def test_wear_of_uniform_contact_equals_archard():
    case = create_case(length=0.4e-3, model="mirror")
    grid = choose_grid(case, cells_x=2, cells_y=8)
    result = wear_in(case, K, distance=[0.0, 1e5], grid=grid, circumference=0.01)
    depth = K * case.normal_load / 0.4e-3 * 1e5 / 0.01
    assert result.wear_depth.values[-1] == pytest.approx(depth, rel=1e-6)
    assert result.pressure.values[-1] == pytest.approx(result.pressure.values[0], abs=1e-4 * 1.5e9)


def test_wear_between_mirrors_makes_pressure_uniform():
    case = create_case(length=0.4e-3, model="mirror", profile=FullCrown(crown_radius=0.05))
    result = wear_in(case, K, distance=[0.0, 1e5], grid=choose_grid(case, cells_x=3, cells_y=8))
    peaks = result.pressure.max("y").values
    assert compute_ratio(peaks[0]) > 1.05
    assert compute_ratio(peaks[1]) < 1.002


def test_continued_wear_equals_uninterrupted_wear(sharp_roller, worn_result):
    case, grid = sharp_roller
    with pytest.warns(ConvergenceWarning, match="max_steps = 4"):
        first_result = wear_in(case, K, distance=1e5, grid=grid, max_steps=4)
    assert first_result.sizes["distance"] == 5
    second_result = wear_in(case, K, distance=1e5, after=first_result)
    assert float(second_result.distance[0]) == float(first_result.distance[-1])
    assert second_result.wear_depth.values[-1] == pytest.approx(worn_result.wear_depth.values[-1], rel=1e-4)
    assert float(second_result.volume_error) < 1e-12
    # The continuation keeps the previous error.
    assert float(second_result.wear_error[0]) == pytest.approx(float(first_result.wear_error[-1]))
    assert float(second_result.wear_error[-1]) == pytest.approx(float(worn_result.wear_error[-1]), rel=0.02)


@pytest.mark.slow
def test_wear_under_eccentric_load_has_linear_line_load(sharp_roller):
    """The roller wears unevenly and tilts with the wear."""
    case, grid = sharp_roller
    eccentric_case = Case(body=case.body, roller=case.roller, max_pressure=1.5e9, load_position=0.32e-3)
    result = wear_in(eccentric_case, K, distance=[1e5], grid=grid)
    load, x = result.line_load.values[-1], grid.x
    is_loaded = load > 0
    length = grid.dx * is_loaded.sum()
    # w = W / L (1 + 12 e x' / L**2)
    load_factor = 12 * (0.32e-3 - 0.3e-3) * (x[is_loaded] - 0.3e-3) / (length**2 - grid.dx**2)
    expected = eccentric_case.normal_load / length * (1 + load_factor)
    assert load[is_loaded] == pytest.approx(expected, rel=2e-3)
    assert float(result.volume_error) < 1e-9


def test_wear_on_quarter_space_makes_load_uniform():
    body = QuarterSpace(material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=0.3e-3), max_pressure=1.5e9, end_distance=0.05e-3)
    result = wear_in(case, K, distance=[1e5], grid=choose_grid(case, cells_x=3, cells_y=8))
    assert compute_ratio(result.line_load.values[-1]) < 1.001
    assert float(result.volume_error) < 1e-12


@pytest.mark.slow
def test_wear_of_coupled_friction_by_work_is_friction_times_slip():
    case = Case(
        body=FiniteLengthSpace(length=0.6e-3, material=STEEL),
        roller=Roller(radius=5e-3, length=0.4e-3, material=STEEL),
        max_pressure=1.5e9,
        friction=0.2,
        coupled=True,
    )
    grid = choose_grid(case, cells_x=2, cells_y=6)
    slip_result, work_result = (wear_in(case, K, distance=[2e3], grid=grid, law=law) for law in ("slip", "work"))
    assert float(work_result.worn_volume[-1]) == pytest.approx(0.2 * float(slip_result.worn_volume[-1]), rel=1e-12)
    assert compute_ratio(slip_result.line_load.values[-1]) < compute_ratio(slip_result.line_load.values[0])


@pytest.fixture(scope="module")
def rolling_contact():
    case = Case(
        body=HalfSpace(material=STEEL),
        roller=Roller(radius=5e-3, length=0.4e-3, material=STEEL, profile=FullCrown(crown_radius=0.05)),
        max_pressure=1.5e9,
        friction=0.2,
        motion=Rolling(longitudinal_creepage=1e-3),
    )
    return case, choose_grid(case, cells_x=2, cells_y=6, window=2.5)


def test_rolling_wear_by_slip_equals_integral(rolling_contact):
    case, grid = rolling_contact
    result = solve(case, grid, stresses=False)
    worn_result = wear_in(case, K, distance=[100.0], grid=grid)
    wear_rate = float((result.pressure * np.hypot(result.slip_x, result.slip_y)).sum()) * grid.cell_area
    assert float(worn_result.worn_volume[-1]) == pytest.approx(K * wear_rate * 100.0, rel=2e-3)


@pytest.mark.slow
def test_rolling_wear_becomes_uniform(rolling_contact):
    case, grid = rolling_contact
    result = wear_in(case, 1e-14, distance=[10.0, 4e4, 1e5], grid=grid, tolerance=0.05)
    assert float(result.volume_error) < 0.02
    is_loaded = result.line_load.values[0] > 0
    depth = result.wear_depth.values[:, is_loaded]
    # The slip is larger at low line loads, so that the middle wears least initially.
    assert compute_ratio(depth[1]) > 1.1
    assert compute_ratio(depth[3] - depth[2]) < 1.01


def test_worn_profile_has_line_load_of_wear(sharp_roller, worn_result, tmp_path):
    case, grid = sharp_roller
    distance = float(worn_result.distance[6])
    profile = worn_profile(case, worn_result, distance)
    worn_case = Case(body=case.body, roller=Roller(radius=5e-3, length=0.4e-3, profile=profile), max_pressure=1.5e9)
    result = solve(worn_case, grid, stresses=False)
    load = grid.dy * result.pressure.sum("y").values
    assert load == pytest.approx(worn_result.line_load.values[6], abs=1e-3 * load.max())
    path = tmp_path / "worn.nc"
    worn_result.to_netcdf(path)
    with xr.open_dataset(path) as stored_result:
        assert worn_profile(case, stored_result, distance) == profile
        assert stored_result.profile_drop.attrs["units"] == "m"


def test_worn_profile_beyond_body_is_zero():
    body = FiniteLengthSpace(length=0.4e-3, material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=0.5e-3), max_pressure=1.5e9, end_distance=-0.05e-3)
    grid = choose_grid(case, cells_x=3, cells_y=8)
    result = wear_in(case, K, distance=[1e4], grid=grid)
    profile = worn_profile(case, result)
    drop = profile.drop(np.array([-0.24e-3, 0.0, 0.24e-3]), 0.5e-3)
    assert drop[[0, 2]].tolist() == [0.0, 0.0]
    assert drop[1] == pytest.approx(result.wear_depth.values[-1, grid.cells_x // 2], rel=0.01)


@pytest.mark.slow
def test_gap_of_worn_profile_contains_mean_depths():
    case = create_case(profile=FullCrown(crown_radius=0.05))
    result = wear_in(case, K, distance=[1e3])
    edges = np.append(result.x_bounds.values[:, 0], result.x_bounds.values[-1, 1])
    grid = Grid.from_edges(edges, (float(result.y[0]), float(result.y[-1])), result.sizes["y"])
    worn_case = Case(
        body=case.body,
        roller=Roller(radius=5e-3, length=0.4e-3, profile=worn_profile(case, result)),
        max_pressure=1.5e9,
    )
    expected_gap = (case.gap(grid) + result.wear_depth.values[-1][:, None])[:, 0]
    is_loaded = np.isfinite(expected_gap)
    assert worn_case.gap(grid)[is_loaded, 0] == pytest.approx(
        expected_gap[is_loaded], abs=1e-5 * result.wear_depth.values.max()
    )


def test_worn_profile_of_infinite_end_drop_is_sum():
    profile = Lundberg(amplitude=0.2e-6)
    assert np.isinf(profile.drop(np.array([0.2e-3]), 0.4e-3)).all()
    case = create_case(profile=profile)
    result = wear_in(case, K, distance=[1e4], grid=choose_grid(case, cells_x=3, cells_y=8))
    sum_profile = worn_profile(case, result)
    assert sum_profile.terms[0] is profile
    assert np.isfinite(sum_profile.terms[1].drop(np.array([-0.2e-3, 0.2e-3]), 0.4e-3)).all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"coefficient": -1e-17}, "coefficient"),
        ({"coefficient": float("nan")}, "coefficient"),
        ({"coefficient": 1e-9}, "mean worn depth"),
        ({"distance": [2.0, 1.0]}, "distance"),
        ({"distance": -1.0}, "distance"),
        ({"distance": 0.0}, "distance"),
        ({"law": "archard"}, "law"),
        ({"law": "work"}, "friction"),
        ({"circumference": 0.0}, "circumference"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"tolerance": 1e-7}, "tolerance"),
        ({"max_steps": 0}, "max_steps"),
        ({"after": xr.Dataset()}, "after"),
        ({"grid": "fine"}, "grid"),
    ],
)
def test_invalid_argument_raises(sharp_roller, changes, message):
    case, grid = sharp_roller
    arguments = {"coefficient": K, "distance": 1e3, "grid": grid} | changes
    with pytest.raises(InvalidInputError, match=message):
        wear_in(case, arguments.pop("coefficient"), distance=arguments.pop("distance"), **arguments)


def test_invalid_case_or_continuation_raises(sharp_roller, worn_result, rolling_contact):
    case, grid = sharp_roller
    with pytest.raises(InvalidInputError, match=r"case\.motion"):
        wear_in(Case(body=case.body, roller=case.roller, max_pressure=1e9, motion=Shift(y=1e-6)), K, distance=1.0)
    coupled_case = Case(
        body=case.body, roller=case.roller, max_pressure=1e9, motion=Rolling(), coupled=True, friction=0.1
    )
    with pytest.raises(InvalidInputError, match=r"case\.coupled"):
        wear_in(coupled_case, K, distance=1.0)
    with pytest.raises(InvalidInputError, match="grid"):
        wear_in(case, K, distance=2e5, after=worn_result, grid=grid)
    with pytest.raises(InvalidInputError, match="where the wear begins"):
        wear_in(case, K, distance=1e4, after=worn_result)
    with pytest.raises(InvalidInputError, match=r"distance = 0\.5"):
        worn_profile(case, worn_result, 0.5)
    with pytest.raises(InvalidInputError, match="wear_depth"):
        worn_profile(case, xr.Dataset())


def test_wear_continues_under_another_load(sharp_roller, worn_result):
    case, _ = sharp_roller
    light_case = replace(case, max_pressure=None, load=0.5 * case.normal_load)
    distances = xr.DataArray([100.0, 150.0], dims="way", attrs={"units": "km"})
    result = wear_in(light_case, K, distance=distances, after=worn_result)
    assert result.distance.values.tolist() == [1e5, 1.5e5]
    added_volume = result.worn_volume[-1] - result.worn_volume[0]
    assert float(added_volume) == pytest.approx(K * light_case.normal_load * 5e4, rel=1e-6)
    smaller_case = replace(case, roller=replace(case.roller, radius=4e-3))
    with pytest.raises(InvalidInputError, match=r"after = 'solved with roller.radius = 0.005'"):
        wear_in(smaller_case, K, distance=2e5, after=worn_result)
    with pytest.raises(InvalidInputError, match=r"worn = 'solved with end_distance = 0.0001'"):
        worn_profile(replace(case, end_distance=0.0), worn_result)


def test_worn_profile_is_finite_at_both_ends():
    """75 cells on 0.6 mm have midpoints at the ends of the roller."""
    case = create_case()
    worn_result = wear_in(
        case,
        K,
        distance=[0.0, 1e3],
        grid=Grid(x_range=(0.0, 0.6e-3), y_range=(-0.13e-3, 0.13e-3), cells_x=75, cells_y=16),
    )
    is_loaded = (worn_result.pressure > 0).any(("distance", "y"))
    assert np.isfinite(worn_result.profile_drop.isel(distance=-1)).where(is_loaded, True).all()
    np.testing.assert_array_equal(np.isfinite(worn_result.profile_drop), np.isfinite(worn_result.profile_drop)[:, ::-1])


@pytest.mark.slow
def test_wear_by_slip_equals_wear_by_work() -> None:
    """A slipping cell carries ``f p``, so wear by slip equals wear by work over f."""
    friction = 0.2
    body = FiniteLengthSpace(length=0.6e-3, material=Material(210e9, 0.3))
    roller = Roller(radius=5e-3, length=0.5e-3, profile=Cylinder(fillet_radius=0.1e-3))
    frictionless_case = Case(body=body, roller=roller, max_pressure=1.5e9)
    creepage = 0.1 * friction * frictionless_case.hertz_half_width / 5e-3
    case = replace(frictionless_case, friction=friction, motion=Rolling(longitudinal_creepage=creepage))
    slip_result, work_result = (
        float(wear_in(case, coefficient, distance=[0.0, 10.0], law=law).worn_volume[-1])
        for law, coefficient in (("slip", 1e-17), ("work", 1e-17 / friction))
    )
    assert slip_result == pytest.approx(work_result, rel=1e-3)


@pytest.mark.slow
def test_rolling_window_widens_until_it_contains_the_contact():
    """The contact of a crowned roller at a low load is wider than the first window."""
    roller = Roller(radius=5e-3, length=0.3e-3, profile=Ellipsoid(crown_radius=3e-3))
    motion = Rolling(longitudinal_creepage=1e-3)
    case = Case(body=HalfSpace(material=STEEL), roller=roller, load=1.0, friction=0.3, motion=motion)
    with pytest.raises(WindowError):
        wear_in(case, K, distance=1.0, grid=choose_grid(case))
    worn_result = wear_in(case, K, distance=1.0)
    assert bool(worn_result.converged)
    assert float(worn_result.line_load.isel(distance=-1).sum() * worn_result.x.diff("x")[0]) == pytest.approx(
        1.0, rel=1e-6
    )
