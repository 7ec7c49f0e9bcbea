"""docs/reference/profiles.md: its table is complete, its figures can be drawn again."""

from __future__ import annotations

import dataclasses
import re
import runpy
from pathlib import Path

import pytest

from contactstudy import profiles
from tests.documentation.pages import ROOT

TEXT = (ROOT / "docs" / "reference" / "profiles.md").read_text()


def test_every_profile_is_in_the_table_with_its_parameters() -> None:
    rows = dict(re.findall(r"^\| `(\w+)` \|(.*)$", TEXT, re.MULTILINE))
    public = (getattr(profiles, name) for name in profiles.__all__)
    made = {entry.__name__: entry for entry in public if dataclasses.is_dataclass(entry)}
    assert set(rows) == set(made)
    for name, row in rows.items():
        for entry in dataclasses.fields(made[name]):
            assert f"`{entry.name}`" in row, (name, entry.name)


@pytest.mark.system
def test_the_figures_can_be_drawn_again(tmp_path: Path) -> None:
    script = runpy.run_path(str(ROOT / "docs" / "gallery" / "figures.py"))
    for name in ("conventions", "comparison"):
        script[name].__globals__["HERE"] = tmp_path
        script[name]()
    for path in tmp_path.iterdir():
        assert (ROOT / "docs" / "gallery" / path.name).exists()
        assert f"gallery/{path.name})" in TEXT
    assert len(list(tmp_path.iterdir())) == 2
