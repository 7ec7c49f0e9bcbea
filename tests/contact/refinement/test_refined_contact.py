"""Contacts on refined columns: against finer cells, uniform cells and known peaks; cached results."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    FiniteLengthSpace,
    Grid,
    InvalidInputError,
    Material,
    QuarterSpace,
    Roller,
    choose_grid,
    profiles,
    solve,
)
from contactstudy.checks import FloatArray
from contactstudy.contact.refinement import refined_contact as module
from contactstudy.contact.refinement.refined_contact import (
    _axial_shape,
    _choose_cells_y,
    _roller_columns,
    refine_contact,
)
from contactstudy.errors import WindowError
from tests.contact.refinement.rollers import (
    CASES,
    HALF_SPACE,
    LENGTH,
    PRESSURE,
    RADIUS,
    SHORT,
    STEEL,
    A,
    filleted,
    finer_peak,
    finite,
    refined_at,
    top_of,
)

KNOWN_FILLETS = {0.5e-3: 2.8565, 0.2e-3: 3.6418, 0.1e-3: 4.4744, 0.05e-3: 5.556}
"""Peaks over p0 on a half-space from an independent refinement to 570 columns down to 0.0004 a."""


def test_fillet_peak_error_covers_finer_cells() -> None:
    fillet = 0.2e-3
    case = Case(body=HALF_SPACE, roller=filleted(fillet), max_pressure=PRESSURE)
    computed = refined_at(case)
    peak, error = computed.refined.peak, computed.refined.peak_error
    finer = finer_peak(case, computed, 2)
    assert computed.refined.accurate
    assert abs(peak - finer) <= error <= 0.01 * peak
    assert abs(peak - finer) < 0.003 * peak
    assert peak / PRESSURE == pytest.approx(KNOWN_FILLETS[fillet], rel=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("fillet", [max(KNOWN_FILLETS), min(KNOWN_FILLETS)])
def test_fillet_peak_error_covers_four_times_finer_cells(fillet: float) -> None:
    case = Case(body=HALF_SPACE, roller=filleted(fillet), max_pressure=PRESSURE)
    computed = refined_at(case)
    finer = finer_peak(case, computed, 4)
    assert finer / PRESSURE == pytest.approx(KNOWN_FILLETS[fillet], rel=1e-3)
    assert abs(computed.refined.peak - finer) <= computed.refined.peak_error <= 0.01 * computed.refined.peak
    assert abs(computed.refined.peak - finer) < 0.01 * finer


@pytest.mark.slow
@pytest.mark.parametrize("body", [finite(), QuarterSpace(material=STEEL)], ids=["finite", "quarter"])
def test_peak_error_between_free_ends_covers_finer_cells(body: FiniteLengthSpace | QuarterSpace) -> None:
    case = Case(body=body, roller=filleted(0.2e-3), max_pressure=PRESSURE)
    computed = refined_at(case)
    assert abs(computed.refined.peak - finer_peak(case, computed, 2)) <= computed.refined.peak_error


@pytest.mark.parametrize("name", [name for name in CASES if name not in ("inside", "tilt")])
def test_refined_contact_matches_uniform_cells(name: str) -> None:
    case = CASES[name]
    computed = solve(case, stresses=False)
    uniform = solve(case, choose_grid(case, cells_x=24, cells_y=16, window=3.0), stresses=False)
    peak, error = float(computed.peak_pressure), float(computed.peak_pressure_error)
    assert bool(computed.converged)
    assert error <= 0.01 * peak
    # The peak of a fillet of 3 a is within half a percent on these uniform cells, of an edge of the body within three.
    allowed = 0.03 if case.roller.material is not None else 0.006
    assert peak == pytest.approx(top_of(uniform.pressure.values), rel=allowed)
    assert float(computed.approach) == pytest.approx(float(uniform.approach), rel=1e-3)
    assert float(computed.tilt) == pytest.approx(float(uniform.tilt), rel=5e-3, abs=1e-9)
    assert abs(float(computed.load_error)) < 1e-9
    forces = computed.pressure * computed.x_width * float(computed.y[1] - computed.y[0])
    assert float(forces.sum()) == pytest.approx(case.normal_load, rel=1e-9)
    if case.load_position is not None:
        assert float((forces * computed.x).sum() / forces.sum()) == pytest.approx(case.load_position, rel=1e-9)
    # The loads are those on equal parts of the roller.
    section_edges = np.linspace(*case.contact_range, 9)
    loads = [load_up_to(variant, section_edges) for variant in (computed, uniform)]
    assert np.abs(loads[0] - loads[1]).max() < 2e-3 * case.normal_load


def load_up_to(result: xr.Dataset, x: FloatArray) -> FloatArray:
    widths = (
        result.x_width.values
        if "x_width" in result.coords
        else np.full(result.x.size, float(result.x[1] - result.x[0]))
    )
    edges = np.append(result.x.values - 0.5 * widths, result.x.values[-1] + 0.5 * widths[-1])
    column_loads = (result.pressure.values.sum(axis=1) * widths) * float(result.y[1] - result.y[0])
    return np.interp(x, edges, np.append(0.0, np.cumsum(column_loads)))


@pytest.mark.parametrize("name", ["flush", "half-space"])
def test_mirrored_case_has_the_mirrored_contact(name: str) -> None:
    tilts = [
        refined_at(Case(body=CASES[name].body, roller=CASES[name].roller, max_pressure=PRESSURE, tilt=tilt), 0.02)
        for tilt in (8e-4, -8e-4)
    ]
    original, mirrored = (variant.refined for variant in tilts)
    assert original.peak == pytest.approx(mirrored.peak, rel=1e-4)
    assert np.allclose(original.pressure.max(axis=1), mirrored.pressure[::-1].max(axis=1), atol=1e-4 * original.peak)


def test_measured_fillet_has_peak_of_fillet() -> None:
    formula_profile = filleted(0.2e-3).profile
    point_distances = np.concatenate([np.linspace(0, 0.2e-3, 401), np.linspace(0.21e-3, 1e-3, 80)])
    x = np.unique(
        np.concatenate([-LENGTH / 2 + point_distances, np.linspace(-4e-3, 4e-3, 161), LENGTH / 2 - point_distances])
    )
    table = profiles.Measured(x.tolist(), formula_profile.drop(x, LENGTH).tolist(), largest_spike=1e-3)
    peaks = []
    for profile in (formula_profile, table):
        roller = Roller(radius=RADIUS, length=LENGTH, profile=profile)
        computed = refined_at(Case(body=HALF_SPACE, roller=roller, max_pressure=PRESSURE)).refined
        assert computed.accurate
        peaks.append(computed.peak)
    assert peaks[1] == pytest.approx(peaks[0], rel=0.01)


@pytest.mark.parametrize("accuracy", [0.0, -0.01, 9e-4, 0.11, np.nan, "high"])
def test_invalid_accuracy_raises_error(accuracy: object) -> None:
    with pytest.raises(InvalidInputError, match="accuracy"):
        solve(CASES["half-space"], accuracy=accuracy, stresses=False)  # type: ignore[arg-type]


@pytest.mark.slow
def test_coupled_friction_changes_stated_values() -> None:
    """The columns follow the uncoupled contact; the values belong to the returned, coupled pressure."""
    body = FiniteLengthSpace(length=8 * A, material=Material(210e9, 0.1))
    roller = Roller(radius=RADIUS, length=8 * A)
    case = Case(body=body, roller=roller, max_pressure=PRESSURE, friction=0.5, coupled=True)
    computed = solve(case, stresses=False)
    fine = solve(case, choose_grid(case, cells_x=32, cells_y=32), stresses=False)
    uncoupled = solve(Case(body=body, roller=roller, max_pressure=PRESSURE), stresses=False)
    difference = abs(float(computed["peak_pressure"] - fine["pressure"].max()))
    assert difference < float(computed["peak_pressure_error"])
    assert float(computed["peak_pressure"]) == pytest.approx(float(computed["pressure"].max()), rel=3e-3)
    assert abs(float(computed["peak_pressure"] / uncoupled["peak_pressure"]) - 1) > 1e-3


@pytest.mark.parametrize(("accuracy", "least"), [(0.05, 8), (0.01, 17)])
def test_accuracy_determines_cells_across_peak(accuracy: float, least: int) -> None:
    computed = refine_contact(CASES["half-space"], accuracy, 1e-6)
    pressure = computed.contact.pressure
    assert int((pressure[int(pressure.max(axis=1).argmax())] > 0).sum()) >= least


class _Crown:
    """A user's mutable profile, which the test changes after a solution."""

    def __init__(self, radius: float) -> None:
        self.radius = radius

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        return np.asarray(x**2 / (2 * self.radius))


