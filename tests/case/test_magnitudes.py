"""Warnings of magnitudes that suggest a wrong unit."""

from __future__ import annotations

import re
import warnings
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    FiniteLengthSpace,
    HalfSpace,
    InvalidInputError,
    Lubricant,
    MagnitudeWarning,
    Material,
    Roller,
    Rolling,
    Sliding,
    WindowError,
    bearing,
    choose_grid,
    fatigue,
    plasticity,
    profiles,
    roughness,
    solve,
    solve_film,
)
from contactstudy.case.magnitudes import list_unusual_magnitudes
from contactstudy.cli import main
from contactstudy.heat import ThermalProperties
from contactstudy.study import Study, run_study
from tests.small_study import BASE, format_toml, small_study
from tests.stand_in_solver import solve_fake

STEEL = Material(206e9, 0.3)
TYPICAL_VALUES = {"radius": 6e-3, "length": 14e-3, "body": 16e-3, "material": STEEL, "load": 9e3}


def create_case(**changes) -> Case:
    values = TYPICAL_VALUES | changes
    roller = Roller(radius=values.pop("radius"), length=values.pop("length"), material=values.pop("roller", None))
    body = FiniteLengthSpace(length=values.pop("body"), material=values.pop("material"))
    return Case(body=body, roller=roller, **values)


def create_crowned_case(crown: profiles.Profile, length: float = 14e-3, radius: float = 6e-3) -> Case:
    roller = Roller(radius=radius, length=length, profile=crown)
    return Case(body=HalfSpace(material=STEEL), roller=roller, max_pressure=1.5e9)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"friction": 0.3, "tilt": 1e-3, "roller": STEEL},
        {"radius": 1e-3, "length": 1e-3, "body": 1e-3, "load": 20.0},
        {"radius": 0.7, "length": 2.0, "body": 2.5, "load": 2e7},
        {"material": Material(2e6, 0.5), "load": 1.0},
        {"material": Material(1.1e12, 0.1), "load": None, "max_pressure": 8e9},
        {"motion": Sliding(body_speed=-80.0, roller_speed=0.0)},
    ],
)
def test_typical_cases_have_no_warning(changes) -> None:
    """Typical cases range from a wire to a rolling mill, and from rubber to diamond."""
    assert not list_unusual_magnitudes(create_case(**changes))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"radius": 6, "length": 14, "body": 16},
            r"roller.radius = 6 m, usual are 1e-05 to 1.5 m; 6 mm is 0.006 m; roller.length = 14 m.*; "
            r"body.length = 16 m, usual are 1e-05 to 3 m; 16 mm is 0.016 m",
        ),
        ({"material": Material(206, 0.3), "load": 9e-6}, r"body.material.young = 206 Pa.*; 206 GPa is 2.06e\+11 Pa"),
        ({"material": Material(206e3, 0.3), "load": 9e-3}, r"body.material.young = 206000 Pa.*; 206000 MPa is 2.06e"),
        ({"roller": Material(1e13, 0.3)}, r"roller.material.young = 1e\+13 Pa, usual are 1e\+06 to 1.5e\+12 Pa"),
        ({"friction": 5}, "friction = 5, usual are 0 to 1.5; 5 % is 0.05"),
        ({"friction": xr.DataArray([0.1, -8.0], dims="x", coords={"x": [0.0, 1e-2]})}, "friction = 8"),
        ({"tilt": 0.05}, "tilt = 0.05 rad, usual are 0 to 0.01 rad; 0.05 deg is 0.000872665 rad"),
        (
            {"load": None, "max_pressure": 1.5e5},
            "max_pressure = 150000 Pa is very low: half-width 1e-06 of the roller's radius, Hertz pressure 0.15 MPa",
        ),
        ({"load": None, "approach": 5e-3}, "approach = 0.005 m, usual are up to 0.0006 m on .*; 0.005 mm is 5e-06 m"),
        ({"load": 6e5}, "load = 600000 N is very high: half-width"),
        (
            {"motion": Sliding(body_speed=2000.0, roller_speed=2200.0)},
            "^entrainment_speed = 2100 m/s, usual are 0 to 150 m/s; 2100 mm/s is 2.1 m/s; sliding_speed = 200 m/s",
        ),
        ({"motion": Rolling(speed=160.0)}, "entrainment_speed = 160 m/s, .*; 160 mm/s is 0.16 m/s"),
    ],
)
def test_unusual_case_has_warning(changes, message: str) -> None:
    assert re.search(message, "; ".join(list_unusual_magnitudes(create_case(**changes))))


