"""The certificate of a contact: how well a pressure meets its conditions, recomputed from the pressure alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy.checks import FloatArray

HELD_TOLERANCES = 10.0
"""Tolerances of the iteration within which a contact counts as converged. Its last step is not checked again."""

OPEN_TOLERANCES = 10.0
"""Tolerances of the displacement's variation from which on a gap counts as open, in `open_pressure_error`."""


@dataclass(frozen=True)
class Certificate:
    """Violations of the contact's conditions.

    Attributes
    ----------
    load_error : float
        Resultant of the pressure minus the prescribed load, over the load; 0 where the approach is prescribed.
    penetration_error : float
        Largest gap or overlap under pressure, or overlap elsewhere, over the variation of the displacement.
    open_pressure_error : float
        Largest pressure where the gap is open, over the peak pressure.
    load_position_error : float
        Distance of the pressure's resultant from where the load is to act, over the length of the contact; 0 where the
        shape keeps its inclination.
    """

    load_error: float
    penetration_error: float
    open_pressure_error: float
    load_position_error: float

    def holds(self, tolerance: float) -> bool:
        """Whether every violation is within some tolerances of the iteration."""
        bound = HELD_TOLERANCES * tolerance
        violations = (self.load_error, self.penetration_error, self.load_position_error, self.open_pressure_error)
        return all(abs(violation) <= bound for violation in violations)


def certify(
    pressure: FloatArray,
    opening: FloatArray,
    displacement: FloatArray,
    *,
    carried: float,
    load: float | None,
    off_position: float,
    tolerance: float,
) -> Certificate:
    """Measure the violations.

    Parameters
    ----------
    pressure, opening, displacement : array (x, y)
        Pressure, Pa; gap after deformation and the displacement in it, metres.
    carried : float
        Resultant of the pressure, N.
    load : float or None
        Prescribed load, N.
    off_position : float
        Distance of the resultant from its prescribed position, over the length of the contact.
    tolerance : float
        Tolerance of the iteration, over the variation of the displacement.
    """
    touching = pressure > 0
    variation = float(np.ptp(displacement))
    violation = max(float(np.abs(opening[touching]).max()), float(-opening.min()))
    at_open_gap = pressure[opening > OPEN_TOLERANCES * tolerance * variation]
    return Certificate(
        load_error=0.0 if load is None else carried / load - 1,
        penetration_error=violation / variation,
        open_pressure_error=float(at_open_gap.max(initial=0.0) / pressure.max()),
        load_position_error=off_position,
    )
