"""Hertz' line contact: the scale of lengths and pressures in the package.

Source: K. L. Johnson, Contact Mechanics (1985), chapter 4.
"""

from __future__ import annotations

import numpy as np


def line_half_width(max_pressure: float, radius: float, modulus: float) -> float:
    """Half-width ``a = 2 p0 R / E*`` of the line contact with peak pressure `max_pressure`, metres."""
    return 2 * max_pressure * radius / modulus


def line_max_pressure(load_per_length: float, radius: float, modulus: float) -> float:
    """Peak pressure ``p0 = sqrt(q E* / (pi R))`` of the line contact under `load_per_length` (N/m), Pa."""
    return float(np.sqrt(load_per_length * modulus / (np.pi * radius)))


def line_load(max_pressure: float, radius: float, modulus: float) -> float:
    """Load per length ``q = pi p0**2 R / E*`` of the line contact, N/m."""
    return float(np.pi * max_pressure**2 * radius / modulus)
