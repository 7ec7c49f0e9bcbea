"""Paths of the documentation's pages."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def page(name: str) -> Path:
    """Page of this name, in any folder."""
    (result,) = (ROOT / "docs").rglob(f"{name}.md")
    return result