@pytest.mark.parametrize(
    ("crown", "message"),
    [
        (
            profiles.Lundberg(8.0),
            "0.4 of the length from the middle = 8.1.* m, usual are up to 0.0009 m .*; 8.1.* µm is 8",
        ),
        (profiles.Lundberg(8e-3), "= 0.008.* m, usual are up to 0.0009 m .*; 0.008.* mm is 8.*e-06 m"),
        (profiles.Measured(1e-3 * np.array([-7, -6.5, 0, 6.5, 7]), [8.0, 0, 0, 0, 8.0]), "0.49 of .* µm is .*e-06 m"),
    ],
)
def test_crown_in_a_wrong_unit_warns(crown: profiles.Profile, message: str) -> None:
    assert re.search(message, list_unusual_magnitudes(create_crowned_case(crown))[0])


@pytest.mark.parametrize(
    "crown",
    [
        profiles.FullCrown(crown_radius=200),
        profiles.FullCrown(crown_radius=200) + profiles.Cylinder(fillet_radius=0.2e-3),
        profiles.PartialCrown(4e-3, crown_radius=200),
    ],
)
def test_crown_radius_in_millimetres_warns(crown: profiles.Profile) -> None:
    message = r"Crown.crown_radius = 200 m drops by 6.2e-08 m over half .*, less than is ground; 200 mm is 0.2 m"
    assert re.search(message, list_unusual_magnitudes(create_crowned_case(crown, length=10e-3))[0])


@pytest.mark.parametrize(("length", "crown_radius"), [(50e-3, 900.0), (20e-3, 300.0), (10e-3, 100.0), (0.5e-3, 2.0)])
def test_real_crowns_have_no_flatness_warning(length: float, crown_radius: float) -> None:
    """Real crowns drop by 0.1 um and more, on a watch pin by some nanometres."""
    assert not list_unusual_magnitudes(
        create_crowned_case(profiles.FullCrown(crown_radius), length=length, radius=0.5 * length)
    )


@pytest.mark.parametrize(
    "crown",
    [
        profiles.Lundberg(8e-6),
        profiles.Cylinder(fillet_radius=1e-3),
        profiles.FullCrown(crown_radius=12e-3),
        profiles.PartialCrown(4e-3, 1.2, dub_length=0.8e-3, dub_radius=0.06),
        profiles.IsoTapered(diameter=12e-3),
    ],
)
def test_typical_crowns_raise_no_warning(crown: profiles.Profile) -> None:
    assert not list_unusual_magnitudes(create_crowned_case(crown, length=10e-3))


def test_solve_warns_once_at_the_line_of_the_call() -> None:
    roller = Roller(radius=5e-3, length=0.3e-3, profile=profiles.FullCrown(0.5))
    case = Case(body=HalfSpace(material=STEEL), roller=roller, max_pressure=1.5e9, friction=2.0)
    with pytest.warns(MagnitudeWarning, match=r"friction = 2, usual are 0 to 1.5; 2 % is 0.02") as caught:
        solve(case, accuracy=0.1, stresses=False)
    (warning,) = [warning for warning in caught if warning.category is MagnitudeWarning]
    assert warning.filename == __file__


def test_plan_and_run_contain_the_warning(tmp_path: Path, capsys) -> None:
    study = small_study(sweep={"e_over_a": [0.0, 1.0], "friction": [0.0, 5.0]})
    assert study.plan().doubts == ("friction = 5, usual are 0 to 1.5; 5 % is 0.05 (2 contacts)",)
    (tmp_path / "small.toml").write_text(format_toml(study))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert main(["plan", str(tmp_path / "small.toml"), "--out", str(tmp_path / "results")]) == 0
        assert "friction = 5" in capsys.readouterr().out
        report = run_study(study, tmp_path / "results", workers=0, solver=solve_fake, progress=False)
    assert report.counts == {"ok": 4}
    assert any("friction = 5" in line for line in report.remarks)
    assert "friction = 5" in (tmp_path / "results" / "run.log").read_text()


