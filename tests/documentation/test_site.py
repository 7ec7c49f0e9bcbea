"""The documentation: its code runs, its tables are those of the code, its pictures can be drawn again."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

from tests.measured import ROWS

ROOT = Path(__file__).resolve().parents[2]


def blocks(path: Path) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", path.read_text(), re.DOTALL | re.MULTILINE)


def test_the_accuracy_table_is_what_the_command_prints() -> None:
    text = (ROOT / "docs" / "explanation" / "accuracy.md").read_text()
    printed = re.findall(r"^\| (.*?) \|", text, re.MULTILINE)
    assert printed[1 : 1 + len(ROWS)] == list(ROWS)


def test_every_picture_is_in_the_gallery_with_its_command() -> None:
    gallery = (ROOT / "docs" / "gallery" / "index.md").read_text()
    for path in (ROOT / "docs").rglob("*.png"):
        assert f"({path.name})" in gallery, path.name
    for row in re.findall(r"^\| !\[.*?\]\((?:study|verification)_\w+\.png\) \| (.*) \|$", gallery, re.MULTILINE):
        assert "`" in row or row == "the same"


def test_pages_save_the_figures_that_the_script_takes_from_them() -> None:
    script = runpy.run_path(str(ROOT / "docs" / "gallery" / "figures.py"))
    for page, names in script["PAGES"].items():
        code = "".join(blocks(ROOT / "docs" / page))
        for name in names:
            assert f'"{name}"' in code, page
            assert (ROOT / "docs" / "gallery" / f"{name}.png").exists()
            assert f"({'../' * page.count('/')}gallery/{name}.png)" in (ROOT / "docs" / page).read_text()


def test_every_marked_table_is_known() -> None:
    source = (ROOT / "docs" / "_site" / "made.py").read_text()
    for page in (ROOT / "docs").rglob("*.md"):
        for name in re.findall(r"^<!-- made: ([\w-]+) -->$", page.read_text(), re.MULTILINE):
            assert f'"{name}": ' in source, (page.name, name)


def test_equations_are_numbered_once_and_in_order() -> None:
    found = []
    for page in ("theory", "numerics", "contact", "columns"):
        text = (ROOT / "docs" / "explanation" / f"{page}.md").read_text()
        found += [int(number) for number in re.findall(r"\\tag\{(\d+)\}", text)]
    assert found == list(range(1, len(found) + 1))
