"""Properties of every converged case with stick and slip."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from benchmarks.fuzz.drawn import Drawn
from benchmarks.fuzz.solved import TOLERANCE, Solved, ViolationError, require, run
from contactstudy import ContactStudyError, Rolling, Shift
from contactstudy.contact.normal.contact import CONVERGED_TOLERANCES

SAME_TRACTION = 0.02
"""Largest difference of the tractions of one case, over friction and peak pressure: both meet the tolerance."""


def law_of_friction(solved: Solved) -> bool:
    """From the result alone: no traction above its bound; slip along the traction, and none where it sticks."""
    result, friction = solved.result, solved.drawn.case.friction
    q, slip = (np.stack([result[f"{name}_{axis}"].values for axis in "xy"]) for name in ("traction", "slip"))
    pressed, sticks = result["pressure"].values > 0, result["stick"].values.astype(bool)
    bound, largest = friction * result["pressure"].values, friction * solved.peak
    excess = float((np.hypot(*q) - bound).max()) / largest
    require(excess <= 1e-9, f"a traction {excess:.3g} above its bound")
    require(not q[:, ~pressed].any(), "traction without pressure")
    scale = max(float(np.hypot(*slip)[pressed].max()), np.finfo(float).tiny)
    if isinstance(solved.drawn.case.motion, Rolling) and solved.drawn.case.motion.model == "fastsim":
        return True
    moves = _largest_move(solved)
    require(
        float(np.hypot(*slip)[pressed & sticks].max(initial=0.0)) <= SLIPS * max(scale, moves),
        "a cell sticks and slips",
    )
    slides = pressed & ~sticks
    against = (q * slip).sum(axis=0)[slides] / largest
    require(float(-against.min(initial=0.0)) <= SLIPS * max(scale, moves), "slip against its traction")
    loose = np.abs(np.hypot(*q) - bound)[slides].max(initial=0.0) / largest
    require(float(loose) <= 1e-6, f"a cell slips at {loose:.3g} below its bound")
    return True


SLIPS = 1e-4
"""Largest slip of a sticking cell over the largest slip, or over the slip of full sliding."""


def _largest_move(solved: Solved) -> float:
    """Slip of the size that friction can take up."""
    case = solved.drawn.case
    size = case.friction * case.hertz_half_width / case.roller.radius
    return size * case.hertz_half_width if isinstance(case.motion, Shift) else size


def forces_of_tractions(solved: Solved) -> bool:
    """Forces and moment equal the resultants of the tractions and the prescribed values."""
    result, grid, case = solved.result, solved.grid, solved.drawn.case
    area = grid.widths[:, None] * grid.dy
    q_x, q_y = (result[f"traction_{axis}"].values for axis in "xy")
    arm = grid.x[:, None] - case.roller_start - 0.5 * case.roller.length
    full_sliding = case.friction * case.normal_load
    residuals = {
        "force_x": (float((area * q_x).sum()), full_sliding),
        "force_y": (float((area * q_y).sum()), full_sliding),
        "moment_z": (float((area * (q_y * arm - q_x * grid.y)).sum()), full_sliding * case.roller.length),
    }
    for name, (value, scale) in residuals.items():
        off = abs(float(result[name]) - value) / scale
        require(off <= 1e-6, f"{name} is {off:.3g} off the tractions' own")
        prescribed = getattr(case.motion, name, None)
        if prescribed is not None:
            off = abs(float(result[name]) - prescribed) / scale
            require(off <= 1e-3, f"{name} is {off:.3g} off what was prescribed")
    return True


def certificate_of_friction(solved: Solved) -> bool:
    """The stated violations of the law are within the tolerance."""
    for name in ("bound_error", "slip_error", "force_error"):
        value = abs(float(solved.result[name])) if name in solved.result else 0.0
        require(value <= CONVERGED_TOLERANCES * TOLERANCE, f"{name} = {value:.3g} in a converged result")
    return True


def work_is_lost(solved: Solved) -> bool:
    """Friction takes work, at most the work of full sliding under the largest slip.

    Forces and creepages determine the work. On two or three cells along rolling it is a few percent too small, and
    without slip it is a difference of large numbers.
    """
    result = solved.result
    loaded_rows = int((result["pressure"].values > 0).any(axis=0).sum())
    work = float(result["friction_work"])
    slip = np.hypot(result["slip_x"].values, result["slip_y"].values)[result["pressure"].values > 0]
    scale = solved.drawn.case.friction * solved.drawn.case.normal_load * max(float(slip.max()), _largest_move(solved))
    least = -1e-3 if loaded_rows > 3 else -0.1
    require(least * scale <= work <= 1.5 * scale, f"work of {work / scale:.3g} of the largest")
    return True


def slip_sums_to_the_work(solved: Solved) -> bool:
    """In rolling the sum of traction times slip is the frictional work."""
    case, result = solved.drawn.case, solved.result
    if not isinstance(case.motion, Rolling) or case.motion.model == "fastsim":
        return False
    density = sum(result[f"traction_{axis}"].values * result[f"slip_{axis}"].values for axis in "xy")
    summed, work = float((solved.grid.widths @ density).sum()) * solved.grid.dy, float(result["friction_work"])
    require(abs(summed - work) <= 1e-6 * work, f"slip sums to {summed:.6g}, work is {work:.6g}")
    return True


def turned_round(solved: Solved) -> bool:
    """Seen from the other end everything is mirrored."""
    extent = np.isfinite(solved.drawn.case.body.extent)
    if extent[0] != extent[1]:
        return False
    other = _solve_again(solved.cells.turned())
    if other is None:
        return False
    for axis, sign in (("x", -1), ("y", 1)):
        traction = solved.result[f"traction_{axis}"].values
        _alike(
            "turned round",
            traction,
            sign * other[f"traction_{axis}"].values[::-1],
            solved.drawn.case.friction * solved.peak,
        )
    return True


def other_units(solved: Solved) -> bool:
    """Lengths and moduli in other units."""
    length, modulus = (2.0 ** solved.chance.randint(-12, 12) for _ in range(2))
    other = _solve_again(solved.cells.scaled(length, modulus))
    if other is None:
        return False
    for axis in "xy":
        traction, scaled = solved.result[f"traction_{axis}"].values, other[f"traction_{axis}"].values / modulus
        _alike(
            f"lengths x {length:g}, moduli x {modulus:g}", traction, scaled, solved.drawn.case.friction * solved.peak
        )
    return True


def _alike(quantity: str, first: np.ndarray, second: np.ndarray, scale: float) -> None:
    """Require two tractions to agree, except in few cells that stick in one of them."""
    require(first.shape == second.shape, f"{quantity}: shapes {first.shape} and {second.shape}")
    apart = np.abs(first - second) / scale
    require(
        float(apart.mean()) <= 0.1 * SAME_TRACTION, f"{quantity}: tractions differ by {apart.mean():.3g} on average"
    )
    tolerated = max(2, apart.size // 100)
    most = float(np.sort(apart.ravel())[-tolerated - 1])
    require(most <= SAME_TRACTION, f"{quantity}: tractions differ by {most:.3g}")


def _solve_again(drawn: Drawn) -> xr.Dataset | None:
    """Result of a variant; None without convergence."""
    try:
        result = run(drawn)
    except ContactStudyError as error:
        raise ViolationError(f"a variant of a solved case was refused: {type(error).__name__}: {error}") from error
    return result if bool(result["converged"]) else None


ALWAYS: tuple[Callable[[Solved], bool], ...] = (
    law_of_friction,
    forces_of_tractions,
    certificate_of_friction,
    work_is_lost,
    slip_sums_to_the_work,
)
"""Cheap ones."""

IN_TURN: tuple[Callable[[Solved], bool], ...] = (turned_round, other_units)
"""Those that solve again."""
