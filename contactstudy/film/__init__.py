"""Lubricated contact: the film between the surfaces, its pressure and its flow."""

from contactstudy.film.asperities import Asperities
from contactstudy.film.levels import FilmResolution
from contactstudy.film.solve import solve_film
from contactstudy.film.traction import film_traction

__all__ = ["Asperities", "FilmResolution", "film_traction", "solve_film"]
