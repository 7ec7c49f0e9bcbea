from dataclasses import replace

import numpy as np
import pytest

from contactstudy import (
    Case,
    FiniteLengthSpace,
    InvalidInputError,
    Material,
    QuarterSpace,
    Roller,
    Rolling,
    Shift,
    Sliding,
    TemperatureWarning,
    choose_grid,
    solve,
)
from contactstudy.arrays.grid import Grid
from contactstudy.heat import flash_temperature

FAST = Sliding(body_speed=-200.0, roller_speed=-199.0)


def moved(case, body_speed, roller_speed):
    return replace(case, motion=Sliding(body_speed=body_speed, roller_speed=roller_speed))


@pytest.fixture(scope="module")
def hot(line_case, on_line, steel):
    return flash_temperature(replace(line_case, motion=FAST), on_line(), body=steel, roller=steel)


def test_fast_line_contact_is_bloks(hot, line_case, steel):
    a, heat = line_case.hertz_half_width, 0.05 * 1.5e9 * 1.0
    blok = 0.5 * heat * np.sqrt(steel.diffusivity * a / (np.pi * 199.5)) / steel.conductivity * 2.18829
    assert float(hot.max_temperature_rise) == pytest.approx(blok, rel=5e-3)
    assert float(hot.max_temperature_rise_y) / a == pytest.approx(-0.65, abs=0.02)
    # the same along the whole length: the ends are insulated
    assert np.ptp(hot.temperature_rise.values, axis=0).max() < 1e-6 * blok


def test_surfaces_are_equally_hot_where_they_touch(hot, on_line):
    touching = on_line().pressure > 0
    apart = abs(hot.temperature_rise - hot.roller_temperature_rise).where(touching).max()
    assert float(apart) < 1e-6 * float(hot.max_temperature_rise)
    assert float(hot.temperature_mismatch) < 1e-6


def test_heat_is_friction_times_speed_and_none_is_lost(hot, on_line):
    assert hot.frictional_heat.values == pytest.approx(on_line().traction_y.values)
    load = 0.5 * np.pi * 1.5e9 * 65e-6 * 1e-3
    assert float(hot.friction_power) == pytest.approx(0.05 * load, rel=1e-3)
    assert abs(float(hot.heat_error)) < 1e-9


def test_a_body_four_times_as_fast_takes_two_thirds(line_case, on_line, steel):
    found = flash_temperature(moved(line_case, -400.0, -100.0), on_line(), body=steel, roller=steel)
    assert float(found.body_heat_share) == pytest.approx(2 / 3, rel=5e-3)
    inner = found.heat_partition.where(abs(found.y) < 0.9 * 65e-6)
    assert float(abs(inner - 2 / 3).max()) < 0.01


def test_bodies_that_move_against_each_other_share_in_halves(line_case, on_line, steel):
    found = flash_temperature(moved(line_case, -1.0, 1.0), on_line(), body=steel, roller=steel)
    assert float(found.body_heat_share) == pytest.approx(0.5, rel=1e-9)
    assert found.temperature_rise.values == pytest.approx(found.roller_temperature_rise.values[:, ::-1], rel=1e-6)


def test_graded_columns_change_nothing(hot, line_case, on_line, steel):
    graded = Grid.from_edges(1e-3 * np.array([0, 0.01, 0.04, 0.1, 0.3, 0.7, 1.0]), (-130e-6, 130e-6), 128)
    found = flash_temperature(replace(line_case, motion=FAST), on_line(graded), body=steel, roller=steel)
    assert float(found.max_temperature_rise) == pytest.approx(float(hot.max_temperature_rise), rel=1e-7)


def test_a_stated_part_needs_no_properties_of_the_roller(hot, line_case, on_line, steel):
    found = flash_temperature(replace(line_case, motion=FAST), on_line(), body=steel, partition=0.5)
    assert float(found.max_temperature_rise) == pytest.approx(float(hot.max_temperature_rise), rel=5e-3)
    assert "roller_temperature_rise" not in found
    assert float(found.body_heat_share) == 0.5


def test_temperature_falls_with_the_depth(hot, line_case, on_line, steel):
    depths = [0.0, 1e-6, 5e-6, 1e-3]
    found = flash_temperature(replace(line_case, motion=FAST), on_line(), body=steel, roller=steel, z=depths)
    assert found.body_temperature_rise.isel(z=0).values == pytest.approx(hot.temperature_rise.values)
    below = found.body_temperature_rise.max(("x", "y")).values
    assert (np.diff(below) < 0).all()
    assert below[-1] < 1e-6 * below[0]


def test_a_roller_that_ends_in_the_middle_of_a_cell_heats_both_its_ends_alike(line_case, steel):
    body = FiniteLengthSpace(length=1.2e-3, material=line_case.body.material)
    case = Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9, friction=0.05)
    grid = Grid(x_range=(0.0, 1.2e-3), y_range=(-2.4 * 65e-6, 2.4 * 65e-6), cells_x=150, cells_y=48)
    assert np.isclose(grid.x, 1e-4, rtol=1e-9).any()
    result = solve(case, grid, stresses=False)
    found = flash_temperature(moved(case, -10.0, -9.0), result, body=steel, roller=steel)
    hottest = found.temperature_rise.max("y").values
    assert abs(float(found.heat_error)) < 1e-9
    assert hottest == pytest.approx(hottest[::-1], rel=1e-3)


