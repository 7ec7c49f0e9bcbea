"""Tractions under a given pressure: number of operator applications, independence of units."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from contactstudy import ConvergenceWarning, FiniteLengthSpace, Grid, HalfSpace, Material, Rolling, Shift
from contactstudy.bodies import Counterbody
from contactstudy.cache import ArrayKey
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.contact import Settings, Shape
from contactstudy.contact.normal.prescribed_loads import PrescribedLoad
from contactstudy.contact.rolling import tractions as module
from contactstudy.contact.rolling.coulomb import (
    CoulombProblem,
    CoulombSolution,
    Guess,
    law_violation,
    solve_with_continuation,
)
from contactstudy.contact.rolling.frictional_contact import FrictionalContact, frictional_contact
from contactstudy.contact.rolling.surfaces import Tractions
from contactstudy.contact.rolling.tractions import FrictionRequest
from contactstudy.fields.surface import SurfaceOperator
from contactstudy.kernels.load import Load
from tests.contact.rolling.motions import FRICTION, LOAD, MOTIONS

EDGES = {
    "uniform": np.linspace(-1.3, 1.3, 27),
    "graded": np.concatenate([np.linspace(-1.3, 0.4, 15), np.linspace(0.5, 1.3, 19)]),
    "nested": np.linspace(-1.3, 1.3, 49),
}
LENGTH, PRESSURE = 2.0**-17, 2.0**37
"""Units of length and pressure: powers of two have no rounding errors."""

POWERS = {"spin": (-1, 0), "force_x": (2, 1), "force_y": (2, 1), "moment_z": (3, 1)}
"""Powers of length and pressure in the prescribed values of a motion: creepages have none, shifts are lengths."""


def scale_units(motion: Rolling | Shift) -> Rolling | Shift:
    """Return a motion in the other units."""
    changes: dict[str, Any] = {}
    for parameter in fields(motion):
        value = getattr(motion, parameter.name)
        if isinstance(value, float):
            length, pressure = POWERS.get(parameter.name, (1, 0) if isinstance(motion, Shift) else (0, 0))
            changes[parameter.name] = value * LENGTH**length * PRESSURE**pressure
    return replace(motion, **changes)


def solve_friction(
    motion: Rolling | Shift, edges: str, *, other_units: bool = False, **keywords: Any
) -> FrictionalContact:
    """Contact of a ball on a body of its material, a little off the origin."""
    length, pressure = (LENGTH, PRESSURE) if other_units else (1.0, 1.0)
    cell_count = 48 if edges == "nested" else 26
    grid = Grid.between(length * EDGES[edges], (-1.3 * length, 1.3 * length), cell_count)
    gap = 0.05 * ((grid.x[:, None] - 0.02 * length) ** 2 + grid.y**2) / length
    body = HalfSpace(material=Material(0.91 * pressure, 0.3))
    prescribed_load = PrescribedLoad(LOAD * pressure * length**2)
    shape = Shape(body, grid, ArrayKey(gap), prescribed_load, Counterbody(body))
    motion = scale_units(motion) if other_units else motion
    request = FrictionRequest(
        motion=motion, friction=FRICTION, reference_x=0.1 * length, **({"coupled": False} | keywords)
    )
    return frictional_contact(shape, Settings(), request)


def count_tangential(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """List with an entry per application of the operator to tractions."""
    calls: list[int] = []
    original_displacements = SurfaceOperator.compute_displacements

    def count_application(self: SurfaceOperator, loads: Any, directions: Any) -> Any:
        calls.extend([1] * (Load.ALONG_X in loads))
        return original_displacements(self, loads, directions)

    monkeypatch.setattr(SurfaceOperator, "compute_displacements", count_application)
    return calls


@pytest.mark.parametrize(("edges", "limits"), [("graded", (566, 82)), ("nested", (858, 100))])
def test_applications_of_the_operator_are_few(
    edges: str, limits: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    sums, calls = {Rolling: 0, Shift: 0}, count_tangential(monkeypatch)
    for motion in MOTIONS.values():
        computed = solve_friction(motion, edges).tractions
        assert computed.converged
        sums[type(motion)] += len(calls)
        calls.clear()
    assert sums[Rolling] < limits[0]
    assert sums[Shift] < limits[1]


def get_value(tractions: Tractions, name: str) -> FloatArray | float:
    return tractions.resultants[name] if name in tractions.resultants else getattr(tractions, name)


@pytest.mark.parametrize(
    ("edges", "name"),
    [
        *(("graded", name) for name in ("longitudinal", "spin", "forces", "shift")),
        *(("nested", name) for name in ("lateral", "all", "moment", "shifting force")),
    ],
)
def test_results_scale_with_units(edges: str, name: str) -> None:
    motion = MOTIONS[name]
    baseline, variant = (
        solve_friction(motion, edges).tractions,
        solve_friction(motion, edges, other_units=True).tractions,
    )
    assert baseline.steps == variant.steps
    is_rolling = isinstance(motion, Rolling)
    units = {"traction": (0, 1), "slip": (0, 0) if is_rolling else (1, 0), "work": (2, 1) if is_rolling else (3, 1)}
    for name, (length, pressure) in (units | {key: POWERS[key] for key in ("force_x", "force_y", "moment_z")}).items():
        value, unit = get_value(baseline, name), LENGTH**length * PRESSURE**pressure
        minimum = 1e-9 * np.abs(value).max() if np.ndim(value) else 1e-9 * FRICTION * LOAD
        assert get_value(variant, name) / unit == pytest.approx(value, rel=1e-6, abs=minimum), name
    for name, rigid_motion in baseline.amplitudes.items():
        length, pressure = POWERS.get(name, (0, 0) if is_rolling else (1, 0))
        assert variant.amplitudes[name] == pytest.approx(rigid_motion * LENGTH**length * PRESSURE**pressure, rel=1e-6)
    assert np.array_equal(baseline.sticks, variant.sticks)
    for name in ("bound_error", "slip_error", "force_error"):  # differences of the values above
        assert getattr(variant, name) == pytest.approx(getattr(baseline, name), rel=1e-3, abs=1e-9)


@pytest.mark.parametrize("name", ["forces", "shifting force", "moment"])
def test_force_error_is_relative_to_largest_resultant(name: str) -> None:
    """The error of an early stop follows from the returned tractions and the positions of the cells."""
    tractions = solve_friction(MOTIONS[name], "uniform", max_steps=1, other_units=True).tractions
    motion, magnitude = scale_units(MOTIONS[name]), np.hypot(*tractions.traction) * (0.1 * LENGTH) ** 2
    centres = 0.1 * LENGTH * (np.arange(26) - 12.5)
    arm = np.abs(centres - 0.1 * LENGTH)[:, None] + np.abs(centres)  # spin and moment refer to x = 0.1
    sizes = {"force_x": magnitude, "force_y": magnitude, "moment_z": arm * magnitude}
    prescribed_values = {key: getattr(motion, key) for key in sizes if getattr(motion, key, None) is not None}
    errors = [abs(tractions.resultants[key] - value) / sizes[key].sum() for key, value in prescribed_values.items()]
    assert tractions.force_error == pytest.approx(max(errors), rel=1e-9)
    assert tractions.force_error > 1e-6


@pytest.mark.parametrize("motion", [MOTIONS["all"], MOTIONS["shift"], replace(MOTIONS["all"], model="fastsim")])
def test_position_along_axis_does_not_change_tractions(motion: Rolling | Shift) -> None:
    """Spin and moment refer to the middle at any position along the axis."""

    def make_contact(start: float) -> FrictionalContact:
        grid = Grid.between(start + EDGES["uniform"], (-1.3, 1.3), 26)
        gap = 0.05 * ((grid.x[:, None] - start - 0.02) ** 2 + grid.y**2)
        body = HalfSpace(material=Material(0.91, 0.3))
        shape = Shape(body, grid, ArrayKey(gap), PrescribedLoad(LOAD), Counterbody(body))
        request = FrictionRequest(motion=motion, friction=FRICTION, reference_x=start + 0.1, coupled=False)
        return frictional_contact(shape, Settings(), request)

    baseline, variant = make_contact(0.0).tractions, make_contact(8.0).tractions
    assert variant.traction == pytest.approx(baseline.traction, abs=1e-6 * baseline.traction.max())
    for name in ("force_x", "force_y", "moment_z", "work"):
        assert get_value(variant, name) == pytest.approx(get_value(baseline, name), rel=1e-5), name


@pytest.mark.parametrize("motion", [Rolling(longitudinal_creepage=0.03), Rolling(lateral_creepage=-0.03, spin=0.02)])
def test_work_is_traction_times_slip(motion: Rolling) -> None:
    """The pressure of a rigid ball on a soft body displaces the surface tangentially and contributes to the work."""
    grid = Grid(x_range=(-1.3, 1.3), y_range=(-1.3, 1.3), cells_x=40, cells_y=40)
    gap = 0.05 * (grid.x[:, None] ** 2 + grid.y**2)
    body = HalfSpace(material=Material(0.91, 0.1))
    for model in ("exact", "fastsim"):
        model_motion = replace(motion, model=model)
        shape = Shape(body, grid, ArrayKey(gap), PrescribedLoad(LOAD))
        request = FrictionRequest(motion=model_motion, friction=FRICTION, reference_x=0.0, coupled=False)
        computed = frictional_contact(shape, Settings(), request).tractions
        slip_work = float((computed.traction * computed.slip).sum() * grid.cell_area)
        assert computed.work == pytest.approx(slip_work, rel=1e-9 if model == "fastsim" else 0.03)
        input_work = (
            computed.amplitudes["x"] * computed.resultants["force_x"]
            + computed.amplitudes["y"] * computed.resultants["force_y"]
        )
        input_work += computed.amplitudes["spin"] * computed.resultants["moment_z"]
        if model == "exact":  # displacements by the pressure also do work
            assert abs(computed.work - input_work) > 0.2 * input_work


@pytest.mark.parametrize("name", ["all", "shift", "forces"])
def test_steps_are_counted(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    steps: list[int] = []

    def record_steps(problem: CoulombProblem, start: Guess | None = None) -> CoulombSolution:
        solution = solve_with_continuation(problem, start)
        steps.append(solution.steps)
        return solution

    monkeypatch.setattr(module, "solve_with_continuation", record_steps)
    assert solve_friction(MOTIONS[name], "uniform").tractions.steps == sum(steps)


def test_warning_contains_unconverged_iteration() -> None:
    computed = solve_friction(MOTIONS["all"], "uniform")
    unconverged_tractions = replace(computed, tractions=replace(computed.tractions, converged=False))
    unconverged_pressure = replace(computed, contact=replace(computed.contact, converged=False))
    for contact, reason in (
        (unconverged_tractions, "stick and slip did not converge"),
        (unconverged_pressure, "the contact iteration stopped"),
    ):
        with pytest.warns(ConvergenceWarning, match=reason):
            contact.warn_unless_converged()


def test_violations_are_relative_to_rigid_slip(monkeypatch: pytest.MonkeyPatch) -> None:
    """The scale is the slip of prescribed and unknown motions together, about a middle outside the contact's centre."""
    scales: list[float] = []

    def record_scale(traction: Any, slip: Any, bound: Any, sticks: Any, scale: float) -> tuple[float, float]:
        scales.append(scale)
        return law_violation(traction, slip, bound, sticks, scale)

    monkeypatch.setattr(module, "law_violation", record_scale)
    computed = solve_friction(MOTIONS["moment"], "uniform")
    amplitudes, grid = computed.tractions.amplitudes, computed.contact.shape.grid
    slip_x = amplitudes["x"] - amplitudes["spin"] * grid.y
    slip_y = amplitudes["y"] + amplitudes["spin"] * (grid.x[:, None] - 0.1)
    is_loaded = computed.contact.pressure > 0
    expected = np.hypot(slip_x, slip_y)[is_loaded].max()
    reversed_spin_slip = np.hypot(
        amplitudes["x"] + amplitudes["spin"] * grid.y, amplitudes["y"] - amplitudes["spin"] * (grid.x[:, None] - 0.1)
    )
    assert scales[-1] == pytest.approx(expected, rel=0.03)
    assert reversed_spin_slip[is_loaded].max() != pytest.approx(expected, rel=0.04)


