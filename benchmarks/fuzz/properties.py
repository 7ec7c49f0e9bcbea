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
import xarray as xr
from scipy import ndimage

from benchmarks.fuzz.profile_properties import drop_determines_the_peak, pressed_corner_is_unbounded
from benchmarks.fuzz.shapes import draw_magnitude
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
from contactstudy.arrays.variables import STRESSES
from contactstudy.bodies.models import BodyWithFreeEnds
from contactstudy.contact.normal.contact import CONVERGED_TOLERANCES
from contactstudy.kernels.fine_cells import MAX_REFINED_DEPTH


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


def superposition(solution: SolvedCase) -> bool:
    """Stresses and displacements are linear in the pressure and in the friction."""
    case, grid, rng = solution.random_case.case, solution.grid, solution.rng
    pressure = solution.result["pressure"]
    peak = solution.peak
    random_factors = np.random.default_rng(rng.randrange(2**32)).random(grid.shape)
    random_load = pressure.copy(data=peak * random_factors)
    load_fields = pressure, random_load, pressure + 0.5 * random_load
    friction = rng.uniform(-1.0, 1.0)
    points = find_inner_points(solution)
    options = {"inside_cells": rng.choice([pressure, "uniform"]), **points}
    fields = [stack_components(stress_field(case.body, load, friction=friction, **options)) for load in load_fields]
    require_close("stresses of a sum", fields[0] + 0.5 * fields[1], fields[2], peak, 1e-9)
    frictionless_stress, sliding_stress = (
        stack_components(stress_field(case.body, pressure, friction=friction_coefficient, **options))
        for friction_coefficient in (0.0, 1.0)
    )
    require_close(
        "stresses with friction",
        frictionless_stress + friction * (sliding_stress - frictionless_stress),
        fields[0],
        peak,
        1e-9,
    )
    first_displacement, second_displacement, sum_displacement = (
        surface_displacement(case.body, load, friction).values for load in load_fields
    )
    require_close(
        "displacements of a sum",
        first_displacement + 0.5 * second_displacement,
        sum_displacement,
        float(np.abs(sum_displacement).max()),
        1e-9,
    )
    return True


POSITION_EFFECT = 2e-5
"""Effect of further positions: the quadrature on the faces depends on the position nearest to a face."""


def reciprocity(solution: SolvedCase) -> bool:
    """Two pressures do equal work on the displacement of each other (Betti)."""
    body, grid = solution.random_case.case.body, solution.grid
    if isinstance(body, BodyWithFreeEnds) and body.model != "exact":
        return False
    pressure = solution.result["pressure"]
    random_factors = np.random.default_rng(solution.rng.randrange(2**32)).random(grid.shape)
    random_load = pressure.copy(data=solution.peak * random_factors)
    displacements = [surface_displacement(body, load).values for load in (pressure, random_load)]
    works = [
        float((grid.weights * force_field.values * displacement).sum())
        for force_field, displacement in ((pressure, displacements[1]), (random_load, displacements[0]))
    ]
    work_scale = float((grid.weights * random_load.values * np.abs(displacements[0])).sum()) + abs(works[0])
    difference = abs(works[0] - works[1]) / work_scale
    require(difference <= MAX_WORK_DIFFERENCE, f"works differ by {difference:.3g}")
    return True


MAX_WORK_DIFFERENCE = 1e-2
"""Values at centres replace means over cells: exact on uniform cells, approximate on others."""


def find_inner_points(solution: SolvedCase) -> dict[str, list[float]]:
    """Random positions inside the body."""
    grid, rng, half_width = solution.grid, solution.rng, solution.random_case.case.hertz_half_width
    low, high = grid.x_range
    return {
        "x": [low + rng.uniform(0.05, 0.95) * (high - low) for _ in range(2)],
        "y": [rng.uniform(-1.5, 1.5) * half_width],
        "z": [rng.uniform(0.05, 3.0) * half_width, 0.0],
    }


def stack_components(field: xr.Dataset) -> np.ndarray:
    """Stresses (6, x, y, z)."""
    return np.stack([field[name].values for name in STRESSES])


