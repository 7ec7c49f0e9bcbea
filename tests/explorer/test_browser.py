"""The page in a real browser: it fetches nothing from elsewhere, shows its figures, and follows a slider at once."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.browser import browser, chromium, open_served

pytest.importorskip("panel", reason="the extra `explore` is not installed")
pytest.importorskip("playwright", reason="playwright, which drives the browser, is not installed")

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(chromium() is None, reason="Chromium is not installed"),
]

FOLLOWS = 3.0
"""Seconds within which a slider is followed on a machine that does other things as well; alone it takes a tenth."""


@pytest.fixture(scope="module")
def address(folder: Path) -> Iterator[str]:
    port = 5400 + os.getpid() % 500
    command = [sys.executable, "-m", "contactstudy.cli", "explore", str(folder), "--no-browser", "--port", str(port)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout is not None
            said = server.stdout.readline()
            assert "until Ctrl-C" in said
            yield said.split()[0]
        finally:
            server.terminate()


def test_the_page_shows_a_study_and_follows(address: str) -> None:
    with browser(1400, 900) as page:
        page.set_default_timeout(15_000)
        errors: list[str] = []
        page.on("pageerror", lambda error: errors.append(str(error)))
        open_served(page, address)
        number = page.locator("tr:has-text('Hertz pressure p0') td.n").first
        assert number.text_content() == "1 GPa"
        before = page.screenshot()
        handle = page.locator(".noUi-handle").first
        handle.focus()
        began = time.perf_counter()
        handle.press("ArrowRight")
        while number.text_content() != "1.25 GPa":
            assert time.perf_counter() - began < FOLLOWS
        page.wait_for_timeout(300)
        assert page.screenshot() != before
        page.locator("input[type=checkbox]").first.check()
        page.wait_for_selector("th:has-text('other')")
        for width in (1400, 390):
            page.set_viewport_size({"width": width, "height": 900})
            page.wait_for_timeout(400)
            assert page.evaluate("document.documentElement.scrollWidth <= document.documentElement.clientWidth"), width
        assert page.refused == []
        assert errors == []
