"""Numbers as engineers write them: GPa, mm and kN instead of SI units, and values with their errors."""

from __future__ import annotations

import math

UNITS: dict[str, tuple[tuple[float, float, str], ...]] = {
    "Pa": ((1e8, 1e9, "GPa"), (0.0, 1e6, "MPa")),
    "m": ((1e-4, 1e-3, "mm"), (0.0, 1e-6, "\N{MICRO SIGN}m")),
    "N": ((1e3, 1e3, "kN"), (0.0, 1.0, "N")),
    "N/m": ((0.0, 1e3, "N/mm"),),
    "N m": ((0.0, 1.0, "N m"),),
    "m2": ((0.0, 1e-6, "mm\N{SUPERSCRIPT TWO}"),),
    "rad": ((0.0, 1e-3, "mrad"),),
    "s": ((0.0, 1.0, "s"),),
}
"""Units of engineers by those of SI: from which size on, how much it is in SI, and its name."""

ROUNDING = 1e-6
"""Part of a size by which rounding may miss a step of units."""

NEGLIGIBLE = 1e-6
"""Part of a value below which an error is that of rounding."""

DIGITS, ERROR_DIGITS = 4, 2
"""Digits of a number whose error is not known, and of an error."""


def unit_for(size: float, units: str) -> tuple[float, str]:
    """Return how much a unit that suits a size is in SI, and its name.

    Examples
    --------
    >>> unit_for(1.5e9, "Pa"), unit_for(2e-6, "m"), unit_for(0.1, "1")
    ((1000000000.0, 'GPa'), (1e-06, 'µm'), (1.0, ''))
    """
    if units in ("", "1"):
        return 1.0, ""
    steps = UNITS.get(units, ((0.0, 1.0, units),))
    factor, name = next((step[1:] for step in steps if abs(size) * (1 + ROUNDING) >= step[0]), steps[-1][1:])
    return factor, name


def written(value: float, digits: int = DIGITS) -> str:
    """Write a number with so many digits, and without an exponent where that stays short.

    Examples
    --------
    >>> written(0.000211234), written(1531.52), written(1e-9), written(math.inf)
    ('0.0002112', '1532', '1e-09', '∞')
    """
    if not math.isfinite(value):
        return "not known" if math.isnan(value) else f"{'-' if value < 0 else ''}\N{INFINITY}"
    return f"{value:.{digits}g}" if not 1e3 <= abs(value) < 1e6 else f"{value:.{max(digits, 4)}g}"


def quantity(value: float, units: str, digits: int = DIGITS) -> str:
    """Write a number of SI units in those of engineers.

    Examples
    --------
    >>> quantity(1.5e9, "Pa"), quantity(65e-6, "m"), quantity(0.1, "1")
    ('1.5 GPa', '65 µm', '0.1')
    """
    if not math.isfinite(value):
        return written(value)
    factor, unit = unit_for(value, units)
    return f"{written(value / factor, digits)} {unit}".rstrip()


def with_error(value: float, error: float | None, units: str) -> str:
    """Write a number and its error in one unit, as many digits as the error lets count.

    Parameters
    ----------
    value : float
        The value, SI.
    error : float or None
        Its estimated error; None: there is no estimate. An infinite one: it has no bound.
    units : str
        SI.

    Examples
    --------
    >>> with_error(2.2531e9, 0.012e9, "Pa"), with_error(65e-6, None, "m"), with_error(0.0, 0.0, "Pa")
    ('2.253 ± 0.012 GPa', '65 µm', '0 MPa')
    """
    if error is None or not math.isfinite(value) or not NEGLIGIBLE * abs(value) < error < math.inf:
        return quantity(value, units)
    factor, unit = unit_for(max(abs(value), error), units)
    value, error = value / factor, error / factor
    decimals = ERROR_DIGITS - 1 - math.floor(math.log10(error))
    if abs(value) >= 1e5 or decimals > 8:
        return f"{written(value)} ± {error:.1g} {unit}".rstrip()
    shown = max(decimals, 0)
    return f"{round(value, decimals):.{shown}f} ± {round(error, decimals):.{shown}f} {unit}".rstrip()
