"""A solved random case, and solutions of its variants."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from random import Random

import numpy as np
import xarray as xr

from benchmarks.fuzz.random_cases import RandomCase
from contactstudy import (
    Case,
    ContactStudyError,
    ConvergenceWarning,
    Grid,
    MagnitudeWarning,
    Sliding,
    solve,
    solve_contact,
)
from contactstudy.arrays.variables import cell_coordinates
from contactstudy.contact import ContactSettings

TOLERANCE = 1e-6
"""Tolerance of every contact."""

SAME_PRESSURE = 2e-3
"""Largest difference of two solutions of one contact that meet the tolerance, over the peak pressure."""


class ViolationError(AssertionError):
    """A property does not hold."""


@dataclass(frozen=True)
class SolvedCase:
    """A case and its converged result, without stresses."""

    random_case: RandomCase
    result: xr.Dataset
    rng: Random

    @property
    def peak(self) -> float:
        """Largest pressure, Pa."""
        return float(self.result["pressure"].max())

    @property
    def moves(self) -> bool:
        """Whether the motion is rolling or a shift, with stick and slip."""
        return not isinstance(self.random_case.case.motion, Sliding)

    @property
    def cells(self) -> RandomCase:
        """The case on the cells of the solution, whether refined or given."""
        if self.random_case.grid is not None:
            return self.random_case
        result = self.result
        dy = float(result["y"][1] - result["y"][0])
        window = (float(result["y"][0]) - 0.5 * dy, float(result["y"][-1]) + 0.5 * dy)
        edges = np.append(result["x_bounds"][:, 0], result["x_bounds"][-1, 1])
        return replace(self.random_case, grid=Grid.between(edges, window, result.sizes["y"]))

    @property
    def grid(self) -> Grid:
        """Cells of the solution."""
        grid = self.cells.grid
        assert grid is not None
        return grid


def require(condition: object, message: str) -> None:
    """Raise unless a condition holds."""
    if not condition:
        raise ViolationError(message)


def run(random_case: RandomCase, **positions: list[float]) -> xr.Dataset:
    """Solve a case, with stresses at positions if given; check its warnings."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = solve(
            random_case.case,
            random_case.grid,
            accuracy=None if random_case.grid is not None else random_case.accuracy,
            stresses=bool(positions),
            tolerance=TOLERANCE,
            **positions,
        )
    categories = {warning.category for warning in caught}
    unexpected_warnings = [
        str(warning.message) for warning in caught if warning.category not in (ConvergenceWarning, MagnitudeWarning)
    ]
    require(not unexpected_warnings, f"an undeclared warning: {unexpected_warnings[:1]}")
    require(
        bool(result["converged"]) == (ConvergenceWarning not in categories),
        "converged and warning contradict each other",
    )
    return result


def solve_again(random_case: RandomCase) -> np.ndarray | None:
    """Pressure of a variant of a solved case; None without convergence."""
    try:
        if random_case.grid is None:
            result = run(random_case)
        else:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", ConvergenceWarning)
                result = solve_gap(
                    random_case.case, label_cells(random_case.grid, random_case.case.gap(random_case.grid))
                )
    except ContactStudyError as error:
        raise ViolationError(f"a variant of a solved case was refused: {type(error).__name__}: {error}") from error
    return result["pressure"].values if bool(result["converged"]) else None


def label_cells(grid: Grid, values: np.ndarray) -> xr.DataArray:
    """Label values on cells."""
    coordinates = {"x": grid.x, "y": grid.y} | cell_coordinates(grid)
    return xr.DataArray(
        values, {name: positions for name, positions in coordinates.items() if name != "x_bounds"}, ("x", "y")
    )


def solve_gap(case: Case, gap: xr.DataArray) -> xr.Dataset:
    """Contact of a case from its gap."""
    return solve_contact(
        case.body,
        gap,
        load=case.normal_load,
        friction=case.friction,
        counterbody=case.counterbody,
        settings=ContactSettings(coupled=case.coupled, load_position=case.load_position, tolerance=TOLERANCE),
    )


def require_close(quantity: str, values: np.ndarray, expected: np.ndarray, scale: float, bound: float) -> None:
    """Require two arrays to agree."""
    require(values.shape == expected.shape, f"{quantity}: shapes {values.shape} and {expected.shape}")
    difference = float(np.abs(values - expected).max()) / scale
    require(difference <= bound, f"{quantity}: differ by {difference:.3g}, allowed {bound:g}")
