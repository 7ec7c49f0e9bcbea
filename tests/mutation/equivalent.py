"""Changes that change no number, and why."""

from __future__ import annotations

EQUIVALENT: dict[str, str] = {}
"""Reason by change."""