def test_fastsim_spin_sign_matches_exact_theory() -> None:
    motion = Rolling(spin=0.003)
    exact_tractions, strip_tractions = (
        solve_friction(model_motion, "uniform").tractions.traction
        for model_motion in (motion, replace(motion, model="fastsim"))
    )
    for component, variant in zip(exact_tractions, strip_tractions, strict=True):
        assert float((component * variant).sum()) > 0.7 * float(np.sqrt((component**2).sum() * (variant**2).sum()))


def test_coupled_contact_scales_with_unit() -> None:
    """The tractions and the pressure of a rigid ball on a compressible body are solved alternately."""
    computed = []
    for length, pressure in ((1.0, 1.0), (LENGTH, PRESSURE), (2.0**17, 2.0**-37)):
        grid = Grid.between(length * EDGES["uniform"], (-1.3 * length, 1.3 * length), 26)
        gap = 0.05 * ((grid.x[:, None] - 0.02 * length) ** 2 + grid.y**2) / length
        body = HalfSpace(material=Material(0.91 * pressure, 0.1))
        shape = Shape(body, grid, ArrayKey(gap), PrescribedLoad(LOAD * pressure * length**2))
        motion = Rolling(longitudinal_creepage=0.01)
        request = FrictionRequest(motion=motion, friction=FRICTION, reference_x=0.0, coupled=True)
        contact = frictional_contact(shape, Settings(), request)
        assert contact.converged
        computed.append(contact.contact.pressure / pressure)
    assert computed[1] == pytest.approx(computed[0], abs=1e-9)
    assert computed[2] == pytest.approx(computed[0], abs=1e-9)


