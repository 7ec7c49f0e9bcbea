"""The page of a case and of a study: what it holds, and that it needs nothing else."""

from __future__ import annotations

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib import pyplot

from contactstudy import InvalidInputError, report
from contactstudy.cli import main
from contactstudy.report import study_page
from contactstudy.report.study_pictures import figures_of_folder
from contactstudy.study import run_study
from contactstudy.study.folder import Entry
from tests.browser import browser, chromium
from tests.small_study import BASE, small_study
from tests.stand_in_solver import FAILS, solve_fake

VOID = {"meta", "img", "br", "link", "input"}


class Page(HTMLParser):
    """Reads a page: its text, what it fetches, its anchors; and fails on tags that do not match."""

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
        if tag not in VOID:
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


def read(path: Path) -> Page:
    text = path.read_text(encoding="utf-8")
    page = Page(text)
    assert all(address.startswith("data:image/svg+xml;base64,") for address in page.fetched)
    assert all(link[1:] in page.anchors for link in page.links), page.links - page.anchors
    assert not re.findall(r"(?:src|href)=[\"'](?:https?:)?//|@import|url\(", text)
    return page


def test_a_case_says_what_was_solved_and_how_far_to_trust_it(solved: xr.Dataset, tmp_path: Path) -> None:
    solved.to_netcdf(tmp_path / "roller.nc")
    page = read(report.write(tmp_path / "roller.nc"))
    for words in (
        *("roller", "0.52 mm apart", "E = 210 GPa", "fillet radius 0.1 mm", "1.5 GPa", "friction coefficient 0.1"),
        *("Is this number real?", "With care", "no error was asked for", "to scale in both directions", "numpy"),
        "Hetenyi",
    ):
        assert words in page.text, words
    assert len(page.fetched) >= 5


def test_a_singular_peak_is_marked_everywhere(solved: xr.Dataset) -> None:
    singular = solved.assign(
        peak_pressure=np.inf, peak_pressure_error=np.inf, end_pressure_first=np.inf, end_intensity_first=1e6
    ).assign(end_exponent_first=0.5)
    page = Page(report.html(singular, title="A <sharp> end"))
    assert "A <sharp> end" in page.text
    assert page.text.count("singular: it grows without a limit") == 4
    assert "its intensity is the result" in page.text


def test_a_dataset_without_inputs_says_so(solved: xr.Dataset) -> None:
    page = Page(report.html(solved.drop_attrs()))
    assert "does not say what was solved" in page.text


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("small")
    profiles = ["cylinder", {"kind": "cylinder", "fillet_radius": 1e-4, "name": "<b>rounded</b>"}]
    sweep = {"e_over_a": [0.0, 1.0, -9.0], "friction": [0.0, FAILS], "profile": profiles}
    run_study(small_study(sweep=sweep, description="Made up."), folder, workers=0, solver=solve_fake, progress=False)
    return folder


def test_a_study_has_its_cases_its_figures_and_its_failures(folder: Path) -> None:
    page = read(report.write(folder))
    for words in (
        *("Study small", "Made up.", "4 ok", "4 failed", "4 skipped", "WindowError: this friction fails in tests"),
        *(
            "<b>rounded</b>",
            "5 mm",
            "error not known",
            "4 cases",
            "Are these numbers real?",
            "(end distance over a: 3, coefficient of friction: 2, roller profile: 2)",
        ),
    ):
        assert words in page.text, words
    for words in ("Are these numbers real?", "end distance over a: 3, coefficient of friction: 2"):
        assert words in page.text, words
    assert {f"case-{number}" for number in range(1, 13)} <= page.anchors
    assert len(page.fetched) == 2


def settled_cases(*parts: float) -> list[study_page.Row]:
    """Rows of solved cases whose peaks are known to parts of them."""
    rows = []
    for part in parts:
        scalars = {"peak_pressure": 2e9, "peak_pressure_error": part * 2e9, "converged": 1.0}
        real, reason = study_page._certainty(Entry("ok", scalars=scalars))
        rows.append(study_page.Row("case-1", [], [], "ok", "", real, reason))
    return rows


def test_a_shared_reason_says_what_is_wrong() -> None:
    ((answer, reason, cases), (best, _, _)) = study_page._answers(settled_cases(0.1, 0.06, 0.001))
    assert (answer, len(cases), best) == ("with care", 2, "yes")
    assert reason == "the peak is known only to 10.0% in the worst case, 6.0% in the best"


