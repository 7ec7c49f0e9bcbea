"""The law of a singular end: its exponent, its intensity, and the peak at an edge of small radius."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import InvalidInputError
from contactstudy.checks import FloatArray
from contactstudy.contact.refinement.laws import RIGID, EndLaw, Sample, edge_peak, elastic_exponent, law_of

WIDTHS = 0.1 * 0.5 ** np.arange(7)


def compute_column_means(edges: FloatArray, exponent: float, intensity: float, relative_slope: float) -> FloatArray:
    """Means over columns of ``K d**-m (1 + c d)``."""
    first_power, second_power = 1 - exponent, 2 - exponent
    primitive = edges**first_power / first_power + relative_slope * edges**second_power / second_power
    return np.asarray(intensity * np.diff(primitive) / np.diff(edges))


def make_graded_edges(width: float) -> FloatArray:
    return width * np.concatenate([np.arange(9.0), 8 + 2 * np.arange(1, 9), 24 + 4 * np.arange(1, 17)])


@given(intensity=st.floats(1e-3, 1e9), relative_slope=st.floats(-3.0, 3.0))
def test_rigid_end_intensity_matches_power_law(intensity: float, relative_slope: float) -> None:
    edges = make_graded_edges(1e-3)
    pressure = compute_column_means(edges, 0.5, intensity, relative_slope)[:, None] * np.array([0.4, 1.0, 0.4])
    law = EndLaw(exponent=0.5).with_intensity(edges, pressure, np.inf)
    assert law.intensity == pytest.approx(intensity, rel=1e-6)
    assert 0 < law.intensity_error < 5e-3 * intensity


def test_intensity_uses_row_of_end_peak() -> None:
    # Random case 4007234: friction loads both ends at different positions along y, the other end more.
    edges = make_graded_edges(1e-3)
    end_pressure = compute_column_means(edges, 0.5, 2.0, 0.0)
    far_row_pressure = np.where(edges[1:] > 0.03, 10 * end_pressure.max(), 0.0)
    law = EndLaw(exponent=0.5).with_intensity(
        edges, np.stack([0.5 * end_pressure, end_pressure, far_row_pressure], axis=1), np.inf
    )
    assert law.intensity == pytest.approx(2.0, rel=1e-6)
    law_of_unloaded_end = law.with_intensity(edges, np.stack([far_row_pressure, far_row_pressure], axis=1), np.inf)
    assert (law_of_unloaded_end.intensity, law_of_unloaded_end.intensity_error) == (0.0, np.inf)


@pytest.mark.parametrize("exponent", [0.5, np.nan])
def test_few_columns_have_infinite_intensity_error(exponent: float) -> None:
    # Random case 4004708: friction reduces the contact to five columns.
    edges = make_graded_edges(1e-3)
    pressure = compute_column_means(edges, 0.5, 2.0, 0.0)[:, None].copy()
    pressure[5:] = 0.0
    law = EndLaw(exponent=exponent).with_intensity(edges, pressure, np.inf)
    assert law.intensity_error == np.inf
    assert law.intensity > 0
    if exponent == 0.5:
        assert law.intensity == pytest.approx(2.0)


@pytest.mark.parametrize("exponent", [0.15, 0.226, 0.3, 0.45])
def test_exponent_of_an_elastic_end_is_fitted(exponent: float) -> None:
    edges = make_graded_edges(1e-3)
    pressure = compute_column_means(edges, exponent, 2.0, -0.5)[:, None]
    law = EndLaw(exponent=np.nan).with_intensity(edges, pressure, np.inf)
    assert law.exponent == pytest.approx(exponent, abs=1e-3)
    assert law.intensity == pytest.approx(2.0, rel=1e-2)


def compute_wedge_slope(angle: float, s: float) -> float:
    """Slope of the loaded face of a wedge over its pressure ``r**(s - 1)``, up to a constant of the material.

    Airy's function is ``r**(s + 1) F(t)``; its constants cancel in the ratio of two slopes.
    """

    def compute_fundamental_solutions(t: float) -> FloatArray:
        """F, F' and F'' of the four fundamental solutions."""
        solutions = []
        for exponent in (s + 1, s - 1):
            cosine, sine = np.cos(exponent * t), np.sin(exponent * t)
            solutions += [
                (cosine, -exponent * sine, -(exponent**2) * cosine),
                (sine, exponent * cosine, -(exponent**2) * sine),
            ]
        return np.array(solutions).T

    loaded_face, free_face = compute_fundamental_solutions(0.0), compute_fundamental_solutions(angle)
    # Stresses divided by r**(s - 1): s (s + 1) F across the radius, shear -s F'.
    conditions = np.array([s * (s + 1) * loaded_face[0], loaded_face[1], free_face[0], free_face[1]])
    _, b, _, d = np.linalg.solve(conditions, [-1.0, 0.0, 0.0, 0.0])
    # Displacement across r**s: solutions with s + 1 have 2 G u = -dF / r, those with s - 1 also a term of the
    # Laplacian.
    return float(s * (-(s + 1) * b - (s - 1) * d - 4 * d))


