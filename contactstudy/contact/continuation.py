"""Coulomb's law under prescribed resultants that Newton's method does not meet at once: they are raised step by step.

Near full sliding few cells stick, if any, and a small change of the rigid slip decides which. Newton's method may then
leave the neighbourhood of the solution. So the resultants go from those that the tractions have without the unknown
rigid slips to the prescribed ones, along a line. Tractions within their bound make all resultants between any two that
they make, so there is a solution all along it; each begins from the last, with shorter steps where one is not found.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contactstudy.contact.coulomb import Guess, solve_coulomb
from contactstudy.contact.coulomb_law import CoulombProblem, CoulombSolution

PATIENCE = 40
"""Steps of Newton's method after which the resultants are raised step by step. Speed."""

SHORTEST = 1e-3
"""Least step along the line, over its length, with which the search goes on. Speed."""


def solve_continued(problem: CoulombProblem, start: Guess | None = None) -> CoulombSolution:
    """Solve as `solve_coulomb` does, with more patience where resultants are prescribed."""
    if not len(problem.modes) or problem.max_steps <= PATIENCE:
        return solve_coulomb(problem, start)
    found = solve_coulomb(replace(problem, max_steps=PATIENCE), start)
    if found.converged:
        return found
    none = problem.modes[:0]
    held = solve_coulomb(replace(problem, modes=none, works=none, resultants=problem.resultants[:0]))
    steps, applications = found.steps + held.steps, found.applications + held.applications
    first = (problem.works * held.traction).sum(axis=(1, 2))
    guess, reached, step = Guess(held.traction, np.zeros(len(problem.modes))), 0.0, 0.5
    while reached < 1 and step > SHORTEST and steps < problem.max_steps:
        part = min(1.0, reached + step)
        raised = (1 - part) * first + part * problem.resultants
        found = solve_coulomb(replace(problem, resultants=raised, max_steps=PATIENCE), guess)
        steps, applications = steps + found.steps, applications + found.applications
        if found.converged:
            reached, step, guess = part, 2 * step, Guess(found.traction, found.amplitudes)
        else:
            step *= 0.5
    return replace(found, steps=steps, applications=applications, converged=found.converged and reached == 1)
