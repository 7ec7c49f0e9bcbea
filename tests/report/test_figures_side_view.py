"""Side view: lengths to scale, magnification of the drop, captions."""

from __future__ import annotations

import re

import numpy as np
import pytest
from matplotlib.figure import Figure

from contactstudy import Case, FiniteLengthSpace, HalfSpace, Material, QuarterSpace, Roller, profiles
from contactstudy.bodies import Body
from contactstudy.report import figures
from contactstudy.report.figures import side_geometry, side_view

STEEL = Material(210e9, 0.3)


def make_case(body: Body | None = None, **roller: object) -> Case:
    body = body or FiniteLengthSpace(length=16e-3, material=STEEL)
    return Case(body=body, roller=Roller(**({"radius": 4e-3, "length": 14e-3} | roller)), max_pressure=1.5e9)


@pytest.fixture
def drawn_figures(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """List of the figures that the page encodes."""
    figure_list: list[Figure] = []
    monkeypatch.setattr(figures, "encode_figure", lambda figure: figure_list.append(figure) or "data:")
    return figure_list


def list_texts(figure: Figure) -> list[str]:
    return [text.get_text().strip() for text in figure.axes[0].texts]


def test_side_view_has_equal_scales(drawn_figures: list[Figure]) -> None:
    geometry = side_geometry(make_case())
    assert geometry.limits == (0.0, 16e-3)
    assert geometry.roller == pytest.approx((1e-3, 15e-3))
    assert geometry.height == 4e-3
    assert geometry.magnification == 1
    caption = side_view(make_case()).caption
    assert "the profile is to scale" in caption
    (figure,) = drawn_figures
    assert figure.axes[0].get_aspect() == 1
    assert {"L = 14 mm", "R = 4 mm", "body 16 mm", "end I: e = 1 mm", "end II: e = 1 mm"} <= {*list_texts(figure)}


@pytest.mark.parametrize("crown_radius", [0.5, 1.0, 20.0])
def test_caption_contains_magnification_of_crown(crown_radius: float) -> None:
    crowned_case = make_case(profile=profiles.FullCrown(crown_radius))
    geometry = side_geometry(crowned_case)
    factor = float(re.search(r"magnified (\S+) times", side_view(crowned_case).caption)[1])
    assert geometry.generatrix.max() == pytest.approx(factor * 7e-3**2 / (2 * crown_radius), rel=0.01)
    assert not geometry.is_clipped


@pytest.mark.parametrize("body", [HalfSpace(material=STEEL), QuarterSpace(material=STEEL)])
def test_view_labels_existing_ends_only(body: Body, drawn_figures: list[Figure]) -> None:
    caption = side_view(make_case(body, profile=profiles.Lundberg(2e-7), radius=50e-3)).caption
    labels = " ".join(list_texts(drawn_figures[0]))
    assert ("end I:" in labels) == isinstance(body, QuarterSpace)
    assert "end II:" not in labels
    assert "cut below its axis" in caption


def test_flush_end_within_rounding_has_distance_zero(drawn_figures: list[Figure]) -> None:
    body = FiniteLengthSpace(length=1.2e-3, material=STEEL)
    roller = Roller(radius=4e-3, length=0.9e-3)
    side_view(Case(body=body, roller=roller, max_pressure=1e9, end_distance=0.3e-3 * (1 + 1e-14)))
    assert any(text.startswith("end II: e = 0 ") for text in list_texts(drawn_figures[0]))


def test_caption_contains_radii_of_cone() -> None:
    caption = side_view(make_case(profile=profiles.Tapered(half_angle=0.05))).caption
    # The cone's radius across the generatrix: R / cos(beta) -+ tan(beta) L / 2.
    assert "changes from 3.655 mm to 4.355 mm along it" in caption
    assert "changes" not in side_view(make_case()).caption


def test_infinite_drop_is_clipped() -> None:
    geometry = side_geometry(make_case(profile=profiles.Lundberg(2e-7)))
    assert np.isfinite(geometry.generatrix).all()
    assert geometry.is_clipped
