"""What cases, rollers, bodies, profiles and studies say of themselves: what an engineer wants first, in his units."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contactstudy import Case, FiniteLengthSpace, HalfSpace, Material, QuarterSpace, Roller, Rolling, profiles
from contactstudy.profiles import Cylinder, EffectiveLength, FullCrown, Halves, Lundberg, Measured, Tapered
from contactstudy.study.setup import build_setup
from tests.small_study import BASE, small_study

STEEL = Material(210e9, 0.3)


def test_parts_say_their_sizes_in_the_units_of_engineers() -> None:
    shown = {
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
    for part, text in shown.items():
        assert repr(part) == text


def test_a_measured_profile_does_not_list_its_points() -> None:
    x = np.linspace(0, 10e-3, 1001)
    assert repr(Measured(x.tolist(), (1e-1 * (x - 5e-3) ** 2).tolist())) == (
        "Measured(1001 points over 10 mm, drop up to 2.5 µm)"
    )


def test_a_case_says_load_pressure_and_place_first() -> None:
    body = FiniteLengthSpace(length=16e-3, material=STEEL)
    roller = Roller(radius=6e-3, length=14e-3, profile=profiles.PartialCrown(6e-3, 2.0), material=STEEL)
    case = Case(body=body, roller=roller, load=9e3, friction=0.05, tilt=1e-3)
    lines = repr(case).splitlines()
    assert lines[0].startswith("Case: W = 9 kN, p0 = ")
    assert lines[0].endswith("e = 1 mm")
    assert "end drop 4 µm, E = 210 GPa" in lines[1]
    assert lines[3] == "  friction 0.05, full sliding along +y; tilt 1 mrad"
    balanced = replace(case, tilt=0.0, load_position=8e-3)
    assert repr(balanced).splitlines()[3].endswith("load at x = 8 mm")
    assert "Rolling(" in repr(replace(case, motion=Rolling(longitudinal_creepage=1e-3)))
    page = case._repr_html_()
    assert page.count("<tr>") == page.count("</tr>") > 15
    assert "9 kN" in page


def test_parts_are_tables_in_a_notebook() -> None:
    crown = FullCrown(1.25) + Cylinder(3e-4)
    parts = {
        STEEL: ("shear modulus G", "80.77 GPa"),
        FiniteLengthSpace(length=16e-3, material=STEEL): ("two free ends, 16 mm apart", "230.8 GPa"),
        QuarterSpace(material=STEEL, model="mirror"): ("comparison model &#x27;mirror&#x27;",),
        Lundberg(2.112e-7): ("amplitude", "0.2112 µm"),
        crown: ("crown_radius=1250 mm", "fillet_radius=0.3 mm"),
        EffectiveLength(FullCrown(1.25), 9e-3): ("effective length", "8.1 µm"),
        Measured((0.0, 1e-3, 2e-3, 3e-3, 4e-3), (2e-6, 1e-6, 0.0, 1e-6, 2e-6)): ("drop up to", "2 µm"),
        Roller(radius=5e-3, length=10e-3, profile=crown, material=STEEL): ("its own free ends", "0.31 mm"),
    }
    for part, texts in parts.items():
        page = part._repr_html_()
        assert all(text in page for text in texts), page
        assert page.count("<td") == page.count("</td>")
    # A result whose profile is a class of one's own has a picture, too.
    assert "<svg" in Roller(radius=5e-3, length=10e-3, profile=Lundberg(2e-7))._repr_html_()


def test_a_study_says_what_it_sweeps() -> None:
    study = small_study(description="<small>", base=BASE | {"roller_body": "rigid"})
    lines = repr(study).splitlines()
    assert lines[0] == "Study small: 4 cases before exclusions, keeping fields"
    assert "  friction (swept): 0, 0.1" in lines
    assert "  radius: 5 mm" in lines
    assert "&lt;small&gt;" in study._repr_html_()
    assert "20 values, 0 to 19" in repr(small_study(sweep={"e_over_a": list(range(20))}))


def test_cases_share_their_preparation_only_if_their_numbers_are_the_same() -> None:
    """Texts are rounded; identities are not."""
    close = [build_setup(BASE | {"e_over_a": 1.0, "young": young}).operator for young in (210e9, 210.000001e9, 210e9)]
    assert close[0] == close[2] != close[1]
