"""Properties of profiles: a user's class has the pressure of its formula."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.fuzz.random_cases import RandomCase
from benchmarks.fuzz.solutions import SolvedCase, require, run
from contactstudy.profiles import Chamfer, Halves, Profile, Sum

PROFILES_BEYOND_DROP = ("Measured", "Tapered")
"""Profiles with more than a drop: measured points, and a radius across the roller."""


@dataclass(frozen=True)
class DropAlone:
    """A user's class that has the drop of a formula and no other method."""

    profile: Profile

    def drop(self, x: np.ndarray, length: float) -> np.ndarray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        return self.profile.drop(x, length)


def has_corners(profile: Profile) -> bool:
    """Whether a profile is a chamfer, two halves or a sum with one of them."""
    return isinstance(profile, (Chamfer, Halves)) or (isinstance(profile, Sum) and any(map(has_corners, profile.terms)))


def drop_determines_the_peak(solution: SolvedCase) -> bool:
    """A class with the drop alone has the peak of the profile, infinite at a corner."""
    cells = solution.cells
    roller = cells.case.roller
    if (
        cells.grid is not None
        or not has_corners(roller.profile)
        or any(map(repr(roller.profile).count, PROFILES_BEYOND_DROP))
    ):
        return False
    user_case = replace(cells.case, roller=replace(roller, profile=DropAlone(roller.profile)))
    peaks = [solve_peak(random_case) for random_case in (cells, replace(cells, case=user_case))]
    (peak, error), (user_peak, user_error) = peaks
    agrees = abs(peak - user_peak) <= error + user_error if np.isfinite(peak) else np.isinf(user_peak)
    require(bool(agrees), f"a peak of {user_peak:.6g} with the drop alone, {peak:.6g} of the profile")
    return True


def solve_peak(random_case: RandomCase) -> tuple[float, float]:
    """Peak and its error."""
    result = run(random_case)
    return float(result["peak_pressure"]), float(result["peak_pressure_error"])
