"""Loads as smooth functions: forces, moments, shapes at borders and ends, symmetry."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contactstudy.checks import FloatArray
from contactstudy.kernels.smooth_load import ShapedLoad, SmoothLoad, _mean_of_root, _opposite_face, moment_loads

WIDTHS = np.array([1.0, 0.8, 1.2, 1.0, 0.9, 1.1, 0.7, 1.5, 1.0])


def fit_shape(cells: FloatArray, edges: FloatArray, *, extends_beyond: bool = False) -> ShapedLoad:
    """Load with its own shape: the ratio is 1."""
    return SmoothLoad.of(cells, edges, extends_beyond=extends_beyond).shape_loads(cells)


def compute_means(load: ShapedLoad, edges: FloatArray) -> FloatArray:
    """Means between other edges: array (row, cell)."""
    return np.asarray(np.diff(load.integral(edges), axis=1) / np.diff(edges))


def integrate_semicircle(y: FloatArray) -> FloatArray:
    """Integral of ``sqrt(1 - y**2)``."""
    clipped_y = np.clip(y, -1.0, 1.0)
    return np.asarray(0.5 * (clipped_y * np.sqrt(1 - clipped_y**2) + np.arcsin(clipped_y)))


@pytest.mark.parametrize("cells", [33, 40, 61])
@pytest.mark.parametrize("half_width", [1.1, 1.2])
def test_smooth_load_of_cell_means_equals_hertz_pressure(cells: int, half_width: float) -> None:
    edges = np.linspace(-half_width, half_width, cells + 1)
    means = np.diff(integrate_semicircle(edges)) / np.diff(edges)
    fine_edges = np.linspace(-half_width, half_width, 12 * cells + 1)
    computed = compute_means(fit_shape(means[None], edges, extends_beyond=True), fine_edges)[0]
    expected = np.diff(integrate_semicircle(fine_edges)) / np.diff(fine_edges)
    assert np.abs(computed - expected)[np.abs(fine_edges[1:]) < 0.9].max() < 5e-3
    # A load uniform in each cell would have an error of a third.
    assert np.abs(computed - expected).max() < 0.06


@st.composite
def rows(draw: st.DrawFn) -> tuple[FloatArray, FloatArray]:
    """Loads of any sign with gaps between them, on cells of any widths."""
    cell_count = draw(st.integers(1, 12))
    edges = np.append(0.0, np.cumsum(draw(st.lists(st.floats(0.5, 2.0), min_size=cell_count, max_size=cell_count))))
    rng = np.random.default_rng(draw(st.integers(0, 1000)))
    signs = draw(st.sampled_from([(1.0,), (1.0, 0.0), (1.0, 0.0, -1.0)]))
    return rng.random((3, cell_count)) * rng.choice(signs, (3, cell_count)), edges


@settings(max_examples=60)
@given(row=rows(), extends_beyond=st.booleans())
def test_smooth_load_keeps_force_without_overshoot(row: tuple[FloatArray, FloatArray], extends_beyond: bool) -> None:
    loads, edges = row
    shaped_load = fit_shape(loads, edges, extends_beyond=extends_beyond)
    widths = np.diff(edges)
    total_force = shaped_load.integral(edges[-1:])[:, 0]
    assert np.allclose(total_force, loads @ widths, atol=1e-6)
    assert np.allclose(shaped_load.middle[loads != 0], 1.0, atol=1e-6)
    fine_edges = np.linspace(edges[0], edges[-1], 301)
    means = compute_means(shaped_load, fine_edges)
    assert np.abs(means).max() <= 2.0 * np.abs(loads).max() + 1e-12
    if (loads >= 0).all():
        assert means.min() >= -1e-9


@settings(max_examples=30)
@given(row=rows())
def test_reversed_load_has_the_reversed_shape(row: tuple[FloatArray, FloatArray]) -> None:
    loads, edges = row
    fine_edges = np.linspace(edges[0], edges[-1], 60)
    load_form = fit_shape(loads, edges, extends_beyond=True)
    mirrored_form = fit_shape(loads[:, ::-1], edges[-1] - edges[::-1], extends_beyond=True)
    assert np.allclose(
        compute_means(load_form, fine_edges),
        compute_means(mirrored_form, edges[-1] - fine_edges[::-1])[:, ::-1],
        atol=1e-9,
    )
    couplings = (load.shape.coupled_to_next[:, :-1] for load in (load_form, mirrored_form))
    assert np.array_equal(next(couplings), next(couplings)[:, ::-1])


def test_uniform_load_ends_in_step() -> None:
    edges = np.linspace(0.0, 8.0, 9)
    loads = np.array([[0, 0, 2.0, 2.0, 2.0, 2.0, 0, 0]])
    shaped_load = fit_shape(loads, edges, extends_beyond=True)
    assert np.allclose(compute_means(shaped_load, np.linspace(0.0, 8.0, 33)), np.repeat(loads, 4, axis=1), atol=1e-12)


def test_rising_load_ends_in_step() -> None:
    edges = np.linspace(0.0, 5.0, 6)
    loads = np.array([[0.0, 3.0, 1.5, 1.0, 1.0]])
    means = compute_means(fit_shape(loads, edges), np.linspace(0.0, 5.0, 51))[0]
    assert (means[:10] == 0).all()
    assert 3.0 <= means[10:15].max() < 1.5 * 3.0


@given(row=rows())
def test_moment_loads_have_no_resultant(row: tuple[FloatArray, FloatArray]) -> None:
    loads, edges = row
    if edges.size < 3:
        return
    widths, centres = np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
    forces = moment_loads(edges, loads) * widths
    assert np.allclose(forces.sum(axis=1), 0.0, atol=1e-9)
    assert np.allclose(forces @ centres, loads.sum(axis=1), atol=1e-9)


def test_rounding_keeps_shape_of_load_end() -> None:
    """The two inner cells of four are equal up to rounding of either sign."""
    edges = np.linspace(-1.0, 1.0, 5)
    rows = np.array([[0.4, 1.0, 1.0, 0.4]]) * (1 + 1e-12 * np.array([[0, 1, -1, 0], [0, -1, 1, 0], [0, 0, 0, 0]]))
    fine_edges = compute_means(fit_shape(rows, edges), np.linspace(-1.0, 1.0, 21))
    assert np.ptp(fine_edges, axis=0).max() < 1e-9
    assert np.abs(fine_edges - fine_edges[:, ::-1]).max() < 1e-9


@settings(max_examples=30)
@given(row=rows(), extends_beyond=st.booleans())
def test_shape_is_linear_in_load(row: tuple[FloatArray, FloatArray], extends_beyond: bool) -> None:
    loads, edges = row
    fine_edges = np.linspace(edges[0], edges[-1], 60)
    means = compute_means(fit_shape(loads, edges, extends_beyond=extends_beyond), fine_edges)
    for factor in (2.0**-30, 2.0**30):
        scaled_means = compute_means(fit_shape(factor * loads, edges, extends_beyond=extends_beyond), fine_edges)
        assert np.allclose(means, scaled_means / factor, atol=1e-9)


@settings(max_examples=30)
@given(row=rows(), extends_beyond=st.booleans())
def test_moments_match_narrow_cells(row: tuple[FloatArray, FloatArray], extends_beyond: bool) -> None:
    loads, edges = row[0], row[1] + 0.7
    shaped_load = fit_shape(loads, edges, extends_beyond=extends_beyond)
    part_count = 400
    fine_edges = np.append(
        (edges[:-1, None] + np.diff(edges)[:, None] * np.arange(part_count) / part_count).ravel(), edges[-1]
    )
    forces, middles = (
        compute_means(shaped_load, fine_edges) * np.diff(fine_edges),
        0.5 * (fine_edges[1:] + fine_edges[:-1]),
    )
    cell_centres = np.repeat(0.5 * (edges[1:] + edges[:-1]), part_count)
    expected = (forces * (middles - cell_centres)).reshape(loads.shape[0], -1, part_count).sum(axis=2)
    assert np.allclose(shaped_load.moments, expected, atol=1e-4)
    total_force = np.cumsum(forces * (middles - edges[0]), axis=1)
    if edges.size < 3:
        return
    scaled_means = np.linspace(edges[0] - 0.3, edges[-1] + 0.2, 9)
    for equivalent_means, cells in (
        (shaped_load.equivalent_means(edges), edges),
        (shaped_load.equivalent_means(scaled_means), scaled_means),
    ):
        computed = equivalent_means * np.diff(cells)
        assert np.allclose(computed.sum(axis=1), forces.sum(axis=1), atol=1e-9)
        centres = 0.5 * (cells[1:] + cells[:-1]) - edges[0]
        assert np.allclose(computed @ centres, total_force[:, -1], atol=2e-3)


@settings(max_examples=30)
@given(row=rows(), seed=st.integers(0, 1000))
def test_ratio_multiplies_shape(row: tuple[FloatArray, FloatArray], seed: int) -> None:
    """Integrals of a shape times a ratio that is linear in each half of a cell, against narrow cells."""
    loads, edges = row
    ratio = np.random.default_rng(seed).uniform(-1.0, 1.0, (3, *loads.shape))
    shape = SmoothLoad.of(loads, edges)
    load = ShapedLoad(shape, *ratio)
    part_count = 400
    fraction = (np.arange(part_count) + 0.5) / part_count
    fine_edges = np.append((edges[:-1, None] + np.diff(edges)[:, None] * (fraction - fraction[0])).ravel(), edges[-1])
    ones = np.ones_like(loads)
    forces = np.diff(ShapedLoad(shape, ones, ones, ones).integral(fine_edges), axis=1).reshape(*loads.shape, part_count)
    first_weight, middle_weight, last_weight = ratio[..., None]
    position = 2 * fraction - 1
    part_forces = forces * np.where(
        position < 0,
        middle_weight + (middle_weight - first_weight) * position,
        middle_weight + (last_weight - middle_weight) * position,
    )
    assert np.allclose(load.cell_means * np.diff(edges), part_forces.sum(axis=2), atol=2e-5)
    assert np.allclose(load.moments, (part_forces * 0.5 * position * np.diff(edges)[:, None]).sum(axis=2), atol=2e-5)
    third_positions = edges[:-1] + np.diff(edges) * fraction[part_count // 3] - 0.5 * np.diff(edges) / part_count
    previous_forces = np.pad(part_forces.sum(axis=2).cumsum(axis=1), ((0, 0), (1, 0)))[:, :-1]
    expected = previous_forces + part_forces[..., : part_count // 3].sum(axis=2)
    assert np.allclose(load.integral(third_positions), expected, atol=1e-4)


@settings(max_examples=60)
@given(row=rows(), seed=st.integers(0, 1000))
def test_load_of_another_shape_keeps_force_and_bound(row: tuple[FloatArray, FloatArray], seed: int) -> None:
    loads, edges = row
    ratio = np.random.default_rng(seed).uniform(0.2, 1.0, loads.shape)
    load = SmoothLoad.of(loads, edges).shape_loads(ratio * loads)
    forces = load.cell_means * np.diff(edges)
    assert np.allclose(forces.sum(axis=1), (ratio * loads) @ np.diff(edges), atol=1e-9)
    for values in (load.first, load.middle, load.last):
        assert values[loads != 0].max(initial=0.0) <= 1 + 1e-9
    # The ratio is continuous inside the load, between loads of similar size.
    magnitude, next_magnitude = np.abs(loads[:, :-1]), np.abs(loads[:, 1:])
    is_similar = (loads[:, :-1] * loads[:, 1:] > 0) & (
        np.minimum(magnitude, next_magnitude) > 0.8 * np.maximum(magnitude, next_magnitude)
    )
    is_coupled = load.shape.coupled_to_next
    is_similar &= ~(is_coupled[:, :-1] | is_coupled[:, 1:] | np.pad(is_coupled[:, :-2], ((0, 0), (1, 0))))
    assert np.allclose(load.last[:, :-1][is_similar], load.first[:, 1:][is_similar], atol=1e-12)


def test_load_where_the_shape_is_zero_is_uniform() -> None:
    edges = np.append(0.0, np.cumsum(WIDTHS))
    shape, load = np.array([[0.0, 0, 1, 2, 3, 2, 1, 0, 0]]), np.array([[0.5, 0, 1, 1, 1, 1, 1, 0, 0.7]])
    means = compute_means(SmoothLoad.of(shape, edges).shape_loads(load), np.linspace(edges[0], edges[1], 5))[0]
    assert means == pytest.approx(0.5)


def test_load_vanishes_outside_edges() -> None:
    edges = np.array([0.0, 1.0, 2.5, 3.0])
    shaped_load = fit_shape(np.array([[1.0, 2.0, 3.0]]), edges)
    assert shaped_load.integral(np.array([-1.0, 0.0, 3.0, 3.1, 9.0]))[0] == pytest.approx([0, 0, 5.5, 5.5, 5.5])


def test_constant_last_cell_ends_in_step() -> None:
    means = compute_means(
        fit_shape(np.array([[1.2, 1.1, 1.0, 1.0]]), np.linspace(0.0, 4.0, 5)), np.linspace(0.0, 4.0, 41)
    )
    assert means[0, 30:] == pytest.approx(1.0)


def compute_square_root_forces(edges: FloatArray, border: float) -> FloatArray:
    """Forces between edges of a load whose square decreases linearly to a border."""
    return np.diff(-2 / 3 * np.maximum(border - edges, 0.0) ** 1.5)


def assert_linear_square(shape: SmoothLoad, cell: int) -> None:
    first_weight, middle_weight, last_weight = (
        values[0, cell] ** 2 for values in (shape.first, shape.middle, shape.last)
    )
    assert middle_weight == pytest.approx(0.5 * (first_weight + last_weight))
    assert shape.knot[0, cell] == 0.5


@pytest.mark.parametrize("factor", [1.0, 5.0])
def test_root_extends_beyond_last_cell(factor: float) -> None:
    """In the discrete contact the cell of the last centre inside the contact carries the force beyond this centre."""
    edges = np.append(0.0, np.cumsum(WIDTHS))
    forces = compute_square_root_forces(edges, edges[6] + 0.25)
    forces[5:7] = forces[5:7].sum(), 0.0
    loads = forces / WIDTHS
    fine_edges = np.linspace(edges[5], edges[7], 31)
    shaped_load = fit_shape(factor * loads[None], edges, extends_beyond=True)
    assert (
        np.abs(
            compute_means(shaped_load, fine_edges)[0] / factor
            - compute_square_root_forces(fine_edges, edges[6] + 0.25) / np.diff(fine_edges)
        ).max()
        < 0.06
    )
    assert shaped_load.integral(edges[6:8])[0] / factor == pytest.approx([forces.sum() - 0.09, forces.sum()], abs=0.02)
    assert shaped_load.integral(edges[7:8])[0] == pytest.approx(factor * forces.sum())
    assert compute_means(shaped_load, np.array([edges[6] + 0.4, edges[7]]))[0] == 0
    assert shaped_load.middle[0, 4:7] == pytest.approx(1.0)
    assert_linear_square(shaped_load.shape, 5)
    # The load does not extend beyond its last cell without `extends_beyond`, at the end of a row, or beside a load.
    adjacent = np.where(np.arange(9) == 7, 1.0, loads)
    for row, extends_beyond in ((loads, False), (adjacent, True), (loads[:6], True)):
        unextended_form = fit_shape(factor * row[None], edges[: row.size + 1], extends_beyond=extends_beyond)
        assert unextended_form.integral(edges[6:7])[0] == pytest.approx(factor * forces.sum())


@pytest.mark.parametrize("moved_fraction", [0.1, 0.4])
@pytest.mark.parametrize("factor", [0.01, 5.0])
def test_narrow_last_cell_shares_force(moved_fraction: float, factor: float) -> None:
    """In the discrete contact the last cell carries too little force, the cell before it too much."""
    edges = np.append(0.0, np.cumsum(WIDTHS))
    border = edges[5] + 0.25
    forces = compute_square_root_forces(edges, border)
    forces[4:6] += moved_fraction * forces[5] * np.array([1, -1])
    fine_edges = np.linspace(edges[4], edges[6], 33)
    shaped_load = fit_shape(factor * forces[None] / WIDTHS, edges)
    assert (
        np.abs(
            compute_means(shaped_load, fine_edges)[0] / factor
            - compute_square_root_forces(fine_edges, border) / np.diff(fine_edges)
        ).max()
        < 0.05
    )
    assert shaped_load.integral(edges[6:7])[0] == pytest.approx(factor * forces.sum())
    assert shaped_load.middle[0, 3:6] == pytest.approx(1.0)
    assert np.flatnonzero(shaped_load.shape.coupled_to_next).tolist() == [4]
    mirrored_load = SmoothLoad.of((forces / WIDTHS)[None, ::-1], edges[-1] - edges[::-1])
    assert np.flatnonzero(mirrored_load.coupled_to_next).tolist() == [3]
    assert_linear_square(shaped_load.shape, 4)


@pytest.mark.parametrize("factor", [1.0, 5.0])
def test_truncated_root_keeps_end_value(factor: float) -> None:
    edges = np.append(0.0, np.cumsum(WIDTHS[:5]))
    loads = compute_square_root_forces(edges, edges[5] + 0.3) / WIDTHS[:5]
    shaped_load = fit_shape(factor * loads[None], edges)
    assert shaped_load.shape.last[0, -1] / factor == pytest.approx(0.3**0.5, rel=0.05)
    assert shaped_load.integral(edges[5:])[0] == pytest.approx(factor * loads @ WIDTHS[:5])


def test_truncated_load_stays_in_last_cell() -> None:
    shaped_load = fit_shape(np.array([[3.0, 2.2, 1.75, 0.0, 0.0]]), np.arange(6.0), extends_beyond=True)
    assert compute_means(shaped_load, np.arange(6.0))[0, 3:].tolist() == [0.0, 0.0]


@pytest.mark.parametrize("loaded_fraction", [0.05, 0.2, 0.45, 0.8])
def test_load_ends_in_last_cell_of_row(loaded_fraction: float) -> None:
    """A small force of the last cell is distributed over this and the previous cell, as in a longer row."""
    edges = np.arange(10.0)
    loaded_end = 8.0 + loaded_fraction
    root_integrals = (loaded_end**1.5 - np.maximum(loaded_end - edges, 0.0) ** 1.5) / 1.5
    cells = np.diff(root_integrals)[None, :]
    for load in (cells, -cells[:, ::-1]):
        smooth_load = fit_shape(load, edges)
        padded_form = fit_shape(np.pad(load, ((0, 0), (1, 1))), np.arange(-1.0, 11.0))
        for name in ("first", "middle", "last", "knot"):
            assert getattr(smooth_load.shape, name) == pytest.approx(getattr(padded_form.shape, name)[:, 1:-1]), name
        assert smooth_load.cell_means.sum() == pytest.approx(load.sum())


def test_opposite_face_follows_from_mean() -> None:
    first_value, last_weight = np.random.default_rng(0).uniform(0.0, 2.0, (2, 50))
    assert _opposite_face(_mean_of_root(first_value, last_weight), first_value) == pytest.approx(last_weight, abs=1e-12)
