"""Properties of every converged case.

Each function raises `ViolationError`, or returns whether the property applies to the case. Bounds are over the peak
pressure unless stated otherwise. They contain the tolerance of the contact, which bounds the gap: on fine cells the
pressure varies by more.
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
from benchmarks.fuzz.shapes import magnitude
from benchmarks.fuzz.solutions import (
    SAME_PRESSURE,
    TOLERANCE,
    SolvedCase,
    ViolationError,
    close,
    contact,
    on_cells,
    require,
    run,
    solve_again,
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
    """No NaN is marked converged, pressure is not negative, the gap is infinite beyond the roller only."""
    for key, values in solution.result.data_vars.items():
        name = str(key)
        array = np.asarray(values.values)
        exponent = name.removesuffix("_error").replace("intensity", "exponent")
        unknown = name.startswith("end_intensity") and float(solution.result[exponent]) == 0  # a logarithm has none
        unknown |= name == "corner_distance" and np.isinf(float(solution.result["corner_distance_error"]))
        if array.dtype.kind == "f" and not unknown:
            require(not np.isnan(array).any(), f"{name} holds NaN")
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
    require(difference <= 1e-5, f"the pressure carries {difference:.3g} more or less than the load")
    if case.load_position is not None:
        arm = abs(float((forces * (grid.x - case.load_position)).sum())) / forces.sum() / case.contact_length
        require(arm <= 1e-4, f"the load acts {arm:.3g} of the length beside its position")
    return True


def complementarity(solution: SolvedCase) -> bool:
    """From the public functions alone: touching cells lie on the rigid roller, the others outside."""
    case, result = solution.random_case.case, solution.result
    if case.roller.material is not None or (solution.moves and case.coupled):
        return False
    friction = case.friction if case.coupled else 0.0
    displacement = result["displacement_z"].values
    # The displacement refers to a line in the body and differs from the displacement of the top by a rigid motion.
    rigid = surface_displacement(case.body, result["pressure"], friction).values - displacement
    line = np.polynomial.polynomial.polyfit(solution.grid.x, rigid[:, 0], min(1, rigid.shape[0] - 1))
    fitted = np.polynomial.polynomial.polyval(solution.grid.x, line)[:, None]
    close("rigid motion of the reference line", rigid, fitted + 0 * rigid, float(np.ptp(displacement)), 1e-6)
    arm = (solution.grid.x - (case.load_position or 0.0))[:, None]
    tilt = float(result["tilt"]) - case.tilt
    opening = result["initial_gap"].values + displacement - float(result["approach"]) - tilt * arm
    in_contact = result["pressure"].values > 0
    variation = float(np.ptp(displacement))
    largest_variation = max(float(np.abs(opening[in_contact]).max()), float(-opening.min())) / variation
    require(largest_variation <= 2e-5, f"gap or overlap of {largest_variation:.3g} of the displacement under pressure")
    return True


def symmetry_across(solution: SolvedCase) -> bool:
    """Without coupled friction the pressure is symmetric in y, in a symmetric window."""
    low, high = solution.grid.y_range
    if solution.random_case.case.coupled or abs(low + high) > 1e-9 * high:
        return False
    pressure = solution.result["pressure"].values
    close("pressure at +y and -y", pressure, pressure[:, ::-1], solution.peak, SAME_PRESSURE)
    return True


def reversed_friction(solution: SolvedCase) -> bool:
    """Friction that acts the other way mirrors the pressure across y."""
    low, high = solution.grid.y_range
    case = solution.cells.case
    if not case.coupled or abs(low + high) > 1e-9 * high:
        return False
    reversed_pressure = solve_again(replace(solution.cells, case=replace(case, friction=-case.friction)))
    if reversed_pressure is None:
        return False
    pressure = solution.result["pressure"].values
    close("pressure under -f", pressure, reversed_pressure[:, ::-1], solution.peak, SAME_PRESSURE)
    return True


def turned_round(solution: SolvedCase) -> bool:
    """A case turned end for end has the mirrored pressure."""
    if not isinstance(solution.random_case.case.body, (FiniteLengthSpace, HalfSpace)):
        return False
    mirrored_pressure = solve_again(solution.cells.from_other_end())
    if mirrored_pressure is None:
        return False
    pressure = solution.result["pressure"].values
    close("pressure turned round", pressure, mirrored_pressure[::-1], solution.peak, SAME_PRESSURE)
    return True


def other_units(solution: SolvedCase) -> bool:
    """Lengths and moduli in other units: a power of two, so that not even rounding differs."""
    length, modulus = (2.0 ** solution.rng.randint(-12, 12) for _ in range(2))
    scaled_pressure = solve_again(solution.cells.scale(length, modulus))
    if scaled_pressure is None:
        return False
    pressure = modulus * solution.result["pressure"].values
    scale = modulus * solution.peak
    close(f"lengths x {length:g}, moduli x {modulus:g}", pressure, scaled_pressure, scale, SAME_PRESSURE)
    return True


def same_load_by_pressure(solution: SolvedCase) -> bool:
    """A load, and the Hertz pressure of that load, are one case."""
    case = solution.random_case.case
    by_pressure = case.load is None
    value = {"load": case.normal_load} if by_pressure else {"max_pressure": case.hertz_max_pressure}
    same_case = replace(case, **({"load": None, "max_pressure": None} | value))
    second_pressure = solve_again(replace(solution.cells, case=same_case))
    if second_pressure is None:
        return False
    close("load or pressure", solution.result["pressure"].values, second_pressure, solution.peak, SAME_PRESSURE)
    return True


def contact_of_gap(solution: SolvedCase) -> bool:
    """`solve_contact` of the initial gap gives the pressure that `solve` gave."""
    case, result = solution.random_case.case, solution.result
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        second_result = contact(case, result["initial_gap"])
    if not bool(second_result["converged"]):
        return False
    pressure, traction = result["pressure"].values, result["traction_y"].values
    close("solve_contact", second_result["pressure"].values, pressure, solution.peak, SAME_PRESSURE)
    close("shear traction", traction, case.friction * pressure, solution.peak, 1e-12)
    return True


def superposition(solution: SolvedCase) -> bool:
    """Stresses and displacements are linear in the pressure and in the friction."""
    case, grid, rng = solution.random_case.case, solution.grid, solution.rng
    pressure = solution.result["pressure"]
    peak = solution.peak
    noise = np.random.default_rng(rng.randrange(2**32)).random(grid.shape)
    second_load = pressure.copy(data=peak * noise)
    loads = pressure, second_load, pressure + 0.5 * second_load
    friction = rng.uniform(-1.0, 1.0)
    points = inner_points(solution)
    options = {"inside_cells": rng.choice([pressure, "uniform"]), **points}
    fields = [stack_components(stress_field(case.body, load, friction=friction, **options)) for load in loads]
    close("stresses of a sum", fields[0] + 0.5 * fields[1], fields[2], peak, 1e-9)
    frictionless, with_friction = (
        stack_components(stress_field(case.body, pressure, friction=f, **options)) for f in (0.0, 1.0)
    )
    close("stresses with friction", frictionless + friction * (with_friction - frictionless), fields[0], peak, 1e-9)
    first, second, total = (surface_displacement(case.body, load, friction).values for load in loads)
    close("displacements of a sum", first + 0.5 * second, total, float(np.abs(total).max()), 1e-9)
    return True


QUADRATURE = 2e-5
"""The positions on the faces depend on the nearest position of the stresses."""


def reciprocity(solution: SolvedCase) -> bool:
    """Two pressures do equal work on the displacement of each other (Betti)."""
    body, grid = solution.random_case.case.body, solution.grid
    if isinstance(body, BodyWithFreeEnds) and body.model != "exact":
        return False
    first_load = solution.result["pressure"]
    noise = np.random.default_rng(solution.rng.randrange(2**32)).random(grid.shape)
    second_load = first_load.copy(data=solution.peak * noise)
    displacements = [surface_displacement(body, load).values for load in (first_load, second_load)]
    works = [
        float((grid.weights * p.values * u).sum())
        for p, u in ((first_load, displacements[1]), (second_load, displacements[0]))
    ]
    size = float((grid.weights * second_load.values * np.abs(displacements[0])).sum()) + abs(works[0])
    difference = abs(works[0] - works[1]) / size
    require(difference <= RECIPROCITY, f"works differ by {difference:.3g}")
    return True


RECIPROCITY = 1e-2
"""Values at centres replace means over cells: exact on uniform cells, approximate on others."""


def inner_points(solution: SolvedCase) -> dict[str, list[float]]:
    """Random positions inside the body."""
    grid, rng, a = solution.grid, solution.rng, solution.random_case.case.hertz_half_width
    low, high = grid.x_range
    return {
        "x": [low + rng.uniform(0.05, 0.95) * (high - low) for _ in range(2)],
        "y": [rng.uniform(-1.5, 1.5) * a],
        "z": [rng.uniform(0.05, 3.0) * a, 0.0],
    }


def stack_components(field: xr.Dataset) -> np.ndarray:
    """Stresses (6, x, y, z)."""
    return np.stack([field[name].values for name in STRESSES])


def equilibrium(solution: SolvedCase) -> bool:
    """The divergence of the stresses inside vanishes, by central differences."""
    case, grid, rng = solution.random_case.case, solution.grid, solution.rng
    a, peak = case.hertz_half_width, solution.peak
    low, high = grid.x_range
    # Below the steps of the cells, and away from the ends by more than a step.
    size = max(a, float(grid.widths.max()), grid.dy)
    depth = rng.uniform(1.0, 2.0) * size
    step = 0.02 * min(size, high - low)
    # Here the load's cells change from fine to coarse, and on few cells the stresses by up to 1e-3 of the peak.
    for change in (MAX_REFINED_DEPTH * grid.dy, MAX_REFINED_DEPTH * float(grid.widths.max())):
        if abs(depth - change) < 2 * step:
            depth = change + 2 * step
    position = [low + rng.uniform(0.1, 0.9) * (high - low), rng.uniform(-1.0, 1.0) * a, depth]
    axes = {axis: [centre - step, centre, centre + step] for axis, centre in zip("xyz", position, strict=True)}
    pressure = solution.result["pressure"]
    field = stack_components(stress_field(case.body, pressure, friction=case.friction, **axes, inside_cells=pressure))
    stress_rows = np.stack(
        [
            field[:, 2, 1, 1] - field[:, 0, 1, 1],
            field[:, 1, 2, 1] - field[:, 1, 0, 1],
            field[:, 1, 1, 2] - field[:, 1, 1, 0],
        ]
    )
    xx, yy, zz, xy, xz, yz = range(6)
    rows = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    for row in rows:
        terms = [stress_rows[axis, component] / (2 * step) * size for axis, component in enumerate(row)]
        require(
            abs(sum(terms)) / peak <= EQUILIBRIUM, f"divergence {abs(sum(terms)) / peak:.3g} p / length at {position}"
        )
    return True


EQUILIBRIUM = 5e-3
"""Divergence times the length of variation of the stresses, over the peak: the error of the differences."""


def loads_on_the_top(solution: SolvedCase) -> bool:
    """On the top the stresses equal the loads, uniform in each cell or smooth."""
    case, grid = solution.random_case.case, solution.grid
    pressure = solution.result["pressure"]
    if isinstance(case.body, BodyWithFreeEnds) and case.body.model == "mirror-factor":
        return False  # its weights add up to one, but its mirrors do not end where the body does
    i, j = (solution.rng.randrange(count) for count in grid.shape)
    p = float(pressure[i, j])
    for smooth in (False, True):
        field = stress_field(
            case.body,
            pressure,
            friction=case.friction,
            x=[grid.x[i]],
            y=[grid.y[j]],
            z=[0.0],
            inside_cells=pressure if smooth else "uniform",
        )
        # A smooth load keeps the force of a cell; in its middle it may differ, up to the steepest that a cell can hold.
        stress = -field["sigma_zz"].item() if smooth else p
        low, high = -MOMENTS * solution.peak, 1.5 * p * (1 + 1e-6) + MOMENTS * solution.peak
        require(
            p == 0 or low <= stress <= high,
            f"a smooth load of {stress / solution.peak:.6g}, its mean is {p / solution.peak:.6g}",
        )
        for name, expected in (("sigma_zz", -stress), ("tau_yz", -case.friction * stress), ("tau_xz", 0.0)):
            value = field[name].item()
            off = abs(value - expected) / solution.peak
            require(off <= 1e-6, f"{name} = {value / solution.peak:.6g} on the top, not {expected / solution.peak:.6g}")
    return True


MOMENTS = 0.03
"""Load of a fine cell for the moments of its neighbours, where a load falls steeply to zero in few cells."""


def same_points_among_others(solution: SolvedCase) -> bool:
    """Stresses at the cells' centres do not depend on further positions, which exclude the use of symmetry."""
    case, grid, rng = solution.random_case.case, solution.grid, solution.rng
    pressure = solution.result["pressure"]
    depth = [rng.uniform(0.2, 2.0) * case.hertz_half_width]
    separate_fields = stack_components(
        stress_field(case.body, pressure, friction=case.friction, z=depth, inside_cells=pressure)
    )
    aside = [
        np.sort(np.append(position, position[0] + 0.31 * (position[1] - position[0]))) for position in (grid.x, grid.y)
    ]
    points = {"x": aside[0], "y": aside[1], "z": depth, "inside_cells": pressure}
    stresses = stack_components(stress_field(case.body, pressure, friction=case.friction, **points))
    index = np.ix_(range(6), *(np.arange(position.size) != 1 for position in aside))
    close("stresses among others", stresses[index], separate_fields, solution.peak, QUADRATURE)
    return True


