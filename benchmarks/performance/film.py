"""Rows of the lubricating film: a roller with a logarithmic profile between free ends and on a half-space, and at
nearby speeds."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import xarray as xr

from benchmarks.performance.problems import STEEL
from benchmarks.performance.timing import Report, Row, format_time
from contactstudy import Case, FiniteLengthSpace, HalfSpace, Lubricant, Roller, Sliding, cache
from contactstudy.checks import FloatArray
from contactstudy.film import solve_film
from contactstudy.profiles import Lundberg, Shape

RADIUS, LENGTH, HALF_WIDTH = 5e-3, 10e-3, 65e-6
MOES_LOAD, MOES_LUBRICANT = 20.0, 10.0
SPEED = 1.0
SPEED_FACTORS = (0.8, 1.25)
"""Ratios of the nearby speeds to `SPEED`."""

SPEEDS = (8.0, 2.0, 0.3)
"""Speeds of a crowned roller, m/s: the table of docs/explanation/film.md."""

ACCURACY = 0.02


@dataclass(frozen=True)
class LogarithmicDrop(Shape):
    """Lundberg's profile with a finite drop at the ends."""

    amplitude: float

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed at distances from mid-length."""
        return np.asarray(-self.amplitude * np.log(1 - 0.998 * (2 * x / length) ** 2))


def make_roller_case(speed: float, *, free_ends: bool) -> Case:
    """A rigid roller on a flush steel body, or on a half-space, in an oil with the numbers M and L at `SPEED`."""
    modulus = STEEL.plane_strain_modulus
    pressure = modulus * HALF_WIDTH / (2 * RADIUS)
    line_load = 0.5 * np.pi * HALF_WIDTH * pressure
    root = float(line_load / (2 * modulus * RADIUS * MOES_LOAD))  # sqrt(2 U)
    oil = Lubricant(
        viscosity=root**2 * modulus * RADIUS / SPEED, pressure_viscosity=MOES_LUBRICANT / (2 * modulus * root**0.5)
    )
    return Case(
        body=FiniteLengthSpace(length=LENGTH, material=STEEL) if free_ends else HalfSpace(material=STEEL),
        roller=Roller(radius=RADIUS, length=LENGTH, profile=LogarithmicDrop(HALF_WIDTH**2 / (4 * RADIUS))),
        max_pressure=pressure,
        motion=Sliding(body_speed=speed, roller_speed=speed),
        lubricant=oil,
    )


def make_crowned_case(speed: float) -> Case:
    """A rigid roller with Lundberg's crown for 1 GPa on a flush steel body, in an oil of VG 220 at 70 C."""
    crown = Lundberg.for_pressure(1e9, radius=RADIUS, modulus=STEEL.plane_strain_modulus)
    return Case(
        body=FiniteLengthSpace(length=LENGTH, material=STEEL),
        roller=Roller(radius=RADIUS, length=LENGTH, profile=crown),
        max_pressure=1e9,
        motion=Sliding(body_speed=speed, roller_speed=speed),
        lubricant=Lubricant.from_kinematic(
            70.0, viscosities={40: 220.0, 100: 19.0}, density=870.0, pressure_viscosity=20e-9
        ),
    )


def time_film(case: Case, start: xr.Dataset | None = None) -> tuple[float, xr.Dataset]:
    """Seconds of a film and the film."""
    start_time = time.perf_counter()
    film = solve_film(case, accuracy=ACCURACY, start=start)
    return time.perf_counter() - start_time, film


def films(_: int, report: Report) -> Iterator[Row]:
    """Films from the dry contact, solved once each; later films reuse the operators of earlier films."""
    seconds, film = time_film(make_roller_case(SPEED, free_ends=True))
    half_space_seconds, half_space_film = time_film(make_roller_case(SPEED, free_ends=False))
    min_film, error = 1e9 * float(film["least_film"]), 1e9 * float(film["least_film_error"])
    half_space_min_film = 1e9 * float(half_space_film["least_film"])
    if error > ACCURACY * 1e9 * float(film["central_film"]):
        report.add_remark("the least film has not converged to 2 % of the central film")
    yield Row(
        work=f"film of a rigid roller, 10 mm, M = {MOES_LOAD:g}, L = {MOES_LUBRICANT:g}",
        ours=format_time(seconds),
        peers=f"half-space: {format_time(half_space_seconds)}",
        ratio=f"{seconds / half_space_seconds:.2f}",
        bar="20 s; 2",
        met=seconds <= 20 and seconds <= 2 * half_space_seconds,
        notes=f"least film {min_film:.1f} +- {error:.1f} nm at the end, half-space {half_space_min_film:.1f} nm",
    )
    for factor in SPEED_FACTORS:
        next_seconds, _film = time_film(make_roller_case(factor * SPEED, free_ends=True), start=film)
        yield Row(
            work=f"film at {factor:g} of the speed",
            ours=format_time(next_seconds),
            peers=f"first speed: {format_time(seconds)}",
            ratio=f"{next_seconds / seconds:.2f}",
            bar="0.25",
            met=next_seconds <= 0.25 * seconds,
        )
    for speed in SPEEDS:
        cache.clear()
        seconds, film = time_film(make_crowned_case(speed))
        central, least = (
            f"{1e9 * float(film[name]):.1f} +- {1e9 * float(film[f'{name}_error']):.1f} nm"
            for name in ("central_film", "least_film")
        )
        yield Row(
            work=f"film of a crowned roller, 10 mm, VG 220 at 70 C, {speed:g} m/s",
            ours=format_time(seconds),
            notes=f"M = {float(film['moes_load']):.1f}, L = {float(film['moes_lubricant']):.0f}, "
            f"central film {central}, least film {least}, "
            f"{int(film['newton_steps'])} Newton and {int(film['linear_steps'])} GMRES steps",
        )