def test_ends_that_are_not_pressed_have_no_column(tmp_path: Path) -> None:
    def rounded(*given, **more) -> xr.Dataset:
        return solve_fake(*given, **more).assign(end_pressure_first=0.0, end_pressure_last=0.0)

    run_study(small_study(), tmp_path, workers=0, solver=rounded, progress=False)
    assert "at end" not in Page(report.html(tmp_path)).text
    entries = [Entry("ok", scalars={"end_pressure_first": value, "end_pressure_last": 0.0}) for value in (0.0, 1e9)]
    names = [name for name in study_page.SHOWN if any(study_page._has_more(entry, name) for entry in entries)]
    assert names == ["end_pressure_first"]


def test_the_banner_follows_the_worst_answer(folder: Path, tmp_path: Path) -> None:
    assert study_page._verdict(settled_cases(0.1, 0.001)) == ("with care", "1 real with care, 1 real")
    assert study_page._verdict(settled_cases(0.001, 0.001)) == ("yes", "2 real")

    def coarse(*given, **more) -> xr.Dataset:
        return solve_fake(*given, **more).assign(peak_pressure=2e9, peak_pressure_error=2e8)

    run_study(small_study(), tmp_path, workers=0, solver=coarse, progress=False)
    page = report.html(tmp_path)
    assert 'class="verdict with-care"' in page
    assert "4 ok; numbers of these: 4 real with care" in Page(page).text


def test_inputs_have_the_units_of_engineers_everywhere(tmp_path: Path) -> None:
    profile = {"kind": "cylinder", "fillet_radius": 1e-4}
    sweep = {"tilt": [0.0, 3e-4], "profile": ["cylinder", profile | {"fillet_radius": 5e-5}]}
    study = small_study(base=BASE | {"e_over_a": 1.0}, sweep=sweep)
    run_study(study, tmp_path, workers=0, solver=solve_fake, progress=False)
    page = Page(report.html(tmp_path))
    assert "cylinder, fillet radius 50 µm" in page.text
    assert "0.3 mrad" in page.text
    figure, _ = figures_of_folder(tmp_path)["study"]
    assert any("mrad" in ax.get_xlabel() for ax in figure.axes)
    assert figure.axes[0].lines[0].get_xdata().max() == pytest.approx(0.3)
    pyplot.close(figure)
    run_study(
        small_study(base=BASE | {"profile": profile}), tmp_path / "b", workers=0, solver=solve_fake, progress=False
    )
    assert "cylinder, fillet radius 0.1 mm" in Page(report.html(tmp_path / "b")).text


def test_singular_ends_have_numbers_and_a_figure(tmp_path: Path) -> None:
    def sharp(*given, **more) -> xr.Dataset:
        law = {"end_exponent_first": 0.5, "end_intensity_first": 3.245e6, "end_intensity_first_error": 1.8e4}
        loads = {"end_load_first": 4.02, "end_load_first_error": 0.02, "end_load_last": 3.0}
        peaks = dict.fromkeys(("peak_pressure", "peak_pressure_error", "end_pressure_first"), np.inf)
        return solve_fake(*given, **more).assign(law | loads | peaks)

    run_study(small_study(), tmp_path, workers=0, solver=sharp, progress=False)
    page = Page(report.html(tmp_path))
    for words in ("K at end I", "0.10262 ± 0.00057 GPa mm^0.5", "load on the last a, end I", "4.020 ± 0.020 N"):
        assert words in page.text, words
    assert "at end I largest" not in page.text
    assert "K at end II" not in page.text  # that end is not singular
    figure, _ = figures_of_folder(tmp_path)["study"]
    labels = [ax.get_ylabel() for ax in figure.axes]
    assert "load on the last" in labels[0]
    assert not any("largest contact pressure" in label for label in labels)
    assert [line for line in figure.axes[0].lines if np.isfinite(line.get_ydata()).all()]
    pyplot.close(figure)


@pytest.mark.browser
@pytest.mark.skipif(chromium() is None, reason="Chromium is not installed")
def test_a_study_fits_a_narrow_and_a_wide_screen(folder: Path, tmp_path: Path) -> None:
    pytest.importorskip("playwright")
    path = report.write(folder, tmp_path / "study.html")
    own = {}
    for width in (420, 1400):
        with browser(width, 900) as page:
            page.goto(path.as_uri())
            assert page.evaluate("document.documentElement.scrollWidth") <= width
            widths = "[...document.querySelectorAll('figure img')].map(each => [each.width, each.naturalWidth])"
            own[width] = page.evaluate(widths)
            hints = page.locator(".hint").evaluate_all("all => all.filter(each => each.offsetParent).length")
            assert bool(hints) == (width == 420)
    assert all(shown <= 1.4 * natural + 4 for shown, natural in own[1400])
    assert all(shown < 400 or shown <= 0.5 * natural + 2 for shown, natural in own[420])


