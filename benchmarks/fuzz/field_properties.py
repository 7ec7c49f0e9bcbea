"""Properties of stresses and displacements: linearity, reciprocity, equilibrium, loads on the top, free ends.

Each function raises `ViolationError`, or returns whether the property applies to the case. Bounds are over the peak
pressure unless stated otherwise.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy import ndimage

from benchmarks.fuzz.shapes import draw_magnitude
from benchmarks.fuzz.solutions import SolvedCase, require, require_close, run
from contactstudy import stress_field, surface_displacement
from contactstudy.arrays.variables import STRESSES
from contactstudy.bodies.models import BodyWithFreeEnds
from contactstudy.kernels.fine_cells import MAX_REFINED_DEPTH


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