@pytest.mark.parametrize("s", [0.55, 0.7, 0.7736, 0.9])
def test_elastic_exponent_satisfies_wedge_equation(s: float) -> None:
    quarter_space_slope = np.sin(np.pi * s) / (2 * (np.sin(0.5 * np.pi * s) ** 2 - s**2))
    half_space_slope = 1 / np.tan(np.pi * s)
    slope_ratio = compute_wedge_slope(0.5 * np.pi, s) / compute_wedge_slope(np.pi, s)
    assert slope_ratio == pytest.approx(quarter_space_slope / half_space_slope)


@given(ratio=st.floats(1e-3, 1e3))
def test_elastic_exponent_lies_between_rigid_limits(ratio: float) -> None:
    exponent = elastic_exponent(ratio, 1.0)
    assert 0 < exponent < RIGID
    assert exponent == pytest.approx(elastic_exponent(5 * ratio, 5.0))
    assert elastic_exponent(1.1 * ratio, 1.0) < exponent


def make_samples(pressure: FloatArray) -> list[Sample]:
    return [Sample(float(width), float(peak)) for width, peak in zip(WIDTHS, pressure, strict=True)]


@given(exponent=st.floats(0.15, 0.5))
def test_power_growth_has_power_law(exponent: float) -> None:
    theory_law, fitted_law = (
        law_of(make_samples(WIDTHS**-exponent), theory_exponent) for theory_exponent in (RIGID, np.nan)
    )
    assert theory_law == EndLaw(exponent=RIGID)
    assert fitted_law is not None
    assert np.isnan(fitted_law.exponent)


@given(growth_rate=st.floats(0.02, 0.2))
def test_logarithmic_growth_has_logarithm_law(growth_rate: float) -> None:
    growing_samples = make_samples(1 + growth_rate * np.log(1 / WIDTHS))
    law = law_of(growing_samples, np.nan)
    assert law is not None
    assert law.exponent == 0
    assert law_of(growing_samples, 0.2264) == EndLaw(exponent=0.2264)
    assert np.isnan(law.with_intensity(make_graded_edges(1e-3), np.ones((32, 1)), np.inf).intensity)


@given(power=st.floats(0.6, 2.0), growth_rate=st.floats(0.0, 1.0))
def test_converged_end_has_no_singular_law(power: float, growth_rate: float) -> None:
    assert law_of(make_samples(1 - growth_rate * WIDTHS**power), np.nan) is None


def test_few_samples_and_falling_pressures_have_no_law() -> None:
    assert law_of(make_samples(WIDTHS**-0.5)[:3], np.nan) is None
    assert law_of(make_samples(WIDTHS**0.5), np.nan) is None


def test_end_loaded_on_some_columns_has_no_law() -> None:
    assert law_of(make_samples(np.array([1.0, 1.0, 1.0, 1.0, 0.5, 0.0, 0.3])), np.nan) is None


def test_loaded_end_has_theoretical_exponent() -> None:
    assert law_of(make_samples(np.array([1.0, 1.0, 1.0, 1.0, 0.9, 0.9, 0.8])), RIGID) == EndLaw(exponent=RIGID)
    assert law_of(make_samples(np.array([1.0, 1.0, 1.0, 1.0, 0.5, 0.2, 0.0])), RIGID) is None


@given(intensity=st.floats(1e3, 1e9), radius=st.floats(1e-7, 1e-3), factor=st.floats(0.1, 10.0))
def test_peak_at_edge_radius_is_a_power_law(intensity: float, radius: float, factor: float) -> None:
    peak = edge_peak(intensity, 231e9, radius)
    assert edge_peak(intensity, 231e9, factor * radius) == pytest.approx(peak * factor ** (-1 / 3))
    assert edge_peak(factor * intensity, 231e9, radius) == pytest.approx(peak * factor ** (2 / 3))
    assert edge_peak(intensity, factor * 231e9, radius) == pytest.approx(peak * factor ** (1 / 3))


