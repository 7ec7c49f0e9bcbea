"""The page in a browser: slider, figures, two window widths, and no requests to other hosts."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.browser import browser, find_chromium, open_served
from tests.explorer.conftest import find_free_port, needs_panel

pytest.importorskip("playwright", reason="playwright, which drives the browser, is not installed")

pytestmark = [
    needs_panel,
    pytest.mark.browser,
    pytest.mark.skipif(find_chromium() is None, reason="Chromium is not installed"),
]


@pytest.fixture(scope="module")
def address(folder: Path) -> Iterator[str]:
    command = [sys.executable, "-m", "contactstudy.cli", "explore", str(folder), "--no-browser"]
    command += ["--port", str(find_free_port())]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout is not None
            line = server.stdout.readline()
            assert "until Ctrl-C" in line
            yield line.split()[0]
        finally:
            server.terminate()


def test_page_updates_after_slider_and_makes_no_external_requests(address: str) -> None:
    with browser(1400, 900) as page:
        errors: list[str] = []
        page.on("pageerror", lambda error: errors.append(str(error)))
        open_served(page, address)
        cell = page.locator("tr:has-text('Hertz pressure p0') td.n").first
        assert cell.text_content() == "1 GPa"
        first_screenshot = page.screenshot()
        handle = page.locator(".noUi-handle").first
        handle.focus()
        handle.press("ArrowRight")
        page.locator("tr:has-text('Hertz pressure p0') td.n:has-text('1.25 GPa')").first.wait_for()
        while page.screenshot() == first_screenshot:
            page.wait_for_timeout(100)
        page.locator("input[type=checkbox]").first.check()
        page.wait_for_selector("th:has-text('second case')")
        for width in (1400, 390):
            page.set_viewport_size({"width": width, "height": 900})
            page.wait_for_timeout(400)
            assert page.evaluate("document.documentElement.scrollWidth <= document.documentElement.clientWidth"), width
        assert page.refused == []
        assert errors == []
