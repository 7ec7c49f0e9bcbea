"""Film of a line contact in Moes' numbers: the special case for which formulas and tables exist."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contactstudy.bodies.lubricant import Lubricant
from contactstudy.checks import FloatArray
from contactstudy.film.levels import moes_line
from contactstudy.film.newton import SETTINGS, FilmProblem, FilmSolution, FilmState, solve_newton
from contactstudy.film.reynolds import FilmCells, Fluid, graded_edges

BARUS = Lubricant(viscosity=0.01, pressure_viscosity=1e-8, viscosity_law="barus", density_law="constant")
COARSEST_FROM_DRY = 0.35  # Narrowest cells that start from the dry contact, as `finest` of `solve_line`. Speed.


class LineFilm(NamedTuple):
    """Film of a line contact."""

    central_film: float  # films ``H = h / R (2 U)**-1/2``
    least_film: float
    y: FloatArray  # position over a
    pressure: FloatArray  # over p0
    film: FloatArray  # ``h R / a**2``
    moment: float  # of the pressure about the middle, per length, over ``p0 a**2``: ``-w delta``
    rolling_moment: float  # ``t`` about the roller's axis of the shear by the pressure's gradient: ``w delta = 2 t``
    solution: FilmSolution


def line_stiffness(edges: FloatArray, centres: FloatArray) -> FloatArray:
    """Matrix: ``u R / a**2`` at `centres` per ``p / p0`` between `edges`, in units of ``a``, up to a constant."""
    distance = centres[:, None] - edges[None, :]
    primitive = distance * (np.log(np.abs(distance)) - 1)
    return np.asarray(np.diff(primitive, axis=1) / np.pi)


def solve_line(
    load: float,
    lubricant: float,
    *,
    finest: float = 0.2,  # narrowest cells over the length on which the film forms
    inlet: float | None = None,  # distance of the inlet from the middle over a; default: without influence
    oil: Lubricant = BARUS,  # viscosity and Barus' coefficient have no influence
    max_pressure: float | None = None,  # p0, Pa, for laws other than Barus', whose coefficient then follows from L
) -> LineFilm:
    """Solve for the film of a line contact of Moes' numbers M and L from the film on cells twice as wide."""
    coarse = None
    if finest < COARSEST_FROM_DRY:
        coarse = solve_line(load, lubricant, finest=2 * finest, inlet=inlet, oil=oil, max_pressure=max_pressure)
    alpha_p0 = lubricant * np.sqrt(load / (2 * np.pi))  # alpha p0
    p0 = alpha_p0 / oil.pressure_viscosity if max_pressure is None else max_pressure
    if max_pressure is not None:
        oil = oil.replaced(pressure_viscosity=alpha_p0 / max_pressure)

    central_film = float(moes_line(load, lubricant)) * np.pi / (8 * load)
    delta = central_film ** (2 / 3)
    inlet_edge = -inlet if inlet is not None else -1 - 40 * delta
    min_width = min(finest * delta, finest * 0.25)

    def cell_width(y: float) -> float:
        distance = max(0.0, min(abs(y + 1), abs(y - 1)) - delta)
        return float(min(min_width + 0.5 * finest * distance, 0.25 * finest + 0.1 * max(0.0, abs(y) - 1)))

    edges = graded_edges(inlet_edge, 1 + 8 * delta, cell_width)
    cells = FilmCells(x_edges=np.array([0.0, 1.0]), y_edges=edges, open_ends=False)
    y, stiffness = cells.y, line_stiffness(edges, cells.y)
    problem = FilmProblem(
        cells=cells,
        fluid=Fluid.of(oil, p0, 3 * np.pi**2 / (8 * load**2)),
        gap=0.5 * y[None] ** 2,
        displace=lambda pressure: pressure @ stiffness.T,
        column_stiffness=stiffness[None].astype(np.float32),
        load=0.5 * np.pi,
        lever=None,
        central_film=central_film,
    )

    def start_from_hertz_pressure() -> FilmState:
        hertz_pressure = np.sqrt(np.maximum(1 - y**2, 0.0))[None]
        deformed_gap = problem.gap + problem.displace(hertz_pressure)
        motion = np.array([central_film - deformed_gap[0, np.abs(y).argmin()]])
        return problem.create_state(hertz_pressure, motion, np.maximum(deformed_gap + motion[0], central_film))

    guess = None
    if coarse is not None:
        pressure, start_film = (np.interp(y, coarse.y, values)[None] for values in (coarse.pressure, coarse.film))
        guess = problem.create_state(pressure, coarse.solution.state.motion, start_film)
    solution = solve_newton(problem, guess, SETTINGS, start_from_hertz_pressure)
    height = solution.film[0]
    thinnest_cell = int(height.argmin())
    neighbours = slice(thinnest_cell - 1, thinnest_cell + 2)
    curvature, slope, _ = np.polyfit(y[neighbours] - y[thinnest_cell], height[neighbours], 2)
    film_scale = 8 * load / np.pi
    pressure = solution.fluid_pressure[0]
    return LineFilm(
        central_film=film_scale * float(np.interp(0.0, y, height)),
        least_film=film_scale * float(height[thinnest_cell] - slope**2 / (4 * curvature)),
        y=y,
        pressure=pressure,
        film=height,
        moment=float((pressure * y * cells.lengths).sum()),
        rolling_moment=0.5 * float((0.5 * (height[1:] + height[:-1]) * np.diff(pressure)).sum()),  # eq. (415)
        solution=solution,
    )
