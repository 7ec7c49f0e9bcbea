"""Page of the explorer: figures and numbers of selected cases, from files and from an opened study."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
import xarray as xr

from contactstudy import ContactStudyError, InvalidInputError, open_study
from contactstudy.analysis import in_plane, measure
from contactstudy.arrays.variables import specification
from contactstudy.explorer import explore, server
from contactstudy.explorer.cases import (
    PIXELS,
    PLANES,
    REGIONS,
    SUBJECTS,
    CaseFields,
    Cases,
    axial_line,
    choose_scale,
    open_cases,
    plane_image,
    region_limits,
    to_pixels,
    top_image,
)
from contactstudy.study import run_study
from tests.explorer.conftest import needs_panel
from tests.small_study import small_study
from tests.stand_in_solver import solve_fake

if TYPE_CHECKING:
    from contactstudy.explorer.page import Page

pytestmark = needs_panel

SOURCES: dict[str, Callable[[Path], Cases]] = {
    "files": open_cases,
    "opened": lambda folder: open_cases(open_study(folder)),
    "original cells": lambda folder: open_cases(open_study(folder, cells="original")),
}


def make_page(cases: Cases) -> Page:
    """Page of cases; the import of panel takes seconds and is limited to tests of pages."""
    from contactstudy.explorer.page import Page

    return Page(cases)


@pytest.fixture
def page(request: pytest.FixtureRequest, folder: Path) -> Page:
    """Page of a study's files, or of the source in the parameter of the test."""
    return make_page(SOURCES[getattr(request, "param", "files")](folder))


any_source = pytest.mark.parametrize("page", SOURCES, indirect=True)
"""Parameter of tests that read fields and status of a case."""


def compute_max_drawn_pressures(page: Page) -> tuple[float, float]:
    """Largest pressure drawn along the axis, and on the top."""
    axial_data = page.axial._lines[0].data["p"]
    (picture,) = page.surface_figures[0]._source.data["image"]
    return float(np.nanmax(axial_data)), float(picture.max())


def test_page_has_choices_of_swept_parameters(page: Page) -> None:
    assert list(page.choices[0]) == ["max_pressure", "friction", "profile"]
    assert list(page.choices[0]["max_pressure"].options) == ["1 GPa", "1.25 GPa", "1.5 GPa"]
    assert list(page.choices[0]["profile"].options) == ["cylinder", "rounded"]
    assert "friction" in page.parameter.options.values()


@any_source
def test_figures_follow_chosen_case(page: Page) -> None:
    initial_maxima = compute_max_drawn_pressures(page)
    assert ">1 GPa<" in page.table.object
    page.choices[0]["max_pressure"].value = 2
    assert ">1.5 GPa<" in page.table.object
    assert compute_max_drawn_pressures(page)[0] == pytest.approx(1.5 * initial_maxima[0], rel=0.05)
    assert page.study._case_marks.data["x"] == [1.5]
    page.units.value = True
    assert compute_max_drawn_pressures(page)[0] == pytest.approx(initial_maxima[0] / 1000, rel=0.05)


def test_two_cases_share_colours(page: Page) -> None:
    assert not page.panes[2].visible
    assert not page.axial._legend.visible
    page.compare.value = True
    page.choices[1]["max_pressure"].value = 2
    assert page.panes[2].visible
    assert page.axial._legend.visible
    assert page.surface_figures[0]._mapper.high == page.surface_figures[1]._mapper.high > 1500
    assert page.table.object.count("edge factor of the contact towards end I (largest within a, over its middle)") == 1
    assert ">1 GPa<" in page.table.object
    assert ">1.5 GPa<" in page.table.object


def test_two_cases_share_axes(page: Page) -> None:
    page.compare.value = True
    page.choices[1]["max_pressure"].value = 2
    for figures in (page.surface_figures, page.plane_figures):
        axis_spans = [(axes_figure.figure.y_range.start, axes_figure.figure.y_range.end) for axes_figure in figures]
        image_corners = [
            (axes_figure._source.data["y"][0], axes_figure._source.data["h"][0]) for axes_figure in figures
        ]
        assert axis_spans[0] == axis_spans[1]
        assert image_corners[0] != image_corners[1]
        assert (axis_spans[0][0] > axis_spans[0][1]) is (figures is page.plane_figures), "depths increase downwards"
        for y, height in image_corners:
            assert min(axis_spans[0]) <= y
            assert y + height <= max(axis_spans[0])