def test_slipping_leading_cell_has_slip() -> None:
    """Under spin some columns stick behind a slipping leading cell, which depends on the cell behind it."""
    computed = solve_friction(Rolling(lateral_creepage=0.03, spin=0.1), "uniform")
    is_loaded, sticks = computed.contact.pressure > 0, computed.tractions.sticks
    is_leading = is_loaded & ~np.pad(is_loaded, ((0, 0), (0, 1)))[:, 1:]
    assert (is_leading & ~sticks & sticks.any(axis=1)[:, None]).any()
    slip = np.hypot(*computed.tractions.slip)
    assert (slip[is_loaded & ~sticks] > 0).all()
    assert (slip[is_leading & ~sticks] > 1e-3).all()


@pytest.mark.parametrize("columns", [1, 4])
def test_contact_with_few_columns_and_many_rows_converges(columns: int) -> None:
    """The coarser cells of a body between free ends have as few as one column."""
    body = FiniteLengthSpace(length=1.0, material=Material(0.91, 0.3))
    grid = Grid(x_range=(0.0, 1.0), y_range=(-2.0, 2.0), cells_x=columns, cells_y=256)
    gap = np.broadcast_to(0.05 * grid.y**2, grid.shape)
    shape = Shape(body, grid, ArrayKey(gap), PrescribedLoad(0.05))
    motion = Rolling(longitudinal_creepage=0.01)
    request = FrictionRequest(motion=motion, friction=0.3, reference_x=0.5, coupled=False)
    computed = frictional_contact(shape, Settings(), request)
    assert computed.converged
    assert computed.tractions.resultants["force_y"] == pytest.approx(-0.475 * 0.3 * 0.05, rel=0.04)


@pytest.mark.parametrize(
    "motion", [Rolling(longitudinal_creepage=0.01), Rolling(longitudinal_creepage=0.006, spin=0.05)]
)
@pytest.mark.parametrize("edges", EDGES)
def test_work_equals_sum_of_traction_times_slip(motion: Rolling, edges: str) -> None:
    contact = solve_friction(motion, edges)
    tractions, grid = contact.tractions, contact.contact.shape.grid
    power = (tractions.traction * tractions.slip).sum(axis=0) * grid.weights * grid.cell_area
    assert float(power.sum()) == pytest.approx(tractions.work, rel=1e-9)
    assert power.min() >= 0