def test_the_file_of_a_studys_case_has_its_inputs(folder: Path, tmp_path: Path, capsys) -> None:
    path = next((folder / "cases").glob("*.nc"))
    assert main(["report", str(path), "--out", str(tmp_path / "case.html"), "--title", "Case"]) == 0
    assert "case.html" in capsys.readouterr().out
    page = read(tmp_path / "case.html")
    for words in ("E = 210 GPa", "two free ends", "study small", "length L 0.5 mm"):
        assert words in page.text, words


def test_wrong_paths_are_named(tmp_path: Path, capsys) -> None:
    with pytest.raises(InvalidInputError, match="no such file"):
        report.write(tmp_path / "nothing.nc")
    (tmp_path / "text.nc").write_text("no netCDF")
    assert main(["report", str(tmp_path / "text.nc")]) == 2
    assert main(["report", str(tmp_path)]) == 2
    assert "not the folder of a study" in capsys.readouterr().err
    with pytest.raises(InvalidInputError, match="given: a result in memory"):
        report.write(xr.Dataset())


WITHOUT = """
import sys
from contactstudy.report import html
assert "data:image" in html(sys.argv[1])
assert "distributed" not in sys.modules
"""


def test_a_report_imports_nothing_of_clusters(tmp_path: Path) -> None:
    run_study(small_study(), tmp_path, workers=0, solver=solve_fake, progress=False)
    subprocess.run([sys.executable, "-c", WITHOUT, str(tmp_path)], check=True)


def test_a_report_is_a_page_and_no_other_file(tmp_path: Path) -> None:
    with pytest.raises(InvalidInputError, match=r"x.pdf': must be a name that ends in .html.*prints the page to PDF"):
        report.write(xr.Dataset(), tmp_path / "x.pdf")


def test_a_studys_figures_say_what_they_leave_out_and_show_another(folder: Path, tmp_path: Path, capsys) -> None:
    page = read(report.write(folder, tmp_path / "all.html"))
    assert "Of coefficient of friction and roller profile one value is drawn" in page.text
    assert "contactstudy report FOLDER --select friction=0.66" in page.text
    chosen = ["--select", "profile=<b>rounded</b>", "--select", "friction=0"]
    assert main(["report", str(folder), "--out", str(tmp_path / "one.html"), *chosen]) == 0
    one = read(tmp_path / "one.html")
    assert "one value is drawn" not in one.text
    assert {f"case-{number}" for number in range(1, 13)} <= one.anchors
    assert main(["report", str(folder), "--select", "speed=1"]) == 2
    assert "swept parameter: e_over_a, friction, profile" in capsys.readouterr().err
    assert main(["report", str(folder), "--select", "friction"]) == 2
    assert "NAME=VALUE" in capsys.readouterr().err


def test_a_case_has_no_figures_to_choose(solved: xr.Dataset) -> None:
    with pytest.raises(InvalidInputError, match="selection"):
        report.html(solved, selection={"friction": 0.1})


def test_files_are_opened_of_the_drawn_cases_alone(folder: Path, tmp_path: Path, monkeypatch) -> None:
    from contactstudy.study import store

    opened, inner = [], store.xr.open_dataset
    monkeypatch.setattr(store.xr, "open_dataset", lambda path, **kw: opened.append(path) or inner(path, **kw))
    report.write(folder, tmp_path / "study.html")
    assert len(set(opened)) <= 3  # of four that are solved: two over e/a, and one for the units of its numbers


def test_a_case_that_rolls_shows_where_it_sticks(solved: xr.Dataset) -> None:
    pressed = (solved["pressure"] > 0).drop_attrs()
    moved = {
        "traction_x": 0.0 * pressed,
        "traction_y": 4e7 * pressed,
        "slip_x": 0.0 * pressed,
        "slip_y": 2e-3 * pressed,
    }
    part = pressed & (pressed["y"] > 0)
    rolled = solved.assign(moved | {"stick": part, "sticking_part": 0.5})
    before, page = Page(report.html(solved)), Page(report.html(rolled))
    assert len(page.fetched) == len(before.fetched) + 2
    for words in ("part of the contact that sticks", "stick within the red line", "leading edge is at the top"):
        assert words in page.text
        assert words not in before.text
    assert "slip everywhere" in Page(report.html(rolled.assign(stick=0 * part))).text
    assert "stick everywhere" in Page(report.html(rolled.assign(stick=pressed))).text
