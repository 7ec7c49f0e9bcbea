"""Paths of modules in the documentation."""

from __future__ import annotations

import re

from tests.documentation.pages import ROOT

PAGES = [*(ROOT / "docs").rglob("*.md"), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
MODULE = re.compile(r"`((?:[a-z_]+/)+[a-z_]+\.py)`")


def test_module_paths_in_documentation_exist() -> None:
    modules = {path for page in PAGES for path in MODULE.findall(page.read_text(encoding="utf-8"))}
    assert len(modules) > 20
    folders = (ROOT, ROOT / "contactstudy")
    assert [path for path in sorted(modules) if not any((folder / path).is_file() for folder in folders)] == []
