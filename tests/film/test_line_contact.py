"""Film of line contacts against tables, limits and formulas."""

import numpy as np
import pytest

from contactstudy import Lubricant
from contactstudy.film.levels import moes_line
from contactstudy.film.line_contact import solve_line
from contactstudy.verification.film import nijenbanning

pytestmark = pytest.mark.filterwarnings("ignore::contactstudy.MagnitudeWarning")

BARUS_TABLE = [
    (2, 5, 4.451, 3.470),
    (20, 10, 5.270, 3.968),
    (1000, 10, 3.265, 2.434),
]
ROELANDS_TABLE = [(20, 5, 2.9088, 2.5116), (50, 10, 3.871, 3.400)]


# The inlets of the table have four half-widths, which matters at low loads.
@pytest.mark.parametrize(("load", "lubricant", "central_film", "least_film"), BARUS_TABLE)
def test_film_of_barus_oil_equals_table(load, lubricant, central_film, least_film):
    film = solve_line(load, lubricant, finest=0.1, inlet=4.0 if load < 100 else None)
    assert film.central_film == pytest.approx(central_film, rel=5e-3)
    assert film.least_film == pytest.approx(least_film, rel=5e-3)
    assert film.solution.residual < 1e-6
    assert film.solution.load_error < 1e-8


@pytest.mark.parametrize(("load", "lubricant", "central_film", "least_film"), ROELANDS_TABLE)
def test_film_of_compressible_roelands_oil_equals_table(load, lubricant, central_film, least_film):
    oil = Lubricant(viscosity=0.01, pressure_viscosity=1e-8, roelands_exponent=0.68)
    film = solve_line(load, lubricant, finest=0.1, inlet=4.0, oil=oil, max_pressure=1e9)
    assert film.central_film == pytest.approx(central_film, rel=5e-3)
    assert film.least_film == pytest.approx(least_film, rel=5e-3)


@pytest.mark.slow
def test_rigid_isoviscous_limit_agrees_with_martin():
    assert 0.1 * solve_line(0.1, 0.01, finest=0.4).central_film == pytest.approx(2.448, rel=5e-3)


@pytest.mark.parametrize(("load", "lubricant"), [(20, 10), (200, 10)])
def test_rolling_moment_follows_the_load(load, lubricant):
    film = solve_line(load, lubricant, inlet=4.0)
    assert film.rolling_moment == pytest.approx(1.45 * load**-1.5, rel=0.04)
    # With w delta = 2 t the moment of the pressure is twice the moment of its force on the slopes.
    assert abs(film.moment) == pytest.approx(2 * film.rolling_moment, rel=0.01)


def test_film_formulas_return_published_values():
    assert float(moes_line(100.0, 10.0)) == pytest.approx(4.297, abs=1e-3)
    assert nijenbanning(20.0, 10.0) == pytest.approx(4.71, abs=0.005)


def test_pressure_of_a_heavy_load_is_hertzian():
    film = solve_line(2000, 10)
    is_inner = np.abs(film.y) < 0.9
    assert np.abs(film.pressure - np.sqrt(np.maximum(1 - film.y**2, 0)))[is_inner].max() < 0.01
