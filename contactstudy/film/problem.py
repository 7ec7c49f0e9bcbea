"""A film to solve, the unknowns of an iteration and the solution, on arrays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from contactstudy.checks import BoolArray, FloatArray
from contactstudy.film.reynolds import FilmCells, Fluid, Law

INVERSE_STEPS = 8
"""Steps that find the distance of rough surfaces from the film; the next Newton step removes the remainder. Speed."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FilmProblem:
    """A film to solve, in the units of `FilmCells`.

    Attributes
    ----------
    cells : FilmCells
        Cells.
    fluid : Fluid
        Laws of the lubricant.
    gap : array (x, y)
        Gap before deformation.
    displace : callable
        Displacement of the surfaces apart, array (x, y), under a pressure.
    column_stiffness : array (x, y, y)
        Displacement of a column's cells under a pressure that is equal in all columns.
    load : float
        Prescribed sum of the pressure times the areas.
    lever : array (x) or None
        Distances from the load's position, over the largest distance, if the roller is free to tilt.
    central_film : float
        Estimate of the central film before the solution: the scale of tolerances.
    asperities : callable or None
        Mean pressure of the asperities at a distance of the surfaces.
    mean_height : callable or None
        Mean height of the film at a distance of rough surfaces.
    """

    cells: FilmCells
    fluid: Fluid
    gap: FloatArray
    displace: Callable[[FloatArray], FloatArray]
    column_stiffness: FloatArray
    load: float
    lever: FloatArray | None
    central_film: float
    asperities: Callable[[FloatArray], Law] | None = None
    mean_height: Callable[[FloatArray], Law] | None = None

    @cached_property
    def motions(self) -> FloatArray:
        """Changes of the distance of the surfaces by unit rigid motions: array (motion, cell)."""
        ones = np.ones(self.cells.shape)
        motions = [ones] if self.lever is None else [ones, self.lever[:, None] * ones]
        return np.stack([motion.ravel() for motion in motions])

    @cached_property
    def resultants(self) -> FloatArray:
        """Factors by which a sum over the pressure gives load and moment: array (motion, cell)."""
        return np.asarray(self.motions * self.cells.areas.ravel())

    def compute_film(self, distance: FloatArray) -> Law:
        """Mean height of the film at a distance of the surfaces."""
        return Law(distance, np.ones_like(distance)) if self.mean_height is None else self.mean_height(distance)

    def solve_distance(self, height: FloatArray, start: FloatArray) -> FloatArray:
        """Distance of the surfaces at a mean film, by Newton's method for the film's logarithm from a `start`."""
        if self.mean_height is None:
            return height
        # The mean height exceeds the distance of the surfaces by at most the height at distance zero.
        touching_height = self.mean_height(np.zeros_like(height)).value
        distance = np.where(height > touching_height, np.maximum(start, height - touching_height), start)
        for _ in range(INVERSE_STEPS):
            film = self.mean_height(distance)
            distance = distance + film.value / film.slope * np.log(height / film.value)
        return distance

    @property
    def prescribed(self) -> FloatArray:
        """Prescribed sums of `resultants`: the load, and its zero moment about the load's position."""
        return np.array([self.load, 0.0][: len(self.motions)])


class FilmState(NamedTuple):
    """Unknowns of an iteration.

    Attributes
    ----------
    pressure : array (x, y)
        Pressure on the surfaces, fluid and asperities.
    motion : array (motion)
        Rigid motion: height and, if free, tilt.
    distance : array (x, y)
        Distance of the surfaces: an unknown, because a start may be interpolated from other cells.
    mismatch : array (x, y)
        Distance less the distance that pressure and motion cause.
    """

    pressure: FloatArray
    motion: FloatArray
    distance: FloatArray
    mismatch: FloatArray


def initial_state(problem: FilmProblem, pressure: FloatArray, motion: FloatArray, distance: FloatArray) -> FilmState:
    """Return a state with the mismatch of the given values."""
    rigid = (motion @ problem.motions).reshape(problem.gap.shape)
    return FilmState(pressure, motion, distance, distance - problem.gap - problem.displace(pressure) - rigid)


class FilmSolution(NamedTuple):
    """Solution of a film problem.

    Attributes
    ----------
    state : FilmState
        Pressure and distance of the surfaces.
    fluid_pressure, asperity_pressure, film : array (x, y)
        Pressures of the fluid and of the asperities; mean height of the film.
    flow : array (x, y + 1)
        Flow along y through the faces.
    outflow : array (x, y)
        Net outflow of each cell per width.
    cavitated : array of bool (x, y)
        Cells with a broken film.
    residual, load_error, complementarity_error, mismatch : float
        Certificate: largest net outflow of a full cell over the central film, error of load and moment over the load,
        and largest net inflow of a cavitated cell and mismatch of the distance, both over the central film.
    newton_steps, linear_steps : int
        Steps taken.
    converged : bool
        Whether the tolerance was reached.
    """

    state: FilmState
    fluid_pressure: FloatArray
    asperity_pressure: FloatArray
    film: FloatArray
    flow: FloatArray
    outflow: FloatArray
    cavitated: BoolArray
    residual: float
    load_error: float
    complementarity_error: float
    mismatch: float
    newton_steps: int
    linear_steps: int
    converged: bool
