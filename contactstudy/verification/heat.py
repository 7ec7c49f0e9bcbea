"""Checks of the flash temperature: closed forms of fast, slow and resting sources, insulated ends, and all the heat."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from contactstudy.arrays.grid import Grid
from contactstudy.bodies import FiniteLengthSpace, Material
from contactstudy.case import Case, Roller
from contactstudy.checks import FloatArray
from contactstudy.heat import ThermalProperties, flash_temperature
from contactstudy.heat.moving_source import MovingBody, SourceOperator
from contactstudy.heat.spreading import Ends
from contactstudy.verification import closed_forms
from contactstudy.verification.check import Check, Curve, compare, compare_fields

STEEL = ThermalProperties(conductivity=46.0, density=7850.0, specific_heat=470.0)
UNIT = ThermalProperties(conductivity=1.0, density=1.0, specific_heat=1.0)
EVERYWHERE = Ends(-np.inf, np.inf)


def rise(grid: Grid, heat: FloatArray, speed: float, ends: Ends, depth: float = 0.0) -> FloatArray:
    """Rise of a body of unit properties."""
    body = MovingBody(UNIT, speed, ends)
    return SourceOperator(body, grid, slice(0, grid.cells_x), depth)(np.broadcast_to(heat, grid.shape))


def line_case() -> tuple[Case, xr.Dataset]:
    """Hertz' line pressure along a whole body, with friction."""
    body = FiniteLengthSpace(length=1e-3, material=Material(210e9, 0.3))
    case = Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9, friction=0.05)
    reach = 1.5 * case.hertz_half_width
    grid = Grid((0.0, 1e-3), (-reach, reach), 4, 96)
    pressure = 1.5e9 * np.sqrt(np.maximum(1 - (grid.y / case.hertz_half_width) ** 2, 0)) + 0 * grid.x[:, None]
    both = {"pressure": (("x", "y"), pressure), "traction_y": (("x", "y"), 0.05 * pressure)}
    return case, xr.Dataset(both, coords={"x": grid.x, "y": grid.y})


def fast_checks() -> Iterator[Check]:
    """Two like bodies in a fast line contact, the heat shared by equal surface temperature."""
    case, result = line_case()
    a, speed, sliding = case.hertz_half_width, 200.0, 1.0
    hot = flash_temperature(
        case, result, body=STEEL, roller=STEEL, body_speed=-speed - 0.5 * sliding, roller_speed=-speed + 0.5 * sliding
    )
    factor, behind = closed_forms.fast_line()
    heat = 0.05 * 1.5e9 * sliding
    expected = 0.5 * heat * np.sqrt(STEEL.diffusivity * a / (np.pi * speed)) / STEEL.conductivity * factor
    name, source = "fast line contact of like bodies", "Blok (1937); Jaeger (1942)"
    yield compare(name, "largest rise", source, float(hot.max_temperature_rise), expected, 5e-3, relative=True)
    place = -float(hot.max_temperature_rise_y) / a
    yield compare(name, "distance behind the middle / a", source, place, behind, 0.02)
    share = float(hot.body_heat_share)
    yield compare(name, "part of the heat in the body", "symmetry", share, 0.5, 2e-3)
    apart = abs(hot.temperature_rise - hot.roller_temperature_rise).where(result.pressure > 0)
    largest = float(apart.max() / hot.max_temperature_rise)
    yield compare(name, "surfaces' difference where they touch, over the rise", "what was asked", largest, 0.0, 1e-6)
    unlike = flash_temperature(case, result, body=STEEL, roller=STEEL, body_speed=-400.0, roller_speed=-100.0)
    name = "fast line contact, the body four times as fast"
    source = "shares go with the root of the speed; Blok (1937)"
    yield compare(name, "part of the heat in the body", source, float(unlike.body_heat_share), 2 / 3, 5e-3)


