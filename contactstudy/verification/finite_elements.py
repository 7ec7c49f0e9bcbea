"""Checks against independent finite elements, from stored data: stresses, displacement and contact with free ends.

The references and their errors are described in `stored`; what is compared is stated in each check. The finite elements
themselves are not needed here.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import STRESSES
from contactstudy.bodies.models import FiniteLengthSpace
from contactstudy.checks import FloatArray
from contactstudy.contact.solve import solve_contact
from contactstudy.fields.stress import stress_field
from contactstudy.fields.surface import surface_displacement
from contactstudy.verification.check import Check, Curve, compare_fields
from contactstudy.verification.load_cases import CONTACT_CASES, LOAD_CASES, LoadCase
from contactstudy.verification.problems import on_cells, on_grid, unit_material
from contactstudy.verification.stored import load_contact, load_stress

SOURCE = "finite elements (scikit-fem), own error {:.0e} {}"
"""Source of every check here, with its error and the unit of that."""

QUICK_STRESSES = ("full_sliding", "eccentric_sliding", "thin", "plate_sliding")
"""Load cases of the quick level."""

CELLS_Y, FINER = 128, {"wedge_sliding": 256}
"""Cells over the loaded width, and more of them for a load that changes along x right at a free end: cells along x are
twice as wide, and at 0.02a below the top their steps show. Accuracy."""

CONTACT_CELLS = 16
"""Cells per half-width along x in contacts. Accuracy."""


def pressure_of(case: LoadCase, cells_y: int = CELLS_Y) -> xr.DataArray:
    """Load of a case, four cells along y for one along x but no fewer than 32 of these."""
    cells_x = max(32, round(0.25 * cells_y * case.length))
    return on_cells(lambda x, y: case.pressure(x[:, 0], y[0]), (0, case.length), (-1, 1), (cells_x, cells_y))


def stress_checks(name: str) -> Iterator[Check]:
    """Stresses under a prescribed load at all stored depths: largest and median difference of six components."""
    reference = load_stress(name)
    case = reference.case
    below = reference.stress
    points = {axis: below[axis].values.astype(float) for axis in "xyz"}
    body = FiniteLengthSpace(length=case.length, material=unit_material(case.poisson))
    stress = stress_field(body, pressure_of(case, FINER.get(name, CELLS_Y)), case.friction, *points.values())
    computed = np.array([stress[component].values for component in STRESSES])
    expected = np.array([below[component].transpose("x", "y", "z").values for component in STRESSES])
    label = f"{name}: L = {case.length:g}a, f = {case.friction:g}, nu = {case.poisson:g}, {case.g}"
    profile = {"x": 0.0, "y": 0.75}
    curve = Curve(
        "z / a",
        "sigma_yy / p0, x = 0, y = 0.75a",
        points["z"],
        stress["sigma_yy"].sel(profile).values,
        below["sigma_yy"].sel(profile).values,
    )
    quantity = f"six stresses / p0, z >= {float(below['z'].min()):g}a"
    source = SOURCE.format(reference.error, "p0")
    yield compare_fields(label, quantity, source, computed, expected, 1e-3, curve=curve)
    source = SOURCE.format(reference.median_error, "p0")
    yield compare_fields(label, quantity, source, computed, expected, 2e-4, median=True)


def displacement_checks(name: str) -> Iterator[Check]:
    """Displacement of the top under a symmetric load, relative to its middle."""
    reference = load_stress(name)
    case, expected = reference.case, reference.stress["displacement_z_young"]
    young = unit_material(case.poisson).young
    # Cell centres on the reference's points y, and x interpolated between them.
    body = FiniteLengthSpace(length=case.length, material=unit_material(case.poisson))
    grid = Grid((0.0, case.length), (-1.3125, 1.3125), round(32 * case.length), 105)
    sunk = surface_displacement(body, on_grid(lambda g: case.pressure(g.x, g.y), grid), case.friction)
    inside = expected.sel(x=slice(0.5 * grid.dx, case.length - 0.5 * grid.dx))
    at = sunk.interp(x=inside["x"], y=inside["y"], method="cubic")
    middle = float(sunk.interp(x=0.5 * case.length, y=0.0, method="cubic"))
    error = float(expected.attrs["error_estimate"])
    yield compare_fields(
        f"{name}: L = {case.length:g}a, {case.g}, f = {case.friction:g}",
        "E u_z / (p0 a), relative to the middle",
        SOURCE.format(error, "p0 a"),
        young * (at - middle),
        inside,
        1e-3,
    )


def contact_checks(name: str) -> Iterator[Check]:
    """Contact of a roller: pressure along its middle line, away from its last cell and in it.

    Both pressures are averaged over the cells. At the sharp end of a cylinder inside the top's face the pressure is
    singular, and neither solution resolves it: there 1 % holds from half a half-width on only, the cells before are
    held to 5 %, and the load that they carry is compared.
    """
    reference = load_contact(name)
    case, stored = reference.case, reference.contact
    grid = Grid((0.0, case.length), (-1.75, 1.75), round(CONTACT_CELLS * case.length), 113)
    body = FiniteLengthSpace(length=case.length, material=unit_material(case.poisson))
    contact = solve_contact(body, on_grid(lambda g: case.gap(g.x, g.y), grid), case.load)
    under = contact["pressure"].sel(x=slice(case.start, case.stop))
    x = under["x"].values
    edges = np.append(x - 0.5 * grid.dx, x[-1] + 0.5 * grid.dx)
    expected = _cell_means(stored["x"].values, stored["pressure"].sel(y=0).values, edges)
    computed = under.sel(y=0, method="nearest").values
    error = float(np.median(stored["pressure_error"].sel(y=0)))
    source, label = (
        SOURCE.format(error, "p0 (median)"),
        f"{name}: contact, L = {case.length:g}a, roller from {case.distance:g}a",
    )
    label += f", crown {case.crown:g}" if case.crown else ""
    curve = Curve("x / a", "p / p0 at y = 0", x, computed, expected)
    singular = case.distance > 0 and not case.crown
    away = slice(1, -1)
    quantity = "pressure / p0 at y = 0, away from the last cell"
    tolerance = 0.05 if singular else 0.01
    yield compare_fields(label, quantity, source, computed[away], expected[away], tolerance, curve=curve)
    if singular:
        far = slice(CONTACT_CELLS // 2, -CONTACT_CELLS // 2)
        quantity = "pressure / p0 at y = 0, 0.5a and more from the roller's end"
        yield compare_fields(label, quantity, source, computed[far], expected[far], 0.01)
        load = stored["line_load"].values
        near = slice(None, CONTACT_CELLS // 2)
        found = float(under.isel(x=near).sum()) * grid.cell_area
        right = float((_cell_means(stored["x"].values, load, edges)[near]).sum()) * grid.dx
        quantity = "load on the roller's last 0.5a / (p0 a^2)"
        yield compare_fields(label, quantity, source, found, right, 0.03)
    else:
        quantity = "pressure / p0 at y = 0 in the last cell"
        yield compare_fields(label, quantity, source, computed[[0, -1]], expected[[0, -1]], 0.03)


def _cell_means(nodes: FloatArray, values: FloatArray, edges: FloatArray) -> FloatArray:
    """Means over cells of a function that is linear between its nodes."""
    widths = np.diff(nodes)
    integral = np.append(0.0, np.cumsum(0.5 * (values[1:] + values[:-1]) * widths))
    panel = np.clip(np.searchsorted(nodes, edges) - 1, 0, nodes.size - 2)
    ahead = edges - nodes[panel]
    slope = np.diff(values)[panel] / widths[panel]
    return np.asarray(np.diff(integral[panel] + ahead * (values[panel] + 0.5 * slope * ahead)) / np.diff(edges))


def checks(*, full: bool) -> Iterator[Check]:
    """Every check against finite elements; some of the load cases only unless `full`."""
    names = [name for name in LOAD_CASES if full or name in QUICK_STRESSES]
    for name in names:
        yield from stress_checks(name)
    for name in names:
        if LOAD_CASES[name].symmetric:
            yield from displacement_checks(name)
    for name in CONTACT_CASES:
        yield from contact_checks(name)
