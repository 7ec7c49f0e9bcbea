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


def set_speeds(case, body_speed, roller_speed):
    return replace(case, motion=Sliding(body_speed=body_speed, roller_speed=roller_speed))


@pytest.fixture(scope="module")
def fast_result(line_case, create_line_result, steel):
    return flash_temperature(replace(line_case, motion=FAST), create_line_result(), body=steel, roller=steel)


def test_fast_line_contact_agrees_with_blok(fast_result, line_case, steel):
    a, heat = line_case.hertz_half_width, 0.05 * 1.5e9 * 1.0
    blok_rise = 0.5 * heat * np.sqrt(steel.diffusivity * a / (np.pi * 199.5)) / steel.conductivity * 2.18829
    assert float(fast_result.max_temperature_rise) == pytest.approx(blok_rise, rel=5e-3)
    assert float(fast_result.max_temperature_rise_y) / a == pytest.approx(-0.65, abs=0.02)
    # the temperature is uniform along the length: the ends are insulated
    assert np.ptp(fast_result.temperature_rise.values, axis=0).max() < 1e-6 * blok_rise


def test_surface_temperatures_are_equal_in_the_contact(fast_result, create_line_result):
    in_contact = create_line_result().pressure > 0
    mismatch = abs(fast_result.temperature_rise - fast_result.roller_temperature_rise).where(in_contact).max()
    assert float(mismatch) < 1e-6 * float(fast_result.max_temperature_rise)
    assert float(fast_result.temperature_mismatch) < 1e-6


def test_heat_equals_friction_power(fast_result, create_line_result):
    assert fast_result.frictional_heat.values == pytest.approx(create_line_result().traction_y.values)
    load = 0.5 * np.pi * 1.5e9 * 65e-6 * 1e-3
    assert float(fast_result.friction_power) == pytest.approx(0.05 * load, rel=1e-3)
    assert abs(float(fast_result.heat_error)) < 1e-9


def test_body_of_fourfold_speed_receives_two_thirds_of_heat(line_case, create_line_result, steel):
    result = flash_temperature(set_speeds(line_case, -400.0, -100.0), create_line_result(), body=steel, roller=steel)
    assert float(result.body_heat_share) == pytest.approx(2 / 3, rel=5e-3)
    inner_partition = result.heat_partition.where(abs(result.y) < 0.9 * 65e-6)
    assert float(abs(inner_partition - 2 / 3).max()) < 0.01


def test_opposite_equal_speeds_halve_the_heat(line_case, create_line_result, steel):
    result = flash_temperature(set_speeds(line_case, -1.0, 1.0), create_line_result(), body=steel, roller=steel)
    assert float(result.body_heat_share) == pytest.approx(0.5, rel=1e-9)
    assert result.temperature_rise.values == pytest.approx(result.roller_temperature_rise.values[:, ::-1], rel=1e-6)


def test_graded_columns_leave_the_maximum_unchanged(fast_result, line_case, create_line_result, steel):
    graded_grid = Grid.from_edges(1e-3 * np.array([0, 0.01, 0.04, 0.1, 0.3, 0.7, 1.0]), (-130e-6, 130e-6), 128)
    result = flash_temperature(
        replace(line_case, motion=FAST), create_line_result(graded_grid), body=steel, roller=steel
    )
    assert float(result.max_temperature_rise) == pytest.approx(float(fast_result.max_temperature_rise), rel=1e-7)


def test_stated_partition_needs_no_roller_properties(fast_result, line_case, create_line_result, steel):
    result = flash_temperature(replace(line_case, motion=FAST), create_line_result(), body=steel, partition=0.5)
    assert float(result.max_temperature_rise) == pytest.approx(float(fast_result.max_temperature_rise), rel=5e-3)
    assert "roller_temperature_rise" not in result
    assert float(result.body_heat_share) == 0.5


def test_temperature_decreases_with_depth(fast_result, line_case, create_line_result, steel):
    depths = [0.0, 1e-6, 5e-6, 1e-3]
    result = flash_temperature(
        replace(line_case, motion=FAST), create_line_result(), body=steel, roller=steel, z=depths
    )
    assert result.body_temperature_rise.isel(z=0).values == pytest.approx(fast_result.temperature_rise.values)
    max_rises = result.body_temperature_rise.max(("x", "y")).values
    assert (np.diff(max_rises) < 0).all()
    assert max_rises[-1] < 1e-6 * max_rises[0]


def test_roller_ending_within_a_cell_heats_symmetrically(line_case, steel):
    body = FiniteLengthSpace(length=1.2e-3, material=line_case.body.material)
    case = Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9, friction=0.05)
    grid = Grid(x_range=(0.0, 1.2e-3), y_range=(-2.4 * 65e-6, 2.4 * 65e-6), cells_x=150, cells_y=48)
    assert np.isclose(grid.x, 1e-4, rtol=1e-9).any()
    result = solve(case, grid, stresses=False)
    flash_result = flash_temperature(set_speeds(case, -10.0, -9.0), result, body=steel, roller=steel)
    column_maxima = flash_result.temperature_rise.max("y").values
    assert abs(float(flash_result.heat_error)) < 1e-9
    assert column_maxima == pytest.approx(column_maxima[::-1], rel=1e-3)


