"""A film to solve, the unknowns of an iteration and the solution, on arrays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.film.reynolds import FilmCells, Fluid, Law

INVERSE_STEPS = 8  # Steps from film to distance of rough surfaces; the next Newton step removes the remainder. Speed


@dataclass(frozen=True, kw_only=True, eq=False)
class FilmProblem:
    """A film to solve, in the units of `FilmCells`."""

    cells: FilmCells
    fluid: Fluid
    gap: FloatArray  # (x, y): gap before deformation
    displace: Callable[[FloatArray], FloatArray]  # displacement of the surfaces apart (x, y) under a pressure
    column_stiffness: FloatArray  # (x, y, y): displacement of a column's cells under a pressure equal in all columns
    load: float  # prescribed sum of the pressure times the areas
    lever: FloatArray | None  # (x): distances from the load's position over the largest one, if free to tilt
    central_film: float  # estimate of the central film: the scale of tolerances
    asperities: Callable[[FloatArray], Law] | None = None  # pressure of the asperities at a distance of the surfaces
    mean_height: Callable[[FloatArray], Law] | None = None  # film at a distance of rough surfaces

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
    """Unknowns of an iteration."""

    pressure: FloatArray  # (x, y): pressure on the surfaces, of fluid and asperities
    motion: FloatArray  # (motion): rigid motion, height and, if free, tilt
    distance: FloatArray  # (x, y): distance of the surfaces, unknown since a start may be interpolated from other cells
    mismatch: FloatArray  # (x, y): distance less the distance that pressure and motion cause


def initial_state(problem: FilmProblem, pressure: FloatArray, motion: FloatArray, distance: FloatArray) -> FilmState:
    """Return a state with the mismatch of the given values."""
    rigid = (motion @ problem.motions).reshape(problem.gap.shape)
    return FilmState(pressure, motion, distance, distance - problem.gap - problem.displace(pressure) - rigid)


class FilmSolution(NamedTuple):
    """Solution of a film problem and its certificate."""

    state: FilmState
    fluid_pressure: FloatArray  # (x, y)
    asperity_pressure: FloatArray  # (x, y)
    film: FloatArray  # (x, y): mean height
    residual: float  # largest net outflow of a full cell over the central film
    load_error: float  # error of load and moment over the load
    complementarity_error: float  # largest net inflow of a cavitated cell over the central film
    newton_steps: int
    linear_steps: int
    converged: bool  # whether every error is within the tolerance
