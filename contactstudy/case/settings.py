"""What a case is solved to, as far as it can be said without the solver: studies are planned and looked at by it."""

from __future__ import annotations

from contactstudy import checks
from contactstudy.errors import InvalidInputError

ACCURACY, TOLERANCE = 0.01, 1e-6
"""Default error over the peak to which a contact is settled, and default tolerance of its iteration."""

ACCURACIES = (1e-3, 0.1)
"""Accuracies that the refinement reaches and that mean something."""


def check_accuracy(value: object) -> float:
    """Return an accuracy that the refinement can reach, or raise."""
    accuracy = checks.positive("accuracy", value)
    least, most = ACCURACIES
    if not least <= accuracy <= most:
        raise InvalidInputError("accuracy", accuracy, f"from {least:g} to {most:g} of the peak pressure")
    return accuracy


def solver_settings(*, tolerance: float = TOLERANCE, error_estimate: bool = False, stresses: bool = True) -> None:
    """Take the keywords of :func:`contactstudy.solve` that a study's case may set, with the same defaults."""
