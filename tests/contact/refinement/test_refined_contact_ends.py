"""Ends of refined contacts: singular, finite, fading, close to the end of a body, or free of contact."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Case, FiniteLengthSpace, Material, QuarterSpace, Roller, profiles, solve, stress_field
from contactstudy.contact.refinement.laws import edge_peak
from contactstudy.contact.refinement.refined_contact import refined_values
from tests.contact.refinement.rollers import (
    HALF_SPACE,
    HALF_WIDTH,
    LENGTH,
    PRESSURE,
    RADIUS,
    SHORT,
    STEEL,
    compute_finer_peak,
    make_filleted_roller,
    make_finite_body,
    refine_case,
)


def test_sharp_rigid_end_has_square_root_law() -> None:
    case = Case(body=HALF_SPACE, roller=Roller(radius=RADIUS, length=LENGTH), max_pressure=PRESSURE)
    values = refined_values(case, refine_case(case))
    assert np.isinf(values.peak_pressure)
    assert np.isinf(values.peak_pressure_error)
    for side in ("first", "last"):
        assert float(values[f"end_exponent_{side}"]) == 0.5
        intensity = float(values[f"end_intensity_{side}"])
        assert intensity / (PRESSURE * np.sqrt(HALF_WIDTH)) == pytest.approx(0.8125, rel=5e-3)
        error = float(values[f"end_intensity_{side}_error"])
        assert (
            abs(intensity / (PRESSURE * np.sqrt(HALF_WIDTH)) - 0.8125) * PRESSURE * np.sqrt(HALF_WIDTH)
            <= error
            < 0.01 * intensity
        )


def test_edge_peak_matches_small_fillet() -> None:
    fillet_radius = 0.01e-3
    sharp_contact = refine_case(
        Case(body=HALF_SPACE, roller=Roller(radius=RADIUS, length=LENGTH), max_pressure=PRESSURE)
    )
    law = sharp_contact.refined.laws[0]
    assert law is not None
    filleted_contact = refine_case(
        Case(body=HALF_SPACE, roller=make_filleted_roller(fillet_radius), max_pressure=PRESSURE)
    )
    assert filleted_contact.refined.accurate
    assert edge_peak(law.intensity, STEEL.plane_strain_modulus, fillet_radius) == pytest.approx(
        filleted_contact.refined.peak, rel=0.01
    )


def test_flush_end_of_a_free_body_has_a_finite_pressure() -> None:
    """The end pressure is 0.497 p0, extrapolated from columns down to 0.003 a."""
    case = Case(body=make_finite_body(), roller=Roller(radius=RADIUS, length=LENGTH), max_pressure=PRESSURE)
    contact = refine_case(case)
    computed, values = contact.refined, refined_values(case, contact)
    assert computed.laws == [None, None]
    assert float(values["peak_pressure"]) == max(
        float(values[f"peak_pressure_{end_pressure}"]) for end_pressure in ("first", "last")
    )
    grid, pressure = contact.contact.shape.grid, contact.contact.pressure
    assert float(values["end_load_first"]) == pytest.approx(
        grid.dy * pressure.sum(axis=1) @ np.diff(np.minimum(grid.x_edges, HALF_WIDTH))
    )
    assert float(values["end_pressure_first"]) == computed.values["end_pressure"][0]
    for end_pressure, error in zip(computed.values["end_pressure"], computed.errors["end_pressure"], strict=True):
        assert end_pressure / PRESSURE == pytest.approx(0.497, abs=0.005)
        assert abs(end_pressure / PRESSURE - 0.497) <= error / PRESSURE <= 0.01
    assert computed.peak / PRESSURE == pytest.approx(1.013, abs=0.004)


def test_tilted_end_without_correction_has_logarithm() -> None:
    body = FiniteLengthSpace(length=LENGTH, material=STEEL, model="mirror")
    case = Case(body=body, roller=Roller(radius=RADIUS, length=LENGTH), max_pressure=PRESSURE, tilt=5e-4)
    laws = refine_case(case).refined.laws
    assert 0.0 in [law.exponent for law in laws if law is not None]
    computed = refine_case(
        Case(body=make_finite_body(), roller=Roller(radius=RADIUS, length=LENGTH), max_pressure=PRESSURE, tilt=5e-4)
    ).refined
    assert computed.laws == [None, None]
    assert computed.values["end_pressure"][0] < computed.values["end_pressure"][1] < computed.peak


def test_singular_end_with_unloaded_half() -> None:
    roller = Roller(radius=RADIUS, length=0.3e-3, profile=profiles.FullCrown(0.5))
    computed = refine_case(Case(body=HALF_SPACE, roller=roller, max_pressure=PRESSURE, tilt=0.02), 0.1).refined
    assert computed.accurate
    assert computed.values["peak_pressure"] == [0.0, np.inf]
    assert computed.values["end_load"][0] == 0.0


def test_sharp_elastic_end_has_smaller_exponent() -> None:
    """The exponent of a 90 degree edge on a half-space of the same material without friction is about 0.226."""
    half_width = 2 * HALF_WIDTH
    roller = Roller(radius=RADIUS, length=30 * half_width, material=STEEL)
    case = Case(body=make_finite_body(60 * half_width), roller=roller, max_pressure=PRESSURE)
    laws = refine_case(case).refined.laws
    for law in laws:
        assert law is not None
        assert 0.2 < law.exponent < 0.24


def test_crowned_roller_peaks_at_mid_length() -> None:
    crown = profiles.Lundberg.for_pressure(PRESSURE, radius=RADIUS, modulus=STEEL.plane_strain_modulus)
    case = Case(
        body=make_finite_body(), roller=Roller(radius=RADIUS, length=LENGTH, profile=crown), max_pressure=PRESSURE
    )
    computed = refine_case(case)
    assert computed.refined.values["end_pressure"] == [0.0, 0.0]
    assert computed.refined.errors["end_pressure"] == [0.0, 0.0]
    assert abs(computed.refined.peak - compute_finer_peak(case, computed, 2)) <= computed.refined.peak_error
    assert computed.refined.peak / PRESSURE == pytest.approx(1.044, abs=0.005)


@pytest.mark.parametrize(("material", "distance"), [(None, 1e-3), pytest.param(STEEL, -1e-2, marks=pytest.mark.slow)])
def test_end_near_free_end_matches_flush_end(material: Material | None, distance: float) -> None:
    """The remaining face is much narrower than the columns; every public function accepts the result's cells."""
    case, flush_case = (
        Case(
            body=QuarterSpace(material=STEEL),
            roller=make_filleted_roller(0.2e-3, SHORT, material),
            max_pressure=PRESSURE,
            end_distance=distance_over_a * HALF_WIDTH,
        )
        for distance_over_a in (distance, 0.0)
    )
    computed = solve(case, accuracy=0.05, y=[0.0], z=[0.3 * HALF_WIDTH], x=[0.0, HALF_WIDTH])
    flush_result = solve(flush_case, accuracy=0.05, stresses=False)
    assert bool(computed.converged)
    assert float(computed.peak_pressure) == pytest.approx(float(flush_result.peak_pressure), rel=0.01)
    repeated_stress = stress_field(
        case.body, computed.pressure, x=[0.0, HALF_WIDTH], y=[0.0], z=[0.3 * HALF_WIDTH], inside_cells=computed.pressure
    )
    # The certificate uses the quadrature of the stresses in `solve`.
    assert np.allclose(repeated_stress.von_mises.values, computed.von_mises.values, rtol=1e-5)


