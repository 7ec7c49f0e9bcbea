"""Contacts on columns that follow them: against finer cells, uniform cells, known ends; steel on steel or rigid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    InvalidInputError,
    Material,
    QuarterSpace,
    Roller,
    cache,
    choose_grid,
    profiles,
    solve,
    solve_contact,
    stress_field,
)
from contactstudy.checks import FloatArray
from contactstudy.contact import settled as module
from contactstudy.contact.contact import Settings, contact_of
from contactstudy.contact.end_law import edge_peak
from contactstudy.contact.settled import (
    SettledContact,
    _axial_shape,
    _cells_across,
    _Solver,
    _under,
    settled_contact,
    settled_values,
)
from contactstudy.errors import WindowError

STEEL = Material(210e9, 0.3)
RADIUS, PRESSURE, LENGTH = 5e-3, 1.5e9, 10e-3
A = 4 * PRESSURE * RADIUS / (2 * STEEL.plane_strain_modulus)
"""Hertz half-width of a rigid roller; twice that of an elastic one."""


def filleted(radius: float, length: float = LENGTH, material: Material | None = None) -> Roller:
    return Roller(radius=RADIUS, length=length, profile=profiles.Cylinder(fillet_radius=radius), material=material)


def finite(length: float = LENGTH) -> FiniteLengthSpace:
    return FiniteLengthSpace(length=length, material=STEEL)


HALF = HalfSpace(material=STEEL)


def settled(case: Case, accuracy: float = 0.01) -> SettledContact:
    return settled_contact(case, accuracy, 1e-6)


def top_of(pressure: FloatArray) -> float:
    """Largest pressure, between the cells along y too: the squared pressure is a parabola across the contact."""
    squared = pressure**2
    column = squared[squared.max(axis=1).argmax()]
    at = int(column.argmax())
    coefficients = np.polynomial.polynomial.polyfit([-1.0, 0.0, 1.0], column[at - 1 : at + 2], 2)
    return float(np.sqrt(coefficients[0] - coefficients[1] ** 2 / (4 * coefficients[2])))


def finer_peak(case: Case, found: SettledContact, factor: int) -> float:
    """Peak on `factor` times finer cells, along both axes."""
    edges, grid = found.refined.edges, found.contact.shape.grid
    fine = np.interp(np.arange((edges.size - 1) * factor + 1) / factor, np.arange(edges.size), edges)
    solver = _Solver(case, grid.y_range[1], grid.cells_y * factor)
    return top_of(contact_of(solver.shape(fine), Settings(1e-6)).pressure)


KNOWN_FILLETS = {0.5e-3: 2.8565, 0.2e-3: 3.6418, 0.1e-3: 4.4744, 0.05e-3: 5.556}
"""Peaks over p0 on a half-space from an independent refinement to 570 columns down to 0.0004 a."""


@pytest.mark.parametrize("fillet", KNOWN_FILLETS)
def test_stated_peak_of_a_fillet_is_within_its_error_of_finer_cells(fillet: float) -> None:
    case = Case(body=HALF, roller=filleted(fillet), max_pressure=PRESSURE)
    found = settled(case)
    peak, error = found.refined.peak, found.refined.peak_error
    finer = finer_peak(case, found, 2)
    assert found.refined.settled
    assert abs(peak - finer) <= error <= 0.01 * peak
    assert abs(peak - finer) < 0.003 * peak
    assert peak / PRESSURE == pytest.approx(KNOWN_FILLETS[fillet], rel=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("fillet", KNOWN_FILLETS)
def test_stated_peak_of_a_fillet_is_within_its_error_of_four_times_finer_cells(fillet: float) -> None:
    case = Case(body=HALF, roller=filleted(fillet), max_pressure=PRESSURE)
    found = settled(case)
    finer = finer_peak(case, found, 4)
    assert finer / PRESSURE == pytest.approx(KNOWN_FILLETS[fillet], rel=1e-3)
    assert abs(found.refined.peak - finer) <= found.refined.peak_error <= 0.01 * found.refined.peak
    assert abs(found.refined.peak - finer) < 0.01 * finer


@pytest.mark.slow
@pytest.mark.parametrize("body", [finite(), QuarterSpace(material=STEEL)], ids=["finite", "quarter"])
def test_stated_peak_between_free_ends_is_within_its_error_of_finer_cells(
    body: FiniteLengthSpace | QuarterSpace,
) -> None:
    case = Case(body=body, roller=filleted(0.2e-3), max_pressure=PRESSURE)
    found = settled(case)
    assert abs(found.refined.peak - finer_peak(case, found, 2)) <= found.refined.peak_error


SHORT, SHORT_ELASTIC = 8 * A, 16 * A
CASES: dict[str, Case] = {
    "flush": Case(body=finite(SHORT), roller=filleted(0.2e-3, SHORT), max_pressure=PRESSURE),
    "inside": Case(body=finite(9 * A), roller=filleted(0.2e-3, SHORT), max_pressure=PRESSURE),
    "half-space": Case(body=HALF, roller=filleted(0.2e-3, SHORT), max_pressure=PRESSURE),
    "quarter": Case(
        body=QuarterSpace(material=STEEL),
        roller=filleted(0.2e-3, SHORT),
        max_pressure=PRESSURE,
        end_distance=0.5 * A,
    ),
    "mirror": Case(
        body=FiniteLengthSpace(length=SHORT, material=STEEL, model="mirror"),
        roller=filleted(0.2e-3, SHORT),
        max_pressure=PRESSURE,
    ),
    "tilt": Case(body=finite(SHORT), roller=filleted(0.2e-3, SHORT), max_pressure=PRESSURE, tilt=1e-3),
    "load position": Case(
        body=finite(SHORT), roller=filleted(0.2e-3, SHORT), max_pressure=PRESSURE, load_position=0.51 * SHORT
    ),
    "coupled": Case(
        body=finite(SHORT), roller=filleted(0.2e-3, SHORT), max_pressure=PRESSURE, friction=0.3, coupled=True
    ),
    "elastic inside": Case(body=finite(SHORT_ELASTIC), roller=filleted(0.2e-3, 12 * A, STEEL), max_pressure=PRESSURE),
    "elastic overhanging": Case(
        body=finite(12 * A), roller=filleted(0.2e-3, SHORT_ELASTIC, STEEL), max_pressure=PRESSURE, end_distance=-2 * A
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_contact_is_that_on_uniform_cells(name: str) -> None:
    case = CASES[name]
    found = solve(case, stresses=False)
    uniform = solve(case, choose_grid(case, cells_x=24, cells_y=16, window=3.0), stresses=False)
    peak, error = float(found.peak_pressure), float(found.peak_pressure_error)
    assert bool(found.converged)
    assert error <= 0.01 * peak
    # A fillet of 3 a is within half a percent on these uniform cells, an edge of the body within three.
    allowed = 0.03 if case.roller.material is not None else 0.006
    assert peak == pytest.approx(top_of(uniform.pressure.values), rel=allowed)
    assert float(found.approach) == pytest.approx(float(uniform.approach), rel=1e-3)
    assert float(found.tilt) == pytest.approx(float(uniform.tilt), rel=5e-3, abs=1e-9)
    assert abs(float(found.load_error)) < 1e-9
    forces = found.pressure * found.x_width * float(found.y[1] - found.y[0])
    assert float(forces.sum()) == pytest.approx(case.normal_load, rel=1e-9)
    if case.load_position is not None:
        assert float((forces * found.x).sum() / forces.sum()) == pytest.approx(case.load_position, rel=1e-9)
    # The load per length, over the same parts of the roller.
    parts = np.linspace(*case.contact_range, 9)
    loads = [load_up_to(each, parts) for each in (found, uniform)]
    assert np.abs(loads[0] - loads[1]).max() < 2e-3 * case.normal_load


def load_up_to(result: xr.Dataset, x: FloatArray) -> FloatArray:
    widths = (
        result.x_width.values
        if "x_width" in result.coords
        else np.full(result.x.size, float(result.x[1] - result.x[0]))
    )
    edges = np.append(result.x.values - 0.5 * widths, result.x.values[-1] + 0.5 * widths[-1])
    carried = (result.pressure.values.sum(axis=1) * widths) * float(result.y[1] - result.y[0])
    return np.interp(x, edges, np.append(0.0, np.cumsum(carried)))


@pytest.mark.parametrize("name", ["flush", "half-space"])
def test_mirrored_case_has_the_mirrored_contact(name: str) -> None:
    tilts = [
        settled(Case(body=CASES[name].body, roller=CASES[name].roller, max_pressure=PRESSURE, tilt=tilt), 0.02)
        for tilt in (8e-4, -8e-4)
    ]
    there, back = (each.refined for each in tilts)
    assert there.peak == pytest.approx(back.peak, rel=1e-4)
    assert np.allclose(there.pressure.max(axis=1), back.pressure[::-1].max(axis=1), atol=1e-4 * there.peak)


# Ends -------------------------------------------------------------------------------------------------------------


def test_sharp_rigid_end_in_a_face_is_a_square_root_with_its_intensity() -> None:
    case = Case(body=HALF, roller=Roller(radius=RADIUS, length=LENGTH), max_pressure=PRESSURE)
    values = settled_values(settled(case))
    assert np.isinf(values.peak_pressure)
    assert np.isinf(values.peak_pressure_error)
    for side in ("first", "last"):
        assert float(values[f"end_exponent_{side}"]) == 0.5
        intensity = float(values[f"end_intensity_{side}"])
        assert intensity / (PRESSURE * np.sqrt(A)) == pytest.approx(0.8125, rel=5e-3)
        error = float(values[f"end_intensity_{side}_error"])
        assert abs(intensity / (PRESSURE * np.sqrt(A)) - 0.8125) * PRESSURE * np.sqrt(A) <= error < 0.01 * intensity


@pytest.mark.parametrize("fillet", [0.01e-3, 0.005e-3])
def test_peak_from_the_intensity_is_that_of_a_small_fillet(fillet: float) -> None:
    sharp = settled(Case(body=HALF, roller=Roller(radius=RADIUS, length=LENGTH), max_pressure=PRESSURE))
    law = sharp.refined.laws[0]
    assert law is not None
    solved = settled(Case(body=HALF, roller=filleted(fillet), max_pressure=PRESSURE))
    assert solved.refined.settled
    assert edge_peak(law.intensity, STEEL.plane_strain_modulus, fillet) == pytest.approx(solved.refined.peak, rel=0.01)


def test_flush_end_of_a_free_body_has_a_finite_pressure() -> None:
    """0.497 p0 from an extrapolation of columns down to 0.003 a."""
    found = settled(Case(body=finite(), roller=Roller(radius=RADIUS, length=LENGTH), max_pressure=PRESSURE)).refined
    assert found.laws == (None, None)
    for end, error in zip(found.ends, found.end_errors, strict=True):
        assert end / PRESSURE == pytest.approx(0.497, abs=0.005)
        assert abs(end / PRESSURE - 0.497) <= error / PRESSURE <= 0.01
    assert found.peak / PRESSURE == pytest.approx(1.013, abs=0.004)


def test_same_end_without_its_own_freedom_is_a_logarithm_when_tilted() -> None:
    body = FiniteLengthSpace(length=LENGTH, material=STEEL, model="mirror")
    case = Case(body=body, roller=Roller(radius=RADIUS, length=LENGTH), max_pressure=PRESSURE, tilt=5e-4)
    laws = settled(case).refined.laws
    assert "logarithm" in [law.kind for law in laws if law is not None]
    freed = settled(
        Case(body=finite(), roller=Roller(radius=RADIUS, length=LENGTH), max_pressure=PRESSURE, tilt=5e-4)
    ).refined
    assert freed.laws == (None, None)
    assert freed.ends[0] < freed.ends[1] < freed.peak


def test_a_singular_end_and_the_other_half_free_of_contact() -> None:
    roller = Roller(radius=RADIUS, length=0.3e-3, profile=profiles.FullCrown(0.5))
    found = settled(Case(body=HALF, roller=roller, max_pressure=PRESSURE, tilt=0.02), 0.1).refined
    assert found.settled
    assert found.peaks == (0.0, np.inf)
    assert found.loads[0] == 0.0


def test_sharp_elastic_end_in_a_face_grows_with_a_smaller_power() -> None:
    """A 90 degree edge on a half-space of the same material, without friction: about 0.226."""
    half_width = 2 * A
    roller = Roller(radius=RADIUS, length=60 * half_width, material=STEEL)
    case = Case(body=finite(100 * half_width), roller=roller, max_pressure=PRESSURE)
    laws = settled(case).refined.laws
    for law in laws:
        assert law is not None
        assert law.kind == "power"
        assert 0.2 < law.exponent < 0.24


def test_crown_that_leaves_the_ends_free_has_its_peak_in_the_middle() -> None:
    crown = profiles.Lundberg.for_pressure(PRESSURE, radius=RADIUS, modulus=STEEL.plane_strain_modulus)
    case = Case(body=finite(), roller=Roller(radius=RADIUS, length=LENGTH, profile=crown), max_pressure=PRESSURE)
    found = settled(case)
    assert found.refined.ends == (0.0, 0.0)
    assert found.refined.end_errors == (0.0, 0.0)
    assert abs(found.refined.peak - finer_peak(case, found, 2)) <= found.refined.peak_error
    assert found.refined.peak / PRESSURE == pytest.approx(1.044, abs=0.005)


def test_table_of_points_of_a_fillet_has_the_peak_of_the_fillet() -> None:
    made = filleted(0.2e-3).profile
    near = np.concatenate([np.linspace(0, 0.2e-3, 401), np.linspace(0.21e-3, 1e-3, 80)])
    x = np.unique(np.concatenate([-LENGTH / 2 + near, np.linspace(-4e-3, 4e-3, 161), LENGTH / 2 - near]))
    table = profiles.Measured(x.tolist(), made.drop(x, LENGTH).tolist(), largest_spike=1e-3)
    peaks = []
    for profile in (made, table):
        roller = Roller(radius=RADIUS, length=LENGTH, profile=profile)
        found = settled(Case(body=HALF, roller=roller, max_pressure=PRESSURE)).refined
        assert found.settled
        peaks.append(found.peak)
    assert peaks[1] == pytest.approx(peaks[0], rel=0.01)


# Given cells ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("body", [HALF, finite(SHORT)], ids=["half", "finite"])
def test_gap_on_cells_of_any_width_has_the_contact_of_uniform_ones(body: HalfSpace | FiniteLengthSpace) -> None:
    """The verb for labelled gaps: the load is exact, the pressure that of uniform cells."""
    finite_body = isinstance(body, FiniteLengthSpace)
    kept = np.concatenate([np.arange(16), np.arange(16, 48, 2), np.arange(48, 65)])
    uniform = Grid((0.0, SHORT), (-2 * A, 2 * A), 64, 32)
    graded = Grid.from_edges(uniform.x_edges[kept], uniform.y_range, 32)
    contacts = []
    for grid in (graded, uniform):
        inside = (grid.x > 0) & (grid.x < SHORT) if finite_body else (grid.x > 0.5 * A) & (grid.x < SHORT - 0.5 * A)
        heights = np.where(inside[:, None], grid.y**2 / (2 * RADIUS), np.inf)
        gap = xr.DataArray(heights, coords={"x": grid.x, "y": grid.y, "x_width": ("x", grid.widths)}, dims=("x", "y"))
        contacts.append(solve_contact(body, gap, load=CASES["flush"].normal_load))
    there, here = contacts
    assert bool(there.converged)
    middles = [float(each.pressure.sel(x=SHORT / 2, method="nearest").max()) for each in contacts]
    assert middles[0] == pytest.approx(middles[1], rel=5e-3)
    assert float(there.approach) == pytest.approx(float(here.approach), rel=5e-3)
    total = float((there.pressure * graded.widths[:, None]).sum()) * graded.dy
    assert total == pytest.approx(CASES["flush"].normal_load, rel=1e-9)
    back = solve_contact(body, gap_of(there, graded), approach=float(there.approach))
    assert float(back["normal_load"]) == pytest.approx(CASES["flush"].normal_load, rel=1e-3)


def gap_of(contact: xr.Dataset, grid: Grid) -> xr.DataArray:
    """The gap that a contact was made from: what is left of it, and its rigid approach."""
    heights = np.where(np.isfinite(contact.gap.values), grid.y**2 / (2 * RADIUS), np.inf)
    return contact.gap.copy(data=heights)


def test_gap_on_cells_that_grow_too_steeply_is_refused_with_the_place() -> None:
    widths = np.array([1.0, 1.0, 5.0, 5.0, 5.0, 1.5, 1.5])
    x = np.cumsum(widths) - 0.5 * widths
    y = np.linspace(-1.5, 1.5, 17)
    heights = np.broadcast_to(0.5 * y**2, (7, 17))
    gap = xr.DataArray(heights, coords={"x": x, "y": y, "x_width": ("x", widths)}, dims=("x", "y"))
    with pytest.raises(InvalidInputError, match="cells of 1 and 5 m beside x = 2 m"):
        solve_contact(HALF, gap, load=1.0)


@pytest.mark.parametrize("accuracy", [0.0, -0.01, 9e-4, 0.11, np.nan, "high"])
def test_accuracy_that_cannot_be_reached_is_refused(accuracy: object) -> None:
    with pytest.raises(InvalidInputError, match="accuracy"):
        solve(CASES["half-space"], accuracy=accuracy, stresses=False)  # type: ignore[arg-type]


def test_cells_that_miss_an_end_of_an_elastic_roller_are_refused_with_its_place() -> None:
    case = CASES["elastic inside"]
    edges = SHORT_ELASTIC * np.array([0.0, 0.1, 0.3, 0.6, 0.8, 1.0])
    with pytest.raises(InvalidInputError, match=r"without a border at x = "):
        solve(case, Grid.from_edges(edges, (-4 * A, 4 * A), 16), stresses=False)


@pytest.mark.parametrize("material", [None, STEEL], ids=["rigid", "elastic"])
@pytest.mark.parametrize("distance", [1e-3, 1e-2, -1e-2])
def test_end_close_to_that_of_the_body_has_the_contact_of_a_flush_one(
    material: Material | None, distance: float
) -> None:
    """The room that is left is much narrower than the columns; its cells are accepted by every verb."""
    case, flush = (
        Case(
            body=QuarterSpace(material=STEEL),
            roller=filleted(0.2e-3, SHORT, material),
            max_pressure=PRESSURE,
            end_distance=each * A,
        )
        for each in (distance, 0.0)
    )
    found = solve(case, accuracy=0.02, y=[0.0], z=[0.3 * A], x=[0.0, A])
    same = solve(flush, accuracy=0.02, stresses=False)
    assert bool(found.converged)
    assert float(found.peak_pressure) == pytest.approx(float(same.peak_pressure), rel=0.01)
    again = stress_field(case.body, found.pressure, x=[0.0, A], y=[0.0], z=[0.3 * A])
    # The certificate shares the quadrature of the stresses in solve.
    assert np.allclose(again.von_mises.values, found.von_mises.values, rtol=1e-5)


def test_error_estimate_on_given_graded_cells() -> None:
    """Joined in twos these cells differ by more than given cells may."""
    ratios = 3.9 ** np.array([0, 1, 2, 2, 2, 2, 2, 1, 1, 0, 0, 1, 2, 2, 1, 0.0])
    edges = SHORT * np.append(0.0, np.cumsum(ratios)) / ratios.sum()
    grid = Grid.from_edges(edges, (-3 * A, 3 * A), 32)
    case = CASES["flush"]
    result = solve(case, grid, stresses=False, error_estimate=True)
    assert bool(result.converged)
    assert result.sizes["x"] == 16
    assert any(name.endswith("_error") and "pressure" in name for name in result.data_vars)


@pytest.mark.parametrize("distance", [1e-4, 0.05])
def test_a_sharp_end_close_to_a_free_end_is_never_a_plain_number(distance: float) -> None:
    """At 1e-4 a no column shows the law; at 0.05 a the fitted intensity says that it is no better than some percent."""
    case = Case(
        body=finite(LENGTH + 2 * distance * A), roller=Roller(radius=RADIUS, length=LENGTH), max_pressure=PRESSURE
    )
    found = settled_values(settled(case))
    assert np.isinf(found["end_pressure_first_error"])
    if distance > 1e-3:
        intensity = found["end_intensity_first"] / (PRESSURE * np.sqrt(A))
        assert float(intensity) == pytest.approx(0.1015, rel=0.06)
        assert float(found["end_intensity_first_error"] / found["end_intensity_first"]) > 0.05


def test_an_end_that_fades_is_never_a_plain_number() -> None:
    """The first column's pressure falls by 5 % with each halving, from 0.64 to 0.47 p0 and on."""
    rubber = Material(6e8, 0.0)
    roller = Roller(radius=RADIUS, length=0.13e-3, material=rubber)
    body = QuarterSpace(material=rubber, model="mirror-factor")
    found = settled_values(settled(Case(body=body, roller=roller, max_pressure=2e6), 0.02))
    assert np.isinf(found["end_pressure_first_error"])
    assert 0 < float(found["peak_pressure_first_error"]) < 0.02 * float(found["peak_pressure_first"])


