"""The least measure over the parameters, and how far each may move before the measure changes beyond its errors."""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.design.evaluations import SAME, Design, Evaluations
from contactstudy.errors import InvalidInputError

SCAN, SPREAD = 7, 8
"""Designs that are looked at first: along one parameter, and per further one in powers of two. Speed."""

CLOSE, SIMPLEX = 0.01, 0.15
"""Part of the range to which the optimum is sought, and the size of the first simplex. Speed and accuracy."""

EDGE = 0.02
"""Part of the range to which the end of a flat part is known. Accuracy."""

FAR = 1e3
"""Factor on the least measure that stands for an infinite one in the search. Speed."""

CUT = 20.0
"""Errors beyond which a difference from the optimum is not told apart while its end is sought. Speed."""

SHARP = (
    "a pressure or stress is infinite where an end of the contact is sharp: widen the bounds until the ends drop "
    "enough, take a profile with rounded ends, or a measure that is finite there, such as 'end_load_last'"
)
"""What to do where nothing that is looked at has a finite measure."""


def fewest(parameters: int) -> int:
    """Least number of designs of a search: those that are looked at first, and one more."""
    return (SCAN if parameters == 1 else SPREAD * 2 ** (parameters - 2)) + 1


def optimum(evaluations: Evaluations, most: int) -> Design:
    """Return the best design that at most so many evaluations find.

    Raises
    ------
    InvalidInputError
        If the measure is finite for none of those that are looked at first.
    """
    count = len(evaluations.ranges)
    first = min((evaluations(parts) for parts in _spread(count)), key=lambda design: design.value)
    if not np.isfinite(first.value):
        if evaluations.refused is not None:
            raise evaluations.refused
        bounds = {name: (each.low, each.high) for name, each in evaluations.ranges.items()}
        raise InvalidInputError("bounds", bounds, "such that the measure is finite somewhere within them", SHARP)
    ceiling = FAR * max(abs(first.value), np.finfo(np.float64).tiny)

    def least(parts: FloatArray) -> float:
        return min(evaluations(np.atleast_1d(parts)).value, ceiling)

    left = max(most - len(evaluations.known), 1)
    if count == 1:
        _along_one(least, float(first.parts[0]), left)
    else:
        _along_several(least, first, left)
    return min(evaluations.known, key=lambda design: design.value)


def _spread(count: int) -> FloatArray:
    """Designs to look at first: array (design, parameter)."""
    if count == 1:
        return np.linspace(0.0, 1.0, SCAN)[:, None]
    from scipy.stats.qmc import Sobol

    return np.asarray(Sobol(count, scramble=False).random(fewest(count) - 1))


def _along_one(least: object, start: float, most: int) -> None:
    """Search between the neighbours of the best of the scan."""
    from scipy.optimize import minimize_scalar

    step = 1 / (SCAN - 1)
    bounds = (max(start - step, 0.0), min(start + step, 1.0))
    minimize_scalar(least, bounds=bounds, method="bounded", options={"xatol": CLOSE, "maxiter": most})


def _along_several(least: object, first: Design, most: int) -> None:
    """Search from the best of the spread by a simplex, which errors of the measure and kinks do not mislead."""
    from scipy.optimize import minimize

    count = first.parts.size
    corners = np.tile(first.parts, (count + 1, 1))
    # Away from the nearer bound, so that no corner is cut off.
    corners[1:] += np.diag(np.where(first.parts > 0.5, -SIMPLEX, SIMPLEX))
    options = {"initial_simplex": corners, "xatol": CLOSE, "fatol": first.error, "maxfev": most}
    minimize(least, first.parts, method="Nelder-Mead", bounds=[(0.0, 1.0)] * count, options=options)


def flat_range(evaluations: Evaluations, best: Design, parameter: int) -> tuple[float, float]:
    """Return the part of the range within which a parameter alone changes the measure by less than the errors."""
    low, high = (_end(evaluations, best, parameter, bound) for bound in (0.0, 1.0))
    return low, high


def _end(evaluations: Evaluations, best: Design, parameter: int, bound: float) -> float:
    """End of the flat part towards one bound."""
    from scipy.optimize import brentq

    here = float(best.parts[parameter])
    if abs(here - bound) <= SAME:
        return bound

    def worse(part: float) -> float:
        """By how much a design is worse than the best, beyond what the errors may make."""
        parts = best.parts.copy()
        parts[parameter] = part
        design = evaluations(parts)
        if not np.isfinite(design.value):
            return CUT * best.error
        return float(min(design.value - best.value - design.error - best.error, CUT * best.error))

    # What is known already on this line, from the best on; the first that is worse ends it.
    inside, outside = here, None
    for part in sorted(_on_line(evaluations, best, parameter), key=lambda part: abs(part - here)):
        if (part - here) * (bound - here) <= 0:
            continue
        if worse(part) > 0:
            outside = part
            break
        inside = part
    if outside is None:
        if worse(bound) <= 0:
            return bound
        outside = bound
    if abs(outside - inside) <= EDGE:
        return inside
    return float(brentq(worse, inside, outside, xtol=EDGE, rtol=1e-3))


def _on_line(evaluations: Evaluations, best: Design, parameter: int) -> list[float]:
    """Parts of the designs that differ from the best in this parameter alone."""
    others = np.delete(np.array([design.parts for design in evaluations.known]), parameter, axis=1)
    same = (np.abs(others - np.delete(best.parts, parameter)) <= SAME).all(axis=1)
    return [float(design.parts[parameter]) for design, on in zip(evaluations.known, same, strict=True) if on]