def test_a_long_roller_on_a_quarter_space_is_insulated_at_both_its_ends(steel):
    case = Case(
        body=QuarterSpace(material=Material(210e9, 0.3)),
        roller=Roller(radius=5e-3, length=0.3e-3),
        max_pressure=1.5e9,
        friction=0.05,
    )
    result = solve(case, choose_grid(case, cells_x=6, cells_y=12), stresses=False)
    found = flash_temperature(moved(case, -1.0, -0.5), result, body=steel, roller=steel)
    beyond = found.x > 0.3e-3
    assert float(found.roller_temperature_rise.where(beyond).max()) == 0.0
    assert float(found.temperature_rise.where(beyond).max()) > 0.0
    assert abs(float(found.heat_error)) < 1e-9
    assert float(found.temperature_mismatch) < 1e-6


@pytest.fixture(scope="module")
def rolled(line_case):
    case = Case(
        body=line_case.body,
        roller=Roller(radius=5e-3, length=1e-3, material=line_case.body.material),
        max_pressure=1.5e9,
        friction=0.1,
        motion=Rolling(longitudinal_creepage=1e-3, speed=20.0),
    )
    return case, solve(case, choose_grid(case, cells_x=2, cells_y=12, window=1.6), stresses=False)


def test_rolling_heats_where_it_slips(rolled, steel):
    case, result = rolled
    found = flash_temperature(case, result, body=steel, roller=steel)
    sticks = result.stick.astype(bool) & (result.pressure > 0)
    assert bool(sticks.any())
    assert float(found.frictional_heat.where(sticks).max()) < 1e-6 * float(found.frictional_heat.max())
    assert float(found.friction_power) == pytest.approx(20.0 * float(result.friction_work))
    assert abs(float(found.heat_error)) < 1e-6
    # the contact moves along +y over both surfaces: slip and wake are behind it
    assert float(found.max_temperature_rise_y) < 0


def test_a_limit_that_is_passed_gives_a_warning(line_case, on_line, steel):
    line_case, arguments = replace(line_case, motion=FAST), {"body": steel, "roller": steel}
    with pytest.warns(TemperatureWarning, match="limit = 1 K"):
        flash_temperature(line_case, on_line(), limit=1.0, **arguments)
    flash_temperature(line_case, on_line(), limit=1000.0, **arguments)


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"roller": None}, "roller"),
        ({"body": None}, "body"),
        ({"motion": Sliding()}, "body_speed"),
        ({"motion": Sliding(body_speed=-200.0, roller_speed=-300.0)}, "roller_speed"),
        ({"partition": 1.5}, "partition"),
        ({"partition": -0.1}, "partition"),
        ({"z": [-1e-6]}, "z = "),
        ({"limit": 0.0}, "limit"),
        ({"motion": Sliding(body_speed=0.0, roller_speed=1.0)}, "speed"),
    ],
)
def test_bad_input(line_case, on_line, steel, changes, named):
    arguments = {"body": steel, "roller": steel, "motion": FAST} | changes
    line_case = replace(line_case, motion=arguments.pop("motion"))
    with pytest.raises(InvalidInputError, match=named):
        flash_temperature(line_case, on_line(), **arguments)


def test_bad_speeds_and_motions_in_rolling(rolled, line_case, on_line, steel):
    case, result = rolled
    with pytest.raises(InvalidInputError, match="speed"):
        flash_temperature(replace(case, motion=replace(case.motion, speed=None)), result, body=steel, roller=steel)
    with pytest.raises(InvalidInputError, match=r"speed = 0\.0"):
        Rolling(speed=0.0)
    shifted = Case(body=case.body, roller=case.roller, max_pressure=1.5e9, friction=0.1, motion=Shift(y=1e-6))
    with pytest.raises(InvalidInputError, match=r"case\.motion"):
        flash_temperature(shifted, result, body=steel, roller=steel)
    with pytest.raises(InvalidInputError, match="slip"):
        flash_temperature(case, on_line(), body=steel, roller=steel)


def test_the_stated_error_covers_finer_cells_and_a_singular_end_has_none(line_case, on_line, steel):
    coarse, fine = (
        on_line(Grid(x_range=(0.0, 1e-3), y_range=(-1.3e-4, 1.3e-4), cells_x=4, cells_y=cells)) for cells in (20, 160)
    )
    known = {"peak_pressure": 1.5e9, "peak_pressure_error": 1.5e6}
    line_case = moved(line_case, -10.0, -9.0)
    found, settled = (
        flash_temperature(line_case, each.assign(known), body=steel, roller=steel) for each in (coarse, fine)
    )
    difference = abs(float(found.max_temperature_rise - settled.max_temperature_rise))
    assert difference < float(found.max_temperature_rise_error) < 0.1 * float(found.max_temperature_rise)
    assert float(settled.max_temperature_rise_error) < 0.3 * float(found.max_temperature_rise_error)
    for unknown in ({}, {"peak_pressure": np.inf, "peak_pressure_error": np.inf}):
        open_end = flash_temperature(line_case, coarse.assign(unknown), body=steel, roller=steel)
        assert np.isnan(float(open_end.max_temperature_rise_error))


def test_surfaces_of_one_speed_make_no_heat(line_case, on_line, steel):
    found = flash_temperature(moved(line_case, -2.0, -2.0), on_line(), body=steel, roller=steel)
    assert float(found.max_temperature_rise) == float(found.friction_power) == 0.0
    assert np.isnan(found.body_heat_share)


def test_the_result_has_to_be_of_the_case(rolled, steel):
    case, result = rolled
    other = replace(case, friction=2 * case.friction)
    with pytest.raises(InvalidInputError, match="result = 'solved with friction"):
        flash_temperature(other, result, body=steel, roller=steel)
