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
"""Largest difference of two solutions of one case that meet the tolerance, over friction and peak pressure."""


def law_of_friction(solution: SolvedCase) -> bool:
    """Tractions are below their bound; slip is along the traction, and zero in sticking cells."""
    result, friction = solution.result, solution.random_case.case.friction
    tractions, slip = (np.stack([result[f"{name}_{axis}"].values for axis in "xy"]) for name in ("traction", "slip"))
    in_contact, is_sticking = result["pressure"].values > 0, result["stick"].values.astype(bool)
    bound, max_bound = friction * result["pressure"].values, friction * solution.peak
    bound_excess = float((np.hypot(*tractions) - bound).max()) / max_bound
    require(bound_excess <= 1e-9, f"a traction {bound_excess:.3g} above its bound")
    require(not tractions[:, ~in_contact].any(), "traction without pressure")
    scale = max(float(np.hypot(*slip)[in_contact].max()), np.finfo(float).tiny)
    if isinstance(solution.random_case.case.motion, Rolling) and solution.random_case.case.motion.model == "fastsim":
        return True
    slip_scale = _compute_slip_of_full_sliding(solution)
    require(
        float(np.hypot(*slip)[in_contact & is_sticking].max(initial=0.0)) <= MAX_STICKING_SLIP * max(scale, slip_scale),
        "a cell sticks and slips",
    )
    is_slipping = in_contact & ~is_sticking
    slip_work = (tractions * slip).sum(axis=0)[is_slipping] / max_bound
    require(
        float(-slip_work.min(initial=0.0)) <= MAX_STICKING_SLIP * max(scale, slip_scale), "slip against its traction"
    )
    bound_deficit = np.abs(np.hypot(*tractions) - bound)[is_slipping].max(initial=0.0) / max_bound
    require(float(bound_deficit) <= 1e-6, f"a cell slips at {bound_deficit:.3g} below its bound")
    return True


MAX_STICKING_SLIP = 1e-4
"""Largest slip of a sticking cell over the largest slip, or over the slip of full sliding."""


def _compute_slip_of_full_sliding(solution: SolvedCase) -> float:
    """Displacement (rolling: creepage) at which friction reaches full sliding, by order of magnitude."""
    case = solution.random_case.case
    ratio = case.friction * case.hertz_half_width / case.roller.radius
    return ratio * case.hertz_half_width if isinstance(case.motion, Shift) else ratio


def law_on_the_top(solution: SolvedCase) -> bool:
    """Between the cells' centres, tractions of rolling on the top are below friction times the pressure of the top."""
    case, grid = solution.random_case.case, solution.grid
    is_inner_cell = ndimage.binary_erosion(
        solution.result["pressure"].values > 0, iterations=EXCLUDED_RIM_CELLS, border_value=1
    )
    columns, rows = (np.flatnonzero(is_inner_cell.any(axis=axis)) for axis in (1, 0))
    if not isinstance(case.motion, Rolling) or not is_inner_cell.any():
        return False
    if getattr(case.body, "model", "") == "mirror-factor":
        return False  # its mirrors do not end where the body does
    y = grid.y[rows[0]] + grid.dy * np.linspace(0.0, rows.size - 1, 8 * rows.size - 7)
    surface_stresses = run(solution.random_case, x=grid.x[columns].tolist(), y=y.tolist(), z=[0.0])
    row_of_point = np.clip(np.round((y - grid.y[0]) / grid.dy).astype(int), rows[0], rows[-1])
    bound = -case.friction * surface_stresses["sigma_zz"].values[..., 0]
    traction = np.hypot(*(surface_stresses[f"tau_{axis}z"].values[..., 0] for axis in "xy"))
    is_inner = is_inner_cell[np.ix_(columns, row_of_point)]
    max_ratio = float((traction[is_inner] / bound[is_inner]).max())
    require(max_ratio <= MAX_TOP_RATIO, f"a traction of {max_ratio:.4g} times its bound on the top")
    return True


EXCLUDED_RIM_CELLS, MAX_TOP_RATIO = 1, 1.005
"""Cells at the rim without accurate stresses on the top; largest ratio of the traction to its bound in the other
cells."""


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
        require(difference <= 1e-6, f"{name} differs from the tractions' resultant by {difference:.3g}")
        prescribed_value = getattr(case.motion, name, None)
        if prescribed_value is not None:
            difference = abs(float(result[name]) - prescribed_value) / scale
            require(difference <= 1e-3, f"{name} differs from its prescribed value by {difference:.3g}")
    return True


