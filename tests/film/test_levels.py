"""First guesses of a film on its cells."""

from random import Random

import pytest

from benchmarks.random_films import random_case
from contactstudy.film import levels
from contactstudy.film.newton import SETTINGS
from contactstudy.film.solve import create_film_case


@pytest.mark.slow
def test_dry_start_converges_on_columns_of_a_thin_film(monkeypatch):
    """Cells leave the contact one by one: from the gap alone the surfaces overlap by 120 films after 500 iterations."""
    iterates = []

    class NewtonReachedError(Exception):
        pass

    def stop(*_arguments, **_settings):
        raise NewtonReachedError

    def record(*arguments):
        iterates.append(solve_normal(*arguments))
        return iterates[-1]

    solve_normal = levels.solve_normal
    monkeypatch.setattr(levels, "solve_normal", record)
    monkeypatch.setattr(levels, "solve_newton", stop)
    film = create_film_case(random_case(Random(1051)))
    with pytest.raises(NewtonReachedError):
        levels.film_on_level(film, film.coarsest_level, SETTINGS)
    assert iterates[0].converged
