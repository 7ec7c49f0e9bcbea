"""Properties of every converged case.

Each function raises `ViolationError`, or returns whether the property applies to the case. Bounds are over the peak
pressure unless stated otherwise. They include the error from the tolerance of the contact. The tolerance bounds the
gap: on fine cells the pressure varies by more.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from benchmarks.fuzz.field_properties import (
    equilibrium,
    free_ends,
    largest_stress,
    loads_on_the_top,
    reciprocity,
    stress_ignores_further_positions,
    superposition,
)
from benchmarks.fuzz.profile_properties import drop_determines_the_peak, pressed_corner_is_unbounded
from benchmarks.fuzz.solutions import (
    SAME_PRESSURE,
    TOLERANCE,
    SolvedCase,
    ViolationError,
    label_cells,
    require,
    require_close,
    run,
    solve_again,
    solve_gap,
)
from contactstudy import (
    ConvergenceWarning,
    FiniteLengthSpace,
    HalfSpace,
    InvalidInputError,
    cache,
    equivalent_loads,
    fatigue,
    stress_field,
    surface_displacement,
)
from contactstudy.bodies.models import BodyWithFreeEnds
from contactstudy.contact.normal.contact import CONVERGED_TOLERANCES


def finite_values(solution: SolvedCase) -> bool:
    """A converged result has no NaN and no negative pressure; its gap is infinite beyond the roller only."""
    for key, values in solution.result.data_vars.items():
        name = str(key)
        array = np.asarray(values.values)
        exponent = name.removesuffix("_error").replace("intensity", "exponent")
        is_unknown = (
            name.startswith("end_intensity") and float(solution.result[exponent]) == 0
        )  # the law is a logarithm
        is_unknown |= name == "corner_distance" and np.isinf(float(solution.result["corner_distance_error"]))
        if array.dtype.kind == "f" and not is_unknown:
            require(not np.isnan(array).any(), f"{name} contains NaN")
    pressure, gap = solution.result["pressure"].values, solution.result["gap"].values
    require(np.isfinite(pressure).all() and pressure.min() >= 0 and pressure.max() > 0, "pressure out of range")
    require((np.isinf(gap) == np.isinf(solution.result["initial_gap"].values)).all(), "the gap is infinite elsewhere")
    return True


def certificate(solution: SolvedCase) -> bool:
    """The stated violations are within the tolerance."""
    for name in ("load_error", "penetration_error", "open_pressure_error", "load_position_error"):
        value = abs(float(solution.result[name]))
        require(value <= CONVERGED_TOLERANCES * TOLERANCE, f"{name} = {value:.3g} in a converged result")
    return True


def balance(solution: SolvedCase) -> bool:
    """The pressure carries the load, where the load acts."""
    case, grid = solution.random_case.case, solution.grid
    forces = solution.result["pressure"].values.sum(axis=1) * grid.widths * grid.dy
    difference = abs(float(forces.sum()) / case.normal_load - 1)
    require(difference <= 1e-5, f"the resultant of the pressure differs from the load by {difference:.3g}")
    if case.load_position is not None:
        arm = abs(float((forces * (grid.x - case.load_position)).sum())) / forces.sum() / case.contact_length
        require(arm <= 1e-4, f"the resultant acts {arm:.3g} of the length beside the load's position")
    return True


def complementarity(solution: SolvedCase) -> bool:
    """By public functions: cells in contact lie on the rigid roller, all other cells outside it."""
    case, result = solution.random_case.case, solution.result
    if case.roller.material is not None or (solution.moves and case.coupled):
        return False
    friction = case.friction if case.coupled else 0.0
    displacement = result["displacement_z"].values
    # The displacement refers to a line in the body and differs from the displacement of the top by a rigid motion.
    rigid_motion = surface_displacement(case.body, result["pressure"], friction).values - displacement
    line_coefficients = np.polynomial.polynomial.polyfit(
        solution.grid.x, rigid_motion[:, 0], min(1, rigid_motion.shape[0] - 1)
    )
    fitted_line = np.polynomial.polynomial.polyval(solution.grid.x, line_coefficients)[:, None]
    require_close(
        "rigid motion of the reference line",
        rigid_motion,
        fitted_line + 0 * rigid_motion,
        float(np.ptp(displacement)),
        1e-6,
    )
    arm = (solution.grid.x - (case.load_position or 0.0))[:, None]
    tilt = float(result["tilt"]) - case.tilt
    gap = result["initial_gap"].values + displacement - float(result["approach"]) - tilt * arm
    in_contact = result["pressure"].values > 0
    variation = float(np.ptp(displacement))
    max_ratio = max(float(np.abs(gap[in_contact]).max()), float(-gap.min())) / variation
    require(max_ratio <= 2e-5, f"gap or overlap of {max_ratio:.3g} of the displacement under pressure")
    return True


def symmetry_across(solution: SolvedCase) -> bool:
    """Without coupled friction the pressure is symmetric in y, in a symmetric window."""
    low, high = solution.grid.y_range
    if solution.random_case.case.coupled or abs(low + high) > 1e-9 * high:
        return False
    pressure = solution.result["pressure"].values
    require_close("pressure at +y and -y", pressure, pressure[:, ::-1], solution.peak, SAME_PRESSURE)
    return True


def mirrored_by_reversed_friction(solution: SolvedCase) -> bool:
    """Reversed friction mirrors the pressure in y."""
    low, high = solution.grid.y_range
    case = solution.cells.case
    if not case.coupled or abs(low + high) > 1e-9 * high:
        return False
    reversed_pressure = solve_again(replace(solution.cells, case=replace(case, friction=-case.friction)))
    if reversed_pressure is None:
        return False
    pressure = solution.result["pressure"].values
    require_close("pressure under -f", pressure, reversed_pressure[:, ::-1], solution.peak, SAME_PRESSURE)
    return True


def mirrored_about_mid_length(solution: SolvedCase) -> bool:
    """A case mirrored about mid-length has the mirrored pressure."""
    if not isinstance(solution.random_case.case.body, (FiniteLengthSpace, HalfSpace)):
        return False
    mirrored_pressure = solve_again(solution.cells.reverse_case())
    if mirrored_pressure is None:
        return False
    pressure = solution.result["pressure"].values
    require_close("pressure mirrored about mid-length", pressure, mirrored_pressure[::-1], solution.peak, SAME_PRESSURE)
    return True


def scaled_units(solution: SolvedCase) -> bool:
    """A case in other units of length and modulus has the scaled pressure; powers of two have no rounding errors."""
    length, modulus = (2.0 ** solution.rng.randint(-12, 12) for _ in range(2))
    scaled_pressure = solve_again(solution.cells.scale(length, modulus))
    if scaled_pressure is None:
        return False
    pressure = modulus * solution.result["pressure"].values
    scale = modulus * solution.peak
    require_close(f"lengths x {length:g}, moduli x {modulus:g}", pressure, scaled_pressure, scale, SAME_PRESSURE)
    return True


def same_load_by_pressure(solution: SolvedCase) -> bool:
    """A load and the Hertz pressure of this load determine the same contact."""
    case = solution.random_case.case
    has_given_pressure = case.load is None
    value = {"load": case.normal_load} if has_given_pressure else {"max_pressure": case.hertz_max_pressure}
    same_case = replace(case, **({"load": None, "max_pressure": None} | value))
    second_pressure = solve_again(replace(solution.cells, case=same_case))
    if second_pressure is None:
        return False
    require_close("load or pressure", solution.result["pressure"].values, second_pressure, solution.peak, SAME_PRESSURE)
    return True


def gap_determines_pressure(solution: SolvedCase) -> bool:
    """The contact of the initial gap has the pressure of `solve`."""
    case, result = solution.random_case.case, solution.result
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        second_result = solve_gap(case, result["initial_gap"])
    if not bool(second_result["converged"]):
        return False
    pressure, traction = result["pressure"].values, result["traction_y"].values
    require_close("solve_contact", second_result["pressure"].values, pressure, solution.peak, SAME_PRESSURE)
    require_close("shear traction", traction, case.friction * pressure, solution.peak, 1e-12)
    return True


def stated_errors(solution: SolvedCase) -> bool:
    """The errors stated on refined cells bound the difference from a finer refinement."""
    if solution.random_case.grid is not None or solution.random_case.accuracy < 0.02:
        return False
    position = {"x": [float(solution.result.x.mean())], "y": [0.0], "z": [solution.random_case.case.hertz_half_width]}
    rough_result, finer_result = (
        run(replace(solution.random_case, accuracy=factor * solution.random_case.accuracy), **position)
        for factor in (1.0, 0.25)
    )
    for name in ("peak_pressure", "end_pressure_first", "end_pressure_last", "peak_von_mises"):
        error, finer_error = float(rough_result[f"{name}_error"]), float(finer_result[f"{name}_error"])
        if not np.isfinite(error + finer_error):
            continue
        difference = abs(float(rough_result[name]) - float(finer_result[name]))
        tolerance = error + finer_error
        require(
            difference <= tolerance,
            f"{name}: the stated error is {error / solution.peak:.3g} of the peak, the difference "
            f"{difference / solution.peak:.3g}",
        )
    return True


def equivalent_loads_are_finite(solution: SolvedCase) -> bool:
    """The equivalent loads of every pressure of `solve` are finite."""
    case = solution.random_case.case
    if not isinstance(case.body, BodyWithFreeEnds) or case.body.model != "exact":
        return False
    depth = solution.rng.uniform(0.1, 3.0) * case.hertz_half_width
    loads = equivalent_loads(case.body, solution.result["pressure"], float(case.friction), z=[depth])
    require(all(np.isfinite(values).all() for values in loads.values()), "an equivalent load is not finite")
    return True


def risk_of_one_plane_is_refused(solution: SolvedCase) -> bool:
    """The risk of a single plane is refused, because the risk is an integral over a volume."""
    case, pressure = solution.random_case.case, solution.result["pressure"]
    depths = case.hertz_half_width * np.array([0.2, 0.5, 1.0])
    field = stress_field(
        case.body, pressure, friction=case.friction, x=solution.grid.x, y=[0.0], z=depths, inside_cells=pressure
    ).assign(hertz_max_pressure=case.hertz_max_pressure)
    try:
        fatigue.lundberg_palmgren(field)
    except InvalidInputError:
        return True
    raise ViolationError("the risk of a single plane is not refused")


def two_threads(solution: SolvedCase) -> bool:
    """Two threads that solve a case without a cache return the pressure of one thread."""
    cells = solution.cells
    assert cells.grid is not None
    gap = label_cells(cells.grid, cells.case.gap(cells.grid))
    cache.clear()
    with ThreadPoolExecutor(2) as pool:
        pressures = [result["pressure"].values for result in pool.map(lambda _: solve_gap(cells.case, gap), range(2))]
    require(np.array_equal(*pressures), "two threads return different pressures")
    return True


CONSTANT_CHECKS: tuple[Callable[[SolvedCase], bool], ...] = (
    finite_values,
    certificate,
    balance,
    complementarity,
    symmetry_across,
    free_ends,
    stated_errors,
    pressed_corner_is_unbounded,
)
"""Properties that need no other solution, and the stated errors."""

RANDOM_CHECKS: tuple[Callable[[SolvedCase], bool], ...] = (
    mirrored_by_reversed_friction,
    mirrored_about_mid_length,
    scaled_units,
    same_load_by_pressure,
    gap_determines_pressure,
    superposition,
    reciprocity,
    equilibrium,
    loads_on_the_top,
    largest_stress,
    drop_determines_the_peak,
    equivalent_loads_are_finite,
    risk_of_one_plane_is_refused,
    two_threads,
    stress_ignores_further_positions,
)
"""Properties that need another solution or stresses: two per case."""
