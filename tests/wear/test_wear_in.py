from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    ConvergenceWarning,
    FiniteLengthSpace,
    Grid,
    InvalidInputError,
    Material,
    QuarterSpace,
    Roller,
    Rolling,
    Shift,
    choose_grid,
    solve,
)
from contactstudy.profiles import Cylinder, FullCrown, Lundberg
from contactstudy.wear import wear_in, worn_profile

STEEL = Material(210e9, 0.3)
K = 1e-17


def roller_on(length=0.6e-3, *, model="exact", **roller):
    body = FiniteLengthSpace(length=length, material=STEEL, model=model)
    return Case(body=body, roller=Roller(**{"radius": 5e-3, "length": 0.4e-3} | roller), max_pressure=1.5e9)


@pytest.fixture(scope="module")
def sharp():
    """A rigid roller with sharp ends inside the face, and coarse cells."""
    case = roller_on()
    return case, choose_grid(case, cells_x=3, cells_y=8)


@pytest.fixture(scope="module")
def worn(sharp):
    case, grid = sharp
    return wear_in(case, K, distance=1e5, grid=grid)


def spread(line_load):
    under = line_load[line_load > 0]
    return under.max() / under.min()


def test_volume_is_archards_to_rounding(sharp, worn):
    expected = K * sharp[0].normal_load * worn.distance.values
    assert worn.worn_volume.values == pytest.approx(expected, rel=1e-12)
    assert float(worn.volume_error) < 1e-12
    summed = 2 * np.pi * 5e-3 * (worn.wear_depth.sum("x") * sharp[1].dx)
    assert worn.worn_volume.values == pytest.approx(summed.values, rel=1e-12)


def test_constant_slip_makes_the_load_uniform(worn):
    spreads = [spread(state) for state in worn.line_load.values]
    assert spreads[0] > 2
    assert (np.diff(spreads) < 1e-6).all()
    assert spreads[-1] < 1.001


def test_step_sizes(worn):
    assert worn.sizes["distance"] < 30
    assert (np.diff(worn.distance.values)[:-2] > 0).all()
    assert float(worn.next_step[-1]) > 100 * float(worn.next_step[0])


@pytest.mark.slow
def test_wear_error_against_small_steps(sharp):
    case, grid = sharp
    rough, fine = (wear_in(case, K, distance=[5e3], grid=grid, tolerance=tolerance) for tolerance in (0.03, 3e-5))
    off = float(abs(rough.wear_depth - fine.wear_depth).isel(distance=-1).max() / fine.wear_depth.max())
    assert off < 2 * float(rough.wear_error[-1])
    assert off < 0.03
    assert off > 5 * float(fine.wear_error[-1])


def test_uniform_wear():
    case = roller_on(length=0.4e-3, model="mirror")
    grid = choose_grid(case, cells_x=2, cells_y=8)
    found = wear_in(case, K, distance=[0.0, 1e5], grid=grid, circumference=0.01)
    depth = K * case.normal_load / 0.4e-3 * 1e5 / 0.01
    assert found.wear_depth.values[-1] == pytest.approx(depth, rel=1e-6)
    assert found.pressure.values[-1] == pytest.approx(found.pressure.values[0], abs=1e-4 * 1.5e9)


def test_uniform_pressure_between_mirrors():
    case = roller_on(length=0.4e-3, model="mirror", profile=FullCrown(crown_radius=0.05))
    found = wear_in(case, K, distance=[0.0, 1e5], grid=choose_grid(case, cells_x=3, cells_y=8))
    peaks = found.pressure.max("y").values
    assert spread(peaks[0]) > 1.05
    assert spread(peaks[1]) < 1.002


def test_continuation(sharp, worn):
    case, grid = sharp
    with pytest.warns(ConvergenceWarning, match="max_steps = 4"):
        first = wear_in(case, K, distance=1e5, grid=grid, max_steps=4)
    assert first.sizes["distance"] == 5
    second = wear_in(case, K, distance=1e5, after=first)
    assert float(second.distance[0]) == float(first.distance[-1])
    assert second.wear_depth.values[-1] == pytest.approx(worn.wear_depth.values[-1], rel=1e-4)
    assert float(second.volume_error) < 1e-12
    # What was in doubt before is in doubt still.
    assert float(second.wear_error[0]) == pytest.approx(float(first.wear_error[-1]))
    assert float(second.wear_error[-1]) == pytest.approx(float(worn.wear_error[-1]), rel=0.02)


@pytest.mark.slow
def test_load_position_off_the_middle(sharp):
    """The roller then wears askew, and turns with its wear."""
    case, grid = sharp
    off = Case(body=case.body, roller=case.roller, max_pressure=1.5e9, load_position=0.32e-3)
    found = wear_in(off, K, distance=[1e5], grid=grid)
    load, x = found.line_load.values[-1], grid.x
    under = load > 0
    length = grid.dx * under.sum()
    # w = W / L (1 + 12 e x' / L**2)
    lever = 12 * (0.32e-3 - 0.3e-3) * (x[under] - 0.3e-3) / (length**2 - grid.dx**2)
    expected = off.normal_load / length * (1 + lever)
    assert load[under] == pytest.approx(expected, rel=2e-3)
    assert float(found.volume_error) < 1e-9


