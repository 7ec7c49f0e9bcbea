"""Cells of a film, and initial states on them."""

from dataclasses import replace
from random import Random

import numpy as np
import pytest

import contactstudy as cs
from benchmarks.random_films import draw_case
from contactstudy.film import levels, solve_film
from contactstudy.film.newton import SETTINGS
from contactstudy.film.solve import create_film_case

COARSE_RESOLUTION = replace(
    levels.RESOLUTION,
    finest=1.1,
    finest_share=0.24,
    inner=0.32,
    inner_inlet=5,
    growth=0.2,
    columns=0.24,
    columns_inlet=0.8,
)


def make_short_case(**changes):
    """A steel roller of 6 a with a crown on a flush body."""
    steel = cs.Material(210e9, 0.3)
    length = 6 * 65e-6
    case = cs.Case(
        body=cs.FiniteLengthSpace(length=length, material=steel),
        roller=cs.Roller(radius=5e-3, length=length, profile=cs.profiles.Lundberg(amplitude=0.2e-6)),
        max_pressure=1.5e9,
        motion=cs.Sliding(body_speed=1.0, roller_speed=1.0),
        lubricant=cs.Lubricant.preset("heavy machine oil", 60.0),
    )
    return replace(case, **changes)


@pytest.mark.slow
def test_dry_start_converges_on_columns_of_a_thin_film(monkeypatch):
    """In an iteration from the gap alone, cells leave the contact one by one; 500 iterations leave an overlap of 120
    films."""
    iterates = []

    class NewtonReachedError(Exception):
        pass

    def stop_before_newton(_problem, _guess, _settings, make_start):
        make_start()
        raise NewtonReachedError

    def record_iterate(*arguments):
        iterates.append(solve_normal(*arguments))
        return iterates[-1]

    solve_normal = levels.solve_normal
    monkeypatch.setattr(levels, "solve_normal", record_iterate)
    monkeypatch.setattr(levels, "solve_newton", stop_before_newton)
    film = create_film_case(draw_case(Random(1051)))
    with pytest.raises(NewtonReachedError):
        levels.film_on_level(film, film.coarsest_level, SETTINGS)
    assert iterates[0].converged


def test_dry_start_that_has_not_converged_raises(monkeypatch):
    solve_normal = levels.solve_normal
    monkeypatch.setattr(levels, "solve_normal", lambda *arguments: replace(solve_normal(*arguments), converged=False))
    with pytest.raises(cs.FilmError, match=r"the dry contact on its cells has not converged in \d+ iterations"):
        solve_film(make_short_case(), accuracy=0.2, resolution=COARSE_RESOLUTION)


def test_nan_guess_is_replaced_by_dry_contact(monkeypatch):
    film = create_film_case(make_short_case(), resolution=COARSE_RESOLUTION)
    level = film.coarsest_level
    first_film = levels.film_on_level(film, level, SETTINGS)

    def make_nan_state(*arguments):
        state = transfer_state(*arguments)
        return state._replace(distance=np.nan * state.distance)

    transfer_state = levels._transfer_state
    monkeypatch.setattr(levels, "_transfer_state", make_nan_state)
    second_film = levels.film_on_level(film, level, SETTINGS, first_film)
    assert second_film.solution.film == pytest.approx(first_film.solution.film, rel=1e-9)


def test_guess_of_thick_film_is_consistent_with_its_pressure():
    """Thin films are interpolated: their distance differs from the distance that pressure and motion cause."""
    film = create_film_case(make_short_case(), resolution=COARSE_RESOLUTION)
    coarse_film = levels.film_on_level(film, film.coarsest_level, SETTINGS)
    fine_level = film.coarsest_level.refined("columns", film, [(0.5, 0.1), (5.5, 0.1)])
    problem = levels.film_on_level(film, fine_level, SETTINGS).problem
    guess = levels._transfer_state(coarse_film, problem)
    caused_distance = guess.distance - guess.mismatch
    rigid_height = (guess.motion @ problem.motions).reshape(problem.gap.shape)
    assert caused_distance == pytest.approx(problem.gap + problem.displace(guess.pressure) + rigid_height, abs=1e-12)
    is_thick = guess.distance > 4 * problem.central_film
    is_thin = guess.distance < 2 * problem.central_film
    assert is_thick.mean() > 0.3
    assert np.abs(guess.mismatch[is_thick]).max() <= 1e-12
    assert np.abs(guess.mismatch[is_thin]).max() > 1e-3 * problem.central_film


def test_refined_columns_are_narrow_at_each_minimum():
    """Columns of 0.01 a at the flat least film of a tilted roller (random seed 1056) stopped Newton."""
    film = create_film_case(make_short_case(), resolution=COARSE_RESOLUTION)
    cells, _ = levels.create_cells(film, film.coarsest_level)
    minima = [(0.5, 0.1), (3.0, 1.5)]  # positions and lengths
    level_refined_once = film.coarsest_level.refined("columns", film, minima)
    level_refined_twice = level_refined_once.refined(
        "columns", film, [(position, 3 * length) for position, length in minima]
    )
    cells_refined_once, cells_refined_twice = (
        levels.create_cells(film, level)[0] for level in (level_refined_once, level_refined_twice)
    )
    for (position, _), width in zip(minima, (0.5 * cells.widths.min(), 0.6), strict=True):
        columns = [
            cells.widths[np.abs(cells.x - position).argmin()] for cells in (cells_refined_once, cells_refined_twice)
        ]
        assert columns == pytest.approx([width, 0.5 * width], rel=0.3)
