"""Layers of points that share the offsets to the corners of cells, and merged columns."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy.kernels.corner_sums import AlignedPoints, Layer, fold_offsets, merge_columns, midpoint_cells


@pytest.mark.parametrize("offset", [0.0, 0.03, 0.1, -0.04, 0.15, 0.35, -0.052, 0.048])
@pytest.mark.parametrize("span", [1.6, 1.55])
def test_layer_cells_centre_points(offset: float, span: float) -> None:
    positions, step, start = np.array([-3, 0, 4, 20]), 0.1, 5.0
    column, edges = midpoint_cells(AlignedPoints(offset, np.arange(4), positions), start, span, step)
    layer = Layer(column, np.array([0.5]), np.array([0]), step=step, edges=edges, fine_per_cell=1)
    assert layer.edges is not None
    cell_positions = (start + offset + step * positions - layer.edges[0]) / step
    assert cell_positions == pytest.approx(np.floor(cell_positions) + 0.5)
    # The layer contains all loaded cells, and at most a cell more.
    assert start - step - 1e-9 < layer.edges[0] <= start + 1e-9
    assert start + span - 1e-9 <= layer.edges[-1] < start + span + step - 1e-9
    assert layer.edges[1:] - layer.edges[:-1] == pytest.approx(step)
    # The offsets include the distances from every point to every corner.
    count = layer.edges.size
    for position, offset_index in zip(positions, layer.offset_indices, strict=True):
        distances = np.sort(start + offset + step * position - layer.edges)
        offsets = layer.distances[layer._indices[offset_index : offset_index + count]]
        assert np.sort(offsets) == pytest.approx(np.sort(np.abs(distances)))


def test_merge_preserves_force_and_moment() -> None:
    """Merged columns keep their force and are at most three percent of their distance wide."""
    edges, loads = np.linspace(0.0, 10.0, 401), np.random.default_rng(0).random((400, 2))
    for position in (0.0, 100.0):
        for x in (-1.0, 10.5, 20.0):
            computed, merged_loads = merge_columns(edges + position, loads, x + position)
            assert (merged_loads * np.diff(computed)[:, None]).sum(axis=0) == pytest.approx(loads.sum(axis=0) * 0.025)
            widths, distance = np.diff(computed), np.abs(0.5 * (computed[1:] + computed[:-1]) - position - x)
            assert (widths <= 0.0301 * distance + 0.0251).all()
            assert widths.size < 0.8 * 400
            assert np.array_equal(computed - position, merge_columns(edges, loads, x)[0]) or position


@pytest.mark.parametrize(
    ("start", "is_folded"), [(-3.0, True), (-3.25, False), (-2.75, False), (-2.5, True), (1.0, True), (-9.0, True)]
)
def test_offsets_about_zero_are_evaluated_on_one_side(start: float, is_folded: bool) -> None:
    offsets = start + np.arange(7.0)
    distances, indices, signs = fold_offsets(offsets, 1.0)
    assert np.all(distances >= 0) == is_folded
    assert signs * distances[indices] == pytest.approx(offsets)


@pytest.mark.parametrize("offset", [0.0, 0.03, 0.05])
def test_fields_unfold_from_distances(offset: float) -> None:
    aligned_points = AlignedPoints(offset, np.arange(2), np.array([0, 4]))
    layer = Layer(aligned_points, np.zeros(1), np.array([0]), step=0.1, edges=None, fine_per_cell=3)
    offsets = offset + 0.1 * np.arange(-3.0, 5.0)
    values, expected = (np.stack([np.cos(y), np.sin(y)]) for y in (layer.distances, offsets))
    unfolded_field = layer.unfold(values[:, None, None, :], np.array([False, True]), 10)[:, 0, 0]
    assert unfolded_field == pytest.approx(np.pad(expected, ((0, 0), (0, 2))))