def band_checks() -> Iterator[Check]:
    """Uniform heat in a band, at all speeds."""
    grid = Grid((0.0, 8.0), (-2, 2), 5, 64)
    band = np.where(np.abs(grid.y) < 1, 1.0, 0.0)
    for drift in (0.01, 0.3, 5.0, 100.0):
        found = rise(grid, band, 2 * drift, Ends(0.0, 8.0))[2]
        exact = closed_forms.moving_band(grid.y, drift)
        curve = Curve("y / a", "T lambda / (q a)", grid.y, found, exact)
        case = f"band of uniform heat between two ends, Peclet number {drift:g}"
        yield compare_fields(
            case, "rise over the largest", "Jaeger (1942)", found / exact.max(), exact / exact.max(), 5e-6, curve=curve
        )


def resting_checks() -> Iterator[Check]:
    """Rest sources on a half-space."""
    grid = Grid((-1.2, 1.2), (-1.2, 1.2), 61, 61)
    source = "Carslaw and Jaeger (1959), 10.5"
    cells = Grid((-1.5, 1.5), (-1.5, 1.5), 45, 45)
    square = np.where((np.abs(cells.x)[:, None] < 1) & (np.abs(cells.y) < 1), 1.0, 0.0)
    side = 0.5 * float(square[22].sum()) * cells.dy
    middle = float(rise(cells, square, 0.0, EVERYWHERE)[22, 22]) / side
    expected = closed_forms.resting_square()
    yield compare("square of uniform heat at rest", "rise in the middle", source, middle, expected, 1e-5, relative=True)
    heat = np.sqrt(np.maximum(1 - grid.x[:, None] ** 2 - grid.y**2, 0))
    middle, expected = float(rise(grid, heat, 0.0, EVERYWHERE)[30, 30]), closed_forms.resting_hertz_circle()
    case = "circle of Hertz' pressure at rest, 61 x 61 cells"
    yield compare(case, "rise in the middle", source, middle, expected, 2e-3, relative=True)


def end_checks() -> Iterator[Check]:
    """Insulated ends, and what all of the heat does."""
    edges = np.array([0.0, 0.2, 0.5, 1.0, 1.7])
    half, whole = (Grid.from_edges(each, (-1, 1), 20) for each in (edges, np.concatenate([-edges[:0:-1], edges])))
    heat = np.array([3.0, 2.0, 1.5, 1.0])[:, None] * (np.abs(half.y) < 0.5)
    at_end = rise(half, heat, 3.0, Ends(0.0, np.inf))
    doubled = rise(whole, np.concatenate([heat[::-1], heat]), 3.0, EVERYWHERE)[4:]
    scale = doubled.max()
    yield compare_fields(
        "heat beside an insulated end", "rise over the largest", "symmetry", at_end / scale, doubled / scale, 1e-9
    )
    for speed in (1.0, -4.0):
        found, power = heat_carried_away(speed)
        case = f"heat in three cells between two ends, surface speed {speed:g}"
        quantity = "heat through planes before and behind, over all of it"
        yield compare(case, quantity, "conservation of energy", found / power, 1.0, 1e-6)


def heat_carried_away(speed: float) -> tuple[float, float]:
    """Heat that flows and is carried through planes before and behind some sources, and the heat of these, W."""
    grid = Grid((0.0, 2.0), (-3, 3), 12, 60)
    heat = np.zeros(grid.shape)
    heat[2, 28:30], heat[7, 30] = 5.0, 1.0
    points, weights = np.polynomial.legendre.leggauss(40)
    nodes = 0.5 * (points + 1)
    stencil = np.array([-1, 9, -45, 0, 45, -9, 1]) / (60 * grid.dy)  # first derivative, sixth order
    away = 0.0
    for depth, weight in zip(40 * nodes**4, weights * 80 * nodes**3, strict=True):
        along = grid.dx * rise(grid, heat, speed, Ends(0.0, 2.0), depth).sum(axis=0)
        for side, at in ((-1, 8), (1, 51)):
            away += side * weight * float(speed * along[at] - stencil @ along[at - 3 : at + 4])
    return away, float(heat.sum()) * grid.cell_area


def checks() -> Iterator[Check]:
    """All of them."""
    yield from fast_checks()
    yield from band_checks()
    yield from resting_checks()
    yield from end_checks()