def test_plan_warns_of_lengths_in_millimetres(tmp_path: Path) -> None:
    base = BASE | {"radius": 6.0, "roller_length": 14.0, "max_pressure": 1.5e9, "e_over_a": 0.0}
    plan = Study(name="mm", base=base).plan()
    assert [warning_text.split(",")[0] for warning_text in plan.doubts] == [
        "roller.radius = 6 m",
        "roller.length = 14 m",
        "body.length = 14 m",
    ]
    assert np.isfinite(plan.review.cells)


@pytest.mark.parametrize(("pressure", "modulus", "rating"), [(1500.0, 113e9, "low"), (1.5e9, 113.0, "high")])
def test_crown_designed_in_a_wrong_unit_warns(pressure: float, modulus: float, rating: str) -> None:
    crown = profiles.JohnsGohar.for_pressure(1.5e9, radius=6e-3, modulus=113e9)
    wrong_crown = profiles.Lundberg.for_pressure(pressure, radius=6e-3, modulus=modulus)
    case = create_case()
    for profile in (wrong_crown, profiles.Halves(crown, wrong_crown)):
        messages = list_unusual_magnitudes(replace(case, roller=replace(case.roller, profile=profile)))
        expected = f"Lundberg.amplitude = {wrong_crown.amplitude:.3g} m belongs to a very {rating} design load"
        assert any(expected in message for message in messages)
    assert not list_unusual_magnitudes(replace(case, roller=replace(case.roller, profile=crown)))


@pytest.mark.parametrize(
    ("create", "message"),
    [
        (lambda: fatigue.FatigueLimits(bending=500, torsion=300), r"bending = 500 Pa.*500 MPa is 5e\+08 Pa; torsion"),
        (lambda: plasticity.ElasticPlastic(yield_stress=1.8), r"yield_stress = 1.8 Pa.*1.8 GPa is 1.8e\+09 Pa"),
        (
            lambda: ThermalProperties(conductivity=46.0, density=7.85, specific_heat=0.47),
            r"density = 7.85 kg/m3.*7.85 g/cm3 is 7850 kg/m3; specific_heat = 0.47 .*is 470 J",
        ),
        (lambda: bearing.roller_ratings(50, rollers=14, gamma=0.2), r"dynamic_rating = 50 N.*50 kN is 50000 N"),
    ],
)
def test_materials_and_ratings_warn_at_creation(create, message: str) -> None:
    with pytest.warns(MagnitudeWarning, match=message) as caught:
        create()
    assert caught[0].filename == __file__


def test_heights_in_micrometres_warn() -> None:
    case = Case(body=HalfSpace(material=STEEL), roller=Roller(radius=6e-3, length=1e-3), max_pressure=1e9)
    grid = choose_grid(case)
    heights = roughness.self_affine(grid, rms_height=0.2, hurst=0.8, longest=0.2e-3, shortest=0.05e-3, seed=1)
    with pytest.warns(MagnitudeWarning, match=r"roughness = .* usual are 0 to 0.0002 m.* µm is"):
        solve_ignoring_window(case, heights)


def test_film_warns_of_unusual_inputs() -> None:
    motion = Sliding(body_speed=2000.0, roller_speed=2000.0)
    oil = Lubricant(viscosity=0.03, pressure_viscosity=20e-9)
    with pytest.warns(MagnitudeWarning, match="entrainment_speed = 2000 m/s") as caught, suppress(InvalidInputError):
        solve_film(create_case(motion=motion, lubricant=oil), accuracy=1.0)
    assert caught[0].filename == __file__


def test_plan_checks_all_speeds_of_a_group() -> None:
    base = {"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 1e-3, "max_pressure": 1e9, "e_over_a": 0.0}
    oil = {"viscosity": 0.03, "pressure_viscosity": 20e-9}
    (doubt,) = Study(name="film", base=base | oil, sweep={"entrainment_speed": [1.0, 1000.0]}).plan().doubts
    assert doubt.startswith("entrainment_speed = 1000 m/s, usual are 0 to 150 m/s; 1000 mm/s is 1 m/s")


def solve_ignoring_window(case: Case, heights: xr.DataArray) -> None:
    with suppress(WindowError):  # heights of a metre exceed the window
        solve(case, roughness=heights, stresses=False)
