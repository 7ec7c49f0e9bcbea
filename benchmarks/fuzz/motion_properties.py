"""Properties of every converged case with stick and slip."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr
from scipy import ndimage

from benchmarks.fuzz.random_cases import RandomCase
from benchmarks.fuzz.solutions import TOLERANCE, SolvedCase, ViolationError, require, run
from contactstudy import ContactStudyError, Rolling, Shift
from contactstudy.contact.normal.contact import CONVERGED_TOLERANCES

SAME_TRACTION = 0.02
"""Largest difference of the tractions of one case, over friction and peak pressure: both meet the tolerance."""


def law_of_friction(solution: SolvedCase) -> bool:
    """Tractions are below their bound; slip is along the traction, and zero in sticking cells."""
    result, friction = solution.result, solution.random_case.case.friction
    q, slip = (np.stack([result[f"{name}_{axis}"].values for axis in "xy"]) for name in ("traction", "slip"))
    in_contact, sticks = result["pressure"].values > 0, result["stick"].values.astype(bool)
    bound, max_bound = friction * result["pressure"].values, friction * solution.peak
    bound_excess = float((np.hypot(*q) - bound).max()) / max_bound
    require(bound_excess <= 1e-9, f"a traction {bound_excess:.3g} above its bound")
    require(not q[:, ~in_contact].any(), "traction without pressure")
    scale = max(float(np.hypot(*slip)[in_contact].max()), np.finfo(float).tiny)
    if isinstance(solution.random_case.case.motion, Rolling) and solution.random_case.case.motion.model == "fastsim":
        return True
    moves = _largest_displacement(solution)
    require(
        float(np.hypot(*slip)[in_contact & sticks].max(initial=0.0)) <= SLIPS * max(scale, moves),
        "a cell sticks and slips",
    )
    slides = in_contact & ~sticks
    opposed_slip = (q * slip).sum(axis=0)[slides] / max_bound
    require(float(-opposed_slip.min(initial=0.0)) <= SLIPS * max(scale, moves), "slip against its traction")
    loose_cells = np.abs(np.hypot(*q) - bound)[slides].max(initial=0.0) / max_bound
    require(float(loose_cells) <= 1e-6, f"a cell slips at {loose_cells:.3g} below its bound")
    return True


SLIPS = 1e-4
"""Largest slip of a sticking cell over the largest slip, or over the slip of full sliding."""


def _largest_displacement(solution: SolvedCase) -> float:
    """Slip of the size that friction can take up."""
    case = solution.random_case.case
    size = case.friction * case.hertz_half_width / case.roller.radius
    return size * case.hertz_half_width if isinstance(case.motion, Shift) else size


def law_on_the_top(solution: SolvedCase) -> bool:
    """Between the cells' centres, tractions of rolling on the top are below friction times the pressure of the top."""
    case, grid = solution.random_case.case, solution.grid
    inner = ndimage.binary_erosion(solution.result["pressure"].values > 0, iterations=RIM_CELLS, border_value=1)
    columns, rows = (np.flatnonzero(inner.any(axis=axis)) for axis in (1, 0))
    if not isinstance(case.motion, Rolling) or not inner.any():
        return False
    if getattr(case.body, "model", "") == "mirror-factor":
        return False  # its mirrors do not end where the body does
    y = grid.y[rows[0]] + grid.dy * np.linspace(0.0, rows.size - 1, 8 * rows.size - 7)
    top = run(solution.random_case, x=grid.x[columns].tolist(), y=y.tolist(), z=[0.0])
    of_cell = np.clip(np.round((y - grid.y[0]) / grid.dy).astype(int), rows[0], rows[-1])
    bound = -case.friction * top["sigma_zz"].values[..., 0]
    traction = np.hypot(*(top[f"tau_{axis}z"].values[..., 0] for axis in "xy"))
    is_inner = inner[np.ix_(columns, of_cell)]
    excess = float((traction[is_inner] / bound[is_inner]).max())
    require(excess <= TOP_EXCESS, f"a traction of {excess:.4g} times its bound on the top")
    return True


RIM_CELLS, TOP_EXCESS = 1, 1.005
"""Cells at the rim without accurate stresses on the top, and the largest traction there over its bound."""


def forces_of_tractions(solution: SolvedCase) -> bool:
    """Forces and moment equal the resultants of the tractions and the prescribed values."""
    result, grid, case = solution.result, solution.grid, solution.random_case.case
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
        difference = abs(float(result[name]) - value) / scale
        require(difference <= 1e-6, f"{name} is {difference:.3g} off the tractions' own")
        prescribed = getattr(case.motion, name, None)
        if prescribed is not None:
            difference = abs(float(result[name]) - prescribed) / scale
            require(difference <= 1e-3, f"{name} is {difference:.3g} off what was prescribed")
    return True


