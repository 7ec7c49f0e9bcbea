"""Pictures of the report and of the page to explore in `results`: ``python -m docs.gallery.screens report explore``.

They are taken by Chromium, without a screen; the packages of the extra `explore`, and playwright, are needed.
"""

from __future__ import annotations

import contextlib
import re
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from contactstudy.study import Study, run_study
from tests.browser import browser, open_served

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "results"


def of_report(folder: Path) -> None:
    """Write the report of the page's case, and keep its top as a picture."""
    text = (ROOT / "docs" / "how-to" / "report.md").read_text()
    (block, *_) = re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    with contextlib.chdir(folder):
        exec(compile(block, "report.md", "exec"), {})
    with browser(1000, 1180) as page:
        page.goto(f"file://{folder}/roller.html")
        page.screenshot(path=RESULTS / "report.png")


def of_explore(folder: Path) -> None:
    """Solve the study of the page, serve it, and keep the page with two cases as a picture."""
    text = (ROOT / "docs" / "how-to" / "explore.md").read_text()
    (block,) = re.findall(r"^```toml\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    run_study(Study.from_mapping(tomllib.loads(block)), folder / "crowns", workers=0)
    command = [sys.executable, "-m", "contactstudy.cli", "explore", str(folder / "crowns"), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout is not None
            address = server.stdout.readline().split()[0]
            with browser(1400, 900) as page:
                open_served(page, address)
                page.locator("input[type=checkbox]").first.check()
                page.wait_for_selector("th:has-text('second case')")
                page.locator("select").nth(1).select_option(index=1)  # profile of the second case
                page.wait_for_timeout(2000)
                page.screenshot(path=RESULTS / "explore.png", full_page=True)
        finally:
            server.terminate()


if __name__ == "__main__":
    for picture in sys.argv[1:]:
        with tempfile.TemporaryDirectory() as folder:
            {"report": of_report, "explore": of_explore}[picture](Path(folder))