def test_page_contains_number_of_cases(page: Page, case_result: xr.Dataset) -> None:
    assert ">12 cases<" in page.view()[0].object
    assert ">1 case<" in make_page(open_cases(case_result)).view()[0].object
    status = page.cases.scalars["status"].astype(object)
    status[0, 0, 0] = "excluded"
    scalars = page.cases.scalars.assign(status=status.astype(str))
    reduced_page = make_page(Cases(scalars, page.cases.load, page.cases.title))
    assert ">11 cases<" in reduced_page.view()[0].object


@any_source
def test_failed_case_has_message_and_no_figures(page: Page) -> None:
    page.choices[0]["friction"].value = 1
    assert ">failed<" in page.table.object
    assert "This case failed. WindowError: this friction fails in tests" in page.table.object
    assert page.surface_figures[0]._source.data["image"] == []
    assert np.isnan(page.study._case_marks.data["v"]).all()
    assert not any(pane.visible for pane in page.panes)  # the page has no empty axes
    assert "No case at these values" in page.table.object
    page.compare.value = True
    assert page.panes[2].visible
    assert not page.panes[1].visible
    assert "<b>case:</b> This case failed" in page.table.object
    page.compare.value = False
    page.choices[0]["friction"].value = 0
    assert len(page.surface_figures[0]._source.data["image"]) == 1
    assert "class=why" not in page.table.object
    assert [pane.visible for pane in page.panes] == [True, True, False, True, False, True]


def test_study_without_surfaces_has_numbers_only(tmp_path: Path) -> None:
    run_study(small_study(level="summary"), tmp_path, workers=0, solver=solve_fake, progress=False)
    page = make_page(open_cases(tmp_path))
    assert "stores no surfaces of this case, only its numbers" in page.table.object
    assert [pane.visible for pane in page.panes] == [False, False, False, False, False, True]


def test_case_without_stresses_has_no_plane(page: Page) -> None:
    case_without_stresses = CaseFields(page.cases.load(page.index(0)).dataset.drop_vars("von_mises"))
    reduced_page = make_page(Cases(page.cases.scalars, lambda index: case_without_stresses, page.cases.title))
    assert "The stresses are not stored." in reduced_page.table.object
    assert [pane.visible for pane in reduced_page.panes] == [True, True, False, False, False, True]
    assert not reduced_page.plane.visible
    assert not reduced_page.plane_figures[0].figure.visible
    assert page.plane.visible
    reduced_page.view()
    assert [pane.visible for pane in reduced_page.panes] == [True, True, False, False, False, True]


def test_numbers_are_grouped_by_subject(page: Page) -> None:
    groups = page.number.groups
    assert list(groups) == [subject for subject in SUBJECTS if subject in groups]
    assert list(groups)[:2] == ["pressure", "stresses"]
    assert list(groups)[-1] == "solution"
    axis_labels = [name for group in groups.values() for name in group.values()]
    assert axis_labels[0] == page.number.value == "peak_pressure"
    floats = {name for name, entry in page.cases.scalars.data_vars.items() if entry.dtype.kind == "f"}
    assert {name for name in floats if not name.endswith("_error")} >= set(axis_labels)
    assert len(axis_labels) == len(set(axis_labels)) == len({text for group in groups.values() for text in group})
    listed_names = [name for subject in SUBJECTS.values() for name in subject]
    assert len(listed_names) == len(set(listed_names))
    assert all(name.endswith("_") or specification(name) for name in listed_names)


