"""Pictures of the report and of the page to explore: ``python docs/gallery/screens.py`` writes them beside this file.

They are taken by Chromium, without a screen; the packages of the extra `explore`, and playwright, are needed.
"""

from __future__ import annotations

import contextlib
import re
import tempfile
from pathlib import Path

from tests.browser import browser

HERE = Path(__file__).resolve().parent


def of_report(folder: Path) -> None:
    """Write the report of the page's case, and keep its top as a picture."""
    text = (HERE.parent / "how-to" / "report.md").read_text()
    (block, *_) = re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    with contextlib.chdir(folder):
        exec(compile(block, "report.md", "exec"), {})
    with browser(1000, 1180) as page:
        page.goto(f"file://{folder}/roller.html")
        page.screenshot(path=HERE / "report.png")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        of_report(Path(place))