@pytest.mark.parametrize(
    ("arguments", "name"),
    [((0.0, 1e9, 1e-5), "intensity"), ((1e7, -1.0, 1e-5), "modulus"), ((1e7, 1e9, np.nan), "edge_radius")],
)
def test_invalid_edges_raise_error(arguments: tuple[float, float, float], name: str) -> None:
    with pytest.raises(InvalidInputError, match=name):
        edge_peak(*arguments)


EDGES = np.array(
    [0.0, 1.0, 2.0, 3.0, 3.2, 4.0, 5.0, 6.0, 7.0, 9.0, 12.0, 17.0, 25.0, 38.0, 64.0, 66.0, 90.0, 128.0, 135.0]
)


@pytest.mark.parametrize("unit", [1.0, 1e-6, 1e3])
def test_fit_uses_columns_from_3_to_64_widths(unit: float) -> None:
    """The fit uses columns from 3 to 64 widths, its error columns from 6 to 128; other columns have no influence."""
    pressure = compute_column_means(unit * EDGES, 0.5, 2.0, 0.01 / unit)[:, None]

    def fit_end_law(changed_distance: float) -> EndLaw:
        changed_pressure = pressure.copy()
        changed_pressure[int(np.flatnonzero(changed_distance == EDGES)[0])] *= 1.5
        return EndLaw(exponent=0.5).with_intensity(unit * EDGES, changed_pressure, np.inf)

    baseline = EndLaw(exponent=0.5).with_intensity(unit * EDGES, pressure, np.inf)
    assert baseline.intensity == pytest.approx(2.0)
    for changed_distance in (2.0, 128.0):
        assert fit_end_law(changed_distance) == baseline
    for changed_distance in (3.0, 38.0):
        assert fit_end_law(changed_distance).intensity != pytest.approx(2.0, rel=1e-3)
    for changed_distance in (64.0, 90.0):
        assert fit_end_law(changed_distance).intensity == pytest.approx(2.0)
        assert fit_end_law(changed_distance).intensity_error > 2 * baseline.intensity_error


@pytest.mark.parametrize("width", [1e-5, 1.0, 1e3])
def test_end_near_free_end_has_larger_error(width: float) -> None:
    """The law is invalid beyond half of the face between the ends; the fit uses columns up to 64 widths."""
    edges = width * EDGES
    pressure = compute_column_means(edges, 0.5, 2.0, 0.0)[:, None]
    wide_face_law, narrow_face_law = (
        EndLaw(exponent=0.5).with_intensity(edges, pressure, face_width * width).intensity_error
        for face_width in (129.0, 127.0)
    )
    assert wide_face_law == pytest.approx(3e-3 * 2.0)
    assert narrow_face_law - wide_face_law == pytest.approx(0.08 * 2.0)
    nearly_flush_law = EndLaw(exponent=0.5).with_intensity(edges, pressure, 2.9 * width)
    assert nearly_flush_law.intensity_error == np.inf


def test_elastic_end_has_larger_error_of_change() -> None:
    """The factor 1.5 multiplies the change with the limits of the fit, not the error of the steps."""
    pressure = compute_column_means(EDGES, 0.5, 2.0, 0.01)[:, None]
    pressure[np.searchsorted(EDGES, 90.0)] *= 1.1
    rigid_law, elastic_law = (
        EndLaw(exponent=exponent).with_intensity(EDGES, pressure, np.inf) for exponent in (0.5, np.nextafter(0.5, 0.0))
    )
    changes = [law.intensity_error - 3e-3 * law.intensity for law in (rigid_law, elastic_law)]
    assert rigid_law.intensity_error > 1.5 * 3e-3 * rigid_law.intensity
    assert changes[1] == pytest.approx(1.5 * changes[0])


def test_rigid_exponent_bounds_elastic_exponent() -> None:
    edges = make_graded_edges(1e-3)
    law = EndLaw(exponent=np.nan).with_intensity(edges, compute_column_means(edges, 0.54, 2.0, 0.0)[:, None], np.inf)
    assert 0.49 < law.exponent <= 0.5


def test_logarithm_law_does_not_depend_on_splitting() -> None:
    widths = 0.1 * np.cumprod([1.0, 0.25, 0.25, 0.25, 0.5, 0.5])
    law = law_of([Sample(float(width), float(1 - 0.1 * np.log(width))) for width in widths], np.nan)
    assert law is not None
    assert law.exponent == 0
