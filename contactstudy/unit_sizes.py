"""Conversion of what input says to be its unit."""

from __future__ import annotations

import math

from contactstudy.errors import InvalidInputError

KNOWN: dict[str, dict[str, float]] = {
    "m": {
        "m": 1.0,
        "mm": 1e-3,
        "um": 1e-6,
        "µm": 1e-6,
        "μm": 1e-6,
        "micrometer": 1e-6,
        "micron": 1e-6,
        "nm": 1e-9,
        "km": 1e3,
        "metre": 1.0,
        "meter": 1.0,
        "metres": 1.0,
        "meters": 1.0,
    },
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "N/mm2": 1e6, "N/mm^2": 1e6, "N mm-2": 1e6, "bar": 1e5},
    "N": {"N": 1.0, "kN": 1e3},
    "N m": {"N m": 1.0, "Nm": 1.0, "N*m": 1.0, "N.m": 1.0, "N mm": 1e-3, "Nmm": 1e-3},
    "rad": {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180, "degree": math.pi / 180, "degrees": math.pi / 180},
    "rad/m": {"rad/m": 1.0, "1/m": 1.0, "rad/mm": 1e3, "1/mm": 1e3},
    "1": {"1": 1.0, "%": 0.01, "percent": 0.01},
}
"""Units that input may have, by the one in SI, and their sizes in it."""


def factor_to(unit: str, name: str, said: object) -> float:
    """Return the factor that takes values in the unit that was said to `unit`, one of those in SI.

    Raises
    ------
    InvalidInputError
        With `name` if the unit is none that is known for it.

    Examples
    --------
    >>> factor_to("N", "load.attrs['units']", "kN")
    1000.0
    """
    known = KNOWN.get(unit, {})
    if not isinstance(said, str) or said.strip() not in known:
        allowed = f"one of {', '.join(known)}" if known else "left out"
        raise InvalidInputError(name, said, allowed, f"without it {unit} is meant" if known else "")
    return known[said.strip()]