def test_coupled_friction_is_in_the_values_that_are_stated() -> None:
    """The columns follow the uncoupled contact, but the values belong to the pressure that is returned."""
    body = FiniteLengthSpace(length=8 * A, material=Material(210e9, 0.1))
    roller = Roller(radius=RADIUS, length=8 * A)
    case = Case(body=body, roller=roller, max_pressure=PRESSURE, friction=0.5, coupled=True)
    found = solve(case, stresses=False)
    fine = solve(case, choose_grid(case, cells_x=32, cells_y=32), stresses=False, error_estimate=True)
    uncoupled = solve(Case(body=body, roller=roller, max_pressure=PRESSURE), stresses=False)
    difference = abs(float(found["peak_pressure"] - fine["peak_pressure"]))
    assert difference < float(found["peak_pressure_error"])
    assert float(found["peak_pressure"]) == pytest.approx(float(found["pressure"].max()), rel=3e-3)
    assert abs(float(found["peak_pressure"] / uncoupled["peak_pressure"]) - 1) > 1e-3


@pytest.mark.parametrize(("accuracy", "least"), [(0.05, 8), (0.01, 17), (0.002, 37), (0.001, 53)])
def test_the_peak_has_cells_across_it_as_the_accuracy_asks(accuracy: float, least: int) -> None:
    found = settled_contact(CASES["half-space"], accuracy, 1e-6)
    pressure = found.contact.pressure
    assert int((pressure[int(pressure.max(axis=1).argmax())] > 0).sum()) >= least