def test_quarter_space():
    body = QuarterSpace(material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=0.3e-3), max_pressure=1.5e9, end_distance=0.05e-3)
    found = wear_in(case, K, distance=[1e5], grid=choose_grid(case, cells_x=3, cells_y=8))
    assert spread(found.line_load.values[-1]) < 1.001
    assert float(found.volume_error) < 1e-12


@pytest.mark.slow
def test_elastic_roller_with_coupled_friction():
    case = Case(
        body=FiniteLengthSpace(length=0.6e-3, material=STEEL),
        roller=Roller(radius=5e-3, length=0.4e-3, material=STEEL),
        max_pressure=1.5e9,
        friction=0.2,
        coupled=True,
    )
    grid = choose_grid(case, cells_x=2, cells_y=6)
    by_slip, by_work = (wear_in(case, K, distance=[2e3], grid=grid, law=law) for law in ("slip", "work"))
    assert float(by_work.worn_volume[-1]) == pytest.approx(0.2 * float(by_slip.worn_volume[-1]), rel=1e-12)
    assert spread(by_slip.line_load.values[-1]) < spread(by_slip.line_load.values[0])


@pytest.fixture(scope="module")
def rolling():
    body = FiniteLengthSpace(length=0.6e-3, material=STEEL)
    case = Case(
        body=body,
        roller=Roller(radius=5e-3, length=0.4e-3, material=STEEL, profile=FullCrown(crown_radius=0.05)),
        max_pressure=1.5e9,
        friction=0.2,
        motion=Rolling(longitudinal_creepage=1e-3),
    )
    return case, choose_grid(case, cells_x=2, cells_y=6, window=2.5)


def test_rolling_by_slip(rolling):
    case, grid = rolling
    result = solve(case, grid, stresses=False)
    worn = wear_in(case, K, distance=[100.0], grid=grid)
    rate = float((result.pressure * np.hypot(result.slip_x, result.slip_y)).sum()) * grid.cell_area
    assert float(worn.worn_volume[-1]) == pytest.approx(K * rate * 100.0, rel=2e-3)


@pytest.mark.slow
def test_steady_wear_in_rolling(rolling):
    case, grid = rolling
    found = wear_in(case, 1e-14, distance=[10.0, 4e4, 1e5], grid=grid, tolerance=0.05)
    assert float(found.volume_error) < 0.02
    under = found.line_load.values[0] > 0
    depth = found.wear_depth.values[:, under]
    # where the load is low the roller slips more: the middle wears last at first
    assert spread(depth[1]) > 1.1
    assert spread(depth[3] - depth[2]) < 1.01


def test_worn_profile_carries_the_worn_load(sharp, worn, tmp_path):
    case, grid = sharp
    distance = float(worn.distance[6])
    profile = worn_profile(case, worn, distance)
    again = Case(body=case.body, roller=Roller(radius=5e-3, length=0.4e-3, profile=profile), max_pressure=1.5e9)
    found = solve(again, grid, stresses=False)
    load = grid.dy * found.pressure.sum("y").values
    assert load == pytest.approx(worn.line_load.values[6], abs=1e-3 * load.max())
    file = tmp_path / "worn.nc"
    worn.to_netcdf(file)
    with xr.open_dataset(file) as stored:
        assert worn_profile(case, stored, distance) == profile
        assert stored.profile_drop.attrs["units"] == "m"