def equilibrium(solution: SolvedCase) -> bool:
    """The divergence of the stresses inside vanishes, by central differences."""
    case, grid, rng = solution.random_case.case, solution.grid, solution.rng
    half_width, peak = case.hertz_half_width, solution.peak
    low, high = grid.x_range
    # At a depth of at least one cell, and away from the ends by more than a step.
    length = max(half_width, float(grid.widths.max()), grid.dy)
    depth = rng.uniform(1.0, 2.0) * length
    step = 0.02 * min(length, high - low)
    # At these depths the representation of the load changes, and on few cells the stresses by up to 1e-3 of the peak.
    for transition_depth in (MAX_REFINED_DEPTH * grid.dy, MAX_REFINED_DEPTH * float(grid.widths.max())):
        if abs(depth - transition_depth) < 2 * step:
            depth = transition_depth + 2 * step
    position = [low + rng.uniform(0.1, 0.9) * (high - low), rng.uniform(-1.0, 1.0) * half_width, depth]
    axes = {axis: [centre - step, centre, centre + step] for axis, centre in zip("xyz", position, strict=True)}
    pressure = solution.result["pressure"]
    field = stack_components(stress_field(case.body, pressure, friction=case.friction, **axes, inside_cells=pressure))
    stress_differences = np.stack(
        [
            field[:, 2, 1, 1] - field[:, 0, 1, 1],
            field[:, 1, 2, 1] - field[:, 1, 0, 1],
            field[:, 1, 1, 2] - field[:, 1, 1, 0],
        ]
    )
    xx, yy, zz, xy, xz, yz = range(6)
    rows = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    for row in rows:
        terms = [stress_differences[axis, component] / (2 * step) * length for axis, component in enumerate(row)]
        require(
            abs(sum(terms)) / peak <= MAX_DIVERGENCE,
            f"divergence {abs(sum(terms)) / peak:.3g} p / length at {position}",
        )
    return True


MAX_DIVERGENCE = 5e-3
"""Divergence of the stresses times their length of variation, over the peak: the error of central differences."""


def loads_on_the_top(solution: SolvedCase) -> bool:
    """On the top the stresses equal the loads, uniform in each cell or smooth."""
    case, grid = solution.random_case.case, solution.grid
    pressure = solution.result["pressure"]
    if isinstance(case.body, BodyWithFreeEnds) and case.body.model == "mirror-factor":
        return False  # its mirrored loads extend beyond the body
    i, j = (solution.rng.randrange(count) for count in grid.shape)
    cell_pressure = float(pressure[i, j])
    for is_smooth in (False, True):
        field = stress_field(
            case.body,
            pressure,
            friction=case.friction,
            x=[grid.x[i]],
            y=[grid.y[j]],
            z=[0.0],
            inside_cells=pressure if is_smooth else "uniform",
        )
        # A smooth load has the force of the cell; at the centre it is at most 1.5 times the mean pressure.
        stress = -field["sigma_zz"].item() if is_smooth else cell_pressure
        low, high = (
            -MOMENT_CORRECTION * solution.peak,
            1.5 * cell_pressure * (1 + 1e-6) + MOMENT_CORRECTION * solution.peak,
        )
        require(
            cell_pressure == 0 or low <= stress <= high,
            f"a smooth load of {stress / solution.peak:.6g}, its mean is {cell_pressure / solution.peak:.6g}",
        )
        for name, expected in (("sigma_zz", -stress), ("tau_yz", -case.friction * stress), ("tau_xz", 0.0)):
            value = field[name].item()
            difference = abs(value - expected) / solution.peak
            require(
                difference <= 1e-6,
                f"{name} = {value / solution.peak:.6g} on the top, not {expected / solution.peak:.6g}",
            )
    return True


MOMENT_CORRECTION = 0.03
"""Load of a fine cell that corrects the moments of its neighbours where a load falls to zero in few cells."""


def stress_ignores_further_positions(solution: SolvedCase) -> bool:
    """Stresses at the cells' centres do not depend on further positions; with these, the solver cannot use symmetry."""
    case, grid, rng = solution.random_case.case, solution.grid, solution.rng
    pressure = solution.result["pressure"]
    depth = [rng.uniform(0.2, 2.0) * case.hertz_half_width]
    stresses_at_centres = stack_components(
        stress_field(case.body, pressure, friction=case.friction, z=depth, inside_cells=pressure)
    )
    positions_by_axis = [
        np.sort(np.append(position, position[0] + 0.31 * (position[1] - position[0]))) for position in (grid.x, grid.y)
    ]
    points = {"x": positions_by_axis[0], "y": positions_by_axis[1], "z": depth, "inside_cells": pressure}
    stresses = stack_components(stress_field(case.body, pressure, friction=case.friction, **points))
    index = np.ix_(range(6), *(np.arange(position.size) != 1 for position in positions_by_axis))
    require_close(
        "stresses with further positions", stresses[index], stresses_at_centres, solution.peak, POSITION_EFFECT
    )
    return True