def test_roller_ends_on_a_quarter_space_are_insulated(steel):
    case = Case(
        body=QuarterSpace(material=Material(210e9, 0.3)),
        roller=Roller(radius=5e-3, length=0.3e-3),
        max_pressure=1.5e9,
        friction=0.05,
    )
    result = solve(case, choose_grid(case, cells_x=6, cells_y=12), stresses=False)
    flash_result = flash_temperature(set_speeds(case, -1.0, -0.5), result, body=steel, roller=steel)
    outside_roller = flash_result.x > 0.3e-3
    assert float(flash_result.roller_temperature_rise.where(outside_roller).max()) == 0.0
    assert float(flash_result.temperature_rise.where(outside_roller).max()) > 0.0
    assert abs(float(flash_result.heat_error)) < 1e-9
    assert float(flash_result.temperature_mismatch) < 1e-6


@pytest.fixture(scope="module")
def rolling_result(line_case):
    case = Case(
        body=line_case.body,
        roller=Roller(radius=5e-3, length=1e-3, material=line_case.body.material),
        max_pressure=1.5e9,
        friction=0.1,
        motion=Rolling(longitudinal_creepage=1e-3, speed=20.0),
    )
    return case, solve(case, choose_grid(case, cells_x=2, cells_y=12, window=1.6), stresses=False)


def test_rolling_heats_the_slip_zone(rolling_result, steel):
    case, result = rolling_result
    flash_result = flash_temperature(case, result, body=steel, roller=steel)
    is_sticking = result.stick.astype(bool) & (result.pressure > 0)
    assert bool(is_sticking.any())
    assert float(flash_result.frictional_heat.where(is_sticking).max()) < 1e-6 * float(
        flash_result.frictional_heat.max()
    )
    assert float(flash_result.friction_power) == pytest.approx(20.0 * float(result.friction_work))
    assert abs(float(flash_result.heat_error)) < 1e-6
    # the contact moves along +y over both surfaces: slip and wake are behind it
    assert float(flash_result.max_temperature_rise_y) < 0


def test_temperature_above_the_limit_warns(line_case, create_line_result, steel):
    line_case, arguments = replace(line_case, motion=FAST), {"body": steel, "roller": steel}
    with pytest.warns(TemperatureWarning, match="limit = 1 K"):
        flash_temperature(line_case, create_line_result(), limit=1.0, **arguments)
    flash_temperature(line_case, create_line_result(), limit=1000.0, **arguments)


@pytest.mark.parametrize(
    ("changes", "message"),
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
def test_invalid_argument_raises(line_case, create_line_result, steel, changes, message):
    arguments = {"body": steel, "roller": steel, "motion": FAST} | changes
    line_case = replace(line_case, motion=arguments.pop("motion"))
    with pytest.raises(InvalidInputError, match=message):
        flash_temperature(line_case, create_line_result(), **arguments)


def test_invalid_speed_or_motion_raises(rolling_result, line_case, create_line_result, steel):
    case, result = rolling_result
    with pytest.raises(InvalidInputError, match="speed"):
        flash_temperature(replace(case, motion=replace(case.motion, speed=None)), result, body=steel, roller=steel)
    with pytest.raises(InvalidInputError, match=r"speed = 0\.0"):
        Rolling(speed=0.0)
    shifted_case = Case(body=case.body, roller=case.roller, max_pressure=1.5e9, friction=0.1, motion=Shift(y=1e-6))
    with pytest.raises(InvalidInputError, match=r"case\.motion"):
        flash_temperature(shifted_case, result, body=steel, roller=steel)
    with pytest.raises(InvalidInputError, match="slip"):
        flash_temperature(case, create_line_result(), body=steel, roller=steel)


def test_stated_error_covers_finer_cells(line_case, create_line_result, steel):
    coarse_contact, fine_contact = (
        create_line_result(Grid(x_range=(0.0, 1e-3), y_range=(-1.3e-4, 1.3e-4), cells_x=4, cells_y=cells))
        for cells in (20, 160)
    )
    peak = {"peak_pressure": 1.5e9, "peak_pressure_error": 1.5e6}
    line_case = set_speeds(line_case, -10.0, -9.0)
    result, fine_result = (
        flash_temperature(line_case, contact.assign(peak), body=steel, roller=steel)
        for contact in (coarse_contact, fine_contact)
    )
    difference = abs(float(result.max_temperature_rise - fine_result.max_temperature_rise))
    assert difference < float(result.max_temperature_rise_error) < 0.1 * float(result.max_temperature_rise)
    assert float(fine_result.max_temperature_rise_error) < 0.3 * float(result.max_temperature_rise_error)
    for peak_values in ({}, {"peak_pressure": np.inf, "peak_pressure_error": np.inf}):
        open_end = flash_temperature(line_case, coarse_contact.assign(peak_values), body=steel, roller=steel)
        assert np.isnan(float(open_end.max_temperature_rise_error))


def test_equal_speeds_cause_no_heat(line_case, create_line_result, steel):
    result = flash_temperature(set_speeds(line_case, -2.0, -2.0), create_line_result(), body=steel, roller=steel)
    assert float(result.max_temperature_rise) == float(result.friction_power) == 0.0
    assert np.isnan(result.body_heat_share)


def test_result_of_another_case_is_rejected(rolling_result, steel):
    case, result = rolling_result
    other_case = replace(case, friction=2 * case.friction)
    with pytest.raises(InvalidInputError, match="result = 'solved with friction"):
        flash_temperature(other_case, result, body=steel, roller=steel)
