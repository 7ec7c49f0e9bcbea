import numpy as np
import pytest

from contactstudy import InvalidInputError
from contactstudy.arrays.grid import Grid
from contactstudy.heat.moving_source import MovingBody, SourceOperator
from contactstudy.verification import closed_forms
from contactstudy.verification.tribology import heat_carried_away

EVERYWHERE = -np.inf, np.inf


def rise(unit, grid, heat, *, speed, ends, depth=0.0):
    return SourceOperator(MovingBody(unit, speed, ends), grid, slice(0, grid.cells_x), depth)(heat)


@pytest.mark.parametrize("drift", [0.01, 0.3, -0.3, 5.0, -100.0])
@pytest.mark.parametrize(
    "grid",
    [
        Grid(x_range=(0, 8), y_range=(-2, 2), cells_x=5, cells_y=64),
        Grid.from_edges([0, 0.1, 0.4, 1, 2, 4, 7, 8], (-2, 2), 64),
    ],
    ids=["uniform", "graded"],
)
def test_moving_band_is_jaegers(unit, grid, drift):
    band = np.broadcast_to(1.0 * (np.abs(grid.y) < 1), grid.shape)
    found = rise(unit, grid, band, speed=2 * drift, ends=(0.0, 8.0))
    exact = closed_forms.moving_band(np.sign(drift) * grid.y, abs(drift))
    assert found == pytest.approx(np.broadcast_to(exact, grid.shape), abs=2e-6 * exact.max())


def test_uniform_square_at_rest(unit):
    grid = Grid(x_range=(-1.5, 1.5), y_range=(-1.5, 1.5), cells_x=45, cells_y=45)
    square = 1.0 * (np.abs(grid.x)[:, None] < 0.5) * (np.abs(grid.y) < 0.5)
    found = rise(unit, grid, square, speed=0.0, ends=EVERYWHERE)
    # Carslaw and Jaeger, 10.5: 2 l asinh(1) / (pi lambda) in the middle of a square of side 2 l
    assert found[22, 22] == pytest.approx(2 * np.arcsinh(1.0) / np.pi, rel=1e-6)


def test_hertzian_circle_at_rest(unit):
    grid = Grid(x_range=(-1.2, 1.2), y_range=(-1.2, 1.2), cells_x=61, cells_y=61)
    heat = np.sqrt(np.maximum(1 - grid.x[:, None] ** 2 - grid.y**2, 0))
    found = rise(unit, grid, heat, speed=0.0, ends=EVERYWHERE)
    assert found[30, 30] == pytest.approx(np.pi / 4, rel=2e-3)


def test_no_wake_comes_round_the_window(unit):
    narrow, wide = (
        Grid(x_range=(-2, 2), y_range=(-2, 2), cells_x=16, cells_y=16),
        Grid(x_range=(-2, 2), y_range=(-8, 8), cells_x=16, cells_y=64),
    )
    heat = np.exp(-(narrow.x[:, None] ** 2) - 4 * narrow.y**2)
    outside = np.pad(heat, ((0, 0), (24, 24)))
    for speed in (0.0, 0.5):
        found, more = (rise(unit, *given, speed=speed, ends=EVERYWHERE) for given in ((narrow, heat), (wide, outside)))
        assert found == pytest.approx(more[:, 24:40], rel=1e-6)


@pytest.mark.parametrize("speed", [0.0, 3.0])
@pytest.mark.parametrize("graded", [False, True])
def test_an_insulated_end_doubles_what_is_symmetric(unit, speed, graded):
    edges = np.array([0, 0.2, 0.5, 1.0, 1.7]) if graded else np.linspace(0, 1.7, 5)
    half = Grid.from_edges(edges, (-1, 1), 20)
    whole = Grid.from_edges(np.concatenate([-edges[:0:-1], edges]), (-1, 1), 20)
    heat = np.array([3.0, 2.0, 1.5, 1.0])[:, None] * (np.abs(half.y) < 0.5)
    at_end = rise(unit, half, heat, speed=speed, ends=(0.0, np.inf))
    doubled = rise(unit, whole, np.concatenate([heat[::-1], heat]), speed=speed, ends=EVERYWHERE)
    assert at_end == pytest.approx(doubled[4:], rel=1e-10)


@pytest.mark.parametrize("graded", [False, True])
def test_two_ends_are_a_row_of_images(unit, graded):
    edges = np.array([0.0, 0.4, 1.0, 1.6, 2.0]) if graded else np.linspace(0, 2.0, 5)
    between = Grid.from_edges(edges, (-1, 1), 20)
    heat = np.array([4.0, 0.0, 0.0, 1.0])[:, None] * (np.abs(between.y) < 0.5)
    period = np.concatenate([-edges[:0:-1], edges])
    turns = range(-5, 6)
    row = Grid.between(
        np.concatenate([[period[0] + 4.0 * turns[0]], *[period[1:] + 4.0 * n for n in turns]]), (-1, 1), 20
    )
    images = np.tile(np.concatenate([heat[::-1], heat]), (len(turns), 1))
    expected = rise(unit, row, images, speed=2.0, ends=EVERYWHERE)[44:48]
    assert rise(unit, between, heat, speed=2.0, ends=(0.0, 2.0)) == pytest.approx(expected, rel=1e-6)


def test_uniform_and_graded_columns_agree_wherever_the_ends_are(unit):
    grid = Grid(x_range=(0, 2), y_range=(-1, 1), cells_x=8, cells_y=20)
    # widths equal but for rounding: another operator
    same = Grid.between(np.linspace(0, 2, 9) + 1e-9 * np.sin(np.arange(9)), (-1, 1), 20)
    assert grid.uniform
    assert not same.uniform
    heat = np.cos(grid.x)[:, None] * (np.abs(grid.y) < 0.5)
    for ends in (EVERYWHERE, (-0.3, np.inf), (-0.3, 2.0), (0.0, 3.1)):
        found, other = (rise(unit, cells, heat, speed=-4.0, ends=ends) for cells in (grid, same))
        assert found == pytest.approx(other, rel=1e-7, abs=1e-9)


@pytest.mark.parametrize("speed", [1.0, -4.0])
def test_all_heat_leaves_through_planes_before_and_behind(speed):
    away, power = heat_carried_away(speed)
    assert away == pytest.approx(power, rel=1e-6)


def test_below_the_surface_a_source_at_rest_is_a_point_from_afar(unit):
    grid = Grid(x_range=(-0.1, 0.1), y_range=(-0.1, 0.1), cells_x=3, cells_y=3)
    found = rise(unit, grid, np.ones(grid.shape), speed=0.0, ends=EVERYWHERE, depth=5.0)
    assert found[1, 1] == pytest.approx(0.04 / (2 * np.pi * 5.0), rel=1e-3)


def test_between_two_ends_a_surface_at_rest_has_no_steady_temperature(unit):
    grid = Grid(x_range=(0, 1), y_range=(-1, 1), cells_x=4, cells_y=4)
    with pytest.raises(InvalidInputError, match="hotter without limit"):
        SourceOperator(MovingBody(unit, 0.0, (0.0, 1.0)), grid, slice(0, 4))