def certificate_of_friction(solution: SolvedCase) -> bool:
    """The stated violations of the law are within the tolerance."""
    for name in ("bound_error", "slip_error", "force_error"):
        value = abs(float(solution.result[name])) if name in solution.result else 0.0
        require(value <= CONVERGED_TOLERANCES * TOLERANCE, f"{name} = {value:.3g} in a converged result")
    return True


def work_is_lost(solution: SolvedCase) -> bool:
    """Friction takes work, at most the work of full sliding under the largest slip.

    Forces and creepages determine the work. On two or three cells along rolling it is a few percent too small, and
    without slip the work is a difference of large numbers.
    """
    result = solution.result
    loaded_rows = int((result["pressure"].values > 0).any(axis=0).sum())
    work = float(result["friction_work"])
    slip = np.hypot(result["slip_x"].values, result["slip_y"].values)[result["pressure"].values > 0]
    scale = (
        solution.random_case.case.friction
        * solution.random_case.case.normal_load
        * max(float(slip.max()), _largest_displacement(solution))
    )
    lower_bound = -1e-3 if loaded_rows > 3 else -0.1
    require(lower_bound * scale <= work <= 1.5 * scale, f"work of {work / scale:.3g} of the largest")
    return True


def slip_sums_to_the_work(solution: SolvedCase) -> bool:
    """In rolling the sum of traction times slip is the frictional work."""
    case, result = solution.random_case.case, solution.result
    if not isinstance(case.motion, Rolling) or case.motion.model == "fastsim":
        return False
    density = sum(result[f"traction_{axis}"].values * result[f"slip_{axis}"].values for axis in "xy")
    summed, work = float((solution.grid.widths @ density).sum()) * solution.grid.dy, float(result["friction_work"])
    require(abs(summed - work) <= 1e-6 * work, f"slip sums to {summed:.6g}, work is {work:.6g}")
    return True


def turned_round(solution: SolvedCase) -> bool:
    """Seen from the other end everything is mirrored."""
    extent = np.isfinite(solution.random_case.case.body.extent)
    if extent[0] != extent[1]:
        return False
    mirrored_solution = _solve_again(solution.cells.from_other_end())
    if mirrored_solution is None:
        return False
    for axis, sign in (("x", -1), ("y", 1)):
        traction = solution.result[f"traction_{axis}"].values
        _require_equal(
            "turned round",
            traction,
            sign * mirrored_solution[f"traction_{axis}"].values[::-1],
            solution.random_case.case.friction * solution.peak,
        )
    return True


def other_units(solution: SolvedCase) -> bool:
    """Lengths and moduli in other units."""
    length, modulus = (2.0 ** solution.rng.randint(-12, 12) for _ in range(2))
    other_solution = _solve_again(solution.cells.scale(length, modulus))
    if other_solution is None:
        return False
    for axis in "xy":
        traction, scaled = (
            solution.result[f"traction_{axis}"].values,
            other_solution[f"traction_{axis}"].values / modulus,
        )
        _require_equal(
            f"lengths x {length:g}, moduli x {modulus:g}",
            traction,
            scaled,
            solution.random_case.case.friction * solution.peak,
        )
    return True


def _require_equal(quantity: str, first: np.ndarray, second: np.ndarray, scale: float) -> None:
    """Require two tractions to agree, except in few cells that stick in one of them."""
    require(first.shape == second.shape, f"{quantity}: shapes {first.shape} and {second.shape}")
    difference = np.abs(first - second) / scale
    require(
        float(difference.mean()) <= 0.1 * SAME_TRACTION,
        f"{quantity}: tractions differ by {difference.mean():.3g} on average",
    )
    tolerated = max(2, difference.size // 100)
    max_difference = float(np.sort(difference.ravel())[-tolerated - 1])
    require(max_difference <= SAME_TRACTION, f"{quantity}: tractions differ by {max_difference:.3g}")


def _solve_again(random_case: RandomCase) -> xr.Dataset | None:
    """Result of a variant; None without convergence."""
    try:
        result = run(random_case)
    except ContactStudyError as error:
        raise ViolationError(f"a variant of a solved case was refused: {type(error).__name__}: {error}") from error
    return result if bool(result["converged"]) else None


CONSTANT_CHECKS: tuple[Callable[[SolvedCase], bool], ...] = (
    law_of_friction,
    law_on_the_top,
    forces_of_tractions,
    certificate_of_friction,
    work_is_lost,
    slip_sums_to_the_work,
)
"""Cheap properties."""

RANDOM_CHECKS: tuple[Callable[[SolvedCase], bool], ...] = (turned_round, other_units)
"""Properties that need a second solution."""
