"""Checks of the quarter space against its exact limits: point loads at and near the edge, resultants, corner.

They belong to the overlapping of Hetenyi (*J. Appl. Mech.* 37 (1970) 70) and of Keer, Lee and Mura (*Int. J. Solids
Struct.* 19 (1983) 497). Seen from far away, a load P at the edge and all that it asks of the two auxiliary bodies act
in a point: the top carries ``H = P + (2 / pi) V``, the end ``V = (2 / pi) H``, each body with its mirror images, so
``H = P / (1 - 4 / pi**2)`` whatever Poisson's ratio is. Along the edge, where V does not move the top, the
displacement is ``2 H / P`` times the half-space's. The ratios along the normal and `EXTRA_DEFLECTION` are not closed
forms: they were computed apart from the solver, to the digits given.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.invariants import von_mises
from contactstudy.bodies.models import HalfSpace, QuarterSpace
from contactstudy.checks import FloatArray
from contactstudy.fields.stress import stress_field
from contactstudy.fields.surface import surface_displacement
from contactstudy.kernels.load import Load
from contactstudy.overlapping.axial import axial_modes
from contactstudy.overlapping.equations import EquationSet
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.verification.check import Check, compare, compare_fields
from contactstudy.verification.problems import on_cells, point_pressure, unit_material

ALONG_EDGE = 3.362954
"""Displacement along the edge under a point load on it, over the half-space's; for every Poisson's ratio."""

ALONG_NORMAL = {0.0: 2.0, 0.3: 2.4727}
"""Likewise along the inward normal, by Poisson's ratio."""

EXTRA_DEFLECTION = {0.0: 1.3677, 0.3: 1.8452, 0.5: 2.7561}
"""``kappa``: at the distance d the edge adds ``kappa (1 - nu**2) P / (2 pi E d)`` to the deflection at a load."""

TOP_RESULTANT = 1 / (1 - 4 / np.pi**2)
"""Resultant of the equivalent load on the top for a unit load, its images not counted."""

END_RESULTANT = -2 / np.pi * TOP_RESULTANT
"""Likewise on the end plane: tension."""

SOURCE = "exact limit of the quarter space"
"""Source of closed forms."""

COMPUTED = "limit of the quarter space, computed apart from the solver"
"""Source of numbers that no closed form gives."""


def _scaled_displacement(poisson: float, grid: Grid, at: tuple[int, int], distance: FloatArray) -> FloatArray:
    """Displacement under a unit load on the cell `at`, over the half-space's at the same distance."""
    body = QuarterSpace(material=unit_material(poisson))
    return np.asarray(surface_displacement(body, point_pressure(grid, *at)).values * np.pi * distance)


def edge_load_checks() -> Iterator[Check]:
    """Displacement under a point load on the edge."""
    for poisson in (0.0, 0.3, 0.5):
        # Cells of a fortieth of the distance; the error falls in proportion, so two distances give the limit.
        grid = Grid((0.0, 0.16), (-4.1, 4.1), 8, 41)
        distance = np.abs(grid.y)[None, :]
        ratio = _scaled_displacement(poisson, grid, (0, 20), distance)[0, 20:]
        yield compare(
            f"point load on the edge, nu = {poisson:g}",
            "u_z along the edge over the half-space's",
            SOURCE,
            float(2 * ratio[20] - ratio[10]),
            ALONG_EDGE,
            0.01,
        )
    for poisson, expected in ALONG_NORMAL.items():
        grid = Grid((0.0, 8.2), (-0.45, 0.45), 82, 9)
        ratio = _scaled_displacement(poisson, grid, (0, 4), grid.x[:, None])[:, 4]
        yield compare(
            f"point load on the edge, nu = {poisson:g}",
            "u_z along the inward normal over the half-space's",
            COMPUTED,
            float(2 * ratio[80] - ratio[40]),
            expected,
            0.01,
        )