@pytest.mark.parametrize("distance", [1e-4, 0.05])
def test_sharp_end_near_free_end_has_infinite_error(distance: float) -> None:
    """At 1e-4 a no column resolves the law; at 0.05 a the error of the fitted intensity is some percent."""
    case = Case(
        body=make_finite_body(LENGTH + 2 * distance * HALF_WIDTH),
        roller=Roller(radius=RADIUS, length=LENGTH),
        max_pressure=PRESSURE,
    )
    computed = refined_values(case, refine_case(case))
    assert np.isinf(computed["end_pressure_first_error"])
    if distance > 1e-3:
        intensity = computed["end_intensity_first"] / (PRESSURE * np.sqrt(HALF_WIDTH))
        assert float(intensity) == pytest.approx(0.1015, rel=0.06)
        assert float(computed["end_intensity_first_error"] / computed["end_intensity_first"]) > 0.05


def test_fading_end_has_infinite_error() -> None:
    """The pressure of the first column decreases by 5 % with each halving of its width, from 0.64 to 0.47 p0 and
    below."""
    rubber = Material(6e8, 0.0)
    roller = Roller(radius=RADIUS, length=0.13e-3, material=rubber)
    body = QuarterSpace(material=rubber, model="mirror-factor")
    case = Case(body=body, roller=roller, max_pressure=2e6)
    computed = refined_values(case, refine_case(case, 0.02))
    assert np.isinf(computed["end_pressure_first_error"])
    assert 0 < float(computed["peak_pressure_first_error"]) < 0.02 * float(computed["peak_pressure_first"])


