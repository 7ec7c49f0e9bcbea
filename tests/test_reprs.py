"""Texts of cases, rollers, bodies, profiles and studies, in engineering units."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contactstudy import Case, FiniteLengthSpace, HalfSpace, Material, QuarterSpace, Roller, Rolling, profiles
from contactstudy.profiles import Cylinder, FullCrown, Halves, Lundberg, Measured, Tapered
from contactstudy.report import case_table
from contactstudy.study.case_setup import build_setup
from tests.small_study import BASE, small_study

STEEL = Material(210e9, 0.3)


def test_reprs_use_engineering_units() -> None:
    expected_texts = {
        STEEL: "Material(E = 210 GPa, nu = 0.3)",
        HalfSpace(material=STEEL): "HalfSpace(E = 210 GPa, nu = 0.3)",
        QuarterSpace(material=STEEL, model="mirror"): "QuarterSpace(E = 210 GPa, nu = 0.3, model='mirror')",
        FiniteLengthSpace(length=16e-3, material=STEEL): "FiniteLengthSpace(L = 16 mm, E = 210 GPa, nu = 0.3)",
        Lundberg(2.112e-7): "Lundberg(amplitude=0.2112 µm)",
        Tapered(2e-3): "Tapered(half_angle=2 mrad)",
        Cylinder(): "Cylinder()",
        FullCrown(1.25) + Cylinder(3e-4): "FullCrown(crown_radius=1250 mm) + Cylinder(fillet_radius=0.3 mm)",
        Halves(Cylinder(), FullCrown(1.0)): "Halves(left=Cylinder(), right=FullCrown(crown_radius=1000 mm))",
    }
    for value, expected in expected_texts.items():
        assert repr(value) == expected


def test_measured_profile_repr_omits_points() -> None:
    x = np.linspace(0, 10e-3, 1001)
    assert repr(Measured(x.tolist(), (1e-1 * (x - 5e-3) ** 2).tolist())) == (
        "Measured(1001 points over 10 mm, drop up to 2.5 µm)"
    )


def test_case_repr_begins_with_load() -> None:
    body = FiniteLengthSpace(length=16e-3, material=STEEL)
    roller = Roller(radius=6e-3, length=14e-3, profile=profiles.PartialCrown(6e-3, 2.0), material=STEEL)
    case = Case(body=body, roller=roller, load=9e3, friction=0.05, tilt=1e-3)
    lines = repr(case).splitlines()
    assert lines[0].startswith("Case: W = 9 kN, p0 = ")
    assert lines[0].endswith("e = 1 mm")
    assert "end drop 4 µm, E = 210 GPa" in lines[1]
    assert lines[3] == "  friction 0.05, full sliding along +y; tilt 1 mrad"
    balanced_case = replace(case, tilt=0.0, load_position=8e-3)
    assert repr(balanced_case).splitlines()[3].endswith("load at x = 8 mm")
    assert "Rolling(" in repr(replace(case, motion=Rolling(longitudinal_creepage=1e-3)))
    page = case_table(case)._repr_html_()
    assert page.count("<tr>") == page.count("</tr>") > 15
    assert "9 kN" in page


def test_study_repr_contains_swept_parameters() -> None:
    study = small_study(description="<small>", base=BASE | {"roller_body": "rigid"})
    lines = repr(study).splitlines()
    assert lines[0] == "Study small: 4 cases before exclusions, keeping fields"
    assert "  friction (swept): 0, 0.1" in lines
    assert "  radius: 5 mm" in lines
    assert "&lt;small&gt;" in study._repr_html_()
    assert "20 values, 0 to 19" in repr(small_study(sweep={"e_over_a": list(range(20))}))


def test_setup_keeps_all_digits_of_parameters() -> None:
    """Identities round parameters; set-up cases must not."""
    bodies = [build_setup(BASE | {"e_over_a": 1.0, "young": young}).case.body for young in (210e9, 210.000001e9, 210e9)]
    assert bodies[0] == bodies[2] != bodies[1]
