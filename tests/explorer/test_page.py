"""What the page shows follows what is chosen, from files and from an opened study alike."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

pytest.importorskip("panel")

from contactstudy import ContactStudyError, InvalidInputError, explore, open_study
from contactstudy.analysis import in_plane
from contactstudy.arrays.variables import specification
from contactstudy.explorer import server, show
from contactstudy.explorer.cases import Cases, of_dataset, of_folder
from contactstudy.explorer.drawn import PLANES, REGIONS, axial, plane, region, scale_of, top
from contactstudy.explorer.figures import NEUTRAL, StudyFigure
from contactstudy.explorer.looked import Looked
from contactstudy.explorer.numbers import ORDER, SUBJECTS
from contactstudy.explorer.page import Page, _marked
from contactstudy.explorer.pixels import between, pixels
from contactstudy.study import run_study
from tests.small_study import small_study
from tests.stand_in_solver import solve_fake

SOURCES: dict[str, Callable[[Path], Cases]] = {
    "files": of_folder,
    "opened": lambda folder: of_dataset(open_study(folder)),
    "own cells": lambda folder: of_dataset(open_study(folder, cells="own")),
}


@pytest.fixture(params=SOURCES)
def page(request: pytest.FixtureRequest, folder: Path) -> Page:
    return Page(SOURCES[request.param](folder))


def shown(page: Page) -> tuple[float, float]:
    """Largest pressure drawn along the axis, and on the top."""
    along = page.axial._lines[0].data["p"]
    (picture,) = page.tops[0]._source.data["image"]
    return float(np.nanmax(along)), float(picture.max())


def test_every_swept_parameter_has_a_choice(page: Page) -> None:
    assert list(page.choices[0]) == ["max_pressure", "friction", "profile"]
    assert list(page.choices[0]["max_pressure"].options) == ["1 GPa", "1.25 GPa", "1.5 GPa"]
    assert list(page.choices[0]["profile"].options) == ["cylinder", "rounded"]
    assert "friction" in page.over.options.values()


def test_figures_and_numbers_follow(page: Page) -> None:
    before = shown(page)
    assert ">1 GPa<" in page.table.object
    page.choices[0]["max_pressure"].value = 2
    assert ">1.5 GPa<" in page.table.object
    assert shown(page)[0] == pytest.approx(1.5 * before[0], rel=0.05)
    assert page.study._chosen.data["x"] == [1.5]
    page.units.value = True
    assert shown(page)[0] == pytest.approx(before[0] / 1000, rel=0.05)


def test_two_cases_side_by_side_share_their_colours(page: Page) -> None:
    assert not page.panes[2].visible
    assert not page.axial._legend.visible
    page.compare.value = True
    page.choices[1]["max_pressure"].value = 2
    assert page.panes[2].visible
    assert page.axial._legend.visible
    assert page.tops[0]._mapper.high == page.tops[1]._mapper.high > 1500
    assert page.table.object.count("edge factor of the contact towards end I (largest within a, over its middle)") == 1
    assert ">1 GPa<" in page.table.object
    assert ">1.5 GPa<" in page.table.object


def test_two_cases_side_by_side_share_their_axes(page: Page) -> None:
    page.compare.value = True
    page.choices[1]["max_pressure"].value = 2
    for figures in (page.tops, page.planes):
        spans = [(each.figure.y_range.start, each.figure.y_range.end) for each in figures]
        drawn = [(each._source.data["y"][0], each._source.data["h"][0]) for each in figures]
        assert spans[0] == spans[1]
        assert drawn[0] != drawn[1]
        for y, height in drawn:
            assert min(spans[0]) <= y
            assert y + height <= max(spans[0])


def test_one_case_is_not_plural(page: Page, solved: xr.Dataset) -> None:
    assert ">12 cases<" in page.view()[0].object
    assert ">1 case<" in Page(of_dataset(solved)).view()[0].object


def test_a_case_that_failed_says_why(page: Page) -> None:
    page.choices[0]["friction"].value = 1
    assert ">failed<" in page.table.object
    assert "This case failed. WindowError: this friction fails in tests" in page.table.object
    assert page.tops[0]._source.data["image"] == []
    assert np.isnan(page.study._chosen.data["v"]).all()
    assert not any(pane.visible for pane in page.panes)  # no empty axes
    assert "No case with these values" in page.table.object
    page.compare.value = True
    assert page.panes[2].visible
    assert not page.panes[1].visible
    assert "<b>case:</b> This case failed" in page.table.object
    page.compare.value = False
    page.choices[0]["friction"].value = 0
    assert len(page.tops[0]._source.data["image"]) == 1
    assert "class=why" not in page.table.object
    assert [pane.visible for pane in page.panes] == [True, True, False, True, False, True]


def test_a_study_of_numbers_alone_shows_them(tmp_path: Path) -> None:
    run_study(small_study(level="summary"), tmp_path, workers=0, solver=solve_fake, progress=False)
    page = Page(of_folder(tmp_path))
    assert "keeps no surfaces of this case, only its numbers" in page.table.object
    assert [pane.visible for pane in page.panes] == [False, False, False, False, False, True]


def test_a_plane_without_stresses_is_said(page: Page) -> None:
    place, inner = page.place(0), page.cases.load
    bare = Looked(inner(place).dataset.drop_vars("von_mises"))
    less = Page(Cases(page.cases.scalars, lambda wanted: bare, page.cases.title))
    assert "Its stresses are not computed or not kept." in less.table.object
    assert [pane.visible for pane in less.panes] == [True, True, False, False, False, True]
    assert not less.plane.visible  # there is nothing to choose a plane of
    assert not less.planes[0].figure.visible
    assert page.plane.visible
    less.view()
    assert [pane.visible for pane in less.panes] == [True, True, False, False, False, True]


def test_numbers_stand_by_subject(page: Page) -> None:
    groups = page.number.groups
    assert list(groups) == [subject for subject in ORDER if subject in groups]
    assert list(groups)[:2] == ["pressure", "stresses"]
    assert list(groups)[-1] == "how it was solved"
    names = [name for group in groups.values() for name in group.values()]
    assert names[0] == page.number.value == "peak_pressure"
    floats = {name for name, entry in page.cases.scalars.data_vars.items() if entry.dtype.kind == "f"}
    assert {name for name in floats if not name.endswith("_error")} >= set(names)
    assert len(names) == len(set(names)) == len({text for group in groups.values() for text in group})
    known = [name for subject in SUBJECTS.values() for name in subject]
    assert len(known) == len(set(known))
    assert all(name.endswith("_") or specification(name) for name in known)


def test_errors_of_the_study_are_bars_and_missing_ones_are_said(page: Page) -> None:
    scalars = page.cases.scalars
    peak = scalars["peak_pressure"]
    error = (0.1 * peak).where(scalars["max_pressure"] > 1.1e9, np.inf)
    made = Page(Cases(scalars.assign(peak_pressure_error=error), page.cases.load, page.cases.title))
    data = made.study._line.data
    np.testing.assert_allclose(data["high"][1:], 1.1 * data["v"][1:])
    np.testing.assert_allclose(data["low"][1:], 0.9 * data["v"][1:])
    assert np.isnan([data["low"][0], data["high"][0]]).all()
    assert data["fill"].tolist() == ["white", NEUTRAL, NEUTRAL]
    assert made.study.figure.title.text == "bars: stated errors; open marks: no error known"
    assert made.study.figure.y_range.end > data["high"][-1]
    made.number.value = "normal_load"  # it was given: nothing is missed
    assert made.study._line.data["fill"].tolist() == [NEUTRAL] * 3
    assert made.study.figure.title.text == ""


def test_planes_are_those_of_the_analysis(folder: Path) -> None:
    one = of_folder(folder).load((0, 0, 0))
    scale = scale_of(one, relative=False)
    whole = region(one, REGIONS[0])
    image = plane(one, scale, whole, PLANES[0], 0.5)
    assert image is not None
    expected = in_plane(one.dataset[["von_mises"]], y=0.0, variables="von_mises")["von_mises"]
    assert float(image.values.max()) == pytest.approx(float(expected.max()) / 1e6, rel=0.02)
    assert image.place == " at y = 0 mm"
    for kind in PLANES[1:]:
        found = plane(one, scale, whole, kind, 0.0)
        assert found is not None
        assert found.names[1].startswith("depth" if kind[0] == "x" else "position along rolling")
    depth = 0.3 * float(one.points["z"][0]) + 0.7 * float(one.points["z"][1])
    expected = in_plane(one.dataset[["von_mises"]], z=depth, variables="von_mises")["von_mises"]
    found = between(one.stress, one.points["z"], depth, 2)
    assert found == pytest.approx(expected.transpose(*one.dataset["von_mises"].dims[:2]).values, rel=1e-9)
    assert plane(Looked(one.dataset.drop_vars("von_mises")), scale, whole, PLANES[0], 0.5) is None


def test_no_singular_height_is_drawn(solved: xr.Dataset) -> None:
    singular = solved[["pressure", "hertz_half_width", "hertz_max_pressure"]].assign(end_pressure_first=np.inf)
    half_width = float(solved["hertz_half_width"])
    fine = Looked(
        singular.interp(x=np.linspace(float(solved.x[0]), float(solved.x[-1]), 400)).drop_vars(
            "x_bounds", errors="ignore"
        )
    )
    scale = scale_of(fine, relative=True)
    line = axial(fine, scale)
    assert len(line.singular) == 1
    assert np.isnan(line.pressure[np.abs(line.x - line.singular[0]) < 0.05]).all()
    limit = top(fine, scale, region(fine, REGIONS[1])).most
    assert limit <= float(np.nanmax(line.pressure)) * (1 + 1e-9)
    assert region(fine, REGIONS[2])[1] - region(fine, REGIONS[2])[0] <= 8 * half_width


def test_a_step_along_numbers_makes_no_new_model(page: Page) -> None:
    axis = page.study.figure.xaxis[0]
    plain = axis.ticker
    page.choices[0]["max_pressure"].value = 1
    assert axis.ticker is plain
    page.over.value = "profile"
    words = axis.ticker
    assert list(words.ticks) == [0.0, 1.0]
    assert axis.major_label_overrides == {0.0: "cylinder", 1.0: "rounded"}
    page.choices[0]["profile"].value = 1
    assert axis.ticker is words
    page.over.value = "max_pressure"
    assert axis.ticker is plain
    assert axis.major_label_overrides == {}


def test_pixels_keep_lines_and_hold_the_ends() -> None:
    x, y = np.array([0.0, 1.0, 4.0]), np.array([0.0, 2.0])
    found = pixels(x[:, None] + y, (x, y), ((-1.0, 5.0), (0.0, 2.0)), (6, 2))
    assert found.shape == (2, 6)
    assert found[0].tolist() == [0.5, 1.0, 2.0, 3.0, 4.0, 4.5]


def test_combinations_that_are_left_out_are_not_counted(page: Page) -> None:
    assert ">12 cases<" in page.view()[0].object
    status = page.cases.scalars["status"].astype(object)
    status[0, 0, 0] = "excluded"
    less = Page(Cases(page.cases.scalars.assign(status=status.astype(str)), page.cases.load, page.cases.title))
    assert ">11 cases<" in less.view()[0].object


def test_a_notebook_is_told_of_changes(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import panel as pn
    from bokeh.document import Document
    from panel.io.model import add_to_doc
    from pyviz_comms import Comm

    sent = []

    class Spy(Comm):
        _comm = property(lambda self: True, lambda self, value: None)  # it is open

        def send(self, data=None, metadata=None, buffers=()):
            sent.append(data)

    page = Page(of_folder(folder))
    view, document, comm = page.view(), Document(), Spy()
    root = view.get_root(document, comm)
    add_to_doc(root, document, hold=True)
    monkeypatch.setitem(pn.state._views, root.ref["id"], (view, root, document, comm))
    page.choices[0]["max_pressure"].value = 1
    assert any("ModelChanged" in str(message) for message in sent)


def test_the_public_ways_in(folder: Path, solved: xr.Dataset) -> None:
    assert type(explore(folder)).__name__ == "Column"
    assert type(open_study(folder).contact.explore()).__name__ == "Column"
    assert type(solved.contact.explore()).__name__ == "Column"
    with pytest.raises(InvalidInputError, match="study"):
        explore(3)  # type: ignore[arg-type]


def test_a_missing_extra_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    monkeypatch.setattr(show, "find_spec", lambda name: None)
    with pytest.raises(ContactStudyError, match=r'pip install "contactstudy\[explore\]"'):
        explore(folder)
    assert "panel" in sys.modules  # it is the check that speaks, not a failed import


def test_a_port_that_is_taken_is_named() -> None:
    import socket

    with socket.socket() as other:
        other.bind(("localhost", 0))
        other.listen()
        port = other.getsockname()[1]
        with pytest.raises(InvalidInputError, match=f"port = {port}"):
            server._checked_port(port)
        assert server._free_port() != port


def test_a_value_without_a_limit_is_a_triangle_whoever_looks_at_it() -> None:
    figure = StudyFigure()
    values, places = np.array([2.0, np.inf]), np.array([0.0, 1.0])
    figure.show(values, places, None, [(0, 2.0, "blue"), (1, np.inf, "red")], ("x", "v"))
    assert (figure._chosen.data["x"], figure._chosen.data["color"]) == ([0.0], ["blue"])
    assert (figure._chosen_endless.data["x"], figure._chosen_endless.data["color"]) == ([1.0], ["red"])
    figure.show(np.array([np.inf, np.inf]), places, None, [(1, np.inf, "red")], ("x", "v"))
    assert figure.figure.y_range.end > 1.0


def test_a_number_that_is_rounding_says_so() -> None:
    assert _marked("0 N", "rounding: below 1e-06 of it") == "0 N (rounding: below 1e-06 of it)"
