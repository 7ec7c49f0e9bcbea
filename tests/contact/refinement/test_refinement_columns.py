"""First columns: widths, and adaptation to the shape where its height allows a load."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from contactstudy.arrays.grid import centres_of
from contactstudy.checks import FloatArray
from contactstudy.contact.refinement.refinement import (
    CHORD_TOLERANCE,
    FIRST_COLUMN,
    MAX_COLUMNS,
    MIN_CHORD_WIDTH,
    MIN_COLUMNS,
    AxialShape,
    first_edges,
)

LENGTH = 20.0
SHAPES: dict[str, Callable[[FloatArray], FloatArray]] = {
    "crown": lambda x: 4e-3 * (x - 9.0) ** 2,
    "inclined crown": lambda x: 4e-3 * (x - 9.0) ** 2 + 0.02 * x + 7.0,
    "fillets": lambda x: 0.2 * np.maximum(np.abs(x - 10.0) - 9.0, 0.0) ** 2,
    "wave": lambda x: 0.03 * np.cos(2.0 * x) - 3.0,
    "deep wave": lambda x: 0.7 * np.cos(2.0 * x) - 3.0,
    "chamfer": lambda x: 0.05 * np.maximum(x - 13.0, 0.0),
    "steps at the ends": lambda x: np.where((x > 0) & (x < LENGTH), 0.0, 10.0),
}


def make_axial_shape(height: Callable[[FloatArray], FloatArray], unit: float = 1.0, start: float = 0.0) -> AxialShape:
    """Shape of half-width 1 and depth 0.05 in a unit of length, with its first end at `start`."""
    return AxialShape(
        start=start,
        stop=start + unit * LENGTH,
        half_width=unit,
        depth=0.05 * unit,
        height=lambda x: unit * height((x - start) / unit),
        face_beyond=(0.0, 0.0),
    )


def compute_chord_deviation(
    height: Callable[[FloatArray], FloatArray], low: FloatArray, high: FloatArray
) -> FloatArray:
    """Distance of the shape from its chord between two positions."""
    fraction = np.linspace(1e-6, 1 - 1e-6, 201)
    heights = height(low[:, None] + (high - low)[:, None] * fraction)
    chord = heights[:, :1] + (heights[:, -1:] - heights[:, :1]) * fraction
    return np.asarray(np.abs(heights - chord).max(axis=1))


@pytest.mark.parametrize("name", SHAPES)
def test_first_columns_follow_low_shape(name: str) -> None:
    height = SHAPES[name]
    edges, baseline = first_edges(make_axial_shape(height)), first_edges(make_axial_shape(np.zeros_like))
    widths, deviations = np.diff(edges), compute_chord_deviation(height, edges[:-1], edges[1:])
    fine_x = np.linspace(1e-6, LENGTH - 1e-6, 20001)
    positions = edges[:-1, None] + widths[:, None] * np.linspace(1e-6, 1 - 1e-6, 201)
    height_excess = height(positions).min(axis=1) - height(fine_x).min()
    depth = 0.05
    is_followed = (widths > MIN_CHORD_WIDTH) & (height_excess < 2.9 * depth)
    assert deviations[is_followed].max(initial=0.0) <= 1.03 * CHORD_TOLERANCE * depth
    # A column is split only if it leaves its chord, or if a neighbour is narrow.
    assert np.isin(baseline, edges).all()
    if name in ("chamfer", "steps at the ends"):
        split_columns = ~np.isin(edges, baseline)
        assert not split_columns.any() or (name == "chamfer" and (np.abs(edges[split_columns] - 13.0) < 3.0).all())
    if name == "deep wave":  # the crests are never loaded
        is_crest = height_excess > 6 * depth
        assert is_crest.any()
        assert np.median(widths[is_crest]) > 1.9 * np.median(widths[height_excess < 0.5 * depth])


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize(("unit", "start"), [(2.0**-17, 0.0), (1.0, -8.0), (1.0, 32.0)])
def test_results_scale_with_unit_and_position(name: str, unit: float, start: float) -> None:
    baseline, variant = (
        first_edges(make_axial_shape(SHAPES[name])),
        first_edges(make_axial_shape(SHAPES[name], unit, start)),
    )
    assert (variant - start) / unit == pytest.approx(baseline, abs=1e-9)


@pytest.mark.parametrize("half_width", [0.01, 0.3, 1.0, 4.0, 100.0])
def test_first_columns_double_from_ends(half_width: float) -> None:
    edges = first_edges(
        AxialShape(
            start=0.0, stop=LENGTH, half_width=half_width, depth=1.0, height=np.zeros_like, face_beyond=(0.0, 0.0)
        )
    )
    widths = np.diff(edges)
    narrowest = min(FIRST_COLUMN * half_width, LENGTH / (4 * MIN_COLUMNS))
    assert 0.5 * narrowest < widths[0] <= narrowest * (1 + 1e-9)
    assert widths.max() <= LENGTH / MIN_COLUMNS * (1 + 1e-9)
    assert widths.size < 2 * MIN_COLUMNS + 2 * np.log2(LENGTH / narrowest)
    half_widths = widths[: widths.size // 2]
    ratios = half_widths[1:] / half_widths[:-1]
    assert (ratios <= 2 * (1 + 1e-9)).all()
    is_growing = half_widths[1:] < 0.7 * widths.max()
    assert ratios[is_growing] == pytest.approx(2.0)
    assert widths == pytest.approx(widths[::-1])


@pytest.mark.parametrize("slope", [0.1, -0.1])
def test_straight_incline_adds_no_columns(slope: float) -> None:
    """The incline rises by more than the depth within a column, but never leaves its chord."""
    baseline, inclined_shape = first_edges(make_axial_shape(np.zeros_like)), make_axial_shape(lambda x: slope * x)
    for nodes in (np.zeros(0), np.linspace(1.0, 19.0, 50)):
        assert first_edges(replace(inclined_shape, nodes=nodes)) == pytest.approx(baseline)


def test_curved_shape_reaches_maximum_columns() -> None:
    edges = first_edges(
        AxialShape(
            start=0.0,
            stop=LENGTH,
            half_width=1e-3,
            depth=1e-9,
            height=lambda x: 1e-9 * np.sin(300 * x),
            face_beyond=(0.0, 0.0),
        )
    )
    assert MAX_COLUMNS < edges.size <= 2 * MAX_COLUMNS
    assert centres_of(np.array([1.0, 2.0, 5.0])).tolist() == [1.5, 3.5]


@pytest.mark.parametrize("position", [5.1, 7.43, 11.9, 12.77])
@pytest.mark.parametrize("width", [0.02, 0.1])
def test_first_columns_contain_narrow_ridges(position: float, width: float) -> None:
    """Ridges of a measured profile, narrower than the widest first column by a factor of 12 to 60."""
    shape = make_axial_shape(lambda x: 4e-3 * (x - 9.0) ** 2 - 0.05 * np.exp(-(((x - position) / width) ** 2)))
    edges = first_edges(shape)
    columns = np.diff(edges)[np.abs(centres_of(edges) - position) < 0.1]
    assert columns.size
    assert columns.max() <= 0.1


@pytest.mark.parametrize("position", [5.1, 7.43, 12.77])
def test_first_columns_contain_ridges_at_nodes(position: float) -> None:
    """A ridge between all sampled points, with its crest at a node."""
    ridge_shape = make_axial_shape(
        lambda x: 4e-3 * (x - 9.0) ** 2 - 0.05 * np.maximum(1 - np.abs(x - position) / 1e-3, 0.0)
    )
    edges = first_edges(replace(ridge_shape, nodes=np.array([2.0, position, 17.0])))
    column = np.searchsorted(edges, position) - 1
    assert np.diff(edges)[column] <= MIN_CHORD_WIDTH


def test_close_corners_are_edges() -> None:
    corners = (13.0, 13.001, 13.002)
    assert set(corners) <= set(first_edges(replace(make_axial_shape(SHAPES["chamfer"]), corners=corners)).tolist())


@pytest.mark.parametrize("corner", [0.4, 7.43, 12.77])
def test_corner_moves_neighbouring_edges_only(corner: float) -> None:
    uncornered_edges = first_edges(make_axial_shape(np.zeros_like))
    edges = first_edges(replace(make_axial_shape(np.zeros_like), corners=(corner,)))
    max_width = np.diff(uncornered_edges).max()
    distant_edges = uncornered_edges[np.abs(uncornered_edges - corner) > 0.25 * max_width]
    assert corner in edges
    assert np.isin(distant_edges, edges).all()
    column = np.searchsorted(edges, corner)
    assert (
        min(np.diff(edges)[column - 1 : column + 1])
        >= 0.2 * np.diff(uncornered_edges)[np.searchsorted(uncornered_edges, corner) - 1]
    )


def test_first_columns_split_at_curvature() -> None:
    fillet_radius, fillet_start = 3.0, 17.0
    bent_shape = make_axial_shape(lambda x: 0.5 * np.maximum(x - fillet_start, 0) ** 2 / fillet_radius)
    widths = np.diff(first_edges(bent_shape))
    baseline = np.diff(first_edges(make_axial_shape(np.zeros_like)))
    assert widths.size > baseline.size
    assert widths[-len(baseline) // 3 :].max() < baseline.max()


@pytest.mark.parametrize("crest_x", [2.2, 9.1, 17.7])
def test_first_columns_resolve_crest_between_samples(crest_x: float) -> None:
    """The crest is narrower than the distance of two samples: only the nodes contain it."""
    nodes = np.sort(np.append(np.linspace(0.0, LENGTH, 201), crest_x + np.array([-4e-4, 1e-4, 5e-4])))
    heights = np.where(np.abs(nodes - crest_x) < 2e-4, 0.0, 0.02)
    ridge_shape = replace(make_axial_shape(lambda x: np.interp(x, nodes, heights)), nodes=nodes)
    edges = first_edges(ridge_shape)
    widths = np.diff(edges)
    assert widths[np.searchsorted(edges, crest_x) - 1] <= MIN_CHORD_WIDTH
    assert edges.size < 1.5 * first_edges(make_axial_shape(np.zeros_like)).size
