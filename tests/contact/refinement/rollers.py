"""Short rollers with refined contacts, and their peaks on finer cells."""

from __future__ import annotations

import numpy as np

from contactstudy import Case, FiniteLengthSpace, HalfSpace, Material, QuarterSpace, Roller, profiles
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.contact import Settings, contact_of
from contactstudy.contact.refinement.refined_contact import RefinedContact, _ColumnSolver, refine_contact

STEEL = Material(210e9, 0.3)
HALF_SPACE = HalfSpace(material=STEEL)
RADIUS, PRESSURE, LENGTH = 5e-3, 1.5e9, 10e-3
HALF_WIDTH = 4 * PRESSURE * RADIUS / (2 * STEEL.plane_strain_modulus)
"""Hertz half-width of a rigid roller; the half-width of an elastic roller is twice as large."""
SHORT, SHORT_ELASTIC = 8 * HALF_WIDTH, 16 * HALF_WIDTH


def make_filleted_roller(radius: float, length: float = LENGTH, material: Material | None = None) -> Roller:
    return Roller(radius=RADIUS, length=length, profile=profiles.Cylinder(fillet_radius=radius), material=material)


def make_finite_body(length: float = LENGTH) -> FiniteLengthSpace:
    return FiniteLengthSpace(length=length, material=STEEL)


def refine_case(case: Case, accuracy: float = 0.01) -> RefinedContact:
    return refine_contact(case, accuracy, 1e-6)


def find_peak_between_cells(pressure: FloatArray) -> float:
    """Largest pressure, also between the cells along y, by a parabola through the squared pressure."""
    squared_pressure = pressure**2
    column = squared_pressure[squared_pressure.max(axis=1).argmax()]
    peak_row = int(column.argmax())
    coefficients = np.polynomial.polynomial.polyfit([-1.0, 0.0, 1.0], column[peak_row - 1 : peak_row + 2], 2)
    return float(np.sqrt(coefficients[0] - coefficients[1] ** 2 / (4 * coefficients[2])))


def compute_finer_peak(case: Case, refined_contact: RefinedContact, factor: int) -> float:
    """Peak on cells that are `factor` times finer along both axes."""
    edges, grid = refined_contact.refined.edges, refined_contact.contact.shape.grid
    fine_edges = np.interp(np.arange((edges.size - 1) * factor + 1) / factor, np.arange(edges.size), edges)
    solver = _ColumnSolver(case, grid.y_range[1], grid.cells_y * factor)
    return find_peak_between_cells(contact_of(solver.shape(fine_edges), Settings(1e-6)).pressure)


CASES: dict[str, Case] = {
    "flush": Case(body=make_finite_body(SHORT), roller=make_filleted_roller(0.2e-3, SHORT), max_pressure=PRESSURE),
    "inside": Case(
        body=make_finite_body(9 * HALF_WIDTH), roller=make_filleted_roller(0.2e-3, SHORT), max_pressure=PRESSURE
    ),
    "half-space": Case(body=HALF_SPACE, roller=make_filleted_roller(0.2e-3, SHORT), max_pressure=PRESSURE),
    "quarter": Case(
        body=QuarterSpace(material=STEEL),
        roller=make_filleted_roller(0.2e-3, SHORT),
        max_pressure=PRESSURE,
        end_distance=0.5 * HALF_WIDTH,
    ),
    "mirror": Case(
        body=FiniteLengthSpace(length=SHORT, material=STEEL, model="mirror"),
        roller=make_filleted_roller(0.2e-3, SHORT),
        max_pressure=PRESSURE,
    ),
    "tilt": Case(
        body=make_finite_body(SHORT), roller=make_filleted_roller(0.2e-3, SHORT), max_pressure=PRESSURE, tilt=1e-3
    ),
    "load position": Case(
        body=make_finite_body(SHORT),
        roller=make_filleted_roller(0.2e-3, SHORT),
        max_pressure=PRESSURE,
        load_position=0.51 * SHORT,
    ),
    "coupled": Case(
        body=make_finite_body(SHORT),
        roller=make_filleted_roller(0.2e-3, SHORT),
        max_pressure=PRESSURE,
        friction=0.3,
        coupled=True,
    ),
    "elastic inside": Case(
        body=make_finite_body(SHORT_ELASTIC),
        roller=make_filleted_roller(0.2e-3, 12 * HALF_WIDTH, STEEL),
        max_pressure=PRESSURE,
    ),
    "elastic overhanging": Case(
        body=make_finite_body(12 * HALF_WIDTH),
        roller=make_filleted_roller(0.2e-3, SHORT_ELASTIC, STEEL),
        max_pressure=PRESSURE,
        end_distance=-2 * HALF_WIDTH,
    ),
}