def free_ends(solution: SolvedCase) -> bool:
    """Free ends carry no traction, from a quarter of a cell below the top.

    Nearer to the top the traction depends on the edges of the cells; `end_traction_residual` bounds it on coarse cells.
    On few columns in a thin body `end_traction_residual` must contain a larger traction.
    """
    case, grid, rng = solution.random_case.case, solution.grid, solution.rng
    end_positions = [end_x for end_x in case.body.extent if np.isfinite(end_x)]
    if not end_positions or not isinstance(case.body, BodyWithFreeEnds) or case.body.model != "exact":
        return False
    size = max(grid.dy, float(grid.widths[[0, -1]].max()))
    depths = [draw_magnitude(rng, 0.25, 4.0) * size for _ in range(2)]
    y = [rng.uniform(*grid.y_range) for _ in range(3)]
    pressure = solution.result["pressure"]
    field = stress_field(
        case.body, pressure, friction=case.friction, x=end_positions, y=y, z=depths, inside_cells=pressure
    )
    end_traction = (
        max(float(np.abs(field[name].values).max()) for name in ("sigma_xx", "tau_xy", "tau_xz")) / solution.peak
    )
    position = {"x": [float(grid.x.mean())], "y": [0.0], "z": [case.hertz_half_width]}
    residual = float(run(solution.random_case, **position)["end_traction_residual"])
    require(
        end_traction <= max(MAX_END_TRACTION, MAX_RESIDUAL_RATIO * residual),
        f"the ends carry a traction of {end_traction:.3g}, {residual:.3g} is stated",
    )
    return True


MAX_END_TRACTION, MAX_RESIDUAL_RATIO = 2e-3, 1.5
"""Largest traction on the ends, and its largest ratio to the stated traction, a maximum over samples."""


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


def largest_stress(solution: SolvedCase) -> bool:
    """The stated largest stress and its error bound the stresses below and on the top off the rim, and are attained."""
    case, grid, rng = solution.random_case.case, solution.grid, solution.rng
    if solution.random_case.grid is not None:
        return False
    position = {"x": [float(grid.x.mean())], "y": [0.0], "z": [case.hertz_half_width]}
    result = run(solution.random_case, **position)
    upper_bound = float(result["peak_von_mises"] + result["peak_von_mises_error"])
    if not np.isfinite(upper_bound):
        return False
    is_loaded = result["pressure"].values > 0
    is_inner = ndimage.binary_erosion(is_loaded, iterations=2, border_value=1)
    columns, rows = (
        np.sort(rng.sample(list(indices), min(len(indices), 25)))
        for indices in (np.flatnonzero(is_loaded.any(axis=1)), np.flatnonzero(is_loaded.any(axis=0)))
    )
    depths = case.hertz_half_width * np.array([0.0, 0.1, 0.2, 0.4, 0.7, 1.0])
    positions = {"x": grid.x[columns], "y": grid.y[rows], "z": depths}
    # Random cases on refined cells are in full sliding.
    pressure = result["pressure"]
    field = stress_field(case.body, pressure, friction=case.friction, **positions, inside_cells=pressure)[
        "von_mises"
    ].values
    field[..., 0][~is_inner[np.ix_(columns, rows)]] = 0.0
    require(field.max() <= upper_bound, f"a von Mises stress of {field.max() / upper_bound:.4g} of the stated largest")
    if float(result["peak_von_mises_z"]) > 0:
        point = {axis: [float(result[f"peak_von_mises_{axis}"])] for axis in "xyz"}
        field = stress_field(case.body, pressure, friction=case.friction, **point, inside_cells=pressure)
        lower_bound = float(result["peak_von_mises"] - result["peak_von_mises_error"])
        stress = 1.005 * field["von_mises"].item()  # representations of the load differ by less than 0.5 %
        require(
            stress >= lower_bound,
            f"a von Mises stress of {stress / lower_bound:.4g} of the stated largest at its position",
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