def free_ends(solution: SolvedCase) -> bool:
    """Free ends carry no traction, from a quarter of a cell below the top on.

    Nearer to the top the traction depends on the edges of the cells; `end_traction_residual` bounds it on coarse cells.
    On few columns in a thin body a larger traction has to be stated.
    """
    case, grid, rng = solution.random_case.case, solution.grid, solution.rng
    ends = [end_x for end_x in case.body.extent if np.isfinite(end_x)]
    if not ends or not isinstance(case.body, BodyWithFreeEnds) or case.body.model != "exact":
        return False
    size = max(grid.dy, float(grid.widths[[0, -1]].max()))
    depths = [magnitude(rng, 0.25, 4.0) * size for _ in range(2)]
    y = [rng.uniform(*grid.y_range) for _ in range(3)]
    pressure = solution.result["pressure"]
    field = stress_field(case.body, pressure, friction=case.friction, x=ends, y=y, z=depths, inside_cells=pressure)
    end_traction = (
        max(float(np.abs(field[name].values).max()) for name in ("sigma_xx", "tau_xy", "tau_xz")) / solution.peak
    )
    position = {"x": [float(grid.x.mean())], "y": [0.0], "z": [case.hertz_half_width]}
    residual = float(run(solution.random_case, **position)["end_traction_residual"])
    require(
        end_traction <= max(FREE, SAMPLED * residual),
        f"traction of {end_traction:.3g} is left on the ends, {residual:.3g} is stated",
    )
    return True


