"""Checks of the film: line contacts, the certificate, a body whose ends are far away, finite elements.

* Moes, *Wear* 159 (1992) 57: the central film of a line contact in the numbers M and L.
* Biboulet and Houpert, *Proc. IMechE J* 224 (2010) 777: rolling moment ``t / (p0 a**2) = 1.45 M**-1.5``; the moment of
  the pressure about the middle is ``2 t``. The moment rises with the length of the inlet.
* Nijenbanning, Venner and Moes, *Wear* 176 (1994) 217: the central film of an elliptic contact.
* Martin, *Engineering* 102 (1916) 119: ``H = 2.448 / M`` of rigid surfaces and constant viscosity.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from contactstudy import film
from contactstudy.bodies import FiniteLengthSpace, HalfSpace, Lubricant, Material
from contactstudy.bodies.models import Body
from contactstudy.case import Case, Roller
from contactstudy.case.motion import Sliding
from contactstudy.film import line_contact
from contactstudy.film.levels import FilmCase, continue_solution, film_on_level, moes_line
from contactstudy.film.newton import SETTINGS
from contactstudy.film.solve import create_film_case
from contactstudy.profiles import FullCrown, Lundberg
from contactstudy.verification.free_ends import FINITE_ELEMENTS
from contactstudy.verification.problems import FILM_CASES, FILM_FILE, Check, Curve, Reference, load_reference

# Moes' numbers M, L: extrapolated central and least film H of Barus oil of constant density; two programs agree to
# 0.2 %. Below M = 100 an inlet of four half-widths reproduces the table; a converged inlet gives thicker films.
TABLE_INLET = 4.0  # below M = 100, over the half-width
FILM_TABLE = {
    (2.0, 5.0): (4.451, 3.470),
    (20.0, 10.0): (5.270, 3.968),
    (200.0, 10.0): (4.009, 2.990),
    (10.0, 5.0): (3.813, 2.881),
    (20.0, 5.0): (3.500, 2.632),
    (100.0, 10.0): (4.367, 3.265),
    (1000.0, 10.0): (3.265, 2.434),
}
STEEL, RADIUS, HALF_WIDTH = Material(210e9, 0.3), 5e-3, 65e-6
BARUS_OIL: dict[str, Any] = {"viscosity_law": "barus", "density_law": "constant"}


def line_checks(*, full: bool) -> Iterator[Check]:
    """Table, formula, rolling moment and limits of line contacts."""
    for (load, lubricant), films in list(FILM_TABLE.items())[: None if full else 3]:
        # The converged inlet shows the error by the table's short inlet.
        inlets = {TABLE_INLET: 5e-3} | ({None: 0.05} if full else {}) if load < 100 else {None: 5e-3}
        for inlet, tolerance in inlets.items():
            line = line_contact.solve_line(load, lubricant, finest=0.1, inlet=inlet)
            case = f"line contact, M = {load:g}, L = {lubricant:g}" + (f", inlet {inlet:g} a" if inlet else "")
            reference = Reference(case, "extrapolated table")
            yield reference.compare("central film H", line.central_film, films[0], tolerance, relative=True)
            yield reference.compare("least film H", line.least_film, films[1], tolerance, relative=True)
    lubricants = (5.0, 10.0, 15.0) if full else (10.0,)
    for load in (2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0) if full else (200.0,):
        lines = [line_contact.solve_line(load, lubricant) for lubricant in lubricants]
        moments = np.array([line.rolling_moment for line in lines])
        case = f"line contact, M = {load:g}, L = {', '.join(f'{lubricant:g}' for lubricant in lubricants)}"
        shifts = np.array([abs(line.moment) / 2 for line in lines])
        yield Reference(case, "equilibrium").compare("w delta / 2 over t", shifts / moments, 1.0, 1e-2)
        reference, formula = Reference(case, "Biboulet and Houpert (2010)"), 1.45 * load**-1.5
        yield reference.compare("rolling moment t / (p0 a^2) over the formula", moments / formula, 1.0, 0.18)
    for load in (50.0, 500.0) if full else (50.0,):
        line, case = line_contact.solve_line(load, 10.0), f"line contact, M = {load:g}, L = 10"
        formula = float(moes_line(load, 10.0))
        yield Reference(case, "Moes (1992)").compare("central film H", line.central_film, formula, 0.04, relative=True)
    line, expected = line_contact.solve_line(20.0, 10.0, inlet=TABLE_INLET), 1.45 * 20.0**-1.5
    reference = Reference(f"line contact, M = 20, L = 10, inlet {TABLE_INLET:g} a", "Biboulet and Houpert (2010)")
    yield reference.compare("rolling moment t / (p0 a^2)", line.rolling_moment, expected, 0.04, relative=True)
    rigid_film = 0.1 * line_contact.solve_line(0.1, 0.01, finest=0.4).central_film
    case = "line contact, M = 0.1, L = 0.01"
    yield Reference(case, "Martin (1916)").compare("M H of rigid surfaces", rigid_film, 2.448, 5e-3, relative=True)


def dry_limit_checks() -> Iterator[Check]:
    """Compare the pressure under a heavy load with the Hertz pressure, and the film's growth with the exponent."""
    films = {load: line_contact.solve_line(load, 10.0) for load in (200.0, 2000.0)}
    heavy_film = films[2000.0]
    is_inner = np.abs(heavy_film.y) < 0.9
    y, pressure = heavy_film.y[is_inner], heavy_film.pressure[is_inner]
    hertz = np.sqrt(1 - y**2)
    curve = Curve(("y / a", "p / p0"), y, pressure, hertz)
    case = "line contact, M = 2000, L = 10"
    yield Reference(case, "Hertz").compare("pressure / p0, abs(y) < 0.9 a", pressure, hertz, 0.01, curve=curve)
    exponent = np.log10(heavy_film.central_film / films[200.0].central_film)
    case = "line contacts, M = 200 and 2000, L = 10"
    yield Reference(case, "Moes (1992)").compare("exponent of M in the central film", float(exponent), -0.125, 0.01)