class _Crown:
    """A profile of a user's own, which can be changed after it has been used."""

    def __init__(self, radius: float) -> None:
        self.radius = radius

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        return np.asarray(x**2 / (2 * self.radius))


def test_contacts_are_kept_for_values_only() -> None:
    cache.clear()
    case = Case(body=HALF, roller=filleted(0.2e-3, SHORT), max_pressure=PRESSURE)
    first = settled_contact(case, 0.05, 1e-6)
    assert settled_contact(replace(case, friction=0.2), 0.05, 1e-6) is first
    assert settled_contact(case, 0.04, 1e-6) is not first
    assert settled_contact(replace(case, friction=0.2, coupled=True), 0.05, 1e-6) is not first
    own = _Crown(5e-3)
    changed = Case(body=HALF, roller=Roller(radius=5e-3, length=SHORT, profile=own), max_pressure=PRESSURE)
    before = settled_contact(changed, 0.05, 1e-6).refined.peak
    own.radius = 2.5e-3
    assert settled_contact(changed, 0.05, 1e-6).refined.peak > 1.05 * before


def test_what_a_user_does_to_a_result_does_not_reach_the_next_one() -> None:
    first = solve(CASES["half-space"], stresses=False, accuracy=0.05)
    kept = first["pressure"].values.copy()
    for name in ("pressure", "gap", "displacement_z", "initial_gap"):
        first[name].values[:] = 0.0
    np.testing.assert_array_equal(solve(CASES["half-space"], stresses=False, accuracy=0.05)["pressure"], kept)


