"""What has to hold of every converged case with stick and slip."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from contactstudy import ContactStudyError, Rolling, Shift
from contactstudy.contact.certificate import HELD_TOLERANCES
from tests.fuzz.drawn import Drawn
from tests.fuzz.solved import TOLERANCE, Solved, ViolationError, require, run

SAME_TRACTION = 0.02
"""Largest difference of the tractions of one case, over friction and peak pressure: both meet the tolerance."""


def law_of_friction(solved: Solved) -> bool:
    """From the result alone: no traction above its bound; slip along the traction, and none where it sticks."""
    result, friction = solved.result, solved.drawn.case.friction
    q, slip = (np.stack([result[f"{name}_{axis}"].values for axis in "xy"]) for name in ("traction", "slip"))
    pressed, sticks = result["pressure"].values > 0, result["stick"].values.astype(bool)
    bound, largest = friction * result["pressure"].values, friction * solved.peak
    over = float((np.hypot(*q) - bound).max()) / largest
    require(over <= 1e-9, f"a traction {over:.3g} above its bound")
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
"""Slip over the largest, or over what saturates the contact, that counts as none."""


def _largest_move(solved: Solved) -> float:
    """Slip of the size that friction can take up."""
    case = solved.drawn.case
    size = case.friction * case.hertz_half_width / case.roller.radius
    return size * case.hertz_half_width if isinstance(case.motion, Shift) else size


def forces_of_tractions(solved: Solved) -> bool:
    """Forces and moment are those of the tractions, and what was prescribed is met."""
    result, grid, case = solved.result, solved.grid, solved.drawn.case
    area = grid.widths[:, None] * grid.dy
    q_x, q_y = (result[f"traction_{axis}"].values for axis in "xy")
    arm = grid.x[:, None] - case.roller_start - 0.5 * case.roller.length
    whole = case.friction * case.normal_load
    found = {
        "force_x": (float((area * q_x).sum()), whole),
        "force_y": (float((area * q_y).sum()), whole),
        "moment_z": (float((area * (q_y * arm - q_x * grid.y)).sum()), whole * case.roller.length),
    }
    for name, (value, scale) in found.items():
        off = abs(float(result[name]) - value) / scale
        require(off <= 1e-6, f"{name} is {off:.3g} off the tractions' own")
        asked = getattr(case.motion, name, None)
        if asked is not None:
            off = abs(float(result[name]) - asked) / scale
            require(off <= 1e-3, f"{name} is {off:.3g} off what was prescribed")
    return True


def certificate_of_friction(solved: Solved) -> bool:
    """The stated violations of the law are within the tolerance."""
    for name in ("bound_error", "slip_error", "force_error"):
        value = abs(float(solved.result[name])) if name in solved.result else 0.0
        require(value <= HELD_TOLERANCES * TOLERANCE, f"{name} = {value:.3g} in a converged result")
    return True


def work_is_lost(solved: Solved) -> bool:
    """Friction takes work, at most that of full sliding under the largest slip.

    It is found from forces and creepages. Two or three cells along rolling make it a few percent too small, and where
    all cells stick, nothing is what is left of large numbers.
    """
    result = solved.result
    along = int((result["pressure"].values > 0).any(axis=0).sum())
    work = float(result["friction_work"])
    slip = np.hypot(result["slip_x"].values, result["slip_y"].values)[result["pressure"].values > 0]
    scale = solved.drawn.case.friction * solved.drawn.case.normal_load * max(float(slip.max()), _largest_move(solved))
    least = -1e-3 if along > 3 else -0.1
    require(least * scale <= work <= 1.5 * scale, f"work of {work / scale:.3g} of the largest")
    return True


def turned_round(solved: Solved) -> bool:
    """Seen from the other end everything is mirrored."""
    extent = np.isfinite(solved.drawn.case.body.extent)
    if extent[0] != extent[1]:
        return False
    other = _again(solved.cells.turned())
    if other is None:
        return False
    for axis, sign in (("x", -1), ("y", 1)):
        own = solved.result[f"traction_{axis}"].values
        _alike(
            "turned round", own, sign * other[f"traction_{axis}"].values[::-1], solved.drawn.case.friction * solved.peak
        )
    return True


def other_units(solved: Solved) -> bool:
    """Lengths and moduli in other units."""
    length, modulus = (2.0 ** solved.chance.randint(-12, 12) for _ in range(2))
    other = _again(solved.cells.scaled(length, modulus))
    if other is None:
        return False
    for axis in "xy":
        own, scaled = solved.result[f"traction_{axis}"].values, other[f"traction_{axis}"].values / modulus
        _alike(f"lengths x {length:g}, moduli x {modulus:g}", own, scaled, solved.drawn.case.friction * solved.peak)
    return True


def _alike(what: str, first: np.ndarray, second: np.ndarray, scale: float) -> None:
    """Require two tractions to agree, but for few cells that stick in one of them."""
    require(first.shape == second.shape, f"{what}: shapes {first.shape} and {second.shape}")
    apart = np.abs(first - second) / scale
    require(float(apart.mean()) <= 0.1 * SAME_TRACTION, f"{what}: tractions differ by {apart.mean():.3g} on average")
    few = max(2, apart.size // 100)
    most = float(np.sort(apart.ravel())[-few - 1])
    require(most <= SAME_TRACTION, f"{what}: tractions differ by {most:.3g}")


def _again(drawn: Drawn) -> xr.Dataset | None:
    """Result of a variant; None if it did not converge, and said so."""
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
)
"""Cheap ones."""

IN_TURN: tuple[Callable[[Solved], bool], ...] = (turned_round, other_units)
"""Those that solve again."""
