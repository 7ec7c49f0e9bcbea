"""Values of known pressures on columns: peaks of both halves, end pressures and end loads."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy.checks import FloatArray
from contactstudy.contact.refinement.laws import EndLaw
from contactstudy.contact.refinement.refinement import AxialShape, ValuePairs, count_from_end, evaluate_pairs

EDGES = 3.0 + 1e-2 * np.cumsum([0.0, 1.0, 1.5, 2.5, 4.0, 6.0, 9.0, 4.0, 7.0, 5.0, 4.0, 3.0, 2.0, 1.0])
ACROSS = np.sqrt(np.array([0.0, 0.19, 0.91, 0.91, 0.19, 0.0]))
"""Pressure across the contact, whose top between the cells is 1 by the parabola through the squares."""


def means(powers: list[float], edges: FloatArray) -> FloatArray:
    """Means over columns of a polynomial in the distance from the middle."""
    complete = np.polynomial.polynomial.polyint(powers)
    mid_x = 0.5 * (edges[0] + edges[-1])
    return np.asarray(np.diff(np.polynomial.polynomial.polyval(edges - mid_x, complete)) / np.diff(edges))


def values_of(
    column_loads: FloatArray, laws: tuple[EndLaw | None, EndLaw | None] = (None, None), half_width: float = 0.1
) -> tuple[ValuePairs, float]:
    start, stop = float(EDGES[0]), float(EDGES[-1])
    shape = AxialShape(
        start=start, stop=stop, half_width=half_width, depth=1.0, height=np.zeros_like, face_beyond=(0.0, 0.0)
    )
    return evaluate_pairs(EDGES, column_loads[:, None] * ACROSS, shape, laws)


@pytest.mark.parametrize("tilt", [2.0, -2.0])
def test_pressure_rising_to_end_peaks_at_end(tilt: float) -> None:
    """The value is exact for a parabola, between the cells along y as well."""
    half_length = 0.5 * (EDGES[-1] - EDGES[0])
    powers = [1.0, tilt, 1.5]
    values, along_y = values_of(means(powers, EDGES))
    peaks = values["peak_pressure"]
    exact_pressures = [
        float(np.polynomial.polynomial.polyval(position, powers)) for position in (-half_length, half_length)
    ]
    assert values["end_pressure"] == pytest.approx(exact_pressures, rel=1e-9)
    risen = 1 if tilt > 0 else 0
    assert peaks[risen] == pytest.approx(exact_pressures[risen], rel=1e-9)
    # The other half is largest in the middle, between two columns, or on its last column if that is larger.
    centres, column_loads = 0.5 * (EDGES[1:] + EDGES[:-1]) - EDGES[0], means(powers, EDGES)
    expected = column_loads[(centres < half_length) if risen else (centres > half_length)].max()
    assert peaks[1 - risen] == pytest.approx(max(expected, np.interp(half_length, centres, column_loads)))
    assert 1 + along_y == pytest.approx(1 / ACROSS.max())


def test_halves_have_separate_peaks() -> None:
    column_loads = np.ones(EDGES.size - 1)
    column_loads[7] = 3.0  # this is the second column beyond the middle
    values, _ = values_of(column_loads)
    assert (0.5 * (EDGES[6] + EDGES[7]) - EDGES[0]) / (EDGES[-1] - EDGES[0]) > 0.5
    assert values["peak_pressure"] == pytest.approx([1.0, 3.0])
    assert values["end_pressure"] == pytest.approx([1.0, 1.0])


def test_ends_without_pressure_and_singular_ends() -> None:
    column_loads = np.append(np.zeros(3), np.ones(EDGES.size - 4))
    values, _ = values_of(column_loads, (None, EndLaw(exponent=0.5)))
    assert values["end_pressure"] == [0.0, np.inf]
    assert values["peak_pressure"] == [pytest.approx(1.0), np.inf]
    falling = column_loads.copy()
    falling[:3] = 0.01, 0.5, 1.0  # The parabola through these means is negative at the end.
    assert values_of(falling)[0]["end_pressure"][0] == 0.0


@pytest.mark.parametrize("width", [1e-2, 2e-2, 0.1, 1.0])
def test_end_loads_integrate_one_half_width(width: float) -> None:
    column_loads = np.random.default_rng(0).uniform(1.0, 2.0, EDGES.size - 1)
    fine = np.linspace(EDGES[0], EDGES[-1], 200001)
    centres, step = 0.5 * (fine[1:] + fine[:-1]), fine[1] - fine[0]
    step_loads = column_loads[np.searchsorted(EDGES, centres) - 1] * ACROSS.sum() * step
    expected = [step_loads[centres < EDGES[0] + width].sum(), step_loads[centres > EDGES[-1] - width].sum()]
    assert values_of(column_loads, half_width=width)[0]["end_load"] == pytest.approx(expected, rel=1e-3)


def test_values_mirror_with_side() -> None:
    column_values = np.arange(EDGES.size - 1.0)
    first, last = (count_from_end(side, EDGES, column_values) for side in (0, 1))
    assert first[0][0] == last[0][0] == 0.0
    assert first[0][-1] == pytest.approx(last[0][-1])
    assert np.diff(last[0]) == pytest.approx(np.diff(EDGES)[::-1])
    assert last[1].tolist() == column_values[::-1].tolist()
