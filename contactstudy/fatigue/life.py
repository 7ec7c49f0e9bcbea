"""Relative life: the ratio of two lives with the same probability to survive, from their risks.

Lundberg and Palmgren's theory and Ioannides and Harris' (see risk.py) both say ``ln(1/S) = const N**e risk`` for the
probability S to survive N passages; the constant belongs to material and lubrication and cancels in the ratio.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.required import require
from contactstudy.arrays.variables import UNBOUNDED, named
from contactstudy.errors import InvalidInputError


@dataclass(frozen=True, kw_only=True)
class LifeExponents:
    """Exponents of the life theories; the defaults are Lundberg and Palmgren's for roller bearings.

    A line contact's risk per length goes with ``p0**(c - h + 1)``, and its load with ``p0**2``: life falls with the
    load to the power ``(c - h + 1) / (2 e)``, which is 4 for rollers.

    Parameters
    ----------
    stress : float
        ``c``, of the stress.
    depth : float
        ``h``, of the depth.
    weibull : float
        ``e``, slope of the Weibull distribution of lives: 9/8 for line contact, 10/9 for point contact.

    Raises
    ------
    InvalidInputError
        If an exponent is not positive.

    Examples
    --------
    >>> exponents = LifeExponents()
    >>> round((exponents.stress - exponents.depth + 1) / (2 * exponents.weibull), 9)
    4.0
    """

    stress: float = 31 / 3
    depth: float = 7 / 3
    weibull: float = 9 / 8

    def __post_init__(self) -> None:
        """Check the exponents."""
        for name in ("stress", "depth", "weibull"):
            object.__setattr__(self, name, checks.positive(name, getattr(self, name)))

    def units(self, lengths: int) -> str:
        """Return the unit of the integral of ``stress**c / depth**h`` over 1 or 2 lengths.

        Examples
        --------
        >>> LifeExponents(stress=10, depth=2, weibull=1).units(2)
        'Pa**10 m**0'
        """
        return f"Pa**{self.stress:.6g} m**{lengths - self.depth:.6g}"


def relative_life(risk: xr.Dataset, reference: xr.Dataset, exponents: LifeExponents | None = None) -> xr.DataArray:
    """Life of one contact over that of another, for the same probability to survive.

    Parameters
    ----------
    risk, reference : Dataset
        Results of :func:`lundberg_palmgren`, or both of :func:`ioannides_harris` with the same limit; for example the
        body with free ends and the half-space.
    exponents : LifeExponents, optional
        Those that both were computed with.

    Returns
    -------
    DataArray
        ``(reference risk / risk)**(1/e)``; infinite without any risk, NaN if neither has a risk. Its coordinate
        `relative_life_error` follows from the errors of both risks; a `comment` says where these are not given.

    Raises
    ------
    InvalidInputError
        If one has no risk, or the two were computed with different exponents, theories or limits.

    Examples
    --------
    >>> one, twice = (xr.Dataset({"risk": xr.DataArray(value, attrs={"units": "1"})}) for value in (1.0, 2.0))
    >>> round(float(relative_life(twice, one)), 6) == round(0.5 ** (8 / 9), 6)
    True
    """
    chosen = LifeExponents() if exponents is None else exponents
    checks.instance("exponents", chosen, LifeExponents, "a LifeExponents")
    for name, dataset in (("risk", risk), ("reference", reference)):
        require(dataset, "risk", argument=name)
    units = [dataset["risk"].attrs.get("units") for dataset in (risk, reference)]
    if units[0] != units[1]:
        raise InvalidInputError("reference", units[1], f"computed with the same exponents, {units[0]}")
    for name in ("theory", "fatigue_limit"):
        own_said, other_said = (dataset["risk"].attrs.get(name) for dataset in (risk, reference))
        if own_said is not None is not other_said and own_said != other_said:
            raise InvalidInputError("reference", f"{name} = {other_said}", f"computed as risk was, {name} = {own_said}")
    own, other = risk["risk"], reference["risk"]
    # Without any risk the life is infinite, unless the reference has none either.
    ratio = (other / own.where(own > 0)).where((own != 0) | (other == 0), np.inf)
    life = named("relative_life", ratio ** (1 / chosen.weibull))
    if not all("risk_error" in dataset for dataset in (risk, reference)):
        return life.assign_attrs(comment=UNBOUNDED)
    part, reference_part = (each["risk_error"] / each["risk"].where(each["risk"] > 0) for each in (risk, reference))
    # The longest life that the errors allow: no bound if there may be no risk at all.
    most = ((1 + reference_part) / (1 - part).clip(0.0)) ** (1 / chosen.weibull)
    error = (life * (most - 1)).reset_coords(drop=True)
    return life.assign_coords(relative_life_error=named("relative_life_error", error))
