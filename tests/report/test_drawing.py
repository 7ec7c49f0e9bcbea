"""The drawing is to scale, and says by how much the crown is not."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree

import pytest

from contactstudy import Case, FiniteLengthSpace, HalfSpace, Material, QuarterSpace, Roller, profiles
from contactstudy.report.drawing import draw

STEEL = Material(210e9, 0.3)


def case(body=None, **roller) -> Case:
    body = body or FiniteLengthSpace(length=16e-3, material=STEEL)
    return Case(body=body, roller=Roller(**({"radius": 4e-3, "length": 14e-3} | roller)), max_pressure=1.5e9)


def test_lengths_are_in_one_scale() -> None:
    drawing = draw(case())
    root = ElementTree.fromstring(drawing.svg)
    space = "{http://www.w3.org/2000/svg}"
    body = float(root.find(f"{space}rect").get("width"))
    points = root.find(f"{space}polygon").get("points").split()
    x, y = ([float(point.split(",")[axis]) for point in points] for axis in (0, 1))
    assert (max(x) - min(x)) / body == pytest.approx(14 / 16, rel=1e-3)
    assert (max(y) - min(y)) / body == pytest.approx(4 / 16, rel=1e-3)
    for text in ("L = 14 mm", "R = 4 mm", "body 16 mm", "end I: e = 1 mm", "end II: e = 1 mm"):
        assert text in drawing.svg
    assert "so is the profile" in drawing.caption


@pytest.mark.parametrize("crown_radius", [0.5, 1.0, 20.0])
def test_a_crown_is_drawn_as_deep_as_is_said(crown_radius: float) -> None:
    drawing = draw(case(profile=profiles.FullCrown(crown_radius)))
    factor = float(re.search(r"drawn (\S+) times as deep", drawing.caption)[1])
    points = ElementTree.fromstring(drawing.svg).find("{http://www.w3.org/2000/svg}polygon").get("points").split()
    z = [float(point.split(",")[1]) for point in points][1:-1]
    scale = (760 - 2 * 56) / 16e-3
    assert max(z) - z[0] == pytest.approx(factor * 7e-3**2 / (2 * crown_radius) * scale, rel=0.01)


@pytest.mark.parametrize("body", [HalfSpace(material=STEEL), QuarterSpace(material=STEEL)])
def test_bodies_without_ends_go_on(body) -> None:
    drawing = draw(case(body, profile=profiles.Lundberg(2e-7), radius=50e-3))
    ElementTree.fromstring(drawing.svg)
    assert ("end I:" in drawing.svg) == isinstance(body, QuarterSpace)
    assert "end II:" not in drawing.svg
    assert "cut below its axis" in drawing.caption


def test_a_flush_roller_has_no_distance_of_rounding() -> None:
    length = 1.2e-3
    body = FiniteLengthSpace(length=length, material=Material(210e9, 0.3))
    # The roller is at end II, but for rounding.
    roller = Roller(radius=4e-3, length=0.9e-3)
    shown = str(draw(Case(body=body, roller=roller, max_pressure=1e9, end_distance=0.3e-3 * (1 + 1e-14))).svg)
    assert "end II: e = 0 " in shown


def test_a_tapered_roller_says_that_its_taper_is_not_drawn() -> None:
    said = draw(case(profile=profiles.Tapered(half_angle=0.05))).caption
    # The cone's radius across the generatrix: R / cos(beta) -+ tan(beta) L / 2.
    assert "changes from 3.655 mm to 4.355 mm along it" in said
    assert "the radius at mid-length all along" in said
    assert "changes" not in draw(case()).caption
