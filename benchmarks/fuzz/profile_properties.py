"""Properties of profiles: the pressure depends on the drop alone, and is infinite at a corner."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.fuzz.random_cases import RandomCase
from benchmarks.fuzz.shapes import Polyline
from benchmarks.fuzz.solutions import SolvedCase, require, run
from contactstudy import ContactStudyError
from contactstudy.profiles import Chamfer, Halves, Profile, Sum

PROFILES_BEYOND_DROP = ("Measured", "Tapered")
"""Profiles with more than a drop: measured points, and a radius across the roller."""


@dataclass(frozen=True)
class DropOnly:
    """A user's class with the drop of a profile and no other method."""

    profile: Profile

    def drop(self, x: np.ndarray, length: float) -> np.ndarray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        return self.profile.drop(x, length)


def has_corners(profile: Profile) -> bool:
    """Whether a profile is a chamfer, two halves, or a sum that contains a chamfer or halves."""
    return isinstance(profile, (Chamfer, Halves)) or (isinstance(profile, Sum) and any(map(has_corners, profile.terms)))


def drop_determines_the_peak(solution: SolvedCase) -> bool:
    """A class with the drop alone has the peak pressure of the profile, infinite at a corner."""
    case_on_cells = solution.random_case
    roller = case_on_cells.case.roller
    if (
        case_on_cells.grid is not None
        or not has_corners(roller.profile)
        or any(map(repr(roller.profile).count, PROFILES_BEYOND_DROP))
    ):
        return False
    user_case = replace(case_on_cells.case, roller=replace(roller, profile=DropOnly(roller.profile)))
    peaks = [solve_peak(random_case) for random_case in (case_on_cells, replace(case_on_cells, case=user_case))]
    (peak, error), (user_peak, user_error) = peaks
    agrees = abs(peak - user_peak) <= error + user_error if np.isfinite(peak) else np.isinf(user_peak)
    require(bool(agrees), f"a peak of {user_peak:.6g} with the drop alone, {peak:.6g} of the profile")
    return True


MIN_CORNER_JUMP = 1e-5
"""Least jump of the slope that is a corner, above the package's bound for rounding."""


def find_convex_bends(profile: Profile) -> list[tuple[float, float]]:
    """Distances from mid-length, and jumps, of the convex bends of a user's profile, alone or in a sum."""
    if isinstance(profile, Sum):
        return [bend for term in profile.terms for bend in find_convex_bends(term)]
    if not isinstance(profile, Polyline):
        return []
    jumps = np.diff(np.diff(profile.drops) / np.diff(profile.positions))
    return [
        (x, jump) for x, jump in zip(profile.positions[1:-1], jumps.tolist(), strict=True) if jump > MIN_CORNER_JUMP
    ]


def pressed_corner_is_unbounded(solution: SolvedCase) -> bool:
    """The corner of refined cells is the strongest convex bend of a user's profile that is pressed on both sides."""
    case = solution.random_case.case
    bends = find_convex_bends(case.roller.profile)
    if solution.moves or not bends or "Measured" in repr(case.roller.profile):
        return False
    try:
        result = run(replace(solution.random_case, grid=None, accuracy=0.1))
    except ContactStudyError:
        return False
    edges = np.append(result["x_bounds"][:, 0], result["x_bounds"][-1, 1])
    is_loaded = np.asarray(result["pressure"].any("y"))
    slope, peak = float(result.get("corner_slope", 0.0)), float(result["peak_pressure"])
    for distance, jump in bends:
        x = case.roller_middle + distance + 1e-9 * case.roller.length * np.array([-1.0, 1.0])
        if edges[0] < x[0] and x[1] < edges[-1] and is_loaded[np.searchsorted(edges, x) - 1].all():
            corner_text = f"a corner of slope {slope:.4g} and a peak of {peak:.4g} are stated"
            require(
                np.isinf(peak) and slope > 0.999 * jump,
                f"a bend of {jump:.4g} at x = {x[0]:.6g} is pressed: {corner_text}",
            )
    return True


def solve_peak(random_case: RandomCase) -> tuple[float, float]:
    """Peak pressure and its error."""
    result = run(random_case)
    return float(result["peak_pressure"]), float(result["peak_pressure_error"])