def extra_deflection_checks() -> Iterator[Check]:
    """Deflection at a point load at a distance from the edge."""
    for poisson, expected in EXTRA_DEFLECTION.items():
        grid = Grid((0.0, 4.8), (-0.45, 0.45), 48, 9)
        load = point_pressure(grid, 40, 4)
        material = unit_material(poisson)
        quarter, half = (
            float(surface_displacement(body, load)[40, 4])
            for body in (QuarterSpace(material=material), HalfSpace(material=material))
        )
        yield compare(
            f"point load at 40 cells from the edge, nu = {poisson:g}",
            "kappa, the edge's deflection over (1 - nu^2) P / (2 pi E d)",
            COMPUTED,
            (quarter - half) * 2 * np.pi * grid.x[40],
            expected,
            5e-4,
        )


def resultant_checks() -> Iterator[Check]:
    """Resultants of the equivalent loads, from their transforms between the two ends of the scale."""
    lateral, place, settings = 1e-7, 1.0, Resolution()
    for poisson in (0.0, 0.3, 0.5):
        (modes,) = axial_modes(np.inf, lateral, 1e-4, settings)
        system = EquationSet.build(modes, lateral, poisson, 1e-4, settings)
        spectrum = modes.load_weights * modes.cosine(np.array([place]))[:, 0]
        scaled = system.solve(system.source(Load.NORMAL, spectrum))
        on_top = system.on_top(scaled) / modes.weights
        small = np.abs(modes.ray) < 3e-3  # against 1 / place; the lateral wavenumber is smaller still
        top = 1 + 0.5 * np.pi * float(np.interp(1e-3, np.abs(modes.ray[small]), on_top.real[small]))
        end = -0.5 * np.pi * float(np.interp(1e-3, system.depth, scaled / system.scale))
        case = f"equivalent loads of a unit load, nu = {poisson:g}"
        yield compare(case, "resultant on the top", SOURCE, top, TOP_RESULTANT, 5e-3)
        yield compare(case, "resultant on the end", SOURCE, end, END_RESULTANT, 5e-3)


def corner_checks() -> Iterator[Check]:
    """Corner under a uniform pressure: ``sigma_z = -p, sigma_x = 0``, and plane strain along a long edge."""
    poisson, width = 0.3, 60.0
    body = QuarterSpace(material=unit_material(poisson))
    pressure = on_cells(lambda x, y: (x < 5) + 0 * y, (0, 6), (-width, width), (48, 12))
    stress = stress_field(body, pressure, x=[0.05], y=[0.0], z=[0.05]).isel(x=0, y=0, z=0)
    case = "uniform pressure on a long strip up to the edge, 0.05 from the corner"
    yield compare_fields(
        case,
        "sigma_xx, sigma_zz, tau_xz / p",
        "uniaxial compression, " + SOURCE,
        [stress["sigma_xx"], stress["sigma_zz"], stress["tau_xz"]],
        [0.0, -1.0, 0.0],
        0.02,
    )
    yield compare(
        case,
        "von Mises stress / p",
        "p sqrt(1 - nu + nu^2), " + SOURCE,
        float(von_mises(stress)),
        float(np.sqrt(1 - poisson + poisson**2)),
        0.02,
    )


def antiplane_checks() -> Iterator[Check]:
    """Check that a traction that does not vary along y asks nothing of the end: its mirror image alone frees it."""
    (modes,) = axial_modes(np.inf, 1e-9, 1e-2, Resolution())
    system = EquationSet.build(modes, 1e-9, 0.3, 1e-2, Resolution())
    spectrum = modes.load_weights * modes.cosine(np.array([1.0]))[:, 0]
    near = system.depth > 1e-3  # below the wavelength along y there is always some
    scale = np.abs(system.source(Load.NORMAL, spectrum)[near]).max()
    yield compare_fields(
        "traction along y that does not vary along y",
        "load asked of the end, over that for an equal pressure",
        SOURCE,
        system.source(Load.ALONG_Y, spectrum)[near] / scale,
        0.0,
        1e-4,
    )


def checks() -> Iterator[Check]:
    """Every check of the quarter space."""
    for family in (edge_load_checks, extra_deflection_checks, resultant_checks, corner_checks, antiplane_checks):
        yield from family()
