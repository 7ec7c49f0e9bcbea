import numpy as np
import pytest

from contactstudy import InvalidInputError
from contactstudy.arrays.grid import Grid
from contactstudy.heat.flash import MovingBody, SourceOperator
from contactstudy.verification import closed_forms
from contactstudy.verification.tribology import compute_heat_flow

NO_ENDS = -np.inf, np.inf


def compute_temperature_rise(unit, grid, heat, *, speed, end_positions, depth=0.0):
    return SourceOperator(MovingBody(unit, speed, end_positions), grid, slice(0, grid.cells_x), depth)(heat)


@pytest.mark.parametrize("drift", [0.01, 0.3, -0.3, 5.0, -100.0])
@pytest.mark.parametrize(
    "grid",
    [
        Grid(x_range=(0, 8), y_range=(-2, 2), cells_x=5, cells_y=64),
        Grid.from_edges([0, 0.1, 0.4, 1, 2, 4, 7, 8], (-2, 2), 64),
    ],
    ids=["uniform", "graded"],
)
def test_moving_band_agrees_with_jaeger(unit, grid, drift):
    band = np.broadcast_to(1.0 * (np.abs(grid.y) < 1), grid.shape)
    computed = compute_temperature_rise(unit, grid, band, speed=2 * drift, end_positions=(0.0, 8.0))
    exact_temperature = closed_forms.moving_band(np.sign(drift) * grid.y, abs(drift))
    assert computed == pytest.approx(np.broadcast_to(exact_temperature, grid.shape), abs=2e-6 * exact_temperature.max())


def test_uniform_square_at_rest_equals_carslaw_and_jaeger(unit):
    grid = Grid(x_range=(-1.5, 1.5), y_range=(-1.5, 1.5), cells_x=45, cells_y=45)
    square = 1.0 * (np.abs(grid.x)[:, None] < 0.5) * (np.abs(grid.y) < 0.5)
    computed = compute_temperature_rise(unit, grid, square, speed=0.0, end_positions=NO_ENDS)
    # Carslaw and Jaeger, 10.5: 2 l asinh(1) / (pi lambda) in the middle of a square of side 2 l
    assert computed[22, 22] == pytest.approx(2 * np.arcsinh(1.0) / np.pi, rel=1e-6)


def test_hertzian_circle_at_rest_equals_closed_form(unit):
    grid = Grid(x_range=(-1.2, 1.2), y_range=(-1.2, 1.2), cells_x=61, cells_y=61)
    heat = np.sqrt(np.maximum(1 - grid.x[:, None] ** 2 - grid.y**2, 0))
    computed = compute_temperature_rise(unit, grid, heat, speed=0.0, end_positions=NO_ENDS)
    assert computed[30, 30] == pytest.approx(np.pi / 4, rel=2e-3)


def test_wake_does_not_return_through_the_window(unit):
    narrow_grid, wide_grid = (
        Grid(x_range=(-2, 2), y_range=(-2, 2), cells_x=16, cells_y=16),
        Grid(x_range=(-2, 2), y_range=(-8, 8), cells_x=16, cells_y=64),
    )
    heat = np.exp(-(narrow_grid.x[:, None] ** 2) - 4 * narrow_grid.y**2)
    wide_heat = np.pad(heat, ((0, 0), (24, 24)))
    for speed in (0.0, 0.5):
        computed, wide_rise = (
            compute_temperature_rise(unit, *arguments, speed=speed, end_positions=NO_ENDS)
            for arguments in ((narrow_grid, heat), (wide_grid, wide_heat))
        )
        assert computed == pytest.approx(wide_rise[:, 24:40], rel=1e-6)