def crowned_case(body: Body, length: float) -> Case:
    """Crowned roller in the middle of a body, with the numbers of the stored film."""
    stored_case = FILM_CASES["crowned"]
    profile = Lundberg(amplitude=stored_case.amplitude * HALF_WIDTH**2 / RADIUS)
    roller = Roller(radius=RADIUS, length=length, profile=profile)
    pressure = HALF_WIDTH * STEEL.plane_strain_modulus / (2 * RADIUS)
    offset = 0.5 * (body.length - length) if isinstance(body, FiniteLengthSpace) else None
    dry_case = Case(body=body, roller=roller, max_pressure=pressure, end_distance=offset)
    modulus = 2 * dry_case.modulus
    half_width_ratio = dry_case.normal_load / (dry_case.contact_length * modulus * RADIUS * stored_case.load_number)
    pressure_viscosity = stored_case.lubricant_number / (modulus * half_width_ratio**0.5)
    viscosity = 0.5 * half_width_ratio**2 * modulus * RADIUS
    oil = Lubricant(viscosity=viscosity, pressure_viscosity=pressure_viscosity, **BARUS_OIL)
    return replace(dry_case, lubricant=oil, motion=Sliding(body_speed=1.0, roller_speed=1.0))


def coarse_film(name: str) -> FilmCase:
    """Film on the cells of the coarsest level, for comparison with the stored film."""
    length = FILM_CASES[name].length * HALF_WIDTH
    return create_film_case(crowned_case(FiniteLengthSpace(length=length, material=STEEL), length))


def finite_element_checks(name: str) -> Iterator[Check]:
    """Compare a film between two free ends with the film of finite elements on the same cells."""
    stored, problem = load_reference(FILM_FILE, name), FILM_CASES[name]
    film_case = coarse_film(name)
    level_film = film_on_level(film_case, film_case.coarsest_level, SETTINGS)
    solution = continue_solution(film_case, level_film, SETTINGS).solution
    fields = {"film": solution.film, "pressure": solution.fluid_pressure}
    # The cells of both solutions differ only by rounding.
    computed = xr.Dataset({key: (("x", "y"), field) for key, field in fields.items()}, stored.coords)
    case = f"crowned roller, {problem.length:g} a, flush, M = {problem.load_number:g}, L = {problem.lubricant_number:g}"
    reference = Reference(case, FINITE_ELEMENTS.format(stored.attrs["film_error"], "of the film, on the same cells"))
    axis, expected = (solution["film"].interp(y=0.0).values for solution in (computed, stored))
    curve = Curve(("x / a", "h R / a^2 at y = 0"), stored["x"].values, axis, expected)
    yield reference.compare("film at y = 0 over the reference", axis / expected, 1.0, 0.02, curve=curve)
    min_film, expected = (solution["film"].min("y").values for solution in (computed, stored))
    yield reference.compare("least film of each column over the reference", min_film / expected, 1.0, 0.02)
    yield reference.compare("pressure / p0", computed["pressure"], stored["pressure"], 0.01)


