"""Tables, figures and equation numbers of the documentation."""

from __future__ import annotations

import json
import re
import runpy
from pathlib import Path

from tests.measured import ROWS

ROOT = Path(__file__).resolve().parents[2]


def test_accuracy_table_has_rows_of_command() -> None:
    text = (ROOT / "docs" / "explanation" / "accuracy.md").read_text()
    first_column = re.findall(r"^\| (.*?) \|", text, re.MULTILINE)
    assert first_column[1 : 1 + len(ROWS)] == list(ROWS)


def test_gallery_contains_every_picture_and_its_code() -> None:
    gallery = (ROOT / "docs" / "gallery" / "index.md").read_text()
    entry = re.compile(r'<div markdown="1" id="(\w+)">\n\n!\[[^]]*\]\((\w+)\.png\)\n\n(.*?)\n\n</div>', re.DOTALL)
    entries = entry.findall(gallery)
    assert sorted(name for name, _, _ in entries) == sorted(path.stem for path in (ROOT / "docs").rglob("*.png"))
    for name, picture, text in entries:
        assert name == picture
        for script in re.findall(r"\]\((\S+\.py)\)", text):
            assert (ROOT / "docs" / "gallery" / script).exists(), script
        assert ".py)" in text or "`" in text or f"(../tutorial/{name}.md)" in text, name


def test_pages_show_pictures_with_links_to_their_scripts() -> None:
    for page in (ROOT / "docs" / "how-to").glob("*.md"):
        for name, target in re.findall(r"\[!\[.*?\]\(\.\./gallery/(\w+)\.png\)\]\((.*?)\)", page.read_text()):
            assert target == f"../gallery/index.md#{name}"
            assert (ROOT / "docs" / "gallery" / f"{name}.py").exists()


def test_stored_digests_of_figures_equal_digests_of_code() -> None:
    gallery = ROOT / "docs" / "gallery"
    digests = runpy.run_path(str(gallery / "figures.py"))["compute_hashes"]()
    stored_digests = json.loads((gallery / "figures.json").read_text())
    outdated_figures = sorted(name for name, value in digests.items() if stored_digests.get(name) != value)
    assert not outdated_figures, f"python docs/gallery/figures.py {' '.join(outdated_figures)}"
    assert digests.keys() == {path.stem for path in gallery.glob("*.png")}


def test_every_table_mark_has_a_generator() -> None:
    source = (ROOT / "docs" / "_site" / "generated_tables.py").read_text()
    for page in (ROOT / "docs").rglob("*.md"):
        for name in re.findall(r"^<!-- made: ([\w-]+) -->$", page.read_text(), re.MULTILINE):
            assert f'"{name}": ' in source, (page.name, name)


def test_equations_are_numbered_once_and_in_order() -> None:
    numbers = []
    for page in ("theory", "numerics", "contact", "columns"):
        text = (ROOT / "docs" / "explanation" / f"{page}.md").read_text()
        numbers += [int(number) for number in re.findall(r"\\tag\{(\d+)\}", text)]
    assert numbers == list(range(1, len(numbers) + 1))