def test_figure_has_error_bars_and_open_marks(page: Page) -> None:
    from contactstudy.explorer.figures import NEUTRAL_COLOR

    scalars = page.cases.scalars
    peak = scalars["peak_pressure"]
    error = (0.1 * peak).where(scalars["max_pressure"] > 1.1e9, np.inf)
    error_page = make_page(Cases(scalars.assign(peak_pressure_error=error), page.cases.load, page.cases.title))
    data = error_page.study._line.data
    np.testing.assert_allclose(data["high"][1:], 1.1 * data["v"][1:])
    np.testing.assert_allclose(data["low"][1:], 0.9 * data["v"][1:])
    assert np.isnan([data["low"][0], data["high"][0]]).all()
    assert data["fill"].tolist() == ["white", NEUTRAL_COLOR, NEUTRAL_COLOR]
    assert error_page.study.figure.title.text == "bars: estimated errors; open marks: error not estimated"
    assert error_page.study.figure.y_range.end > data["high"][-1]
    error_page.number.value = "normal_load"  # a prescribed load is exact
    assert error_page.study._line.data["fill"].tolist() == [NEUTRAL_COLOR] * 3
    assert error_page.study.figure.title.text == ""


def test_planes_equal_analysis_cuts(folder: Path) -> None:
    case = open_cases(folder).load((0, 0, 0))
    scale = choose_scale(case, relative=False)
    limits = region_limits(case, REGIONS[0])
    image = plane_image(case, scale, limits, PLANES[0], 0.5)
    assert image is not None
    expected = in_plane(case.dataset[["von_mises"]], y=0.0, variables="von_mises")["von_mises"]
    assert float(image.values.max()) == pytest.approx(float(expected.max()) / 1e6, rel=0.02)
    assert image.position == "y = 0 mm"
    value, x, z = image.largest
    assert value == pytest.approx(float(expected.max()) / 1e6)
    column_x, row_z = (
        int(np.abs(case.points[axis] - 1e-3 * position).argmin()) for axis, position in (("x", x), ("z", z))
    )
    assert float(expected[column_x, row_z]) == float(expected.max())
    for kind in PLANES[1:]:
        image = plane_image(case, scale, limits, kind, 0.0)
        assert image is not None
        assert image.axis_labels[1].startswith("depth" if kind[0] == "x" else "position along rolling")
    assert plane_image(CaseFields(case.dataset.drop_vars("von_mises")), scale, limits, PLANES[0], 0.5) is None


@any_source
def test_plane_has_selected_stress_measure(page: Page, case_result: xr.Dataset) -> None:
    from contactstudy.explorer.page import MEASURES

    titles = {}
    for text, name in MEASURES.items():
        page.measure.value = name
        assert ", largest " in page.plane_figures[0].figure.title.text
        assert page.plane_figures[0].figure.title.text.startswith(f"{text} (MPa)\ny = 0")
        titles[name] = float(page.plane_figures[0]._source.data["image"][0].max())
    assert titles["principal_stress_1"] < titles["maximum_shear"] < titles["von_mises"]
    case = CaseFields(case_result)
    xr.testing.assert_identical(case.compute_measure("principal_stress_1"), measure(case_result, "principal_stress_1"))


def test_singular_end_is_not_drawn(case_result: xr.Dataset) -> None:
    singular_result = case_result[["pressure", "hertz_half_width", "hertz_max_pressure"]].assign(
        end_pressure_first=np.inf
    )
    x = np.linspace(float(case_result.x[0]), float(case_result.x[-1]), 400)
    case = CaseFields(singular_result.interp(x=x).drop_vars("x_bounds", errors="ignore"))
    scale = choose_scale(case, relative=True)
    line = axial_line(case, scale, region_limits(case, REGIONS[0]))
    assert len(line.singular_ends) == 1
    assert np.isnan(line.pressure[np.abs(line.x - line.singular_ends[0]) < 0.05]).all()
    assert top_image(case, scale, region_limits(case, REGIONS[1])).color_limit <= np.nanmax(line.pressure) * (1 + 1e-9)
    low, high = region_limits(case, REGIONS[2])
    assert high - low <= 8 * float(case_result["hertz_half_width"])


