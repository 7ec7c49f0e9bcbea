"""Which columns a point sees: split around it, wherever the body lies, with all of their force."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Grid
from contactstudy.cache import ArrayKey
from contactstudy.checks import FloatArray
from contactstudy.kernels.column_layers import EvenOffsets, Layer, gathered_far
from contactstudy.kernels.columns_seen import (
    AlongY,
    SeenRequest,
    _Surroundings,
    _surroundings,
    columns_seen,
    common_step,
)
from contactstudy.kernels.fine_cells import FineCells, seen_apart

EDGES = np.array([0.0, 0.1, 0.3, 0.6, 1.0, 1.5, 2.0, 2.4, 2.7, 2.9, 3.0])
UNIT, PRESSURE = 2.0**-17, 2.0**37
PLACES = (0.0, 1e-12, 0.02, 0.05, 0.07, 0.3, 0.4, 0.75, 1.5, 1.7, 2.2, 2.95, 3.0)


def fine(place: float = 0.0, unit: float = 1.0, *, ends: int = 2, image: int = 1, steps: bool = False) -> FineCells:
    """A load that is pressed at both ends, and may end in steps between columns."""
    grid = Grid.between(unit * (EDGES + place), (-unit, unit), 8)
    x, y = grid.x[:, None] / unit - place, grid.y / unit
    cells = np.sqrt(np.maximum(1 - (y / 0.9) ** 2, 0.0)) * (1 + 0.4 * np.sin(2 * x))
    if steps:
        cells = np.where((x > 0.6) & (x < 2.4), cells, 0.0)
    extent = (unit * place if ends else -np.inf, unit * (place + 3.0) if ends == 2 else np.inf)
    return FineCells((PRESSURE if unit < 1 else 1.0) * cells, grid, extent, image)


def around(x: float, own: FineCells, narrow: float = 0.0) -> _Surroundings:
    return _surroundings(x, own, narrow, own._extent)


@pytest.mark.parametrize("x", PLACES)
@pytest.mark.parametrize("narrow", [0.0, 0.15, 5.0])
@pytest.mark.parametrize("steps", [False, True])
def test_neither_unit_nor_place_decides_anything(x: float, narrow: float, *, steps: bool) -> None:
    for ends in (0, 1, 2):
        plain_cells = fine(ends=ends, steps=steps)
        plain = around(x, plain_cells, narrow)
        for place, unit in ((0.0, UNIT), (8.0, 1.0), (-32.0, 1.0)):
            cells = fine(place, unit, ends=ends, steps=steps)
            other = around(unit * (x + place), cells, unit * narrow)
            if x == 1e-12 and place:  # not to be told from 0 there
                continue
            assert (other.lowest, other.highest) == (plain.lowest, plain.highest)
            assert other.inserted / unit - place == pytest.approx(plain.inserted, abs=1e-9)
            factor = PRESSURE if unit < 1 else 1.0
            assert other.received(cells) / factor == pytest.approx(plain.received(plain_cells), abs=1e-9)
            for reach in (0.0, 0.3137, 1.0731, 9.0):
                there = other.within(cells.edges, unit * (x + place), unit * reach)
                assert there == plain.within(plain_cells.edges, x, reach)


@pytest.mark.parametrize("x", PLACES)
@pytest.mark.parametrize("image", [1, -1])
def test_columns_with_those_inserted_carry_all_of_the_force(x: float, image: int) -> None:
    own = fine(image=image)
    each = around(x, own)
    forces = own.gathered * np.diff(own.edges)[:, None]
    inserted = own.columns([each.inserted]) + each.received(own)
    inside = (inserted * np.diff(each.inserted)[:, None]).sum(axis=0)
    outside = forces.sum(axis=0) - forces[each.lowest : each.highest].sum(axis=0)
    assert inside + outside == pytest.approx(forces.sum(axis=0), abs=1e-9)
    assert each.inserted[0] == own.edges[each.lowest]
    assert each.inserted[-1] == own.edges[each.highest]
    assert (np.diff(each.inserted) > 0).all()


@pytest.mark.parametrize("x", [0.02, 0.07, 0.3, 0.4, 0.75, 1.5, 1.7, 2.2, 2.95])
def test_a_point_lies_in_the_middle_of_a_narrow_column_and_two_like_it(x: float) -> None:
    """A quarter as wide as what it lies in; on an edge as the narrower of both."""
    own = fine()
    edges = around(x, own).inserted
    at = int(np.searchsorted(edges, x)) - 1
    assert 0.5 * (edges[at] + edges[at + 1]) == pytest.approx(x)
    widths = np.diff(edges)
    assert widths[at - 1] == pytest.approx(widths[at])
    assert widths[at + 1] == pytest.approx(widths[at])
    split = own.x_edges
    beside = np.flatnonzero((split[:-1] <= x + 1e-12) & (split[1:] >= x - 1e-12))
    assert widths[at] == pytest.approx(0.25 * np.diff(split)[beside].min())
    low, high = seen_apart(own.edges, x)
    assert np.isin(edges[[0, -1]], own.edges[[max(low - 1, 0), min(high + 1, own.edges.size - 1)]]).all()
    left = split[(split > own.edges[low]) & (split < own.edges[high]) & (np.abs(split - x) > 2.1 * widths[at])]
    assert np.isin(left, edges).all()


def test_no_column_around_a_point_reaches_over_a_step_of_the_load() -> None:
    own = fine(steps=True)
    (step,) = own.steps[np.abs(own.steps - 0.6) < 1e-9]
    for distance in (0.001, 0.004, 0.01):
        for x in (step - distance, step + distance):
            edges = around(float(x), own).inserted
            at = int(np.searchsorted(edges, x)) - 1
            assert 0.5 * (edges[at] + edges[at + 1]) == pytest.approx(x)
            assert not edges[at - 1] < step - 1e-12 < step + 1e-12 < edges[at + 2]
    edges = around(float(step), own).inserted  # on the step itself as little as may be
    assert np.diff(edges).min() == pytest.approx(1e-3 * 0.1, rel=0.5)


@pytest.mark.parametrize("narrow", [0.0, 0.02])
def test_a_rounding_before_an_edge_is_as_good_as_the_edge(narrow: float) -> None:
    """Also before the outermost edge of those that are split, where narrow columns follow that are not."""
    edges = np.concatenate([[0.0, 1.0], np.linspace(2.0, 2.1, 11)])
    grid = Grid.between(edges, (-1.0, 1.0), 4)
    own = FineCells(PRESSURE * np.ones(grid.shape), grid, (-np.inf, np.inf), 1)
    on = around(2.0, own, narrow).inserted
    for towards in (-np.inf, np.inf):
        beside = around(float(np.nextafter(2.0, towards)), own, narrow).inserted
        assert np.diff(beside).min() == pytest.approx(np.diff(on).min(), rel=0.6)


def test_a_point_on_an_end_is_not_in_the_middle_of_a_column() -> None:
    """There the mirrored load goes on smoothly, or is reversed; of a body without an end the point is like another."""
    for place in (0.0, 8.0):
        for end in (place, place + 3.0):
            assert np.abs(around(end, fine(place)).inserted - end).min() < 1e-12
        beside = around(place + 1e-3, fine(place)).inserted
        at = int(np.searchsorted(beside, place + 1e-3)) - 1
        assert 0.5 * (beside[at] + beside[at + 1]) == pytest.approx(place + 1e-3)


def test_within_reach_are_columns_up_to_it_the_nearest_and_those_replaced() -> None:
    edges = np.array([0.0, 1.0, 2.0, 4.0, 5.0, 7.0])
    none = _Surroundings(edges[:1], 2, 2)
    assert none.within(edges, 3.0, 0.0) == (2, 3)
    assert none.within(edges, 3.0, 1.5) == (1, 4)
    assert none.within(edges, -3.0, 1.0) == (0, 2)
    assert none.within(edges, 9.0, 2.5) == (2, 5)
    assert _Surroundings(edges[:3], 0, 2).within(edges, 4.5, 0.1) == (0, 4)
    assert _Surroundings(edges[3:], 3, 5).within(edges, 0.5, 0.1) == (0, 5)


@pytest.mark.parametrize("parts", range(1, 9))
def test_distances_between_positions_have_a_common_step_of_up_to_six_parts(parts: int) -> None:
    y = np.array([0.0, 0.1 * parts, 0.1 * parts + 0.1 * (parts + 1)])
    found = common_step(y, 0.25)
    assert found == (pytest.approx(0.1) if parts <= 6 else None)
    assert common_step(y, 0.61) is None or parts == 1  # much shorter than a cell
    assert common_step(y[:1], 0.25) is None


@pytest.mark.parametrize("offset", [0.0, 0.03, 0.1, -0.04, 0.15, 0.35, -0.052, 0.048])
@pytest.mark.parametrize("span", [1.6, 1.55])
def test_points_are_in_the_middle_of_a_layers_cells(offset: float, span: float) -> None:
    places, step, start = np.array([-3, 0, 4, 20]), 0.1, 5.0
    layer = Layer.centred(np.arange(4), places, np.array([0.5]), np.array([0]), offset, start, span, step)
    assert layer.edges is not None
    at = (start + offset + step * places - layer.edges[0]) / step
    assert at == pytest.approx(np.floor(at) + 0.5)
    # All that is loaded, and no more than a cell beyond it.
    assert start - step - 1e-9 < layer.edges[0] <= start + 1e-9
    assert start + span - 1e-9 <= layer.edges[-1] < start + span + step - 1e-9
    assert layer.edges[1:] - layer.edges[:-1] == pytest.approx(step)
    # Distances from every point to every corner are among the offsets.
    count = layer.edges.size
    for place, first in zip(places, layer.at, strict=True):
        distances = np.sort(start + offset + step * place - layer.edges)
        offsets = layer.corners.along_y[layer.corners.index[first : first + count]]
        assert np.sort(offsets) == pytest.approx(np.sort(np.abs(distances)))


def seen(y: FloatArray, parts: int | None) -> list[Layer]:
    grid = Grid((0.0, 1.0), (-0.75, 1.25), 4, 8)
    return AlongY(grid, y, 1, 6).layers(np.array([0.1, 0.2]), np.array([1]), parts)


def test_positions_with_a_common_step_share_cells_and_others_do_not() -> None:
    together = seen(np.array([-0.1, 0.0, 0.3]), 5)
    assert len(together) == 1
    (layer,) = together
    assert layer.edges is not None
    for y in (-0.1, 0.0, 0.3):
        at = (y - layer.edges[0]) / np.diff(layer.edges)[0]
        assert at == pytest.approx(np.floor(at) + 0.5)
    # No wider than a fifth of a cell, and a whole part of the step of 0.1.
    assert np.diff(layer.edges)[0] == pytest.approx(0.05)
    assert len(seen(np.array([-0.1, 0.0, 0.1 * np.pi]), 5)) == 3
    assert len(seen(np.array([-0.1, 0.0, 0.3]), None)) == 3
    assert len(seen(np.array([-0.25, 0.0, 0.5]), 5)) == 1
    assert seen(np.array([0.0]), 5)[0].edges is not None


def test_narrow_columns_are_taken_together_wherever_they_are() -> None:
    """Within three percent of their distance from the point, with their force."""
    edges, loads = np.linspace(0.0, 10.0, 401), np.random.default_rng(0).random((400, 2))
    for place in (0.0, 100.0):
        for x in (-1.0, 10.5, 20.0):
            found, together = gathered_far(edges + place, loads, x + place)
            assert (together * np.diff(found)[:, None]).sum(axis=0) == pytest.approx(loads.sum(axis=0) * 0.025)
            widths, distance = np.diff(found), np.abs(0.5 * (found[1:] + found[:-1]) - place - x)
            assert (widths <= 0.0301 * distance + 0.0251).all()
            assert widths.size < 0.8 * 400
            assert np.array_equal(found - place, gathered_far(edges, loads, x)[0]) or place


def test_offsets_about_zero_are_evaluated_on_one_side() -> None:
    for start, few in ((-3.0, True), (-3.25, False), (-2.75, False), (-2.5, True)):
        offsets = np.arange(start, 4.0)
        found = EvenOffsets(offsets, np.zeros(1))
        assert (found.along_y.size < offsets.size) == few
        values = np.stack([np.cos(found.along_y), np.sin(found.along_y)])[:, None, None, :]
        both = found.on_both_sides(values, np.array([False, True]))[:, 0, 0]
        assert both == pytest.approx(np.stack([np.cos(offsets), np.sin(offsets)]))


@pytest.mark.parametrize("x", [0.002, 0.005, 0.01, 2.99, 2.995, 2.998])
def test_no_column_reaches_beyond_those_that_it_replaces(x: float) -> None:
    """Beside the first and the last edge of a load without images there is no room for narrow ones."""
    own = fine(ends=0)
    each = around(x, own)
    assert (each.inserted[0], each.inserted[-1]) == (own.edges[each.lowest], own.edges[each.highest])
    assert (np.diff(each.inserted) > 0).all()


@pytest.mark.parametrize("added", [True, False])
def test_what_points_see_does_not_depend_on_the_unit(*, added: bool) -> None:
    found = []
    for unit in (1.0, UNIT):
        cells = fine(unit=unit)
        x, y, z = np.array([0.3, 1.3, 2.9]), np.array([-0.1, 0.0, 0.3]), np.linspace(0.01, 6.0, 30)
        whole = np.zeros(cells.grid.shape)
        whole[:, cells.first : cells.first + cells.cells.shape[1]] = cells.cells
        axes = ArrayKey(unit * x), ArrayKey(unit * y), ArrayKey(unit * z)
        found.append(columns_seen(SeenRequest(ArrayKey(whole), cells.grid, cells._extent, 1, axes, added)))
    plain, other = found
    assert plain.depths == other.depths
    assert (plain.depths == 0) == added
    assert len(plain.layers) == len(other.layers)
    for (near, sides), (same, alike) in zip(plain.jumps, other.jumps, strict=True):
        for one, two in zip(near, same, strict=True):
            assert two.edges / UNIT == pytest.approx(one.edges, abs=1e-9)
        assert [[jumps.edges.size for jumps in side] for side in sides] == [
            [jumps.edges.size for jumps in side] for side in alike
        ]