def test_single_loaded_sharp_end_has_law() -> None:
    body = make_finite_body(3e-3)
    case = Case(body=body, roller=Roller(radius=RADIUS, length=2e-3), load=100.0, end_distance=0.5e-3, tilt=2e-3)
    unloaded_end_law, law = refine_case(case, 0.05).refined.laws
    assert unloaded_end_law is None
    assert law is not None
    assert law.exponent == 0.5


@pytest.mark.parametrize(("material", "distance"), [(STEEL, 1e-3), pytest.param(None, 1e-4, marks=pytest.mark.slow)])
def test_law_of_nearly_flush_end_does_not_depend_on_accuracy(material: Material | None, distance: float) -> None:
    """On columns several times wider than the face beyond the roller, the end pressure hardly increases."""
    body = FiniteLengthSpace(length=SHORT + 2 * distance * HALF_WIDTH, material=STEEL)
    case = Case(body=body, roller=Roller(radius=RADIUS, length=SHORT, material=material), max_pressure=PRESSURE)
    results = [solve(case, accuracy=accuracy, stresses=False) for accuracy in (0.05, 0.01, 0.005)]
    for result in results:
        assert np.isinf([result.end_pressure_first, result.peak_pressure]).all()
        assert float(result.end_exponent) == pytest.approx(0.5 if material is None else 0.226, abs=1e-3)
        assert float(result.end_intensity) == pytest.approx(float(results[-1].end_intensity), rel=0.01)


def test_law_of_corner_does_not_depend_on_accuracy() -> None:
    roller = Roller(radius=RADIUS, length=SHORT, profile=profiles.Chamfer(width=0.5 * HALF_WIDTH, angle=0.3))
    case = Case(body=HALF_SPACE, roller=roller, max_pressure=PRESSURE)
    results = [solve(case, accuracy=accuracy, stresses=False) for accuracy in (0.05, 0.01, 0.005)]
    assert [float(result.corner_distance) for result in results] == pytest.approx(
        [float(results[-1].corner_distance)] * 3, rel=0.02
    )


class Roof:
    """A roof with slopes of 0.1."""

    def drop(self, x: np.ndarray, length: float) -> np.ndarray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        return 0.1 * np.abs(x)


def test_window_is_widened_for_ridge_of_a_long_roller() -> None:
    roller = Roller(radius=RADIUS, length=4000 * HALF_WIDTH, profile=Roof())
    case = Case(body=HALF_SPACE, roller=roller, max_pressure=PRESSURE)
    pressure = solve(case, accuracy=0.1, stresses=False).pressure.any("x")
    assert float(pressure.y[pressure].max()) > 12 * HALF_WIDTH
