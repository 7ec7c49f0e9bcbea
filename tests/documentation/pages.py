"""Where the pages of the documentation are."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def page(name: str) -> Path:
    """The page of this name, on whatever shelf it stands."""
    (result,) = (ROOT / "docs").rglob(f"{name}.md")
    return result
