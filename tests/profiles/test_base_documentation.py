"""The table of docs/reference/profiles.md."""

from __future__ import annotations

import dataclasses
import re

from contactstudy import profiles
from tests.documentation.pages import ROOT

TEXT = (ROOT / "docs" / "reference" / "profiles.md").read_text()


def test_table_contains_all_profiles_and_parameters() -> None:
    rows = dict(re.findall(r"^\| `(\w+)` \|(.*)$", TEXT, re.MULTILINE))
    public_objects = (getattr(profiles, name) for name in profiles.__all__)
    profile_classes = {entry.__name__: entry for entry in public_objects if dataclasses.is_dataclass(entry)}
    assert set(rows) == set(profile_classes)
    for name, row in rows.items():
        for entry in dataclasses.fields(profile_classes[name]):
            assert f"`{entry.name}`" in row, (name, entry.name)