def test_cache_compares_cases_by_value() -> None:
    case = Case(body=HALF_SPACE, roller=filleted(0.2e-3, SHORT), max_pressure=PRESSURE)
    first_contact = refine_contact(case, 0.05, 1e-6)
    assert refine_contact(replace(case, friction=0.2), 0.05, 1e-6) is first_contact
    assert refine_contact(case, 0.04, 1e-6) is not first_contact
    assert refine_contact(replace(case, friction=0.2, coupled=True), 0.05, 1e-6) is not first_contact
    expected = _Crown(5e-3)
    changed = Case(body=HALF_SPACE, roller=Roller(radius=5e-3, length=SHORT, profile=expected), max_pressure=PRESSURE)
    previous_peak = refine_contact(changed, 0.05, 1e-6).refined.peak
    expected.radius = 2.5e-3
    assert refine_contact(changed, 0.05, 1e-6).refined.peak > 1.05 * previous_peak


def test_modified_result_does_not_change_next_result() -> None:
    first_result = solve(CASES["half-space"], stresses=False, accuracy=0.05)
    retained = first_result["pressure"].values.copy()
    for name in ("pressure", "gap", "displacement_z", "initial_gap"):
        first_result[name].values[:] = 0.0
    np.testing.assert_array_equal(solve(CASES["half-space"], stresses=False, accuracy=0.05)["pressure"], retained)


