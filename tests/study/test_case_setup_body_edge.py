"""Edge of the body in studies: the case, its identity, the labels of a sweep, and invalid input."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from contactstudy import Case, InvalidInputError, profiles, solve
from contactstudy.analysis import solved_case
from contactstudy.study import Study, load_case, open_study, run_study
from contactstudy.study.case_setup import build_setup
from contactstudy.study.parameters import PARAMETERS
from contactstudy.study.profile_tables import PROFILES
from tests.small_study import BASE, case_id, format_toml, small_study
from tests.study.test_profile_tables import EXAMPLES

OVERHANG = {key: value for key, value in BASE.items() if not key.startswith("field")} | {"end_distance": -5e-5}
EDGES = [{"name": "drawn", "kind": "chamfer", "width": 5e-5, "angle": 0.1}, profiles.Cylinder(2e-5), "cylinder"]
TABLES = """
[[sweep.body_edge]]
name = "drawn"
kind = "chamfer"
width = 5e-5
angle = 0.1

[[sweep.body_edge]]
kind = "cylinder"
fillet_radius = 2e-5

[[sweep.body_edge]]
kind = "cylinder"
"""


def build_case(edge: object, **changes: object) -> Case:
    return build_setup(OVERHANG | {"body_edge": edge} | changes).case


@pytest.mark.parametrize("kind", PROFILES)
def test_study_accepts_body_edges_of_case_only(kind: str) -> None:
    edge = EXAMPLES[kind]
    if isinstance(edge, profiles.Cylinder | profiles.Chamfer):
        assert build_case(edge).body_edge == edge
    else:
        with pytest.raises(InvalidInputError, match=f"body_edge.kind = '{kind}': must be one of chamfer, cylinder"):
            build_case(edge)


def test_identity_ignores_sharp_edge_and_name() -> None:
    assert case_id(OVERHANG | {"body_edge": "cylinder"}) == case_id(OVERHANG)
    edge_table = {"kind": "cylinder", "fillet_radius": 2e-5}
    assert case_id({"body_edge": edge_table | {"name": "ours"}}) == case_id({"body_edge": edge_table}) != case_id({})
    assert PARAMETERS["body_edge"].default == {"kind": "cylinder"}


def test_swept_edges_equal_solved_cases(tmp_path: Path) -> None:
    study = small_study(base=OVERHANG | {"stresses": False}, sweep={"body_edge": EDGES}, level="surface")
    path = tmp_path / "small.toml"
    study_without_edges = small_study(base=OVERHANG | {"stresses": False}, sweep={}, level="surface")
    path.write_text(format_toml(study_without_edges) + TABLES)
    assert Study.from_toml(path) == study == Study.from_mapping(json.loads(study.to_json()))
    assert run_study(study, tmp_path / "results", workers=0, progress=False).counts == {"ok": 3}
    dataset = open_study(tmp_path / "results", cells="original")
    assert dataset["body_edge"].values.tolist() == ["drawn", "cylinder fillet_radius=2e-05", "cylinder"]
    assert dataset["body_edge"].attrs["long_name"] == "body edge"
    for planned_case, input_edge in zip(
        study.plan(), [profiles.Chamfer(width=5e-5, angle=0.1), *EDGES[1:]], strict=True
    ):
        setup = build_setup(planned_case.parameters)
        expected = solve(setup.case, setup.grid, tolerance=1e-6, stresses=False)
        stored_case = load_case(tmp_path / "results", planned_case.id)
        assert solved_case(stored_case) == setup.case
        assert setup.case.body_edge == (profiles.Cylinder() if input_edge == "cylinder" else input_edge)
        np.testing.assert_allclose(
            stored_case["pressure"], expected["pressure"], rtol=1e-6
        )  # stored in single precision
    assert len(set(dataset["peak_pressure"].values.tolist())) == len(EDGES)


def test_exclusion_by_name_of_edge() -> None:
    study = small_study(base=OVERHANG, sweep={"body_edge": EDGES}, exclude=[{"body_edge": ["drawn", "cylinder"]}])
    assert [case.name for case in study.plan()] == ["body_edge=cylinder fillet_radius=2e-05"]


@pytest.mark.parametrize(
    ("edge", "message"),
    [
        (1e-4, r"body_edge = 0.0001: must be .* a table with a kind: one of cylinder, chamfer"),
        (lambda x, length: x, r"body_edge = .*: must be .* one of cylinder, chamfer"),
        ({"fillet_radius": 1e-4}, r"body_edge = {'fillet_radius': 0.0001}: must be .* a table with a kind"),
        ({"kind": "cylinder", "radius": 1e-4}, "body_edge key = 'radius': must be one of fillet_radius"),
        ({"kind": "cylinder", "fillet_radius": "wide"}, "body_edge.fillet_radius = 'wide'"),
        ({"kind": "cylinder", "fillet_radius": -1e-4}, "body_edge.fillet_radius = -0.0001: must be .* not below zero"),
        ({"kind": "cylinder", "fillet_radius": 1.0}, "body_edge.fillet_radius = 1.0: must be at most half the length"),
        ({"kind": "chamfer", "width": 1e-4}, "body_edge.depth, width, angle = .*exactly two"),
    ],
)
def test_invalid_edge_raises(edge: object, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        build_case(edge)


@pytest.mark.parametrize("edge", EDGES)
def test_edge_of_half_space_has_no_effect(edge: object) -> None:
    sharp_case, case = build_case("cylinder", body="half-space"), build_case(edge, body="half-space")
    x = np.linspace(*case.contact_range, 9)
    np.testing.assert_array_equal(case.gap_on_axis(x), sharp_case.gap_on_axis(x))
    assert not case.nodes.size
