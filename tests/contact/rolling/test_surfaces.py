"""Forces and moments that full sliding can cause, and rigid motions against their resultants."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Grid, Material, Rolling
from contactstudy.checks import FloatArray
from contactstudy.contact.rolling.surfaces import Surfaces, _largest_multiple, check_forces
from contactstudy.errors import InvalidInputError

GRID = Grid.between(np.cumsum([5.0, 0.1, 0.1, 0.2, 0.3, 0.2, 0.1]), (-0.4, 0.4), 8)
SURFACES = Surfaces(None, GRID, [Material(1.0, 0.3)], 5.45)  # type: ignore[arg-type]


def make_friction_bound() -> FloatArray:
    """Friction times a pressure that is not symmetric."""
    position = ((GRID.x[:, None] - 5.55) / 0.45) ** 2 + (GRID.y / 0.35) ** 2
    return np.asarray(np.sqrt(np.maximum(1 - position, 0.0)) * (1 + GRID.y))


@pytest.mark.parametrize(
    "resultants", [[0.3, -0.1], [0.3, -0.1, 0.02], [0.0, 0.0, -1.0], [0.2, 0.0, 0.05], [1e3, 1e3, 30.0]]
)
def test_largest_multiple_is_minimum_over_directions(resultants: list[float]) -> None:
    """Tractions along the slip of a rigid motion have the largest resultant along it; the test tries many motions."""
    resultant_weights, target = SURFACES.weights[: len(resultants)], np.array(resultants)
    rng = np.random.default_rng(0)
    computed = _largest_multiple(target, make_friction_bound(), resultant_weights)
    sizes = np.array([(make_friction_bound() * np.hypot(*work)).sum() for work in resultant_weights])
    best_direction, search_radius = target / sizes / np.hypot.reduce(target / sizes), 1.0
    minimum = np.inf
    for _ in range(60):  # directions about the best one so far, in ever smaller distances
        trial_directions = best_direction + search_radius * rng.standard_normal((200, target.size))
        trial_directions[0] = best_direction
        trial_directions = trial_directions[(trial_directions * target / sizes).sum(axis=1) > 0] / sizes
        slips = np.tensordot(trial_directions, resultant_weights, axes=1)
        multiples = (make_friction_bound() * np.hypot(slips[:, 0], slips[:, 1])).sum(axis=(1, 2)) / (
            trial_directions @ target
        )
        if multiples.min() < minimum:
            minimum, best_direction = float(multiples.min()), trial_directions[multiples.argmin()] * sizes
            best_direction = best_direction / np.hypot.reduce(best_direction)
        search_radius *= 0.85
    assert computed == pytest.approx(minimum, rel=1e-4)
    for factor in (3.0, 1e-200):
        assert _largest_multiple(factor * target, make_friction_bound(), resultant_weights) == pytest.approx(
            computed / factor, rel=1e-6
        )


def test_single_force_is_limited_by_bound_sum() -> None:
    max_force = float((make_friction_bound() * SURFACES.areas).sum())
    check_forces(Rolling(force_y=0.9999 * max_force), make_friction_bound(), SURFACES.weights)
    check_forces(Rolling(force_y=5e-324), make_friction_bound(), SURFACES.weights)
    check_forces(Rolling(force_y=max_force * (1 - 5e-9)), make_friction_bound(), SURFACES.weights)
    for force_fraction in (1 - 1e-10, 1.0001):
        with pytest.raises(InvalidInputError, match="force_y"):
            check_forces(Rolling(force_y=force_fraction * max_force), make_friction_bound(), SURFACES.weights)
    max_moment = float((make_friction_bound() * SURFACES.areas * np.hypot(GRID.x[:, None] - 5.45, GRID.y)).sum())
    check_forces(Rolling(moment_z=0.999 * max_moment), make_friction_bound(), SURFACES.weights)
    with pytest.raises(InvalidInputError, match="moment_z"):
        check_forces(Rolling(moment_z=1.001 * max_moment), make_friction_bound(), SURFACES.weights)


def test_resultants_are_the_work_on_rigid_motions() -> None:
    """The motions turn about `middle`, anticlockwise in a view from above."""
    for index, name in enumerate(("x", "y", "spin")):
        slip = SURFACES.rigid_slip(name, GRID.x[:, None], GRID.y)
        assert slip * SURFACES.areas == pytest.approx(SURFACES.weights[index], abs=1e-15)
