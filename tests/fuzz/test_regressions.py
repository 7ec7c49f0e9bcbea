"""Cases from random runs that violated a property."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Case, FiniteLengthSpace, Grid, Material, Roller, Shift, profiles, solve, stress_field


@pytest.mark.slow
def test_coupled_contact_of_short_elastic_roller_converges() -> None:
    body = FiniteLengthSpace(material=Material(82323447553.80612, 0.5), length=2.1301408010505498e-07)
    roller = Roller(
        radius=0.0029670151688925748,
        length=2.5064003993584664e-07,
        profile=profiles.PartialCrown(straight_length=2.086192658853036e-07, crown_radius=0.004163218428832561),
        material=Material(30514801145.037006, 0.5),
    )
    case = Case(
        body=body,
        roller=roller,
        max_pressure=18316553.800983183,
        friction=0.5,
        end_distance=-3.754181617903073e-08,
        coupled=True,
    )
    window = (-1.09849551913929e-05, 1.09849551913929e-05)
    result = solve(case, Grid(x_range=(0.0, body.length), y_range=window, cells_x=130, cells_y=34), stresses=False)
    assert bool(result["converged"])
    assert float(result["penetration_error"]) < 1e-6


def test_stress_below_single_cell_contact_equals_pressure() -> None:
    """A contact of one cell in a wide window has finite stresses below it."""
    body = FiniteLengthSpace(material=Material(210e9, 0.3), length=0.001, model="single-mirror")
    case = Case(body=body, roller=Roller(radius=8.5e-3, length=0.25e-3), max_pressure=0.2e9)
    result = solve(case, Grid(x_range=(0.0, 0.001), y_range=(-1.1e-3, 1.1e-3), cells_x=16, cells_y=13), stresses=False)
    pressure = result["pressure"]
    (row,) = np.flatnonzero(pressure.any("x"))
    stress = stress_field(body, pressure, x=pressure["x"][[7]], y=pressure["y"][[row]], z=[0.0])
    assert stress["sigma_zz"].item() == pytest.approx(-pressure[7, row].item())


@pytest.mark.parametrize(
    "motion",
    [
        Shift(x=3.6e-11, y=-1.1e-11),
        pytest.param(Shift(force_x=-2e-10), marks=pytest.mark.slow),
        pytest.param(Shift(force_y=3e-10, x=1e-11), marks=pytest.mark.slow),
    ],
    ids=str,
)
def test_small_shift_converges(motion: Shift) -> None:
    """The pressure alone displaces the surfaces by more than the shift, so that Newton's method may cycle."""
    material = Material(4.625e9, 0.3)
    case = Case(
        body=FiniteLengthSpace(length=2.407632396547847e-08, material=material),
        roller=Roller(radius=2.932e-6, length=3.741e-8, profile=profiles.FullCrown(crown_radius=5.419e-6)),
        load=7.008e-08,
        friction=0.1,
        end_distance=-0.6665e-8,
        tilt=-4.716e-3,
        motion=motion,
    )
    window = (-9.248014993268249e-08, 9.248014993268249e-08)
    result = solve(case, Grid(x_range=(0.0, case.body.length), y_range=window, cells_x=6, cells_y=12), stresses=False)
    assert bool(result["converged"])
    assert float(result["slip_error"]) < 1e-5


def test_shift_of_overlapping_ends_converges() -> None:
    """Newton's method cycles, and descents of the energy start from its iterates."""
    steel = Material(210e9, 0.0)
    tapered = profiles.FujiwaraKawase(
        amplitude=1.689573911465408e-12, edge_drop=3.379147822930816e-12, k1=1.2727051015735997, k2=0.6896010243489831
    )
    profile = profiles.Halves(tapered, profiles.Cylinder())
    case = Case(
        body=FiniteLengthSpace(length=1.7655611798901384e-06, material=steel),
        roller=Roller(radius=0.005, length=2.265449651387833e-06, profile=profile, material=steel),
        max_pressure=5712319.066402162,
        friction=0.1,
        end_distance=-2.8849034107501417e-07,
        tilt=1.4182392634012695e-05,
        motion=Shift(x=-1.1929520552566943e-12, y=-9.388347962207421e-13),
    )
    window = (-2.1761215491055856e-06, 2.1761215491055856e-06)
    result = solve(case, Grid(x_range=(0.0, case.body.length), y_range=window, cells_x=14, cells_y=19), stresses=False)
    assert bool(result["converged"])
    assert int(result["friction_steps"]) < 100
