"""Profiles in studies: every kind, files of measured profiles, and identities of cases."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from contactstudy import Material, profiles
from contactstudy.errors import InvalidInputError
from contactstudy.study import Study, open_study, run_study
from contactstudy.study.case_setup import build_setup
from contactstudy.study.profile_tables import PROFILES, format_profile, profile_table
from tests.small_study import BASE, case_id, format_toml, small_study
from tests.stand_in_solver import solve_fake
from tests.study.conftest import ROOT

LENGTH = BASE["roller_length"]
EXAMPLES = {
    "cylinder": profiles.Cylinder(1e-5),
    "tapered": profiles.Tapered(0.05, 1e-5),
    "lundberg": profiles.Lundberg(1e-7, 1.5),
    "johns-gohar": profiles.JohnsGohar(1e-7, 6e-5),
    "fujiwara-kawase": profiles.FujiwaraKawase(1e-7, 1e-6, 2.0, 0.5),
    "iso-cylindrical": profiles.IsoCylindrical(8e-3),
    "iso-tapered": profiles.IsoTapered(8e-3),
    "full-crown": profiles.FullCrown(0.5, 1e-5),
    "partial-crown": profiles.PartialCrown(1e-4, 0.5, 5e-5, 0.1),
    "ellipsoid": profiles.Ellipsoid(0.5),
    "sphere": profiles.Sphere(BASE["radius"]),
    "chamfer": profiles.Chamfer(width=2e-5, angle=0.05),
    "measured": profiles.Measured(
        [round(5e-5 * index, 6) for index in range(11)], [4e-7] + 9 * [1e-7] + [0.0], 1e-6, 3e-4
    ),
    "halves": profiles.Halves(left=profiles.Cylinder(), right=profiles.FullCrown(0.5)),
    "effective-length": profiles.EffectiveLength(profiles.FullCrown(0.5), 4.5e-4),
    "sum": profiles.Tapered(0.05) + profiles.IsoTapered(8e-3),
}


def build_profile(profile: object) -> profiles.Profile:
    return build_setup(BASE | {"e_over_a": 1, "profile": profile}).case.roller.profile


def write_trace(folder: Path, height: float = 1.0, name: str = "trace.csv") -> Path:
    """File with a measured crown of `height` micrometres at the ends, as long as the roller of BASE."""
    folder.mkdir(exist_ok=True)
    path, x = folder / name, np.linspace(-1, 1, 51)
    rows = [f"{1e3 * LENGTH * position / 2:.6f}, {height * position * position:.6f}" for position in x]
    path.write_text("\n".join(["x [mm], drop [um]", *rows]))
    return path


def test_profile_classes_have_kinds() -> None:
    public_objects = {getattr(profiles, name) for name in profiles.__all__}
    assert {kind.profile_class for kind in PROFILES.values()} == {
        entry for entry in public_objects if dataclasses.is_dataclass(entry)
    }
    assert set(EXAMPLES) == set(PROFILES)


@pytest.mark.parametrize("kind", EXAMPLES)
def test_profile_object_table_and_json_agree(kind: str) -> None:
    profile = EXAMPLES[kind]
    assert build_profile(profile) == profile
    table = profile_table("profile", profile)
    assert table["kind"] == kind
    restored_table = json.loads(json.dumps(table))
    assert build_profile(restored_table) == profile
    assert case_id({"profile": profile}) == case_id({"profile": restored_table})
    assert format_profile(table)


def test_documented_profiles_are_valid(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "reference" / "study_file.md").read_text()
    block = next(section for section in text.split("```toml\n") if section.startswith("[[sweep.profile]]")).split(
        "```"
    )[0]
    write_trace(tmp_path / "traces", name="roller_7.csv")
    path = tmp_path / "documented.toml"
    path.write_text(format_toml(small_study(sweep={"e_over_a": [1.0]})) + block)
    plan = Study.from_toml(path).plan()
    assert (len(plan), plan.skipped) == (2, [])


def test_identity_of_profiles_never_changes() -> None:
    """Results on disk depend on these values."""
    assert case_id({"profile": {"kind": "cylinder", "fillet_radius": 5e-5}})[:16] == "5dad625aa5b6ab8f"
    assert case_id({"profile": {"kind": "lundberg", "design_pressure": 1.5e9, "delta": 2}})[:16] == "20f2b4da00ad6e96"


@pytest.mark.parametrize("kind", ["lundberg", "johns-gohar", "fujiwara-kawase"])
def test_profile_from_design_pressure_equals_for_pressure(kind: str) -> None:
    edge_options = {"edge_drop": 1e-6} if kind == "fujiwara-kawase" else {}
    modulus = BASE["young"] / (1 - BASE["poisson"] ** 2)
    profile = PROFILES[kind].profile_class.for_pressure(2e9, radius=BASE["radius"], modulus=modulus, **edge_options)  # type: ignore[attr-defined]
    assert build_profile({"kind": kind, "design_pressure": 2e9, **edge_options}) == profile


def test_profile_from_design_load_equals_for_load() -> None:
    profile = build_profile({"kind": "lundberg", "design_load": 100.0})
    material = Material(BASE["young"], BASE["poisson"])
    contact_parameters = {"radius": BASE["radius"], "modulus": material.plane_strain_modulus}
    assert profile == profiles.Lundberg.for_load(100.0, length=BASE["roller_length"], **contact_parameters)


def test_profile_defaults_scale_with_radius() -> None:
    assert build_profile("sphere") == profiles.Sphere(BASE["radius"])
    assert build_profile("iso-cylindrical") == profiles.IsoCylindrical(2 * BASE["radius"])
    assert build_profile({"kind": "iso-tapered", "diameter": 1e-2}) == profiles.IsoTapered(1e-2)


def test_identity_depends_on_file_content_only(tmp_path: Path) -> None:
    def identity(path: Path, **options) -> str:
        return case_id(BASE | {"profile": {"kind": "measured", "file": str(path), **options}})

    first_identity = identity(write_trace(tmp_path / "one"))
    assert identity(write_trace(tmp_path / "two", name="moved.csv")) == first_identity
    assert identity(write_trace(tmp_path / "one", height=1.001)) != first_identity
    assert identity(write_trace(tmp_path / "one")) == first_identity
    assert identity(tmp_path / "one" / "trace.csv", remove_offset=True) == first_identity
    assert identity(tmp_path / "one" / "trace.csv", largest_spike=1e-3) != first_identity
    assert identity(tmp_path / "one" / "trace.csv", cutoff=1e-4) != first_identity
    filtered_profile = build_profile(
        {"kind": "measured", "file": str(tmp_path / "one" / "trace.csv"), "cutoff": 1e-4, "turn": 180}
    )
    assert filtered_profile.cutoff == 1e-4


def test_profile_paths_are_relative_to_study_file(tmp_path: Path, monkeypatch) -> None:
    path = write_trace(tmp_path / "traces")
    entries = [
        {"kind": "measured", "file": "traces/trace.csv"},
        {"kind": "sum", "name": "both", "terms": [{"kind": "measured", "file": "traces/trace.csv"}, "cylinder"]},
    ]
    file = tmp_path / "small.toml"
    lines = [
        "[[sweep.profile]]\nkind = 'measured'\nfile = 'traces/trace.csv'",
        "[[sweep.profile]]\nkind = 'sum'\nname = 'both'",
        "terms = [{ kind = 'measured', file = 'traces/trace.csv' }, 'cylinder']",
    ]
    file.write_text(format_toml(small_study(sweep={"e_over_a": [1.0]})) + "\n".join(lines))
    monkeypatch.chdir(ROOT)
    study = Study.from_toml(file)
    monkeypatch.chdir(tmp_path)
    assert study == small_study(sweep={"e_over_a": [1.0], "profile": entries})
    path.unlink()
    report = run_study(study, tmp_path / "results", workers=0, solver=solve_fake, progress=False)
    assert report.counts == {"ok": 2}
    dataset = open_study(tmp_path / "results")
    assert dataset["profile"].values.tolist() == ["trace", "both"]
    assert (dataset["status"] == "ok").all()


def test_labels_of_different_measured_profiles_differ(tmp_path: Path) -> None:
    tables = [
        profile_table("profile", profiles.Measured.from_file(write_trace(tmp_path, height))) for height in (1.0, 2.0)
    ]
    assert len({format_profile(table) for table in tables}) == 2
    assert format_profile(profile_table("profile", EXAMPLES["halves"])) == "cylinder | full-crown crown_radius=0.5"


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"kind": "taper"}, "profile.kind = 'taper'.*did you mean 'tapered'"),
        ({"kind": "tapered", "angle": 0.1}, "profile key = 'angle'.*half_angle"),
        ({"kind": "tapered"}, "given with half_angle"),
        ({"kind": "tapered", "half_angle": "3 degrees"}, "profile.half_angle = '3 degrees'"),
        (
            {"kind": "lundberg", "amplitude": 1e-6, "design_pressure": 1e9},
            "exactly one of amplitude, design_pressu",
        ),
        ({"kind": "johns-gohar", "amplitude": 1e-6}, "given with half_width"),
        (
            {"kind": "johns-gohar", "half_width": 1e-6, "design_pressure": 1e9},
            "exactly one of amplitude with half",
        ),
        ({"kind": "fujiwara-kawase", "design_pressure": 1e9}, "given with edge_drop"),
        ({"kind": "sphere", "radius": 4e-3}, "radius = 0.004: must be the roller's radius"),
        ({"kind": "measured"}, "given with positions"),
        ({"kind": "measured", "file": 3}, "profile.file = 3"),
        ({"kind": "measured", "file": "none.csv"}, "path = 'none.csv'"),
        ({"kind": "measured", "file": "none.csv", "remove_tilt": 1}, "profile.remove_tilt = 1"),
        ({"kind": "measured", "file": "a.csv", "drops": [0]}, "given with file, or with positions and drops"),
        ({"kind": "measured", "positions": [0, 1], "drops": ["a", "b"]}, "profile.drops"),
        ({"kind": "measured", "path": "a.csv"}, "profile key = 'path'"),
        ({"kind": "halves", "left": "cylinder"}, "given with right"),
        ({"kind": "halves", "left": "cylinder", "right": {"kind": "round"}}, "profile.kind = 'round'"),
        ({"kind": "sum", "terms": "cylinder"}, "profile.terms = 'cylinder'"),
        ({"kind": "sum", "terms": []}, "terms = "),
    ],
)
def test_invalid_profile_table_raises(table, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        build_profile(table)
