"""Pages of a case and of a study: content, links, self-containment."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib import pyplot

from contactstudy import Case, InvalidInputError, open_study, report
from contactstudy.cli import main
from contactstudy.report import figures
from contactstudy.report import page as pages
from contactstudy.report.page import figures_of_folder
from contactstudy.study import load_case, run_study
from tests.browser import browser, find_chromium
from tests.small_study import BASE, small_study
from tests.stand_in_solver import FAILS, solve_fake

VOID_TAGS = {"meta", "img", "br", "link", "input"}


class Page(HTMLParser):
    """Parser of a page: text, fetched addresses, anchors; an unmatched tag raises an error."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.fetched: list[str] = []
        self.anchors: set[str] = set()
        self.links: set[str] = set()
        self.words: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        assert tag not in ("script", "link", "iframe")
        if "id" in values:
            assert values["id"] not in self.anchors, values["id"]
            self.anchors.add(values["id"])
        if tag == "a":
            self.links.add(values["href"])
        if "src" in values:
            self.fetched.append(values["src"])
        if tag not in VOID_TAGS:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


def read_page(path: Path) -> Page:
    text = path.read_text(encoding="utf-8")
    page = Page(text)
    assert all(address.startswith("data:image/svg+xml;base64,") for address in page.fetched)
    assert all(link[1:] in page.anchors for link in page.links), page.links - page.anchors
    assert not re.findall(r"(?:src|href)=[\"'](?:https?:)?//|@import|url\(", text)
    return page


