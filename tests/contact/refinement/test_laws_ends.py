"""Values of given pressures on columns: peaks of both halves, end pressures and end loads."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy.checks import FloatArray
from contactstudy.contact.refinement.laws import EndLaw
from contactstudy.contact.refinement.refinement import AxialShape, ValuePairs, count_from_end, evaluate_pairs

EDGES = 3.0 + 1e-2 * np.cumsum([0.0, 1.0, 1.5, 2.5, 4.0, 6.0, 9.0, 4.0, 7.0, 5.0, 4.0, 3.0, 2.0, 1.0])
SECTION_PRESSURE = np.sqrt(np.array([0.0, 0.19, 0.91, 0.91, 0.19, 0.0]))
"""Pressure across the contact; the parabola through its squares has the maximum 1 between the cells."""


def compute_column_means(coefficients: list[float], edges: FloatArray) -> FloatArray:
    """Means over columns of a polynomial in the distance from the middle."""
    complete = np.polynomial.polynomial.polyint(coefficients)
    mid_x = 0.5 * (edges[0] + edges[-1])
    return np.asarray(np.diff(np.polynomial.polynomial.polyval(edges - mid_x, complete)) / np.diff(edges))


def evaluate_columns(
    column_pressures: FloatArray, laws: tuple[EndLaw | None, EndLaw | None] = (None, None), half_width: float = 0.1
) -> tuple[ValuePairs, float]:
    start, stop = float(EDGES[0]), float(EDGES[-1])
    shape = AxialShape(
        start=start, stop=stop, half_width=half_width, depth=1.0, height=np.zeros_like, face_beyond=(0.0, 0.0)
    )
    return evaluate_pairs(EDGES, column_pressures[:, None] * SECTION_PRESSURE, shape, laws)


@pytest.mark.parametrize("tilt", [2.0, -2.0])
def test_pressure_rising_to_end_peaks_at_end(tilt: float) -> None:
    """The value is exact for a parabola, between the cells along y as well."""
    half_length = 0.5 * (EDGES[-1] - EDGES[0])
    coefficients = [1.0, tilt, 1.5]
    values, correction_y = evaluate_columns(compute_column_means(coefficients, EDGES))
    peaks = values["peak_pressure"]
    exact_pressures = [
        float(np.polynomial.polynomial.polyval(position, coefficients)) for position in (-half_length, half_length)
    ]
    assert values["end_pressure"] == pytest.approx(exact_pressures, rel=1e-9)
    higher_end = 1 if tilt > 0 else 0
    assert peaks[higher_end] == pytest.approx(exact_pressures[higher_end], rel=1e-9)
    # The peak of the other half lies at mid-length between two columns, or on the outermost column.
    centres, column_pressures = 0.5 * (EDGES[1:] + EDGES[:-1]) - EDGES[0], compute_column_means(coefficients, EDGES)
    expected = column_pressures[(centres < half_length) if higher_end else (centres > half_length)].max()
    assert peaks[1 - higher_end] == pytest.approx(max(expected, np.interp(half_length, centres, column_pressures)))
    assert 1 + correction_y == pytest.approx(1 / SECTION_PRESSURE.max())


def test_halves_have_separate_peaks() -> None:
    column_pressures = np.ones(EDGES.size - 1)
    column_pressures[7] = 3.0  # this is the second column beyond the middle
    values, _ = evaluate_columns(column_pressures)
    assert (0.5 * (EDGES[6] + EDGES[7]) - EDGES[0]) / (EDGES[-1] - EDGES[0]) > 0.5
    assert values["peak_pressure"] == pytest.approx([1.0, 3.0])
    assert values["end_pressure"] == pytest.approx([1.0, 1.0])


def test_end_pressure_is_zero_or_infinite() -> None:
    column_pressures = np.append(np.zeros(3), np.ones(EDGES.size - 4))
    values, _ = evaluate_columns(column_pressures, (None, EndLaw(exponent=0.5)))
    assert values["end_pressure"] == [0.0, np.inf]
    assert values["peak_pressure"] == [pytest.approx(1.0), np.inf]
    falling_pressures = column_pressures.copy()
    falling_pressures[:3] = 0.01, 0.5, 1.0  # The parabola through these means is negative at the end.
    assert evaluate_columns(falling_pressures)[0]["end_pressure"][0] == 0.0


@pytest.mark.parametrize("width", [1e-2, 2e-2, 0.1, 1.0])
def test_end_loads_integrate_one_half_width(width: float) -> None:
    column_pressures = np.random.default_rng(0).uniform(1.0, 2.0, EDGES.size - 1)
    fine_edges = np.linspace(EDGES[0], EDGES[-1], 200001)
    centres, step = 0.5 * (fine_edges[1:] + fine_edges[:-1]), fine_edges[1] - fine_edges[0]
    step_loads = column_pressures[np.searchsorted(EDGES, centres) - 1] * SECTION_PRESSURE.sum() * step
    expected = [step_loads[centres < EDGES[0] + width].sum(), step_loads[centres > EDGES[-1] - width].sum()]
    assert evaluate_columns(column_pressures, half_width=width)[0]["end_load"] == pytest.approx(expected, rel=1e-3)


def test_values_mirror_with_side() -> None:
    column_values = np.arange(EDGES.size - 1.0)
    first_count, last_count = (count_from_end(side, EDGES, column_values) for side in (0, 1))
    assert first_count[0][0] == last_count[0][0] == 0.0
    assert first_count[0][-1] == pytest.approx(last_count[0][-1])
    assert np.diff(last_count[0]) == pytest.approx(np.diff(EDGES)[::-1])
    assert last_count[1].tolist() == column_values[::-1].tolist()