def certificate_of_friction(solution: SolvedCase) -> bool:
    """The stated violations of the law are within the tolerance."""
    for name in ("bound_error", "slip_error", "force_error"):
        value = abs(float(solution.result[name])) if name in solution.result else 0.0
        require(value <= CONVERGED_TOLERANCES * TOLERANCE, f"{name} = {value:.3g} in a converged result")
    return True


def friction_dissipates_work(solution: SolvedCase) -> bool:
    """The work of friction is positive and at most 1.5 times that of full sliding at the largest slip.

    Forces and creepages determine the work. On two or three cells along rolling, the sum is a few percent too small;
    without slip, the work is a difference of large numbers.
    """
    result = solution.result
    loaded_row_count = int((result["pressure"].values > 0).any(axis=0).sum())
    work = float(result["friction_work"])
    slip = np.hypot(result["slip_x"].values, result["slip_y"].values)[result["pressure"].values > 0]
    scale = (
        solution.random_case.case.friction
        * solution.random_case.case.normal_load
        * max(float(slip.max()), _compute_slip_of_full_sliding(solution))
    )
    lower_bound = -1e-3 if loaded_row_count > 3 else -0.1
    require(lower_bound * scale <= work <= 1.5 * scale, f"work of {work / scale:.3g} of the largest")
    return True


def slip_work_equals_friction_work(solution: SolvedCase) -> bool:
    """In rolling the sum of traction times slip is the frictional work."""
    case, result = solution.random_case.case, solution.result
    if not isinstance(case.motion, Rolling) or case.motion.model == "fastsim":
        return False
    density = sum(result[f"traction_{axis}"].values * result[f"slip_{axis}"].values for axis in "xy")
    summed_work, work = float((solution.grid.widths @ density).sum()) * solution.grid.dy, float(result["friction_work"])
    require(
        abs(summed_work - work) <= 1e-6 * work,
        f"the traction times the slip sums to {summed_work:.6g}, the work is {work:.6g}",
    )
    return True


def mirrored_about_mid_length(solution: SolvedCase) -> bool:
    """A case mirrored about mid-length has the mirrored tractions."""
    extent = np.isfinite(solution.random_case.case.body.extent)
    if extent[0] != extent[1]:
        return False
    mirrored_solution = _solve_variant(solution.cells.reverse_case())
    if mirrored_solution is None:
        return False
    for axis, sign in (("x", -1), ("y", 1)):
        traction = solution.result[f"traction_{axis}"].values
        _require_equal(
            "mirrored about mid-length",
            traction,
            sign * mirrored_solution[f"traction_{axis}"].values[::-1],
            solution.random_case.case.friction * solution.peak,
        )
    return True


def scaled_units(solution: SolvedCase) -> bool:
    """A case in other units of length and modulus has the scaled tractions."""
    length, modulus = (2.0 ** solution.rng.randint(-12, 12) for _ in range(2))
    scaled_solution = _solve_variant(solution.cells.scale(length, modulus))
    if scaled_solution is None:
        return False
    for axis in "xy":
        traction, scaled_traction = (
            solution.result[f"traction_{axis}"].values,
            scaled_solution[f"traction_{axis}"].values / modulus,
        )
        _require_equal(
            f"lengths x {length:g}, moduli x {modulus:g}",
            traction,
            scaled_traction,
            solution.random_case.case.friction * solution.peak,
        )
    return True


def _require_equal(quantity: str, traction: np.ndarray, other_traction: np.ndarray, scale: float) -> None:
    """Require two tractions to agree, except in a few cells that stick in one solution only."""
    require(traction.shape == other_traction.shape, f"{quantity}: shapes {traction.shape} and {other_traction.shape}")
    difference = np.abs(traction - other_traction) / scale
    require(
        float(difference.mean()) <= 0.1 * SAME_TRACTION,
        f"{quantity}: tractions differ by {difference.mean():.3g} on average",
    )
    excluded_count = max(2, difference.size // 100)
    max_difference = float(np.sort(difference.ravel())[-excluded_count - 1])
    require(max_difference <= SAME_TRACTION, f"{quantity}: tractions differ by {max_difference:.3g}")


def _solve_variant(random_case: RandomCase) -> xr.Dataset | None:
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
    friction_dissipates_work,
    slip_work_equals_friction_work,
)
"""Properties without a second solution."""

RANDOM_CHECKS: tuple[Callable[[SolvedCase], bool], ...] = (mirrored_about_mid_length, scaled_units)
"""Properties that need a second solution."""