def test_ticks_change_with_parameter_only(page: Page) -> None:
    axis = page.study.figure.xaxis[0]
    numeric_ticker = axis.ticker
    page.choices[0]["max_pressure"].value = 1
    assert axis.ticker is numeric_ticker
    page.parameter.value = "profile"
    assert list(axis.ticker.ticks) == [0.0, 1.0]
    assert axis.major_label_overrides == {0.0: "cylinder", 1.0: "rounded"}
    page.parameter.value = "max_pressure"
    assert axis.ticker is numeric_ticker
    assert axis.major_label_overrides == {}


def test_pixel_interpolation_is_linear_inside_points() -> None:
    x, y = np.array([0.0, 1.0, 4.0]), np.array([0.0, 2.0])
    image = to_pixels(x[:, None] + y, (x, y), ((-1.0, 5.0), (0.0, 2.0)))
    assert image.shape == PIXELS[::-1]
    fractions = [(np.arange(count) + 0.5) / count for count in PIXELS]
    assert image == pytest.approx(np.clip(6 * fractions[0] - 1, 0.0, 4.0) + 2 * fractions[1][:, None])


def test_notebook_receives_updates(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import panel as pn
    from bokeh.document import Document
    from panel.io.model import add_to_doc
    from pyviz_comms import Comm

    sent_messages = []

    class RecordingComm(Comm):
        _comm = property(lambda self: True, lambda self, value: None)  # the connection is open

        def send(self, data=None, metadata=None, buffers=()):
            sent_messages.append(data)

    page = make_page(open_cases(folder))
    view, document, comm = page.view(), Document(), RecordingComm()
    root = view.get_root(document, comm)
    add_to_doc(root, document, hold=True)
    monkeypatch.setitem(pn.state._views, root.ref["id"], (view, root, document, comm))
    page.choices[0]["max_pressure"].value = 1
    assert any("ModelChanged" in str(message) for message in sent_messages)


def test_explore_accepts_folder_study_and_case(folder: Path, case_result: xr.Dataset) -> None:
    assert type(explore(folder)).__name__ == "Column"
    assert type(open_study(folder).contact.explore()).__name__ == "Column"
    assert type(case_result.contact.explore()).__name__ == "Column"
    with pytest.raises(InvalidInputError, match="study"):
        explore(3)  # type: ignore[arg-type]


def test_missing_panel_raises(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    import panel as pn

    monkeypatch.setattr(server, "find_spec", lambda name: None)
    with pytest.raises(ContactStudyError, match=r'pip install "contactstudy\[explore\]"'):
        explore(folder)
    assert sys.modules["panel"] is pn


def test_used_port_raises() -> None:
    import socket

    with socket.socket() as listener:
        listener.bind(("localhost", 0))
        listener.listen()
        port = listener.getsockname()[1]
        with pytest.raises(InvalidInputError, match=f"port = {port}"):
            server._choose_port(port)
        assert server._choose_port(None) != port


def test_unbounded_values_are_triangles() -> None:
    from contactstudy.explorer.figures import StudyFigure

    figure = StudyFigure()
    values, x = np.array([2.0, np.inf]), np.array([0.0, 1.0])
    marked_cases = [(0, 2.0, "blue"), (1, np.inf, "red")]
    figure.show(x, values, np.zeros(2), marked_cases=marked_cases, labels=("x", "v"))
    assert (figure._case_marks.data["x"], figure._case_marks.data["color"]) == ([0.0], ["blue"])
    assert (figure._case_triangles.data["x"], figure._case_triangles.data["color"]) == ([1.0], ["red"])
    figure.show(x, np.array([np.inf, np.inf]), np.zeros(2), marked_cases=marked_cases[1:], labels=("x", "v"))
    assert figure.figure.y_range.end > 1.0


def test_rounding_mark_has_remark() -> None:
    from contactstudy.explorer.page import _format_number
    from contactstudy.report.tables import Quantity

    row = Quantity("force_x", "force along the axis", 0.0, 0.0, "N", text="0 N", remark="below 1e-06", mark="rounding")
    assert _format_number(row) == "0 N (below 1e-06)"
    assert _format_number(row._replace(mark="")) == "0 N"