@pytest.mark.parametrize("part", [0.2, 0.5, 0.75, 0.95])
@pytest.mark.parametrize("accuracy", [0.2, 0.05, 0.01, 0.002])
def test_cells_across_are_the_fewest_that_leave_a_quarter_of_the_accuracy(accuracy: float, part: float) -> None:
    """What lies between cells is 0.7 over the square of their number across the contact."""
    cells = _cells_across(part, accuracy)

    def left(cells: int) -> float:
        return 0.7 / (cells * part) ** 2

    assert left(cells) <= 0.25 * accuracy or cells == 256
    assert left(cells // 2) > 0.25 * accuracy or cells == 32


@pytest.mark.parametrize("distance", [-0.2e-3, 0.0, 1e-15, 1e-9, 0.3e-3])
def test_the_face_goes_on_beyond_an_end_of_the_roller(distance: float) -> None:
    """By what is left to the end of the body; by nothing where both end together, or where the roller overhangs."""
    body = finite(1.5e-3)
    case = Case(body=body, roller=filleted(0.1e-3, 1e-3), max_pressure=PRESSURE, end_distance=distance)
    shape = _axial_shape(case)
    room = shape.room
    assert shape.depth == pytest.approx(case.hertz_half_width**2 / (2 * RADIUS))
    assert (shape.start, shape.stop) == pytest.approx((max(distance, 0.0), min(distance + 1e-3, 1.5e-3)))
    assert room == pytest.approx((max(distance, 0.0) if distance > 1e-12 else 0.0, 0.5e-3 - distance))
    assert room[0] == 0.0 or distance > 1e-12


def test_columns_of_a_grid_that_begins_elsewhere() -> None:
    grid = Grid.between(np.array([-3.0, -2.0, -1.0, 1.0, 1.5, 2.0, 4.0]), (0.0, 1.0), 2)
    assert _under(grid, np.array([1.0, 1.5, 2.0])) == slice(3, 5)
    assert _under(grid, np.array([-2.0 + 1e-12, -1.0])) == slice(1, 2)


def test_a_contact_that_needs_the_widest_window_gets_it(monkeypatch: pytest.MonkeyPatch) -> None:
    case, tried = Case(body=HALF, roller=filleted(0.2e-3), max_pressure=PRESSURE), []

    def too_narrow(case: Case, half_window: float, accuracy: float, tolerance: float) -> object:
        tried.append(half_window / case.hertz_half_width)
        if len(tried) < 5:
            raise WindowError("too narrow")
        return "found"

    monkeypatch.setattr(module, "_within", too_narrow)
    assert module._settled(module._Request(case, 0.01, 1e-6)) == "found"
    assert tried == pytest.approx([2.0, 3.0, 5.0, 8.0, 12.0])


FITTED = {
    "peaks at fillets": Case(body=HALF, roller=filleted(0.2e-3, 1e-3), max_pressure=PRESSURE),
    "even": Case(
        body=FiniteLengthSpace(length=1e-3, material=STEEL, model="mirror"),
        roller=Roller(radius=RADIUS, length=1e-3),
        max_pressure=PRESSURE,
    ),
}


@pytest.mark.parametrize("name", FITTED)
def test_the_window_fits_the_contact(name: str) -> None:
    """A tenth wider at least, and by no more than one step of the windows that cases share, and a rough cell."""
    contact = settled(FITTED[name], 0.05).contact
    grid = contact.shape.grid
    reach = np.abs(grid.y[contact.pressure.any(axis=0)]).max() + 0.5 * grid.dy
    assert 1.05 < grid.y_range[1] / reach < 1.1 * 2 ** (1 / 6) * 1.15


@pytest.mark.parametrize("side", [0, 1])
def test_a_sharp_end_that_alone_is_pressed_has_its_law(side: int) -> None:
    tilt = 2e-3 if side else -2e-3
    body = finite(3e-3)
    case = Case(body=body, roller=Roller(radius=RADIUS, length=2e-3), load=100.0, end_distance=0.5e-3, tilt=tilt)
    found = settled(case, 0.05).refined
    assert found.laws[1 - side] is None
    law = found.laws[side]
    assert law is not None
    assert law.exponent == 0.5