def test_worn_profile_of_an_overhanging_roller():
    body = FiniteLengthSpace(length=0.4e-3, material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=0.5e-3), max_pressure=1.5e9, end_distance=-0.05e-3)
    grid = choose_grid(case, cells_x=3, cells_y=8)
    found = wear_in(case, K, distance=[1e4], grid=grid)
    profile = worn_profile(case, found)
    drop = profile.drop(np.array([-0.24e-3, 0.0, 0.24e-3]), 0.5e-3)
    assert drop[[0, 2]].tolist() == [0.0, 0.0]
    assert drop[1] == pytest.approx(found.wear_depth.values[-1, grid.cells_x // 2], rel=0.01)


@pytest.mark.slow
def test_mean_depths_on_columns():
    case = roller_on(profile=FullCrown(crown_radius=0.05))
    found = wear_in(case, K, distance=[1e3])
    edges = np.append(found.x_bounds.values[:, 0], found.x_bounds.values[-1, 1])
    grid = Grid.from_edges(edges, (float(found.y[0]), float(found.y[-1])), found.sizes["y"])
    again = Case(
        body=case.body,
        roller=Roller(radius=5e-3, length=0.4e-3, profile=worn_profile(case, found)),
        max_pressure=1.5e9,
    )
    wanted = (case.gap(grid) + found.wear_depth.values[-1][:, None])[:, 0]
    under = np.isfinite(wanted)
    assert again.gap(grid)[under, 0] == pytest.approx(wanted[under], abs=1e-5 * found.wear_depth.values.max())


def test_profile_infinite_at_its_ends():
    profile = Lundberg(amplitude=0.2e-6)
    assert np.isinf(profile.drop(np.array([0.2e-3]), 0.4e-3)).all()
    case = roller_on(profile=profile)
    found = wear_in(case, K, distance=[1e4], grid=choose_grid(case, cells_x=3, cells_y=8))
    taken = worn_profile(case, found)
    assert taken.terms[0] is profile
    assert np.isfinite(taken.terms[1].drop(np.array([-0.2e-3, 0.2e-3]), 0.4e-3)).all()


@pytest.mark.parametrize(
    ("changes", "named"),
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
def test_bad_input(sharp, changes, named):
    case, grid = sharp
    arguments = {"coefficient": K, "distance": 1e3, "grid": grid} | changes
    with pytest.raises(InvalidInputError, match=named):
        wear_in(case, arguments.pop("coefficient"), distance=arguments.pop("distance"), **arguments)


def test_bad_cases_and_states(sharp, worn, rolling):
    case, grid = sharp
    with pytest.raises(InvalidInputError, match=r"case\.motion"):
        wear_in(Case(body=case.body, roller=case.roller, max_pressure=1e9, motion=Shift(y=1e-6)), K, distance=1.0)
    coupled = Case(body=case.body, roller=case.roller, max_pressure=1e9, motion=Rolling(), coupled=True, friction=0.1)
    with pytest.raises(InvalidInputError, match=r"case\.coupled"):
        wear_in(coupled, K, distance=1.0)
    with pytest.raises(InvalidInputError, match="grid"):
        wear_in(case, K, distance=2e5, after=worn, grid=grid)
    with pytest.raises(InvalidInputError, match="where the wear begins"):
        wear_in(case, K, distance=1e4, after=worn)
    with pytest.raises(InvalidInputError, match=r"distance = 0\.5"):
        worn_profile(case, worn, 0.5)
    with pytest.raises(InvalidInputError, match="wear_depth"):
        worn_profile(case, xr.Dataset())


def test_continuation_under_another_load(sharp, worn):
    case, _ = sharp
    lighter = replace(case, max_pressure=None, load=0.5 * case.normal_load)
    further = xr.DataArray([100.0, 150.0], dims="way", attrs={"units": "km"})
    found = wear_in(lighter, K, distance=further, after=worn)
    assert found.distance.values.tolist() == [1e5, 1.5e5]
    gained = found.worn_volume[-1] - found.worn_volume[0]
    assert float(gained) == pytest.approx(K * lighter.normal_load * 5e4, rel=1e-6)
    smaller = replace(case, roller=replace(case.roller, radius=4e-3))
    with pytest.raises(InvalidInputError, match=r"after = 'solved with roller.radius = 0.005'"):
        wear_in(smaller, K, distance=2e5, after=worn)
    with pytest.raises(InvalidInputError, match=r"worn = 'solved with end_distance = 0.0001'"):
        worn_profile(replace(case, end_distance=0.0), worn)


def test_finite_drop_at_both_ends():
    """75 cells on 0.6 mm have middles where the roller begins and ends."""
    case = roller_on()
    worn = wear_in(
        case,
        K,
        distance=[0.0, 1e3],
        grid=Grid(x_range=(0.0, 0.6e-3), y_range=(-0.13e-3, 0.13e-3), cells_x=75, cells_y=16),
    )
    pressed = (worn.pressure > 0).any(("distance", "y"))
    assert np.isfinite(worn.profile_drop.isel(distance=-1)).where(pressed, True).all()
    np.testing.assert_array_equal(np.isfinite(worn.profile_drop), np.isfinite(worn.profile_drop)[:, ::-1])


@pytest.mark.slow
def test_slip_and_work_of_uniform_friction() -> None:
    """A slipping cell carries ``f p``, so wear by slip equals wear by work over f."""
    friction = 0.2
    body = FiniteLengthSpace(length=0.6e-3, material=Material(210e9, 0.3))
    roller = Roller(radius=5e-3, length=0.5e-3, profile=Cylinder(fillet_radius=0.1e-3))
    smooth = Case(body=body, roller=roller, max_pressure=1.5e9)
    creepage = 0.1 * friction * smooth.hertz_half_width / 5e-3
    case = replace(smooth, friction=friction, motion=Rolling(longitudinal_creepage=creepage))
    by_slip, by_work = (
        float(wear_in(case, coefficient, distance=[0.0, 10.0], law=law).worn_volume[-1])
        for law, coefficient in (("slip", 1e-17), ("work", 1e-17 / friction))
    )
    assert by_slip == pytest.approx(by_work, rel=1e-3)
