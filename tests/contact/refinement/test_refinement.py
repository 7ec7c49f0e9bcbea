"""Columns that adapt to prescribed pressures: split columns, values and errors, end of the refinement."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy.checks import BoolArray, FloatArray
from contactstudy.contact.refinement.laws import RIGID, EndLaw
from contactstudy.contact.refinement.refinement import (
    CORNER_GROWTH,
    EDGE_COLUMN_WIDTH,
    END_COLUMN_WIDTH,
    MAX_COLUMNS,
    MAX_WIDTH_RATIO,
    MIN_END_COLUMN,
    AxialShape,
    ColumnPressure,
    Refinement,
    _change_error,
    find_overlooked,
    first_edges,
    refine_coarsely,
    refine_columns,
    replace_pressure,
    split_columns,
)

HALF_WIDTH, LENGTH = 1.0, 20.0
Y = (np.arange(16) - 7.5) / 8


def make_shape(
    length: float = LENGTH, *, face_beyond: tuple[float, float] = (0.0, 0.0), is_elastic: bool = False
) -> AxialShape:
    exponents = [np.nan if is_elastic or face_length == 0 else RIGID for face_length in face_beyond]
    return AxialShape(
        start=0.0,
        stop=length,
        half_width=HALF_WIDTH,
        depth=0.05,
        height=lambda x: np.zeros_like(x),
        face_beyond=face_beyond,
        exponents=(exponents[0], exponents[1]),
    )


def make_column_pressure(pressure: FloatArray) -> ColumnPressure:
    """Column pressure with an infinite opening of the unloaded columns."""
    return ColumnPressure(np.asarray(pressure), lambda: np.where(pressure.any(axis=1), 0.0, np.inf))


def make_column_solver(line_pressure: Callable[[FloatArray], FloatArray]) -> Callable[..., ColumnPressure]:
    """Solver that returns column means of a pressure prescribed along the axis, elliptic across the contact."""
    nodes, weights = np.polynomial.legendre.leggauss(20)

    def solve(edges: FloatArray, start: FloatArray | None, tolerance: float) -> ColumnPressure:
        if start is not None:
            assert start.shape == (edges.size - 1, Y.size)
        positions = 0.5 * (edges[1:] + edges[:-1])[:, None] + 0.5 * np.diff(edges)[:, None] * nodes
        means = 0.5 * line_pressure(positions) @ weights
        return make_column_pressure(means[:, None] * np.sqrt(np.maximum(1 - Y**2, 0)))

    return solve


@st.composite
def marked_edges(draw: st.DrawFn) -> tuple[FloatArray, BoolArray]:
    ratios = draw(st.lists(st.floats(0.4, 2.5), min_size=1, max_size=20))
    edges = np.append(0.0, np.cumsum(np.cumprod([1.0, *ratios])))
    drawn_marks = draw(st.lists(st.booleans(), min_size=edges.size - 1, max_size=edges.size - 1))
    return edges, np.array(drawn_marks)


@given(marked_columns=marked_edges())
def test_split_halves_marked_columns(marked_columns: tuple[FloatArray, BoolArray]) -> None:
    edges, is_marked = marked_columns
    fine_edges = split_columns(edges, is_marked)
    assert np.all(np.isin(edges, fine_edges))
    centres = 0.5 * (edges[1:] + edges[:-1])
    assert np.all(np.isin(centres[is_marked], fine_edges))
    widths = np.diff(fine_edges)
    assert np.all(widths > 0)
    if is_marked.any():
        assert np.all(np.maximum(widths[1:] / widths[:-1], widths[:-1] / widths[1:]) <= MAX_WIDTH_RATIO * (1 + 1e-12))


@given(length=st.floats(1.0, 300.0))
def test_first_columns_are_symmetric_and_narrow_at_ends(length: float) -> None:
    edges = first_edges(make_shape(length))
    widths = np.diff(edges)
    assert (edges[0], edges[-1]) == (0.0, length)
    assert widths[0] <= 0.1 * HALF_WIDTH * (1 + 1e-9)
    assert np.allclose(widths, widths[::-1])
    assert np.all(widths[1 : widths.size // 2] / widths[: widths.size // 2 - 1] <= MAX_WIDTH_RATIO)


def test_open_column_with_step_at_end_is_not_overlooked() -> None:
    stepped_shape = replace(make_shape(), height=lambda x: np.where((x > 0.0) & (x < LENGTH), 0.0, 1e3))
    edges, is_loaded = np.linspace(0.0, LENGTH, 11), np.zeros(10, dtype=bool)
    for opening, is_overlooked in ((0.01, False), (-0.01, True)):
        assert (find_overlooked(stepped_shape, edges, is_loaded, np.full(10, opening)) == is_overlooked).all()


AXIAL_PRESSURES: dict[str, Callable[[FloatArray], FloatArray]] = {
    "narrow": lambda x: 1 + 2 * np.exp(-(((x - 3.3) / 0.15) ** 2)),
    "contact's end": lambda x: np.sqrt(np.maximum(1 - ((x - 10.0) / 8.0) ** 2, 0)),
    "lesser peak": lambda x: 1 + np.exp(-(((x - 2.0) / 0.3) ** 2)) + 0.5 * np.exp(-(((x - 17.0) / 0.2) ** 2)),
    "falls to the end": lambda x: 1 - 0.5 * np.exp(-x / 0.3) - 0.4 * np.exp(-(LENGTH - x) / 0.5),
    "even": lambda x: np.ones_like(x),
}


@pytest.mark.parametrize("accuracy", [0.05, 0.01, 0.003])
@pytest.mark.parametrize("name", AXIAL_PRESSURES)
def test_errors_cover_peak_and_ends(name: str, accuracy: float) -> None:
    line_pressure = AXIAL_PRESSURES[name]
    computed = refine_columns(make_column_solver(line_pressure), make_shape(), accuracy)
    peak = float(line_pressure(np.linspace(0.0, LENGTH, 200001)).max())
    assert computed.accurate
    assert computed.laws == [None, None]
    assert abs(computed.peak - peak) <= computed.peak_error <= accuracy * peak * (1 + 1e-9)
    end_pressures = line_pressure(np.array([0.0, LENGTH]))
    for end_pressure, error, exact_pressure in zip(
        computed.values["end_pressure"], computed.errors["end_pressure"], end_pressures, strict=True
    ):
        assert abs(end_pressure - exact_pressure) <= error + 1e-12


def test_tighter_accuracy_takes_more_columns() -> None:
    sizes = [
        refine_columns(make_column_solver(AXIAL_PRESSURES["narrow"]), make_shape(), accuracy).edges.size
        for accuracy in (0.02, 0.003, 0.0015)
    ]
    assert sizes[0] < sizes[1] < sizes[2]


@given(bump_position=st.floats(0.5, 19.5), height=st.floats(0.5, 3.0), width=st.floats(0.2, 2.0))
def test_mirrored_pressure_is_refined_to_mirrored_columns(bump_position: float, height: float, width: float) -> None:
    def compute_pressure_with_bump(x: FloatArray) -> FloatArray:
        return np.asarray(1 + height * np.exp(-(((x - bump_position) / width) ** 2)))

    original_columns = refine_columns(make_column_solver(compute_pressure_with_bump), make_shape(), 0.02)
    mirrored_columns = refine_columns(
        make_column_solver(lambda x: compute_pressure_with_bump(LENGTH - x)), make_shape(), 0.02
    )
    assert mirrored_columns.peak == pytest.approx(original_columns.peak, rel=2e-3)
    assert abs(mirrored_columns.edges.size - original_columns.edges.size) <= 4
    assert (
        abs(original_columns.peak - float(compute_pressure_with_bump(np.linspace(0, LENGTH, 20001)).max()))
        <= original_columns.peak_error
    )


@pytest.mark.parametrize("exponent", [0.5, 0.25])
def test_singular_end_has_intensity_and_regular_end_pressure(exponent: float) -> None:
    relative_slope = 0.02

    def solve_exactly(edges: FloatArray, start: FloatArray | None, tolerance: float) -> ColumnPressure:
        first_primitive, second_primitive = (edges**power / power for power in (1 - exponent, 2 - exponent))
        means = 0.7 * np.diff(first_primitive + relative_slope * second_primitive) / np.diff(edges)
        return make_column_pressure(means[:, None] * np.sqrt(np.maximum(1 - Y**2, 0)))

    computed = refine_columns(solve_exactly, make_shape(face_beyond=(np.inf, 0.0), is_elastic=exponent != RIGID), 0.01)
    singular_law, regular_law = computed.laws
    assert singular_law is not None
    assert regular_law is None
    assert np.isinf(
        [computed.peak, computed.peak_error, computed.values["end_pressure"][0], computed.errors["end_pressure"][0]]
    ).all()
    assert singular_law.exponent == pytest.approx(exponent, abs=0.02)
    assert np.diff(computed.edges)[0] <= MIN_END_COLUMN * HALF_WIDTH
    assert computed.values["end_pressure"][1] == pytest.approx(
        0.7 * LENGTH**-exponent * (1 + relative_slope * LENGTH), abs=computed.errors["end_pressure"][1]
    )
    # The intensity K belongs to the row of cells next to y = 0.
    assert singular_law.intensity == pytest.approx(0.7 * np.sqrt(1 - Y[7] ** 2), rel=0.01)


def test_unresolved_pressure_ends_at_maximum_columns() -> None:
    def solve_alternating(edges: FloatArray, start: FloatArray | None, tolerance: float) -> ColumnPressure:
        noise = np.random.default_rng(edges.size).random((edges.size - 1, 1))
        noise[[0, 1, -2, -1]] = 0.0
        return make_column_pressure((1 + noise) * np.sqrt(np.maximum(1 - Y**2, 0)))

    computed = refine_columns(solve_alternating, make_shape(), 0.001)
    assert not computed.accurate
    assert computed.edges.size <= 2 * MAX_COLUMNS
    assert computed.peak_error > 0.001 * computed.peak


def compute_power_law(x: FloatArray) -> FloatArray:
    """Pressure that is singular at the first end."""
    return np.asarray(0.7 / np.sqrt(x))


SCALED_PRESSURES = AXIAL_PRESSURES | {
    "singular": compute_power_law,
    "a logarithm": lambda x: 1 - 0.3 * np.log(x / LENGTH),
    "one half only": lambda x: np.sqrt(np.maximum(1 - ((x - 4.0) / 3.0) ** 2, 0)),
    "rises to one end": lambda x: 1 + np.exp(-(LENGTH - x) / 0.2),
    "rises to one end below a peak": lambda x: 1 + np.exp(-(LENGTH - x) / 0.2) + 3 * np.exp(-((x - 5.0) ** 2)),
}


@pytest.mark.parametrize(
    ("unit", "offset", "end"), [(2.0**-17, 0.0, 0), (1.0, -8.0, 0), (1.0, 64.0, 1), (2.0**-17, 0.0, 1)]
)
@pytest.mark.parametrize("name", SCALED_PRESSURES)
def test_refinement_scales_with_units_position_and_side(name: str, unit: float, offset: float, end: int) -> None:
    """The columns do not depend on the units of length and pressure, on the position, or on the end that is counted
    first."""
    pressure, unit_solver = 2.0**37 if unit < 1 else 1.0, make_column_solver(SCALED_PRESSURES[name])

    def compute_unit_position(x: FloatArray) -> FloatArray:
        """Distances from the first end, in the original unit."""
        return x / unit - offset if end == 0 else LENGTH - (x / unit - offset)

    def height(x: FloatArray) -> FloatArray:
        return np.asarray(0.02 * np.maximum(x - 17.0, 0) ** 2)

    def solve(edges: FloatArray, start: FloatArray | None, tolerance: float) -> ColumnPressure:
        order = slice(None, None, 1 - 2 * end)
        return make_column_pressure(
            pressure * unit_solver(compute_unit_position(edges)[order], None, tolerance).pressure[order]
        )

    face_beyond, exponents = (3.0, 0.0), (RIGID, np.nan)
    baseline = refine_columns(
        unit_solver,
        AxialShape(
            start=0.0,
            stop=LENGTH,
            half_width=HALF_WIDTH,
            depth=0.05,
            height=height,
            face_beyond=face_beyond,
            exponents=exponents,
        ),
        0.02,
    )
    shifted_shape = AxialShape(
        start=unit * offset,
        stop=unit * (offset + LENGTH),
        half_width=unit * HALF_WIDTH,
        depth=unit * 0.05,
        height=lambda x: unit * height(compute_unit_position(x)),
        face_beyond=(unit * face_beyond[end], unit * face_beyond[1 - end]),
        exponents=exponents[:: 1 - 2 * end],
    )
    shifted_result = refine_columns(solve, shifted_shape, 0.02)
    assert (shifted_result.accurate, shifted_result.first_edges.size) == (baseline.accurate, baseline.first_edges.size)
    assert np.sort(compute_unit_position(shifted_result.edges)) == pytest.approx(baseline.edges, abs=1e-9)
    for key, factor in {"peak_pressure": pressure, "end_pressure": pressure, "end_load": pressure * unit}.items():
        for values, expected in ((shifted_result.values, baseline.values), (shifted_result.errors, baseline.errors)):
            assert np.array(values[key])[:: 1 - 2 * end] / factor == pytest.approx(expected[key], rel=1e-6), key
    for computed, law in zip(
        shifted_result.laws if end == 0 else shifted_result.laws[::-1], baseline.laws, strict=True
    ):
        assert (computed is None) == (law is None)
        if computed and law:
            factor = pressure * unit**law.exponent
            assert computed.exponent == pytest.approx(law.exponent)
            for key in ("intensity", "intensity_error"):
                assert getattr(computed, key) / factor == pytest.approx(getattr(law, key), rel=1e-5, nan_ok=True)


def list_outermost_widths(
    name: str, face_beyond: tuple[float, float] = (0.0, 0.0), *, is_elastic: bool = False
) -> tuple[float, float]:
    """Widths of the first and the last column of a refined pressure, over the half-width."""
    request = make_shape(face_beyond=face_beyond, is_elastic=is_elastic)
    widths = np.diff(refine_columns(make_column_solver(SCALED_PRESSURES[name]), request, 0.02).edges) / HALF_WIDTH
    return float(widths[0]), float(widths[-1])


@pytest.mark.parametrize("is_elastic", [False, True])
def test_sharper_ends_have_narrower_columns(*, is_elastic: bool) -> None:
    for width in list_outermost_widths("falls to the end"):
        assert MIN_END_COLUMN < 0.3 * END_COLUMN_WIDTH < width <= END_COLUMN_WIDTH
    for name in ("rises to one end", "rises to one end below a peak"):
        assert 0.3 * MIN_END_COLUMN < list_outermost_widths(name)[1] <= MIN_END_COLUMN
    for face_beyond in ((2.0, 0.0), (0.0, 2.0)):
        widths = list_outermost_widths("falls to the end", face_beyond, is_elastic=is_elastic)
        sharp_end = face_beyond.index(2.0)
        assert 0.1 * MIN_END_COLUMN < widths[sharp_end] <= MIN_END_COLUMN
        assert 0.3 * END_COLUMN_WIDTH < widths[1 - sharp_end] <= END_COLUMN_WIDTH
    assert min(list_outermost_widths("contact's end", (2.0, 2.0))) > END_COLUMN_WIDTH  # neither end is loaded


def test_columns_near_contact_ends_are_narrow() -> None:
    computed = refine_columns(make_column_solver(SCALED_PRESSURES["contact's end"]), make_shape(), 0.05)
    edges, widths = computed.edges, np.diff(computed.edges)
    loaded_columns = np.flatnonzero(computed.pressure.any(axis=1))
    for end in (edges[loaded_columns[0]], edges[loaded_columns[-1] + 1]):
        is_near_end = (edges[:-1] < end + 0.99 * HALF_WIDTH) & (edges[1:] > end - 0.99 * HALF_WIDTH)
        assert is_near_end.sum() > 4
        assert widths[is_near_end].max() <= EDGE_COLUMN_WIDTH * HALF_WIDTH
    assert widths.max() > 2 * EDGE_COLUMN_WIDTH * HALF_WIDTH


@pytest.mark.parametrize("unit", [2.0**-17, 1.0, 2.0**10])
@pytest.mark.parametrize("side", [0, 1])
def test_end_step_marks_end_columns(side: int, unit: float) -> None:
    """The end step is half of the difference 0.1 with weight 4; the jump of the squares is only 0.03 of the largest."""
    edges = np.concatenate([0.01 * np.arange(11), np.linspace(0.2, LENGTH, 100)])
    line_pressure = np.where(np.arange(edges.size - 1) == 0, 0.1, 0.2)
    line_pressure[40:] = 1.0
    if side:
        edges, line_pressure = LENGTH - edges[::-1], line_pressure[::-1]
    request = AxialShape(
        start=0.0,
        stop=unit * LENGTH,
        half_width=unit * HALF_WIDTH,
        depth=0.05 * unit,
        height=np.zeros_like,
        face_beyond=(0.0, 0.0),
    )
    refinement = Refinement(
        solve=lambda *_: make_column_pressure(line_pressure[:, None] * np.sqrt(1 - Y**2)),
        shape=request,
        edges=unit * edges,
    )
    for theta, is_marked in ((0.19, True), (0.21, False)):
        assert refinement._select_columns_to_split(theta)[-side] == is_marked


def test_error_is_half_of_last_changes() -> None:
    assert _change_error([5.0, 1.0, 1.2, 1.25], 0.0) == pytest.approx(0.5 * 0.25)
    assert _change_error([1.0, 1.25, 1.2], 0.2) == 0.2
    assert _change_error([1.0, np.inf, 1.2], 0.0) == pytest.approx(0.1)
    assert _change_error([1.2], 0.0) == _change_error([1.2, np.inf], 0.0) == np.inf
    assert _change_error([3.0, 0.0, 0.0, 0.0], 0.2) == 0.0


@pytest.mark.parametrize("length", [20.0, 0.5])
def test_load_and_peak_errors_have_equal_floor(length: float) -> None:
    computed = refine_columns(make_column_solver(AXIAL_PRESSURES["even"]), make_shape(length), 0.02)
    baseline = float(computed.pressure[0].sum()) * min(HALF_WIDTH, length)
    assert computed.values["end_load"] == pytest.approx((baseline, baseline))
    relative_errors = np.array(computed.errors["peak_pressure"]) / computed.values["peak_pressure"]
    assert np.array(computed.errors["end_load"]) / baseline == pytest.approx(relative_errors)


@pytest.mark.parametrize("name", ["lesser peak", "singular"])
def test_replaced_pressure_scales_errors(name: str) -> None:
    request = make_shape(face_beyond=(3.0, 0.0))
    computed = refine_columns(make_column_solver(SCALED_PRESSURES[name]), request, 0.02)
    replaced_contact = replace_pressure(computed, 1.25 * computed.pressure, request)
    for values, expected in ((replaced_contact.values, computed.values), (replaced_contact.errors, computed.errors)):
        for key in ("peak_pressure", "end_pressure"):
            assert values[key] == pytest.approx([1.25 * value for value in expected[key]]), key
    assert replaced_contact.values["end_load"] == pytest.approx([1.25 * value for value in computed.values["end_load"]])
    assert replaced_contact.errors["end_load"] == computed.errors["end_load"]
    for law, replaced_law in zip(computed.laws, replaced_contact.laws, strict=True):
        assert (law is None) == (replaced_law is None)
        if law and replaced_law:
            assert replaced_law.intensity == pytest.approx(1.25 * law.intensity)


def test_newly_loaded_end_has_error_of_its_pressure() -> None:
    # Random case 4008736: coupled friction loads an end that the pressure alone does not reach.
    request = make_shape()
    computed = refine_columns(make_column_solver(SCALED_PRESSURES["contact's end"]), request, 0.02)
    assert (computed.values["end_pressure"], computed.errors["end_pressure"]) == ([0.0, 0.0], [0.0, 0.0])
    changed_pressure = computed.pressure.copy()
    changed_pressure[:20] += 0.02 * computed.pressure.max()
    refined_contact = replace_pressure(computed, changed_pressure, request)
    first_pressure, last_pressure = refined_contact.values["end_pressure"]
    assert first_pressure > 0
    assert refined_contact.errors["end_pressure"] == [first_pressure, last_pressure] == [first_pressure, 0.0]


@pytest.mark.parametrize("errors", [(0.1, np.inf), (np.inf, 0.1)])
def test_equal_peaks_take_larger_error(errors: tuple[float, float]) -> None:
    computed = refine_columns(make_column_solver(SCALED_PRESSURES["even"]), make_shape(), 0.02)

    def compute_peak_error(peaks: tuple[float, ...]) -> float:
        return replace(computed, values={"peak_pressure": peaks}, errors={"peak_pressure": errors}).peak_error

    assert np.isinf(compute_peak_error((1.0, 1.0)))
    assert compute_peak_error((1.0, 0.5)[:: 1 if errors[0] < 1 else -1]) == 0.1


def test_end_samples_follow_splitting(caplog: pytest.LogCaptureFixture) -> None:
    refinement = Refinement(
        solve=make_column_solver(SCALED_PRESSURES["rises to one end"]),
        shape=make_shape(),
        edges=first_edges(make_shape()),
    )
    with caplog.at_level("INFO"):
        for theta in (0.5, 0.3, 0.2):
            refinement.refine(theta)
    assert caplog.messages[-1] == f"refined to {refinement.edges.size - 1} columns"
    for side, samples in enumerate(refinement.samples):
        widths = np.array([sample.width for sample in samples])
        assert len(samples) > 3
        assert widths[:-1] / widths[1:] == pytest.approx(2.0)
        assert widths[-1] == pytest.approx(np.diff(refinement.edges)[-side])
        assert samples[-1].pressure == pytest.approx(refinement.pressure[-side].max(), rel=1e-3)


@pytest.mark.parametrize("side", [0, 1])
def test_unloaded_sharp_end_has_no_law(side: int) -> None:
    """The other end is loaded and converges; the pressure begins one column behind the sharp end."""

    def line_pressure(x: FloatArray) -> FloatArray:
        position = x if side == 0 else LENGTH - x
        return np.asarray(np.where(position > 0.06, 1.0, 0.0) * (1 - 0.2 * position / LENGTH))

    face_beyond = (2.0, 0.0) if side == 0 else (0.0, 2.0)
    computed = refine_columns(make_column_solver(line_pressure), make_shape(face_beyond=face_beyond), 0.05)
    assert computed.laws == [None, None]
    assert computed.values["end_pressure"][side] == 0.0
    assert np.isfinite(computed.errors["end_pressure"]).all()
    assert np.isfinite(computed.errors["peak_pressure"]).all()


@pytest.mark.parametrize("slope", [0.5, -0.5])
@pytest.mark.parametrize("side", [0, 1])
def test_peak_at_sharp_end_has_infinite_error(side: int, slope: float) -> None:
    def pressure(x: FloatArray) -> FloatArray:
        distance = x if side == 0 else LENGTH - x
        return np.asarray(1 + slope * distance / LENGTH)

    columns = refine_columns(
        make_column_solver(pressure), make_shape(face_beyond=(2.0, 0.0) if side == 0 else (0.0, 2.0)), 0.05
    )
    for errors in (columns.errors["end_pressure"], columns.errors["peak_pressure"]):
        assert np.isinf(errors[side])
        assert np.isfinite(errors[1 - side])


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("law", [None, EndLaw(exponent=0.5)])
def test_loaded_sharp_end_makes_contact_singular(side: int, law: EndLaw | None) -> None:
    pressure = np.zeros((4, 3))
    pressure[-side] = 1.0

    def is_singular(axial_shape: AxialShape) -> bool:
        refinement = Refinement(
            solve=lambda *_: make_column_pressure(pressure), shape=axial_shape, edges=np.arange(5.0)
        )
        refinement.laws = [law, None] if side else [None, law]
        return refinement.singular

    sharp_faces, other_faces = ((2.0, 0.0), (0.0, 2.0))[:: 1 - 2 * side]
    assert is_singular(make_shape(face_beyond=sharp_faces))
    assert is_singular(make_shape(face_beyond=other_faces)) == (law is not None)
    assert is_singular(make_shape(face_beyond=sharp_faces, is_elastic=True)) == (law is not None)


def test_rough_contact_uses_second_threshold() -> None:
    solve, request = make_column_solver(SCALED_PRESSURES["lesser peak"]), make_shape()
    coarse_result, fine_result = refine_coarsely(solve, request), refine_columns(solve, request, 0.02)
    assert np.isin(coarse_result.edges, fine_result.edges).all()
    continued_result = refine_columns(solve, request, 0.02, coarse_result.edges)
    assert continued_result.edges == pytest.approx(fine_result.edges)
    assert continued_result.first_edges == pytest.approx(coarse_result.edges)
    assert coarse_result.laws == [None, None]


@pytest.mark.parametrize(("side", "half_width"), [(0, HALF_WIDTH), (1, HALF_WIDTH), (0, 0.25)])
def test_pressure_at_corner_is_refined_on_both_sides(side: int, half_width: float) -> None:
    """The logarithm at a corner makes the peak of its half infinite, and the columns on both sides narrow."""
    corner = (6.3, LENGTH - 6.3)[side]
    cornered_shape = replace(make_shape(), corners=(corner,), half_width=half_width)
    result = refine_columns(make_column_solver(lambda x: 3 - 0.5 * np.log(np.abs(x - corner))), cornered_shape, 0.01)
    peaks = result.values["peak_pressure"]
    assert np.isinf(peaks[side])
    assert np.isfinite(peaks[1 - side])
    widths, distances = np.diff(result.edges), np.abs(result.edges - corner)
    outer_distances = np.maximum(distances[:-1], distances[1:])
    is_near = outer_distances < half_width
    bounds = np.maximum(MIN_END_COLUMN * half_width, CORNER_GROWTH * outer_distances)
    assert (widths <= bounds)[is_near].all()
