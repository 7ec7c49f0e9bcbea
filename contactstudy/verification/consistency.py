"""Checks that need no reference: equilibrium, free ends, reciprocity, symmetry, and Hetenyi's own iteration."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import STRESSES
from contactstudy.bodies.models import FiniteLengthSpace
from contactstudy.checks import FloatArray
from contactstudy.contact.solve import solve_contact
from contactstudy.fields.loads import sliding
from contactstudy.fields.stress import end_traction_residual, stress_field
from contactstudy.fields.surface import surface_displacement
from contactstudy.kernels.load import Load
from contactstudy.overlapping.axial import axial_modes
from contactstudy.overlapping.equations import EquationSet
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.verification.check import Check, compare, compare_fields
from contactstudy.verification.load_cases import LINE_LOAD, quartic
from contactstudy.verification.problems import on_cells, strip, unit_material


def _body(length: float) -> FiniteLengthSpace:
    """Body of the unit material."""
    return FiniteLengthSpace(length=length, material=unit_material())


def free_end_checks() -> Iterator[Check]:
    """Traction that the solution, before anything is imposed, leaves on loaded ends."""
    for length in (8.0, 2.5):
        pressure = on_cells(strip, (0, length), (-2, 2), (round(16 * length), 64))
        grid = Grid.from_centres(pressure["x"].values, pressure["y"].values)
        for depths, label in (((0.02, 0.05), "z = 0.02a, 0.05a"), ((0.1, 0.3, 1.0, 5.0), "z >= 0.1a")):
            found = end_traction_residual(
                _body(length), sliding(pressure.values, 0.3), grid, grid.y[::5], np.array(depths)
            )
            case = f"strip load on both ends, L = {length:g}a, f = 0.3"
            yield compare(case, f"traction on the ends / p0, {label}", "free ends", found, 0.0, 1e-4)


def equilibrium_checks() -> Iterator[Check]:
    """Divergence of the stress near an end, by central differences of sixth order, and a cut's resultants."""
    length, step = 4.0, 0.02
    pressure = on_cells(lambda x, y: quartic(y) + 0 * x, (0, length), (-1, 1), (64, 64))
    body, friction = _body(length), 0.3
    offsets, weights = np.arange(-3, 4) * step, np.array([-1, 9, -45, 0, 45, -9, 1]) / (60 * step)
    centre = {"x": 0.3, "y": 0.4, "z": 0.6}
    slopes = {}
    for axis in "xyz":
        points = {name: [value] for name, value in centre.items()} | {axis: centre[axis] + offsets}
        stress = stress_field(body, pressure, friction, *points.values())
        slopes[axis] = {name: float(weights @ stress[name].values.ravel()) for name in STRESSES}
    divergence = [
        sum(slopes[axis][name] for axis, name in zip("xyz", names, strict=True))
        for names in (
            ("sigma_xx", "tau_xy", "tau_xz"),
            ("tau_xy", "sigma_yy", "tau_yz"),
            ("tau_xz", "tau_yz", "sigma_zz"),
        )
    ]
    size = max(abs(value) for by_name in slopes.values() for value in by_name.values())
    case = "smooth strip load, f = 0.3, L = 4a"
    yield compare_fields(
        f"{case}, 0.3a from the end",
        "divergence of the stress over its largest slope",
        "equilibrium",
        np.array(divergence) / size,
        0.0,
        2e-3,
    )
    # Resultants on the plane z = 1: the load itself. Gauss in x, graded in y; farther out there is Flamant's plate,
    # whose shear under a traction Q falls like 2 Q z / (pi y**2).
    node, weight = np.polynomial.legendre.leggauss(10)
    x = 0.5 * length * (node + 1)
    parameter = np.linspace(-5.0, 5.0, 101)
    y, dy = np.sinh(parameter), np.cosh(parameter) * (parameter[1] - parameter[0])
    cut = stress_field(body, pressure, friction, x=x, y=y, z=[1.0]).isel(z=0)
    load = length * 16 / 15
    beyond = 1 - 4 / (np.pi * np.abs(y).max())
    for component, expected in (("sigma_zz", -load), ("tau_yz", -friction * load * beyond)):
        found = float(np.einsum("xy,x,y->", cut[component].values, 0.5 * length * weight, dy))
        yield compare(
            f"{case}, cut at z = a", f"resultant of {component} / (p0 a^2)", "equilibrium", found, expected, 2e-3
        )


def contact_checks() -> Iterator[Check]:
    """Load, symmetry and conditions of a contact."""
    gap = on_cells(lambda x, y: y**2 + 0 * x, (0, 8), (-2, 2), (129, 65))
    contact = solve_contact(_body(8.0), gap, 8 * LINE_LOAD)
    pressure = contact["pressure"].values
    case = "rigid cylinder on a body of its own length, 8a"
    carried = pressure.sum() * 32 / pressure.size
    yield compare(case, "load", "prescribed", carried, 8 * LINE_LOAD, 1e-9, relative=True)
    mirrored = [pressure[::-1], pressure[:, ::-1]]
    quantity = "pressure / p0 against its mirror images"
    yield compare_fields(case, quantity, "symmetry", [pressure, pressure], mirrored, 1e-8)
    sunk = surface_displacement(_body(8.0), contact["pressure"])
    height = ((gap + sunk) / float(sunk.max() - sunk.min())).values
    touching = pressure > 0
    approach = height[touching].mean()
    quantity = "gap under pressure over the variation of the displacement"
    yield compare_fields(case, quantity, "conditions of contact", height[touching], approach, 1e-5)
    overlap = min(0.0, float((height - approach)[~touching].min()))
    yield compare(case, "overlap elsewhere, likewise", "conditions of contact", overlap, 0.0, 1e-5)


def reciprocity_checks() -> Iterator[Check]:
    """Betti: each of two loads does the same work on the displacement of the other."""
    for length in (8.0, 2.5):
        body, span, cells = _body(length), (0, length), (48, 32)
        first = on_cells(lambda x, y: np.exp(-((x - 1) ** 2) - y**2), span, (-2, 2), cells)
        second = on_cells(lambda x, y: np.exp(-((x - 2) ** 2) - 2 * y**2), span, (-2, 2), cells)
        work = float((first * surface_displacement(body, second)).sum())
        other = float((second * surface_displacement(body, first)).sum())
        case = f"two loads on a body of length {length:g}a"
        yield compare(case, "work of one on the other's displacement", "Betti", work, other, 1e-9, relative=True)


def alternation_checks() -> Iterator[Check]:
    """Free the ends, then the top, and again: the iteration must end at the explicit solution."""
    settings = Resolution()
    modes = axial_modes(8.0, 2.0, 0.05, settings)[0]
    system = EquationSet.build(modes, 2.0, 0.3, 0.05, settings)
    asked: FloatArray = system.source(
        Load.NORMAL, modes.load_weights * modes.cell_integrals(Load.NORMAL, np.array([0.0, 3.0]))[:, 0]
    )
    explicit, face_load = system.solve(asked), asked.copy()
    for _ in range(200):
        face_load = asked + system.source(Load.NORMAL, modes.on_end * system.on_top(system.scale * face_load))
    scale = np.abs(explicit).max()
    yield compare_fields(
        "equivalent loads at one wavenumber, 200 alternations",
        "face loads over the largest",
        "iteration of Hetenyi (1970) and Keer",
        explicit / scale,
        system.scale * face_load / scale,
        1e-9,
    )


def checks() -> Iterator[Check]:
    """Every check of consistency."""
    for family in (free_end_checks, equilibrium_checks, contact_checks, reciprocity_checks, alternation_checks):
        yield from family()
