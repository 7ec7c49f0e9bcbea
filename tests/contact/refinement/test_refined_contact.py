"""Contacts on refined columns against finer cells, uniform cells and known peaks; cached results."""

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
    HALF_WIDTH,
    LENGTH,
    PRESSURE,
    RADIUS,
    SHORT,
    STEEL,
    compute_finer_peak,
    find_peak_between_cells,
    make_filleted_roller,
    make_finite_body,
    refine_case,
)

KNOWN_FILLETS = {0.5e-3: 2.8565, 0.2e-3: 3.6418, 0.1e-3: 4.4744, 0.05e-3: 5.556}
"""Peaks over p0 on a half-space from an independent refinement to 570 columns down to 0.0004 a."""


def test_fillet_peak_error_covers_finer_cells() -> None:
    fillet_radius = 0.2e-3
    case = Case(body=HALF_SPACE, roller=make_filleted_roller(fillet_radius), max_pressure=PRESSURE)
    computed = refine_case(case)
    peak, error = computed.refined.peak, computed.refined.peak_error
    finer_cells_peak = compute_finer_peak(case, computed, 2)
    assert computed.refined.accurate
    assert abs(peak - finer_cells_peak) <= error <= 0.01 * peak
    assert abs(peak - finer_cells_peak) < 0.003 * peak
    assert peak / PRESSURE == pytest.approx(KNOWN_FILLETS[fillet_radius], rel=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("fillet_radius", [max(KNOWN_FILLETS), min(KNOWN_FILLETS)])
def test_fillet_peak_error_covers_four_times_finer_cells(fillet_radius: float) -> None:
    case = Case(body=HALF_SPACE, roller=make_filleted_roller(fillet_radius), max_pressure=PRESSURE)
    computed = refine_case(case)
    finer_cells_peak = compute_finer_peak(case, computed, 4)
    assert finer_cells_peak / PRESSURE == pytest.approx(KNOWN_FILLETS[fillet_radius], rel=1e-3)
    assert abs(computed.refined.peak - finer_cells_peak) <= computed.refined.peak_error <= 0.01 * computed.refined.peak
    assert abs(computed.refined.peak - finer_cells_peak) < 0.01 * finer_cells_peak


@pytest.mark.slow
@pytest.mark.parametrize("body", [make_finite_body(), QuarterSpace(material=STEEL)], ids=["finite", "quarter"])
def test_peak_error_between_free_ends_covers_finer_cells(body: FiniteLengthSpace | QuarterSpace) -> None:
    case = Case(body=body, roller=make_filleted_roller(0.2e-3), max_pressure=PRESSURE)
    computed = refine_case(case)
    assert abs(computed.refined.peak - compute_finer_peak(case, computed, 2)) <= computed.refined.peak_error


@pytest.mark.parametrize("name", [name for name in CASES if name not in ("inside", "tilt")])
def test_refined_contact_matches_uniform_cells(name: str) -> None:
    case = CASES[name]
    computed = solve(case, stresses=False)
    uniform_result = solve(case, choose_grid(case, cells_x=24, cells_y=16, window=3.0), stresses=False)
    peak, error = float(computed.peak_pressure), float(computed.peak_pressure_error)
    assert bool(computed.converged)
    assert error <= 0.01 * peak
    # On these uniform cells the peak at a fillet of 3 a has an error of 0.5 percent, the peak at an edge of the body 3.
    peak_tolerance = 0.03 if case.roller.material is not None else 0.006
    assert peak == pytest.approx(find_peak_between_cells(uniform_result.pressure.values), rel=peak_tolerance)
    assert float(computed.approach) == pytest.approx(float(uniform_result.approach), rel=1e-3)
    assert float(computed.tilt) == pytest.approx(float(uniform_result.tilt), rel=5e-3, abs=1e-9)
    assert abs(float(computed.load_error)) < 1e-9
    forces = computed.pressure * computed.x_width * float(computed.y[1] - computed.y[0])
    assert float(forces.sum()) == pytest.approx(case.normal_load, rel=1e-9)
    if case.load_position is not None:
        assert float((forces * computed.x).sum() / forces.sum()) == pytest.approx(case.load_position, rel=1e-9)
    # Loads on eight sections of equal length
    section_edges = np.linspace(*case.contact_range, 9)
    loads = [compute_cumulative_load(variant, section_edges) for variant in (computed, uniform_result)]
    assert np.abs(loads[0] - loads[1]).max() < 2e-3 * case.normal_load


def compute_cumulative_load(result: xr.Dataset, x: FloatArray) -> FloatArray:
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
    contacts = [
        refine_case(Case(body=CASES[name].body, roller=CASES[name].roller, max_pressure=PRESSURE, tilt=tilt), 0.02)
        for tilt in (8e-4, -8e-4)
    ]
    tilted_contact, mirrored_contact = (variant.refined for variant in contacts)
    assert tilted_contact.peak == pytest.approx(mirrored_contact.peak, rel=1e-4)
    assert np.allclose(
        tilted_contact.pressure.max(axis=1),
        mirrored_contact.pressure[::-1].max(axis=1),
        atol=1e-4 * tilted_contact.peak,
    )


def test_measured_fillet_has_peak_of_fillet() -> None:
    formula_profile = make_filleted_roller(0.2e-3).profile
    point_distances = np.concatenate([np.linspace(0, 0.2e-3, 401), np.linspace(0.21e-3, 1e-3, 80)])
    x = np.unique(
        np.concatenate([-LENGTH / 2 + point_distances, np.linspace(-4e-3, 4e-3, 161), LENGTH / 2 - point_distances])
    )
    measured_profile = profiles.Measured(x.tolist(), formula_profile.drop(x, LENGTH).tolist(), largest_spike=1e-3)
    peaks = []
    for profile in (formula_profile, measured_profile):
        roller = Roller(radius=RADIUS, length=LENGTH, profile=profile)
        computed = refine_case(Case(body=HALF_SPACE, roller=roller, max_pressure=PRESSURE)).refined
        assert computed.accurate
        peaks.append(computed.peak)
    assert peaks[1] == pytest.approx(peaks[0], rel=0.01)


@pytest.mark.parametrize("accuracy", [0.0, -0.01, 9e-4, 0.11, np.nan, "high"])
def test_invalid_accuracy_raises_error(accuracy: object) -> None:
    with pytest.raises(InvalidInputError, match="accuracy"):
        solve(CASES["half-space"], accuracy=accuracy, stresses=False)  # type: ignore[arg-type]


@pytest.mark.slow
def test_values_belong_to_coupled_pressure() -> None:
    """The columns follow the uncoupled contact; the values belong to the returned, coupled pressure."""
    body = FiniteLengthSpace(length=8 * HALF_WIDTH, material=Material(210e9, 0.1))
    roller = Roller(radius=RADIUS, length=8 * HALF_WIDTH)
    case = Case(body=body, roller=roller, max_pressure=PRESSURE, friction=0.5, coupled=True)
    computed = solve(case, stresses=False)
    fine_result = solve(case, choose_grid(case, cells_x=32, cells_y=32), stresses=False)
    uncoupled_result = solve(Case(body=body, roller=roller, max_pressure=PRESSURE), stresses=False)
    difference = abs(float(computed["peak_pressure"] - fine_result["pressure"].max()))
    assert difference < float(computed["peak_pressure_error"])
    assert float(computed["peak_pressure"]) == pytest.approx(float(computed["pressure"].max()), rel=3e-3)
    assert abs(float(computed["peak_pressure"] / uncoupled_result["peak_pressure"]) - 1) > 1e-3


@pytest.mark.parametrize(("accuracy", "min_cells"), [(0.05, 8), (0.01, 17)])
def test_accuracy_determines_cells_across_peak(accuracy: float, min_cells: int) -> None:
    computed = refine_contact(CASES["half-space"], accuracy, 1e-6)
    pressure = computed.contact.pressure
    assert int((pressure[int(pressure.max(axis=1).argmax())] > 0).sum()) >= min_cells


class MutableCrown:
    """A user's mutable profile, which the test changes after a solution."""

    def __init__(self, radius: float) -> None:
        self.radius = radius

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        return np.asarray(x**2 / (2 * self.radius))


def test_cache_compares_cases_by_value() -> None:
    case = Case(body=HALF_SPACE, roller=make_filleted_roller(0.2e-3, SHORT), max_pressure=PRESSURE)
    first_contact = refine_contact(case, 0.05, 1e-6)
    assert refine_contact(replace(case, friction=0.2), 0.05, 1e-6) is first_contact
    assert refine_contact(case, 0.04, 1e-6) is not first_contact
    assert refine_contact(replace(case, friction=0.2, coupled=True), 0.05, 1e-6) is not first_contact
    mutable_crown = MutableCrown(5e-3)
    user_case = Case(
        body=HALF_SPACE, roller=Roller(radius=5e-3, length=SHORT, profile=mutable_crown), max_pressure=PRESSURE
    )
    previous_peak = refine_contact(user_case, 0.05, 1e-6).refined.peak
    mutable_crown.radius = 2.5e-3
    assert refine_contact(user_case, 0.05, 1e-6).refined.peak > 1.05 * previous_peak


def test_modified_result_does_not_change_next_result() -> None:
    first_result = solve(CASES["half-space"], stresses=False, accuracy=0.05)
    copied_pressure = first_result["pressure"].values.copy()
    for name in ("pressure", "gap", "displacement_z", "initial_gap"):
        first_result[name].values[:] = 0.0
    np.testing.assert_array_equal(
        solve(CASES["half-space"], stresses=False, accuracy=0.05)["pressure"], copied_pressure
    )


@pytest.mark.parametrize("fraction", [0.2, 0.5, 0.75, 0.95])
@pytest.mark.parametrize("accuracy", [0.2, 0.05, 0.01, 0.002])
def test_cell_number_is_least_sufficient_number(accuracy: float, fraction: float) -> None:
    """The error between cells is 0.7 over the square of the number of cells across the contact."""
    cells = _choose_cells_y(fraction, accuracy)

    def compute_remaining_error(cells: int) -> float:
        return 0.7 / (cells * fraction) ** 2

    assert compute_remaining_error(cells) <= 0.25 * accuracy or cells == 256
    assert compute_remaining_error(cells // 2) > 0.25 * accuracy or cells == 32


@pytest.mark.parametrize("distance", [-0.2e-3, 0.0, 1e-15, 1e-9, 0.3e-3])
def test_face_length_beyond_roller_end(distance: float) -> None:
    """The face is the distance to the body's end; it is zero for ends in one plane and for an overhanging roller."""
    body = make_finite_body(1.5e-3)
    case = Case(body=body, roller=make_filleted_roller(0.1e-3, 1e-3), max_pressure=PRESSURE, end_distance=distance)
    shape = _axial_shape(case)
    face_lengths = shape.face_beyond
    assert shape.depth == pytest.approx(case.hertz_half_width**2 / (2 * RADIUS))
    assert (shape.start, shape.stop) == pytest.approx((max(distance, 0.0), min(distance + 1e-3, 1.5e-3)))
    assert face_lengths == pytest.approx((max(distance, 0.0) if distance > 1e-12 else 0.0, 0.5e-3 - distance))
    assert face_lengths[0] == 0.0 or distance > 1e-12


def test_wide_contact_has_widest_window(monkeypatch: pytest.MonkeyPatch) -> None:
    case, attempts = Case(body=HALF_SPACE, roller=make_filleted_roller(0.2e-3), max_pressure=PRESSURE), []

    def raise_window_error(case: Case, half_window: float, accuracy: float, tolerance: float) -> object:
        attempts.append(half_window / case.hertz_half_width)
        if len(attempts) < 5:
            raise WindowError("too narrow")
        return "found"

    monkeypatch.setattr(module, "_refine_in_window", raise_window_error)
    assert module._refine_contact(case, 0.01, 1e-6) == "found"
    assert attempts == pytest.approx([2.0, 3.0, 5.0, 8.0, 12.0])


WINDOW_CASES = {
    "peaks at fillets": Case(body=HALF_SPACE, roller=make_filleted_roller(0.2e-3, 1e-3), max_pressure=PRESSURE),
    "even": Case(
        body=FiniteLengthSpace(length=1e-3, material=STEEL, model="mirror"),
        roller=Roller(radius=RADIUS, length=1e-3),
        max_pressure=PRESSURE,
    ),
}


@pytest.mark.parametrize("name", WINDOW_CASES)
def test_window_fits_contact(name: str) -> None:
    """The window exceeds the contact by at least a tenth, at most by a step of the windows and a coarse cell."""
    contact = refine_case(WINDOW_CASES[name], 0.05).contact
    grid = contact.shape.grid
    contact_half_width = np.abs(grid.y[contact.pressure.any(axis=0)]).max() + 0.5 * grid.dy
    assert 1.05 < grid.y_range[1] / contact_half_width < 1.1 * 2 ** (1 / 6) * 1.15


def test_roller_columns_have_edges_of_roller() -> None:
    grid = Grid.between(np.array([-3.0, -2.0, -1.0, 1.0, 1.5, 2.0, 4.0]), (0.0, 1.0), 2)
    assert _roller_columns(grid, np.array([1.0, 1.5, 2.0])) == slice(3, 5)
    assert _roller_columns(grid, np.array([-2.0 + 1e-12, -1.0])) == slice(1, 2)


@dataclass(frozen=True)
class WavyCrown(profiles.Shape):
    """A slight crown with waves."""

    crown_radius: float
    amplitude: float
    wavelength: float

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        waves = self.amplitude * (1 - np.cos(2 * np.pi * np.asarray(x) / self.wavelength))
        return np.asarray(x) ** 2 / (2 * self.crown_radius) + waves


def test_wavy_profile_crests_are_resolved() -> None:
    """The approach is several a**2/2R: loaded crests lie deeper than the depth that the first columns resolve."""
    length, wavelength = 2e-3, 0.2e-3
    roller = Roller(radius=RADIUS, length=length, profile=WavyCrown(0.5, 0.6e-6, wavelength))
    case = Case(body=HALF_SPACE, roller=roller, max_pressure=0.7e9)
    refined_result = solve(case, stresses=False, accuracy=0.03)
    uniform_result = solve(case, choose_grid(case, cells_x=4, cells_y=12, window=3.0), stresses=False)
    for crest in range(5):
        is_crest = abs(abs(refined_result.x - length / 2) - crest * wavelength) < 0.35 * wavelength
        is_uniform_crest = abs(abs(uniform_result.x - length / 2) - crest * wavelength) < 0.35 * wavelength
        loads = [
            float((result.pressure.sum("y") * widths).where(is_selected).sum() * (result.y[1] - result.y[0]))
            for result, widths, is_selected in (
                (refined_result, refined_result.x_width, is_crest),
                (uniform_result, float(uniform_result.x[1] - uniform_result.x[0]), is_uniform_crest),
            )
        ]
        assert loads[0] == pytest.approx(loads[1], rel=0.02)
    assert abs(float(refined_result.peak_pressure) - float(uniform_result.pressure.max())) <= 1.5 * float(
        refined_result.peak_pressure_error
    )
