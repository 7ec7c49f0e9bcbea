"""Stick and slip on the columns of a refined contact, against fine uniform cells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contactstudy import Case, FiniteLengthSpace, Grid, HalfSpace, Material, Roller, Rolling, Shift, choose_grid, solve
from contactstudy.cache import ArrayKey
from contactstudy.contact.normal.contact import Certificate, Contact, Settings, Shape
from contactstudy.contact.normal.prescribed_loads import PrescribedLoad
from contactstudy.contact.refinement import refined_contact as module
from contactstudy.contact.refinement.refined_contact import (
    CELLS_Y,
    COLUMN_ERROR_FACTOR,
    RefinedContact,
    _scales,
    refine_contact,
    refine_tractions,
)
from contactstudy.contact.rolling.frictional_contact import FrictionalContact
from contactstudy.contact.rolling.surfaces import Tractions
from contactstudy.contact.rolling.tractions import FrictionRequest
from contactstudy.profiles import Ellipsoid

STEEL = Material(210e9, 0.3)
BODY = FiniteLengthSpace(length=0.5e-3, material=STEEL)
STEEL_CASE = Case(
    body=BODY, roller=Roller(radius=5e-3, length=0.5e-3, material=STEEL), max_pressure=1.5e9, friction=0.1
)
SHORT_CASE = Case(
    body=HalfSpace(material=STEEL), roller=Roller(radius=5e-3, length=0.5e-3), max_pressure=1.5e9, friction=0.1
)
"""A rigid roller that ends inside the face with a singular pressure."""

SLIDING_FORCE = 0.1 * STEEL_CASE.normal_load
CREEPAGES = Rolling(longitudinal_creepage=5e-4, lateral_creepage=-3e-4, spin=1.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    "motion",
    [
        CREEPAGES,
        Rolling(force_y=0.6 * SLIDING_FORCE, force_x=0.2 * SLIDING_FORCE),
        Shift(y=3e-7),
        Shift(force_x=0.5 * SLIDING_FORCE),
    ],
    ids=["creepages and spin", "forces", "shift", "shifting force"],
)
def test_stated_errors_cover_fine_uniform_cells(motion: Rolling | Shift) -> None:
    case = replace(STEEL_CASE, motion=motion)
    computed = solve(case, stresses=False)
    assert bool(computed.converged)
    fine_result = solve(case, choose_grid(case, cells_x=8, cells_y=40, window=1.5), stresses=False)
    scales = {"force_x": SLIDING_FORCE, "force_y": SLIDING_FORCE, "moment_z": SLIDING_FORCE * 0.1e-3}
    for name, scale in scales.items():
        error = float(computed.get(f"{name}_error", 0.0))
        assert error <= 0.01 * scale
        assert float(computed[name]) == pytest.approx(float(fine_result[name]), abs=max(error, 2e-3 * scale))
    for name in ("longitudinal_creepage", "lateral_creepage", "shift_x", "shift_y"):
        if name in computed:
            error = float(computed.get(f"{name}_error", 0.0))
            baseline = 0.1 * case.hertz_half_width / 5e-3 * (case.hertz_half_width if "shift" in name else 1.0)
            assert float(computed[name]) == pytest.approx(
                float(fine_result[name]), abs=max(error, 2e-3 * baseline, 1e-3 * abs(float(computed[name])))
            )
    # The frictional work is a small difference of the supplied and the stored work.
    names = ("shift_x", "shift_y") if isinstance(motion, Shift) else ("lateral_creepage", "longitudinal_creepage")
    input_work = sum(
        abs(float(computed[force] * computed[name])) for force, name in zip(("force_x", "force_y"), names, strict=True)
    )
    assert float(computed["friction_work"]) == pytest.approx(float(fine_result["friction_work"]), abs=5e-3 * input_work)


def test_motion_keeps_columns() -> None:
    rolling_short_case = replace(SHORT_CASE, motion=Rolling(longitudinal_creepage=2e-2))
    sliding_result, rolling_result = (
        solve(case, stresses=False, accuracy=0.1) for case in (SHORT_CASE, rolling_short_case)
    )
    assert np.array_equal(sliding_result["x"], rolling_result["x"])
    assert float(rolling_result["end_intensity_first"]) == pytest.approx(
        float(sliding_result["end_intensity_first"]), rel=0.01
    )
    assert 0 < float(rolling_result["force_y"]) < 0.1 * SHORT_CASE.normal_load
    bound = 0.1 * rolling_result["pressure"]
    assert float((np.hypot(rolling_result["traction_x"], rolling_result["traction_y"]) - bound).max()) < 1e-6 * float(
        bound.max()
    )


def test_creepages_share_one_contact() -> None:
    first_contact = refine_contact(replace(STEEL_CASE, motion=Rolling(longitudinal_creepage=1e-3)), 0.05, 1e-6)
    assert refine_contact(replace(STEEL_CASE, motion=Rolling(force_y=1.0)), 0.05, 1e-6) is first_contact
    assert refine_contact(STEEL_CASE, 0.05, 1e-6) is not first_contact  # the window of full sliding is narrower


@pytest.mark.slow
def test_coupled_tractions_change_end_load() -> None:
    """The traction of a rigid roller on compressible material lifts the surface."""
    body = HalfSpace(material=Material(210e9, 0.0))
    case = replace(SHORT_CASE, body=body, coupled=True, friction=0.5, motion=Rolling(longitudinal_creepage=0.05))
    computed = solve(case, stresses=False, accuracy=0.1)
    uncoupled_result = solve(replace(case, coupled=False), stresses=False, accuracy=0.1)
    assert bool(computed.converged)
    assert abs(float(computed["end_load_first"] / uncoupled_result["end_load_first"]) - 1) > 1e-3
    assert float(computed["force_y"]) == pytest.approx(0.5 * case.normal_load, rel=0.02)


def test_given_columns_are_used() -> None:
    edges = STEEL_CASE.body.extent[1] * np.concatenate([np.linspace(0, 0.2, 9)[:-1], np.linspace(0.2, 1, 13)])
    half_width = STEEL_CASE.hertz_half_width
    case = replace(STEEL_CASE, motion=CREEPAGES)
    computed = solve(case, Grid.from_edges(edges, (-1.5 * half_width, 1.5 * half_width), 30), stresses=False)
    assert computed.sizes["x"] == edges.size - 1
    assert float(computed["force_y"]) == pytest.approx(float(solve(case, stresses=False)["force_y"]), rel=3e-3)


def make_contact(case: Case, peak_pressure: float, **rigid_motion: float) -> FrictionalContact:
    """Contact of a case under a uniform pressure on two cells, with given rigid motions."""
    grid = Grid.between(np.array([0.0, 1e-4, 2e-4, 5e-4]), (-2e-4, 2e-4), 4)
    pressure = np.zeros(grid.shape)
    pressure[0, 3] = pressure[2, 1] = peak_pressure
    shape = Shape(case.body, grid, ArrayKey(np.zeros(grid.shape)), PrescribedLoad(1.0))
    zeros = np.zeros(grid.shape)
    certificate = Certificate(0.0, 0.0, 0.0, 0.0)
    contact = Contact(
        shape=shape,
        settings=Settings(),
        pressure=pressure,
        gap=zeros,
        displacement=zeros,
        approach=0.0,
        tilt=0.0,
        iterations=1,
        converged=True,
        motions=np.inf,
        certificate=certificate,
    )
    resultants = dict.fromkeys(("force_x", "force_y", "moment_z"), 0.0)
    zero_vectors = np.stack([zeros] * 2)
    tractions = Tractions(
        traction=zero_vectors,
        slip=zero_vectors,
        sticks=zeros > 1,
        bound=zeros,
        amplitudes=rigid_motion,
        resultants=resultants,
        work=0.0,
    )
    return FrictionalContact(contact, tractions, True)


def test_changes_are_relative_to_full_sliding() -> None:
    """The scales are forces and moment of full sliding, creepages ``f a / R``, shifts ``f a**2 / R`` or larger ones."""
    peak_pressure = 1e9
    slip_scale = 0.1 * STEEL_CASE.hertz_half_width / 5e-3
    force_scale = 0.1 * peak_pressure * (1e-4 * 1e-4 + 3e-4 * 1e-4)
    # The reference is the roller's middle, 0.25 mm: the cells' centres are 0.2 and 0.1 mm from it along x.
    moment_scale = 0.1 * peak_pressure * (1e-8 * np.hypot(2e-4, 1.5e-4) + 3e-8 * np.hypot(1e-4, 0.5e-4))
    case = replace(STEEL_CASE, motion=Rolling(longitudinal_creepage=0.0))
    computed = make_contact(case, peak_pressure, x=0.0, y=1e-9, spin=0.0)
    baseline = {
        "lateral_creepage": slip_scale,
        "longitudinal_creepage": slip_scale,
        "spin": slip_scale * force_scale / moment_scale,
    }
    assert _scales(case, computed) == pytest.approx(
        baseline
        | {
            "force_x": force_scale,
            "force_y": force_scale,
            "moment_z": moment_scale,
            "friction_work": force_scale * slip_scale,
        }
    )
    fast_contact = make_contact(
        case, peak_pressure, x=-3 * slip_scale, y=2 * slip_scale, spin=9 * slip_scale * force_scale / moment_scale
    )
    scales = _scales(case, fast_contact)
    assert scales["lateral_creepage"] == pytest.approx(3 * slip_scale)
    assert scales["friction_work"] == pytest.approx(force_scale * 9 * slip_scale)
    case = replace(STEEL_CASE, motion=Shift(y=1e-9))
    shifted_contact = make_contact(case, peak_pressure, x=0.0, y=1e-12)
    assert _scales(case, shifted_contact)["shift_x"] == pytest.approx(slip_scale * STEEL_CASE.hertz_half_width)
    assert _scales(case, shifted_contact)["friction_work"] == pytest.approx(
        force_scale * slip_scale * STEEL_CASE.hertz_half_width
    )
    frictionless_contact = make_contact(replace(STEEL_CASE, friction=0.0), peak_pressure, x=0.0, y=0.0, spin=0.0)
    assert _scales(replace(STEEL_CASE, friction=0.0, motion=Rolling()), frictionless_contact)["friction_work"] == 0.0


@pytest.mark.parametrize(
    ("changes", "accuracy", "solution_count", "roller"),
    [([0.5], 0.6, 2, STEEL), ([0.5], 0.6, 2, None), ([0.5, 0.3, 0.1], 0.2, 4, STEEL), ([0.9] * 9, 0.1, 9, STEEL)],
)
def test_cells_double_until_changes_meet_accuracy(
    changes: list[float], accuracy: float, solution_count: int, roller: Material | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The changes are over full sliding's force; prescribed values may change; the stated error is the last change
    plus the errors of the columns and, with a rigid roller, of the leading edge on the only cell across the contact.
    """
    bodies = replace(STEEL_CASE, roller=replace(STEEL_CASE.roller, material=roller))
    case = replace(bodies, motion=Rolling(longitudinal_creepage=1e-3))
    contact = make_contact(case, 1e9, x=0.0, y=1e-3, spin=0.0)
    full_sliding, forces, rows = 0.1 * 1e9 * 4e-8, np.cumsum([3.0, *changes]), []

    def solve_on_cells(
        case: Case, refined: RefinedContact, cells: int, coarse_contact: FrictionalContact | None
    ) -> FrictionalContact:
        rows.append(cells)
        assert (coarse_contact is None) == (len(rows) == 1)
        resultants = contact.tractions.resultants | {"force_x": -full_sliding * forces[len(rows) - 1]}
        amplitudes = contact.tractions.amplitudes | {"y": float(len(rows))}
        return replace(contact, tractions=replace(contact.tractions, amplitudes=amplitudes, resultants=resultants))

    refined_contact = refine_contact(replace(STEEL_CASE, friction=0.0), 0.05, 1e-6)
    cells = refined_contact.contact.shape.grid.cells_y
    max_count = 1 + int(np.log2(CELLS_Y[-1] / cells)) + 1
    monkeypatch.setattr(module, "_solve_on_cells", solve_on_cells)
    monkeypatch.setattr(module, "replace_contact", lambda refined, contact, case: refined_contact)
    _, _, errors = refine_tractions(case, refined_contact, accuracy)
    assert rows == [cells // 2 * 2**index for index in range(min(solution_count, max_count))]
    assert ("comment" not in errors.force_x_error.attrs) == (solution_count < 9)
    column_error = COLUMN_ERROR_FACTOR * refined_contact.refined.least_error
    edge_error = 0.0 if roller else 0.5 * (1 - 2 * STEEL.poisson) / (1 - STEEL.poisson)
    assert float(errors.force_x_error) == pytest.approx(
        full_sliding * (changes[len(rows) - 2] + column_error + edge_error)
    )
    assert "longitudinal_creepage_error" not in errors


def test_fastsim_uses_cells_of_normal_contact(monkeypatch: pytest.MonkeyPatch) -> None:
    """FASTSIM keeps the cells of the normal contact: finer cells do not reduce the error of the model."""
    rows: list[int] = []
    compute_contact = module.frictional_contact

    def record_cells(shape: Shape, settings: Settings, request: FrictionRequest) -> FrictionalContact:
        rows.append(shape.grid.cells_y)
        return compute_contact(shape, settings, request)

    monkeypatch.setattr(module, "frictional_contact", record_cells)
    case = replace(STEEL_CASE, motion=Rolling(longitudinal_creepage=1e-3, model="fastsim"))
    refined_contact = refine_contact(case, 0.05, 1e-6)
    _, _, errors = refine_tractions(case, refined_contact, 1e-6)
    cells = refined_contact.contact.shape.grid.cells_y
    assert rows == [cells // 2, cells]
    assert "comment" in errors.friction_work_error.attrs


@pytest.mark.slow
def test_window_contains_contact_of_wheel_and_rail() -> None:
    """The window contains the contact with the margin of rolling, although it exceeds the first window."""
    steel = Material(206e9, 0.28)
    wheel = Roller(radius=0.46, length=30e-3, profile=Ellipsoid(crown_radius=0.3), material=steel)
    motion = Rolling(longitudinal_creepage=1e-3)
    case = Case(body=HalfSpace(material=steel), roller=wheel, load=150e3, friction=0.3, motion=motion)
    result = solve(case, accuracy=0.1, stresses=False)
    assert bool(result.converged)
    assert 0.3 < float(result.force_y) / (0.3 * 150e3) < 1


def test_newton_steps_on_the_first_cells_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    bounds, solve_frictional = [], module.frictional_contact

    def record_bound(shape: Shape, settings: Settings, request: FrictionRequest) -> FrictionalContact:
        bounds.append(request.max_steps)
        return solve_frictional(shape, settings, request)

    monkeypatch.setattr(module, "frictional_contact", record_bound)
    case = replace(STEEL_CASE, motion=Shift(y=1e-8))
    refine_tractions(case, refine_contact(case, 0.05, 1e-6), 0.05)
    assert bounds[:2] == [module.MAX_COARSE_STEPS, None]
