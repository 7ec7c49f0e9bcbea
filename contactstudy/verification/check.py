"""A check: one quantity, its reference with the source, the difference and the tolerance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from contactstudy.checks import FloatArray


@dataclass(frozen=True, eq=False)
class Curve:
    """Computed and expected curve of a check, for a figure."""

    labels: tuple[str, str]  # position and quantity
    positions: FloatArray
    computed: FloatArray
    expected: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Check:
    """One quantity compared with its reference."""

    case: str  # solved problem
    quantity: str  # compared quantity with its unit
    source: str  # source of the reference
    computed: float  # computed value; of a field, the value at the worst point
    expected: float
    difference: float  # between both, over `expected` if relative; for a field the largest or the median
    tolerance: float  # largest difference that passes
    curve: Curve | None = None  # for a figure

    @property
    def passed(self) -> bool:
        """Whether the difference is a number within the tolerance."""
        return bool(abs(self.difference) <= self.tolerance)


class Reference(NamedTuple):
    """A solved problem and the source of its expected values."""

    case: str
    source: str

    def compare(
        self,
        quantity: str,
        computed: ArrayLike,
        expected: ArrayLike,
        tolerance: float,
        *,
        relative: bool = False,
        median: bool = False,
        curve: Curve | None = None,
    ) -> Check:
        """Compare two numbers, or two fields where they differ most or by the median."""
        is_field = np.ndim(computed) > 0
        values, references = (np.ravel(a).astype(float) for a in np.broadcast_arrays(computed, expected))
        differences = np.abs(values - references)
        # argmax also finds a NaN, which exceeds every tolerance.
        is_median = median and not np.isnan(differences).any()
        index = np.argsort(differences)[differences.size // 2] if is_median else differences.argmax()
        value, reference = float(values[index]), float(references[index])
        kind = f", {'median' if median else 'largest'} difference" if is_field else ", relative" if relative else ""
        return Check(
            case=self.case,
            quantity=f"{quantity}{kind}",
            source=self.source,
            computed=value,
            expected=reference,
            difference=(value - reference) / (reference if relative else 1.0),
            tolerance=tolerance,
            curve=curve,
        )
