"""Steps of wear: implicit, of second order, as long as their own estimate of the error allows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.wear.worn_contact import WornContact

STAGE = 1 - np.sqrt(0.5)
"""Length of either implicit stage over that of the step, with which the scheme damps the stiffest wear fully
(R. Alexander, SIAM Journal on Numerical Analysis 14 (1977) 1006, theorem 5). Accuracy."""

FIRST_WORN = 1e-3
"""Depth that the first step wears off at most, over the depth ``a**2 / (2 R)`` by which a roller sinks in. Speed."""

SAFETY, LARGEST_GROWTH, LARGEST_CUT = 0.85, 4.0, 0.2
"""Factor on the next step, and its bounds. Speed."""


SHORTEST = 1e-6
"""Length over the first one below which a step is taken in spite of its error, which is stated. Speed."""


class State(NamedTuple):
    """Where the wear stands.

    Attributes
    ----------
    distance : float
        Slid or rolled so far, metres.
    depth : array (x)
        Worn depth, metres.
    pressure : array (x, y)
        Pressure on the profile as worn, Pa.
    slip : array (x)
        What the load per length is multiplied with to give wear.
    error : float
        Estimated error of the depth, summed over the steps, metres.
    worn : float
        Volume over the circumference that the law gives for the pressures along the way, by trapezoids, m2.
    converged : bool
        Whether every contact converged.
    """

    distance: float
    depth: FloatArray
    pressure: FloatArray
    slip: FloatArray
    error: float = 0.0
    worn: float = 0.0
    converged: bool = True


@dataclass(frozen=True, eq=False)
class Stepper:
    """Takes steps.

    Attributes
    ----------
    contact : WornContact
        The contact.
    rate : float
        Worn depth per distance, load per length and slip, m2/N per metre.
    law : str
        "slip" or "work".
    tolerance : float
        Error of the depth that one step may make, over the largest depth.
    """

    contact: WornContact
    rate: float
    law: str
    tolerance: float

    def begun(self, distance: float, depth: FloatArray, error: float) -> State:
        """Return the state of a worn depth, which is known within an error."""
        pressed = self.contact.pressed(depth, np.zeros_like(depth), None)
        slip = self.contact.slip(depth, self.law)
        return State(distance, depth, pressed.pressure, slip, error, converged=pressed.converged)

    def first_step(self, state: State) -> float:
        """Return a step that wears off little wherever the pressure is."""
        case, grid = self.contact.case, self.contact.shape.grid
        load = grid.dy * state.pressure.sum(axis=1)
        sinking = case.hertz_half_width**2 / (2 * case.roller.radius)
        fastest = float((self.rate * state.slip * load).max())
        return FIRST_WORN * sinking / fastest if fastest > 0 else np.inf

    def states(self, state: State, until: float, step: float) -> Iterator[tuple[State, float]]:
        """Go on to a distance; after each step give its state and the length of the next."""
        least = SHORTEST * min(step, until - state.distance)
        while state.distance < until:
            remaining = until - state.distance
            taken = min(step, remaining)
            if remaining < 1.5 * taken:
                taken = remaining
            here = state._replace(converged=True)
            whole = self._stepped(here, taken)
            halved = self._stepped(self._stepped(here, 0.5 * taken), 0.5 * taken)
            # Two halves of a scheme of second order err by a quarter of the whole.
            error = float(np.abs(halved.depth - whole.depth).max()) / 3
            allowed = self.tolerance * float(halved.depth.max())
            growth = SAFETY * (allowed / error) ** (1 / 3) if error > 0 else LARGEST_GROWTH
            factor = min(max(growth, LARGEST_CUT), LARGEST_GROWTH)
            solved = halved.converged and whole.converged
            if (error > allowed or not solved) and taken > least:
                step = (factor if solved else LARGEST_CUT) * taken
                continue
            reached = until if taken == remaining else state.distance + taken
            worn = state.worn + 0.5 * taken * (self._area_per_distance(state) + self._area_per_distance(halved))
            converged = state.converged and halved.converged
            state = halved._replace(distance=reached, error=state.error + error, worn=worn, converged=converged)
            step = max(step, factor * taken)
            yield state, step

    def _area_per_distance(self, state: State) -> float:
        """Return what the law wears off a section along the axis, per distance."""
        grid = self.contact.shape.grid
        return self.rate * grid.dy * float((grid.widths * state.slip) @ state.pressure.sum(axis=1))

    def _stepped(self, state: State, length: float) -> State:
        """One step, or a predictor and a corrector if the slip depends on the depth."""
        stepped = self._staged(state, length, state.slip, state.slip)
        slip = self.contact.slip(stepped.depth, self.law)
        if np.array_equal(slip, state.slip):
            return stepped
        between = state.slip + STAGE * (slip - state.slip)
        return self._staged(state, length, between, slip)

    def _staged(self, state: State, length: float, first: FloatArray, last: FloatArray) -> State:
        """Two implicit stages, of which the second is the result."""
        early, late = self.rate * length * first, self.rate * length * last
        one = self.contact.pressed(state.depth, STAGE * early, state.pressure)
        known = state.depth + (1 - STAGE) * early * one.line_load
        two = self.contact.pressed(known, STAGE * late, one.pressure)
        depth = known + STAGE * late * two.line_load
        converged = state.converged and one.converged and two.converged
        return State(state.distance + length, depth, two.pressure, last, converged=converged)