@pytest.mark.parametrize("speed", [0.0, 3.0])
@pytest.mark.parametrize("graded_grid", [False, True])
def test_insulated_end_equals_a_symmetric_source(unit, speed, graded_grid):
    edges = np.array([0, 0.2, 0.5, 1.0, 1.7]) if graded_grid else np.linspace(0, 1.7, 5)
    half_grid = Grid.from_edges(edges, (-1, 1), 20)
    mirrored_grid = Grid.from_edges(np.concatenate([-edges[:0:-1], edges]), (-1, 1), 20)
    heat = np.array([3.0, 2.0, 1.5, 1.0])[:, None] * (np.abs(half_grid.y) < 0.5)
    rise_at_end = compute_temperature_rise(unit, half_grid, heat, speed=speed, end_positions=(0.0, np.inf))
    mirrored_rise = compute_temperature_rise(
        unit, mirrored_grid, np.concatenate([heat[::-1], heat]), speed=speed, end_positions=NO_ENDS
    )
    assert rise_at_end == pytest.approx(mirrored_rise[4:], rel=1e-10)


@pytest.mark.parametrize("graded_grid", [False, True])
def test_two_ends_equal_a_row_of_images(unit, graded_grid):
    edges = np.array([0.0, 0.4, 1.0, 1.6, 2.0]) if graded_grid else np.linspace(0, 2.0, 5)
    section = Grid.from_edges(edges, (-1, 1), 20)
    heat = np.array([4.0, 0.0, 0.0, 1.0])[:, None] * (np.abs(section.y) < 0.5)
    period = np.concatenate([-edges[:0:-1], edges])
    periods = range(-5, 6)
    images_grid = Grid.between(
        np.concatenate(
            [[period[0] + 4.0 * periods[0]], *[period[1:] + 4.0 * period_index for period_index in periods]]
        ),
        (-1, 1),
        20,
    )
    images = np.tile(np.concatenate([heat[::-1], heat]), (len(periods), 1))
    expected = compute_temperature_rise(unit, images_grid, images, speed=2.0, end_positions=NO_ENDS)[44:48]
    assert compute_temperature_rise(unit, section, heat, speed=2.0, end_positions=(0.0, 2.0)) == pytest.approx(
        expected, rel=1e-6
    )


def test_uniform_and_graded_columns_agree(unit):
    grid = Grid(x_range=(0, 2), y_range=(-1, 1), cells_x=8, cells_y=20)
    # the widths differ by rounding, but the operator for graded columns is used
    graded_grid = Grid.between(np.linspace(0, 2, 9) + 1e-9 * np.sin(np.arange(9)), (-1, 1), 20)
    assert grid.uniform
    assert not graded_grid.uniform
    heat = np.cos(grid.x)[:, None] * (np.abs(grid.y) < 0.5)
    for end_positions in (NO_ENDS, (-0.3, np.inf), (-0.3, 2.0), (0.0, 3.1)):
        computed, graded_result = (
            compute_temperature_rise(unit, cells, heat, speed=-4.0, end_positions=end_positions)
            for cells in (grid, graded_grid)
        )
        assert computed == pytest.approx(graded_result, rel=1e-7, abs=1e-9)


@pytest.mark.parametrize("speed", [1.0, -4.0])
def test_heat_leaves_through_front_and_rear_planes(speed):
    convected_heat, power = compute_heat_flow(speed)
    assert convected_heat == pytest.approx(power, rel=1e-6)


def test_distant_resting_source_equals_a_point_source(unit):
    grid = Grid(x_range=(-0.1, 0.1), y_range=(-0.1, 0.1), cells_x=3, cells_y=3)
    computed = compute_temperature_rise(unit, grid, np.ones(grid.shape), speed=0.0, end_positions=NO_ENDS, depth=5.0)
    assert computed[1, 1] == pytest.approx(0.04 / (2 * np.pi * 5.0), rel=1e-3)


def test_resting_surface_between_two_ends_is_rejected(unit):
    grid = Grid(x_range=(0, 1), y_range=(-1, 1), cells_x=4, cells_y=4)
    with pytest.raises(InvalidInputError, match="hotter without limit"):
        SourceOperator(MovingBody(unit, 0.0, (0.0, 1.0)), grid, slice(0, 4))