@pytest.mark.parametrize("fraction", [0.2, 0.5, 0.75, 0.95])
@pytest.mark.parametrize("accuracy", [0.2, 0.05, 0.01, 0.002])
def test_cell_number_is_least_sufficient_one(accuracy: float, fraction: float) -> None:
    """The error between cells is 0.7 over the square of the number of cells across the contact."""
    cells = _choose_cells_y(fraction, accuracy)

    def remaining_error(cells: int) -> float:
        return 0.7 / (cells * fraction) ** 2

    assert remaining_error(cells) <= 0.25 * accuracy or cells == 256
    assert remaining_error(cells // 2) > 0.25 * accuracy or cells == 32


@pytest.mark.parametrize("distance", [-0.2e-3, 0.0, 1e-15, 1e-9, 0.3e-3])
def test_face_length_beyond_roller_end(distance: float) -> None:
    """The face is the distance to the body's end; it is zero for ends in one plane and for an overhanging roller."""
    body = finite(1.5e-3)
    case = Case(body=body, roller=filleted(0.1e-3, 1e-3), max_pressure=PRESSURE, end_distance=distance)
    shape = _axial_shape(case)
    room = shape.face_beyond
    assert shape.depth == pytest.approx(case.hertz_half_width**2 / (2 * RADIUS))
    assert (shape.start, shape.stop) == pytest.approx((max(distance, 0.0), min(distance + 1e-3, 1.5e-3)))
    assert room == pytest.approx((max(distance, 0.0) if distance > 1e-12 else 0.0, 0.5e-3 - distance))
    assert room[0] == 0.0 or distance > 1e-12


def test_wide_contact_has_widest_window(monkeypatch: pytest.MonkeyPatch) -> None:
    case, attempts = Case(body=HALF_SPACE, roller=filleted(0.2e-3), max_pressure=PRESSURE), []

    def too_narrow(case: Case, half_window: float, accuracy: float, tolerance: float) -> object:
        attempts.append(half_window / case.hertz_half_width)
        if len(attempts) < 5:
            raise WindowError("too narrow")
        return "found"

    monkeypatch.setattr(module, "_refine_in_window", too_narrow)
    assert module._refine_contact(case, 0.01, 1e-6) == "found"
    assert attempts == pytest.approx([2.0, 3.0, 5.0, 8.0, 12.0])


FITTED = {
    "peaks at fillets": Case(body=HALF_SPACE, roller=filleted(0.2e-3, 1e-3), max_pressure=PRESSURE),
    "even": Case(
        body=FiniteLengthSpace(length=1e-3, material=STEEL, model="mirror"),
        roller=Roller(radius=RADIUS, length=1e-3),
        max_pressure=PRESSURE,
    ),
}


@pytest.mark.parametrize("name", FITTED)
def test_window_fits_contact(name: str) -> None:
    """The window exceeds the contact by at least a tenth, at most by a step of the windows and a coarse cell."""
    contact = refined_at(FITTED[name], 0.05).contact
    grid = contact.shape.grid
    reach = np.abs(grid.y[contact.pressure.any(axis=0)]).max() + 0.5 * grid.dy
    assert 1.05 < grid.y_range[1] / reach < 1.1 * 2 ** (1 / 6) * 1.15


def test_roller_columns_of_shifted_grid() -> None:
    grid = Grid.between(np.array([-3.0, -2.0, -1.0, 1.0, 1.5, 2.0, 4.0]), (0.0, 1.0), 2)
    assert _roller_columns(grid, np.array([1.0, 1.5, 2.0])) == slice(3, 5)
    assert _roller_columns(grid, np.array([-2.0 + 1e-12, -1.0])) == slice(1, 2)


@dataclass(frozen=True)
class Wavy(profiles.Shape):
    """A slight crown with waves."""

    crown_radius: float
    amplitude: float
    wave: float

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        waves = self.amplitude * (1 - np.cos(2 * np.pi * np.asarray(x) / self.wave))
        return np.asarray(x) ** 2 / (2 * self.crown_radius) + waves


def test_wavy_profile_crests_are_resolved() -> None:
    """Some crests below the depth of the first columns are loaded: the approach is several a**2/2R."""
    length, wave = 2e-3, 0.2e-3
    roller = Roller(radius=RADIUS, length=length, profile=Wavy(0.5, 0.6e-6, wave))
    case = Case(body=HALF_SPACE, roller=roller, max_pressure=0.7e9)
    refined = solve(case, stresses=False, accuracy=0.03)
    uniform = solve(case, choose_grid(case, cells_x=4, cells_y=12, window=3.0), stresses=False)
    for crest in range(5):
        is_crest = abs(abs(refined.x - length / 2) - crest * wave) < 0.35 * wave
        others = abs(abs(uniform.x - length / 2) - crest * wave) < 0.35 * wave
        loads = [
            float((result.pressure.sum("y") * widths).where(where).sum() * (result.y[1] - result.y[0]))
            for result, widths, where in (
                (refined, refined.x_width, is_crest),
                (uniform, float(uniform.x[1] - uniform.x[0]), others),
            )
        ]
        assert loads[0] == pytest.approx(loads[1], rel=0.02)
    assert abs(float(refined.peak_pressure) - float(uniform.pressure.max())) <= 1.5 * float(refined.peak_pressure_error)
