"""A check: one quantity, what it should be and why, what it is, and whether that is near enough."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from contactstudy.checks import FloatArray


@dataclass(frozen=True, eq=False)
class Curve:
    """A profile behind a check, for a figure.

    Attributes
    ----------
    along, quantity : str
        Labels of the axes.
    positions, computed, expected : array
        Both profiles.
    """

    along: str
    quantity: str
    positions: FloatArray
    computed: FloatArray
    expected: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Check:
    """One quantity compared with its reference.

    Attributes
    ----------
    case, quantity : str
        What was solved, and what of it is compared, with its unit.
    source : str
        The reference: what it is and where it comes from.
    computed, expected : float
        Both values; of a field those at its worst point.
    difference : float
        What is held against the tolerance: ``computed - expected``, or that over ``expected`` where the quantity says
        so; of a field the largest, or the median.
    tolerance : float
        Largest difference that passes.
    curve : Curve, optional
        Profile for a figure.
    """

    case: str
    quantity: str
    source: str
    computed: float
    expected: float
    difference: float
    tolerance: float
    curve: Curve | None = None

    @property
    def passed(self) -> bool:
        """Whether the difference is within the tolerance; a difference that is not a number is not."""
        return bool(abs(self.difference) <= self.tolerance)


def compare(
    case: str,
    quantity: str,
    source: str,
    computed: float,
    expected: float,
    tolerance: float,
    *,
    relative: bool = False,
    curve: Curve | None = None,
) -> Check:
    """Compare two numbers.

    Examples
    --------
    >>> compare("sphere", "peak pressure", "Hertz", 0.99, 1.0, 0.02).passed
    True
    >>> compare("sphere", "peak pressure", "Hertz", float("nan"), 1.0, 0.02).passed
    False
    """
    difference = float(computed) - float(expected)
    return Check(
        case=case,
        quantity=f"{quantity}, relative" if relative else quantity,
        source=source,
        computed=float(computed),
        expected=float(expected),
        difference=difference / expected if relative else difference,
        tolerance=tolerance,
        curve=curve,
    )


def compare_fields(
    case: str,
    quantity: str,
    source: str,
    computed: ArrayLike,
    expected: ArrayLike,
    tolerance: float,
    *,
    median: bool = False,
    curve: Curve | None = None,
) -> Check:
    """Compare two arrays: their largest difference, or its median.

    Examples
    --------
    >>> check = compare_fields("strip", "stress", "closed form", [1.0, 2.5], [1.0, 2.0], 0.1)
    >>> check.computed, check.expected, check.difference, check.passed
    (2.5, 2.0, 0.5, False)
    """
    found, right = (np.ravel(a).astype(float) for a in np.broadcast_arrays(computed, expected))
    distance = np.abs(found - right)
    if np.isnan(distance).any():
        at = int(np.flatnonzero(np.isnan(distance))[0])
    elif median:
        at = int(np.argsort(distance)[distance.size // 2])
    else:
        at = int(distance.argmax())
    return Check(
        case=case,
        quantity=f"{quantity}, {'median' if median else 'largest'} difference",
        source=source,
        computed=float(found[at]),
        expected=float(right[at]),
        difference=float(distance[at]),
        tolerance=tolerance,
        curve=curve,
    )