@pytest.fixture
def skip_encoding(monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace the encoding of drawn figures by an empty address."""
    for module in (figures, pages):
        monkeypatch.setattr(module, "encode_figure", lambda figure: "data:image/svg+xml;base64,")


def test_page_of_case_contains_inputs_and_assessment(case_result: xr.Dataset, tmp_path: Path) -> None:
    case_result.to_netcdf(tmp_path / "roller.nc")
    page = read_page(report.write(tmp_path / "roller.nc"))
    for text in (
        *("roller", "0.52 mm apart", "E = 210 GPa", "fillet radius 0.1 mm", "1.5 GPa", "friction coefficient 0.1"),
        *("Is this number real?", "With care", "was not estimated", "to scale in both directions", "numpy"),
        *("Hetenyi", "Dot: largest in the body"),
        *(f"{axis} of the largest von Mises stress" for axis in ("position x", "position y", "depth")),
    ):
        assert text in page.text, text
    assert re.search(r"(at mid-length|from end I+ of the contact), error not estimated", page.text)
    assert len(page.fetched) == 7


@pytest.mark.usefixtures("skip_encoding")
def test_page_of_singular_peak_has_marks(case_result: xr.Dataset) -> None:
    singular = case_result.assign(
        peak_pressure=np.inf, peak_pressure_error=np.inf, end_pressure_first=np.inf, end_intensity_first=1e6
    ).assign(end_exponent_first=0.5)
    page = Page(report.html(singular, title="A <sharp> end"))
    assert "A <sharp> end" in page.text
    assert page.text.count("singular: unbounded towards a sharp end") == 4
    assert "its intensity replaces the peak" in page.text


@pytest.mark.usefixtures("skip_encoding")
def test_page_of_singular_corner_has_position(case_result: xr.Dataset) -> None:
    corner_result = case_result.assign(
        peak_pressure=np.inf, peak_pressure_error=np.inf, corner_x=5e-3, corner_distance=54e-6
    )
    page = Page(report.html(corner_result))
    assert page.text.count("singular: unbounded towards the corner at x = 5 mm") == 3
    assert "distance d0 in the law of the pressure at the corner" in page.text


@pytest.mark.usefixtures("skip_encoding")
def test_page_without_inputs_has_remark(case_result: xr.Dataset) -> None:
    page = Page(report.html(case_result.drop_attrs()))
    assert "contains no inputs" in page.text


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("small")
    profiles = ["cylinder", {"kind": "cylinder", "fillet_radius": 1e-4, "name": "<b>rounded</b>"}]
    sweep = {"e_over_a": [0.0, 1.0, -9.0], "friction": [0.0, FAILS], "profile": profiles}
    run_study(small_study(sweep=sweep, description="Made up."), folder, workers=0, solver=solve_fake, progress=False)
    return folder


@pytest.fixture(scope="module")
def page(folder: Path) -> Page:
    return read_page(report.write(folder))


def test_page_of_study_contains_all_cases(page: Page) -> None:
    for text in (
        *("Study small", "Made up.", "4 ok", "4 failed", "4 skipped", "WindowError: this friction fails in tests"),
        *("<b>rounded</b>", "5 mm", "error not estimated", "4 cases", "Are these numbers real?"),
        "(end distance over a: 3, coefficient of friction: 2, roller profile: 2)",
    ):
        assert text in page.text, text
    assert {f"case-{index}" for index in range(1, 13)} <= page.anchors
    assert len(page.fetched) == 2


@pytest.mark.usefixtures("skip_encoding")
def test_study_table_contains_corners(tmp_path: Path) -> None:
    corner_values = {"corner_x": 0.1e-3, "corner_slope": 0.02, "corner_intensity": 7.3e8, "corner_distance": 54e-6}

    def solve_corner(case: Case, *arguments, **keywords) -> xr.Dataset:
        values = corner_values | {"corner_distance_error": 1.3e-6}
        return solve_fake(case, *arguments, **keywords).assign(values if case.friction else {})

    run_study(small_study(), tmp_path, workers=0, solver=solve_corner, progress=False)
    text = read_page(report.write(tmp_path)).text
    for heading in (pages.HEADINGS[name] for name in corner_values):
        assert heading in text
    assert text.count("0.1 mm 0.02 0.73 GPa 54.0 ± 1.3 µm") == 2


def make_converged_rows(*errors: float) -> list[pages.Row]:
    """Rows of solved cases with relative errors of the peak."""
    scalars = [{"peak_pressure": 2e9, "peak_pressure_error": error * 2e9, "converged": 1.0} for error in errors]
    return [pages._create_row("case-1", "ok", "", xr.Dataset(case_scalars), []) for case_scalars in scalars]


def test_assessment_reason_contains_worst_and_best_case() -> None:
    ((rating, reason, cases), (best_group, _, _)) = pages._count_answers(make_converged_rows(0.1, 0.06, 0.001))
    assert (rating, len(cases), best_group) == ("with care", 2, "yes")
    assert reason == "the error of the peak pressure is 10.0% in the worst case, 6.0% in the best"


@pytest.mark.usefixtures("skip_encoding")
def test_open_ends_coarse_cells_and_malformed_runs(tmp_path: Path) -> None:
    assert pages._summarise_answers(make_converged_rows(0.1, 0.001)) == ("with care", "1 real with care, 1 real")
    assert pages._summarise_answers(make_converged_rows(0.001, 0.001)) == ("yes", "2 real")
    runs = list(MALFORMED_ATTRIBUTES)

    def solve_coarsely(*arguments, **keywords) -> xr.Dataset:
        values = {"end_pressure_first": 0.0, "end_pressure_last": 0.0, "peak_pressure": 2e9, "peak_pressure_error": 2e8}
        return solve_fake(*arguments, **keywords).assign(values).assign_attrs(contactstudy_run=json.dumps(runs.pop()))

    base = BASE | {"profile": {"kind": "cylinder", "fillet_radius": 1e-4}}
    run_study(small_study(base=base), tmp_path, workers=0, solver=solve_coarsely, progress=False)
    text = report.html(tmp_path)
    assert 'class="verdict with-care"' in text
    page = Page(text)
    assert "4 ok; numbers of these: 4 real with care" in page.text
    assert "cylinder, fillet radius 0.1 mm" in page.text
    assert "at end" not in page.text
    scalars = [{"end_pressure_first": value, "end_pressure_last": 0.0} for value in (0.0, 1e9)]
    rows = [pages._create_row("case-1", "ok", "", xr.Dataset(numbers), []) for numbers in scalars]
    names = [name for name in pages.HEADINGS if pages._has_number(rows, name)]
    assert names == ["end_pressure_first"]


@pytest.mark.usefixtures("skip_encoding")
def test_study_page_has_engineering_units(tmp_path: Path) -> None:
    profile = {"kind": "cylinder", "fillet_radius": 5e-5}
    study = small_study(base=BASE | {"e_over_a": 1.0}, sweep={"tilt": [0.0, 3e-4], "profile": ["cylinder", profile]})
    run_study(study, tmp_path, workers=0, solver=solve_fake, progress=False)
    page = Page(report.html(tmp_path))
    assert "cylinder, fillet radius 50 µm" in page.text
    assert "0.3 mrad" in page.text
    figure, _ = figures_of_folder(tmp_path)["study"]
    assert any("mrad" in ax.get_xlabel() for ax in figure.axes)
    assert figure.axes[0].lines[0].get_xdata().max() == pytest.approx(0.3)
    pyplot.close("all")


@pytest.mark.usefixtures("skip_encoding")
def test_study_page_contains_laws_of_singular_ends(tmp_path: Path) -> None:
    def solve_sharp(case: Case, *arguments, **keywords) -> xr.Dataset:
        units = {"units": "Pa m^0.5" if case.friction == 0 else "Pa m^0.34"}
        intensity, error = (xr.DataArray(value, attrs=units) for value in (3.245e6, 1.8e4))
        law = {"end_intensity": intensity, "end_intensity_first": intensity, "end_intensity_first_error": error}
        exponents = dict.fromkeys(("end_exponent", "end_exponent_first"), 0.5 if case.friction == 0 else 0.34)
        loads = {"end_load_first": 4.02, "end_load_first_error": 0.02, "end_load_last": 3.0}
        peaks = dict.fromkeys(("peak_pressure", "peak_pressure_error", "end_pressure_first"), np.inf)
        return solve_fake(case, *arguments, **keywords).assign(law | exponents | loads | peaks)

    run_study(small_study(), tmp_path, workers=0, solver=solve_sharp, progress=False)
    page = Page(report.html(tmp_path))
    for text in ("K at end I", "0.10262 ± 0.00057 GPa mm^0.5", "GPa mm^0.34", "load on the last a, end I"):
        assert text in page.text, text
    assert "4.020 ± 0.020 N" in page.text
    assert "units" not in open_study(tmp_path)["end_intensity"].attrs  # the exponents differ between cases
    assert "at end I largest" not in page.text
    assert "K at end II" not in page.text  # end II is not singular
    figure, _ = figures_of_folder(tmp_path)["study"]
    labels = [ax.get_ylabel() for ax in figure.axes]
    assert "load on the last" in labels[0]
    assert not any("largest contact pressure" in label for label in labels)
    assert [line for line in figure.axes[0].lines if np.isfinite(line.get_ydata()).all()]
    pyplot.close("all")


@pytest.mark.browser
@pytest.mark.skipif(find_chromium() is None, reason="Chromium is not installed")
def test_figures_fit_screen_width(folder: Path, tmp_path: Path) -> None:
    pytest.importorskip("playwright")
    path = report.write(folder, tmp_path / "study.html")
    natural_widths = {}
    for width in (420, 1400):
        with browser(width, 900) as page:
            page.goto(path.as_uri())
            assert page.evaluate("document.documentElement.scrollWidth") <= width
            widths = "[...document.querySelectorAll('figure img')].map(each => [each.width, each.naturalWidth])"
            natural_widths[width] = page.evaluate(widths)
            hints = page.locator(".hint").evaluate_all("all => all.filter(each => each.offsetParent).length")
            assert bool(hints) == (width == 420)
    assert all(shown_width <= 1.4 * natural + 4 for shown_width, natural in natural_widths[1400])
    assert all(shown_width < 400 or shown_width <= 0.5 * natural + 2 for shown_width, natural in natural_widths[420])


@pytest.mark.usefixtures("skip_encoding")
def test_page_of_study_case_names_study(folder: Path, tmp_path: Path, capsys) -> None:
    path = tmp_path / "case.nc"
    load_case(folder, str(open_study(folder)["case_id"].values.ravel()[0])).to_netcdf(path)
    assert main(["report", str(path), "--out", str(tmp_path / "case.html"), "--title", "Case"]) == 0
    assert "case.html" in capsys.readouterr().out
    page = read_page(tmp_path / "case.html")
    for text in ("E = 210 GPa", "two free ends", "study small", "length L 0.5 mm"):
        assert text in page.text, text


def test_invalid_path_raises(tmp_path: Path, capsys) -> None:
    with pytest.raises(InvalidInputError, match="no such file"):
        report.write(tmp_path / "nothing.nc")
    (tmp_path / "text.nc").write_text("no netCDF")
    assert main(["report", str(tmp_path / "text.nc")]) == 2
    assert main(["report", str(tmp_path)]) == 2
    assert "not the folder of a study" in capsys.readouterr().err
    with pytest.raises(InvalidInputError, match="given: a result in memory"):
        report.write(xr.Dataset())


SCRIPT_WITHOUT_DISTRIBUTED = """
import sys
from contactstudy.report import html
assert "data:image" in html(sys.argv[1])
assert "distributed" not in sys.modules
"""


@pytest.mark.system
def test_report_imports_no_distributed(tmp_path: Path) -> None:
    run_study(small_study(), tmp_path, workers=0, solver=solve_fake, progress=False)
    subprocess.run([sys.executable, "-c", SCRIPT_WITHOUT_DISTRIBUTED, str(tmp_path)], check=True)


def test_page_suffix_is_checked(tmp_path: Path) -> None:
    with pytest.raises(InvalidInputError, match=r"x.pdf': must be a name that ends in .html.*prints the page to PDF"):
        report.write(xr.Dataset(), tmp_path / "x.pdf")


@pytest.mark.usefixtures("skip_encoding")
def test_selected_values_determine_figure(page: Page, folder: Path, tmp_path: Path, capsys) -> None:
    assert "The figure's title contains the value of coefficient of friction and roller profile" in page.text
    assert "contactstudy report FOLDER --select friction=0.66" in page.text
    selected_titles = ["--select", "profile=<b>rounded</b>", "--select", "friction=0"]
    assert main(["report", str(folder), "--out", str(tmp_path / "one.html"), *selected_titles]) == 0
    selected_page = read_page(tmp_path / "one.html")
    assert "The figure's title contains" not in selected_page.text
    assert {f"case-{index}" for index in range(1, 13)} <= selected_page.anchors
    assert main(["report", str(folder), "--select", "speed=1"]) == 2
    assert "swept parameter: e_over_a, friction, profile" in capsys.readouterr().err
    assert main(["report", str(folder), "--select", "friction"]) == 2
    assert "NAME=VALUE" in capsys.readouterr().err


def test_selection_for_single_case_raises(case_result: xr.Dataset) -> None:
    with pytest.raises(InvalidInputError, match="selection"):
        report.html(case_result, selection={"friction": 0.1})


def test_only_drawn_cases_are_loaded(folder: Path, monkeypatch) -> None:
    from contactstudy.study import folder as module

    loaded_cases, load = [], module.read_case
    monkeypatch.setattr(
        module, "read_case", lambda path, row, names: loaded_cases.append(row) or load(path, row, names)
    )
    figures_of_folder(folder)
    pyplot.close("all")
    assert len(set(loaded_cases)) == 2  # two of four solved cases over e/a


@pytest.mark.usefixtures("skip_encoding")
def test_page_of_rolling_case_contains_stick_and_slip(case_result: xr.Dataset) -> None:
    in_contact = (case_result["pressure"] > 0).drop_attrs()
    is_sticking = in_contact & (in_contact["y"] > 0)
    tractions = {"traction_x": 0.0, "traction_y": 4e7, "slip_x": 0.0, "slip_y": 2e-3}
    standing_result = case_result[["pressure"]]
    rolling_result = standing_result.assign(
        {name: value * in_contact for name, value in tractions.items()} | {"stick": is_sticking}
    )
    page_without_motion, page = (
        Page(report.html(standing_result)),
        Page(report.html(rolling_result.assign(sticking_part=0.5))),
    )
    assert len(page.fetched) == len(page_without_motion.fetched) + 2
    for text in ("part of the contact that sticks", "stick within the red line", "leading edge is at the top"):
        assert text in page.text
        assert text not in page_without_motion.text
    assert "slip everywhere" in Page(report.html(rolling_result.assign(stick=0 * is_sticking))).text
    assert "stick everywhere" in Page(report.html(rolling_result.assign(stick=in_contact))).text


MALFORMED_ATTRIBUTES = (
    {"seconds": "many"},
    {"seconds": None, "stages": {"contact": "long"}},
    {"stages": [1], "time": "yesterday"},
    {"time": 5, "warnings": 5},
)


MALFORMED_SETTINGS = ({"cells": "given"}, {"cells": "given", "tolerance": "x", "accuracy": []}, 5, 5)


@pytest.mark.parametrize(("run", "settings"), [*zip(MALFORMED_ATTRIBUTES, MALFORMED_SETTINGS, strict=True)])
def test_page_ignores_malformed_run_and_settings(
    case_result: xr.Dataset, run: dict[str, object], settings: object
) -> None:
    attributes = {"contactstudy_run": run, "contactstudy_inputs": {"settings": settings}}
    changed_attributes = {
        name: json.dumps(json.loads(case_result.attrs[name]) | entries) for name, entries in attributes.items()
    }
    page = report.html(case_result[["normal_load", "iterations"]].assign_attrs(changed_attributes))
    assert "many" not in page
    assert "numpy" in page
    assert "Numbers" in page


@pytest.mark.usefixtures("skip_encoding")
def test_page_omits_nan_numbers(case_result: xr.Dataset) -> None:
    scalars = {str(name): np.nan for name, variable in case_result.data_vars.items() if variable.ndim == 0}
    assert "not known" in report.html(case_result.assign(scalars))
    assert "not known" in report.html(case_result[["pressure"]] * np.nan)