FREE, SAMPLED = 2e-3, 1.5
"""Largest traction on the ends, and its ratio to the stated one, which is a sample."""


def stated_errors(solution: SolvedCase) -> bool:
    """The errors that refined cells state cover the difference from cells refined further."""
    if solution.random_case.grid is not None or solution.random_case.accuracy < 0.02:
        return False
    position = {"x": [float(solution.result.x.mean())], "y": [0.0], "z": [solution.random_case.case.hertz_half_width]}
    rough_result, finer_result = (
        run(replace(solution.random_case, accuracy=factor * solution.random_case.accuracy), **position)
        for factor in (1.0, 0.25)
    )
    for name in ("peak_pressure", "end_pressure_first", "end_pressure_last", "peak_von_mises"):
        error, stress = float(rough_result[f"{name}_error"]), float(finer_result[f"{name}_error"])
        if not np.isfinite(error + stress):
            continue
        difference = abs(float(rough_result[name]) - float(finer_result[name]))
        tolerance = error + stress
        require(
            difference <= tolerance,
            f"{name}: stated {error / solution.peak:.3g} of the peak, off by {difference / solution.peak:.3g}",
        )
    return True


def largest_stress(solution: SolvedCase) -> bool:
    """The stated largest stress and its error bound the stresses on the top off the rim and below; the body has it."""
    case, grid, rng = solution.random_case.case, solution.grid, solution.rng
    if solution.random_case.grid is not None:
        return False
    position = {"x": [float(grid.x.mean())], "y": [0.0], "z": [case.hertz_half_width]}
    result = run(solution.random_case, **position)
    upper_bound = float(result["peak_von_mises"] + result["peak_von_mises_error"])
    if not np.isfinite(upper_bound):
        return False
    loaded = result["pressure"].values > 0
    inner = ndimage.binary_erosion(loaded, iterations=2, border_value=1)
    columns, rows = (
        np.sort(rng.sample(list(indices), min(len(indices), 25)))
        for indices in (np.flatnonzero(loaded.any(axis=1)), np.flatnonzero(loaded.any(axis=0)))
    )
    depths = case.hertz_half_width * np.array([0.0, 0.1, 0.2, 0.4, 0.7, 1.0])
    positions = {"x": grid.x[columns], "y": grid.y[rows], "z": depths}
    # On refined cells random cases slide.
    pressure = result["pressure"]
    field = stress_field(case.body, pressure, friction=case.friction, **positions, inside_cells=pressure)[
        "von_mises"
    ].values
    field[..., 0][~inner[np.ix_(columns, rows)]] = 0.0
    require(field.max() <= upper_bound, f"a von Mises stress of {field.max() / upper_bound:.4g} of the stated largest")
    if float(result["peak_von_mises_z"]) > 0:
        point = {axis: [float(result[f"peak_von_mises_{axis}"])] for axis in "xyz"}
        field = stress_field(case.body, pressure, friction=case.friction, **point, inside_cells=pressure)
        lower_bound = float(result["peak_von_mises"] - result["peak_von_mises_error"])
        stress = 1.005 * field["von_mises"].item()  # the representations of the load differ by less
        require(
            stress >= lower_bound,
            f"a von Mises stress of {stress / lower_bound:.4g} of the stated largest at its position",
        )
    return True