def nijenbanning(load: float, lubricant: float, ratio: float = 1.0) -> float:
    """Central film of an elliptic contact by Nijenbanning, Venner and Moes (1994), eq. (411); `ratio` at most 1.

    Of ``M = F / (E' Rx**2) (2 U)**-3/4``, ``L``, and ``Rx / Ry`` with the radius Rx along rolling.
    """
    h_ri = 145 * (1 + 0.796 * ratio ** (14 / 15)) ** (-15 / 7) * load**-2 / ratio
    h_ei = 3.18 * (1 + 0.006 * np.log(ratio) + 0.63 * ratio ** (4 / 7)) ** (-14 / 25) * ratio ** (-1 / 15)
    h_ei *= load ** (-2 / 15)
    h_rp = 1.29 * (1 + 0.691 * ratio) ** (-2 / 3) * lubricant ** (2 / 3)
    h_ep = 1.48 * (1 + 0.006 * np.log(ratio) + 0.63 * ratio ** (4 / 7)) ** (-7 / 20) * ratio ** (-1 / 24)
    h_ep *= load ** (-1 / 12) * lubricant**0.75
    s = 1.5 * (1 + np.exp(-1.2 * h_ei / h_ri))
    isoviscous = (h_ri**1.5 + (h_ei**-4 + (1.8 / ratio) ** -4) ** (-3 / 8)) ** (2 * s / 3)
    return float((isoviscous + (h_rp**-8 + h_ep**-8) ** (-s / 8)) ** (1 / s))


def ellipse_checks() -> Iterator[Check]:
    """Compare the central films of a circular and of an elliptic contact on a half-space with the formula."""
    radius, speed, viscosity, modulus = 10e-3, 1.0, 0.04, 2 * STEEL.plane_strain_modulus
    root = float(np.sqrt(2 * viscosity * speed / (modulus * radius)))  # sqrt(2 U)
    for load, lubricant, ratio in ((20.0, 5.0, 1.0), (100.0, 10.0, 0.3)):
        force, crown_radius = load * modulus * radius**2 * root**1.5, radius / ratio
        # The roller is longer than the contact, 2 b, by the length over which the film forms.
        half_length = float(
            np.cbrt(3 * force * np.sqrt(radius * crown_radius) / modulus) * (crown_radius / radius) ** 0.25
        )
        roller = Roller(radius=radius, length=5 * half_length, profile=FullCrown(crown_radius))
        motion = Sliding(body_speed=speed, roller_speed=speed)
        pressure_viscosity = lubricant / (modulus * np.sqrt(root))
        oil = Lubricant(viscosity=viscosity, pressure_viscosity=pressure_viscosity, **BARUS_OIL)
        lubricated = Case(body=HalfSpace(material=STEEL), roller=roller, load=force, motion=motion, lubricant=oil)
        solved_film = film.solve_film(lubricated, accuracy=0.2)
        central, formula = solved_film["central_film"] / (radius * root), nijenbanning(load, lubricant, ratio)
        case = f"crowned roller on a half-space, Rx / Ry = {ratio:g}, M = {load:g}, L = {lubricant:g}"
        reference = Reference(case, "Nijenbanning, Venner and Moes (1994)")
        yield reference.compare("central film H", central, formula, 0.04, relative=True)


def roller_checks(*, full: bool) -> Iterator[Check]:
    """Certificate and middle of a film between free ends; at the full level, free ends far away."""
    length = 32 * HALF_WIDTH
    flush_case = crowned_case(FiniteLengthSpace(length=length, material=STEEL), length)
    flush_film = film.solve_film(flush_case, accuracy=0.1)
    case = "crowned roller, 32 a, flush, M = 10, L = 5"
    yield Reference(case, "mass balance").compare("net outflow of a cell / (um h)", flush_film["mass_error"], 0.0, 1e-6)
    balance = flush_film["film_balance_error"]
    yield Reference(case, "mass balance with the ends").compare("net outflow of the film / (um h)", balance, 0.0, 1e-8)
    area = flush_film["x_width"] * float(flush_film["y"][1] - flush_film["y"][0])
    load, quantity = (flush_film["pressure"] * area).sum(), "sum of the pressure over the cells, N"
    yield Reference(case, "equilibrium").compare(quantity, load, flush_film["normal_load"], 1e-8, relative=True)
    line = line_contact.solve_line(float(flush_film["moes_load"]), float(flush_film["moes_lubricant"]), finest=0.1)
    height = RADIUS * np.sqrt(2 * create_film_case(flush_case).speed_number)
    for name, expected in (("central_film", line.central_film), ("least_film_middle", line.least_film)):
        yield Reference(case, "line contact").compare(
            f"{name}, H", flush_film[name] / height, expected, 5e-3, relative=True
        )
    if full:
        bodies = FiniteLengthSpace(length=10 * length, material=STEEL), HalfSpace(material=STEEL)
        long_film, half_space_film = (film.solve_film(crowned_case(body, length), accuracy=0.1) for body in bodies)
        reference = Reference("crowned roller, 32 a, 144 a from both free ends", "half-space")
        for name in ("central_film", "least_film"):
            yield reference.compare(f"{name}, m", long_film[name], half_space_film[name], 5e-3, relative=True)