def equivalent_loads_are_finite(solution: SolvedCase) -> bool:
    """The method's equivalent loads exist for every pressure of `solve`."""
    case = solution.random_case.case
    if not isinstance(case.body, BodyWithFreeEnds) or case.body.model != "exact":
        return False
    depth = solution.rng.uniform(0.1, 3.0) * case.hertz_half_width
    loads = equivalent_loads(case.body, solution.result["pressure"], float(case.friction), z=[depth])
    require(all(np.isfinite(values).all() for values in loads.values()), "an equivalent load is not finite")
    return True


def single_plane(solution: SolvedCase) -> bool:
    """The risk of a single plane is refused: it needs a volume."""
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
    gap = on_cells(cells.grid, cells.case.gap(cells.grid))
    cache.clear()
    with ThreadPoolExecutor(2) as pool:
        pressures = [result["pressure"].values for result in pool.map(lambda _: contact(cells.case, gap), range(2))]
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
    reversed_friction,
    turned_round,
    other_units,
    same_load_by_pressure,
    contact_of_gap,
    superposition,
    reciprocity,
    equilibrium,
    loads_on_the_top,
    largest_stress,
    drop_determines_the_peak,
    equivalent_loads_are_finite,
    single_plane,
    two_threads,
    same_points_among_others,
)
"""Properties that need another solution or stresses: two per case."""
