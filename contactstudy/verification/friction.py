"""Checks of stick and slip: closed forms of rolling and shifting, Kalker's coefficients, published numbers.

* Carter, *Proc. R. Soc. Lond.* A 112 (1926) 151; Cattaneo (1938) and Mindlin, *J. Appl. Mech.* 16 (1949) 259: closed
  forms, by Johnson (1985), sections 7.2 and 8.3.
* Kalker, *Three-Dimensional Elastic Bodies in Rolling Contact* (1990), table E.3: creep coefficients to three digits.
  They belong to vanishing creepage, where no cell slips and the traction at the trailing edge is singular, so the error
  is of first order in the cell; it is extrapolated from two grids.
* Bentall and Johnson, *Int. J. Mech. Sci.* 9 (1967) 389, recomputed by the program CONTACT: unlike rollers.
* A traction curve by CONTACT, 48 x 44 cells: its values are 1.4 % above those here at all creepages but the largest.
  With the slip taken half a cell late, between neighbouring cells, this solver gives CONTACT's values to 0.2 % on as
  many cells, and on twice as many half of the difference is gone: it is the cells' error.
* Spence, *J. Elasticity* 5 (1975) 297: pressed with friction, a sphere sticks within the same part of the contact at
  any load, so the load is raised in steps; by the program CONTACT half of the radius at this friction.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr
from scipy import special

from contactstudy.bodies import Counterbody, FiniteLengthSpace, HalfSpace, Material
from contactstudy.case.motion import Rolling, Shift
from contactstudy.contact.fastsim import POISSONS, TABLE
from contactstudy.contact.solve import solve_contact
from contactstudy.verification import closed_forms
from contactstudy.verification.check import Check, Curve, compare, compare_fields
from contactstudy.verification.problems import on_cells

LINE_CELLS = 52
"""Cells along y over 2.6 half-widths of a line contact: 20 per half-width."""


def material(shear: float, poisson: float) -> Material:
    """Material of a shear modulus, Pa."""
    return Material(2 * shear * (1 + poisson), poisson)


def line_contact(
    first: Material, second: Material, motion: Rolling, friction: float, *, coupled: bool = False
) -> xr.Dataset:
    """Contact of two cylinders of radius 2 on each other, half-width 1, in plane strain: ends that only mirror."""
    modulus = 1 / (1 / first.plane_strain_modulus + 1 / second.plane_strain_modulus)
    gap = on_cells(lambda x, y: 0.5 * y**2 + 0 * x, (0, 1), (-1.3, 1.3), (2, LINE_CELLS))
    bodies = [FiniteLengthSpace(length=1.0, material=each, model="mirror") for each in (first, second)]
    return solve_contact(
        bodies[0],
        gap,
        0.25 * np.pi * modulus,
        friction,
        coupled,
        counterbody=Counterbody(bodies[1]),
        motion=motion,
    )


def carter_checks() -> Iterator[Check]:
    """Like cylinders in steady rolling."""
    steel, friction, radius = material(1.0, 0.28), 0.3, 1.0
    source = "Carter (1926); Johnson (1985) 8.44 to 8.46"
    for stick in (0.2, 0.6, 0.9):
        creepage = closed_forms.carter_creepage(stick, friction, 1.0, radius)
        found = line_contact(steel, steel, Rolling(longitudinal_creepage=creepage), friction).isel(x=0)
        case = f"like cylinders rolling, stick zone {stick:g} of the contact"
        step = float(found["y"][1] - found["y"][0])
        whole = friction * float(found["pressure"].sum()) * step
        force = float(found["traction_y"].sum()) * step / whole
        yield compare(case, "force over full sliding's", source, force, closed_forms.carter_force(stick), 1e-3)
        width = 0.5 * float(found["stick"].sum()) * step
        yield compare(case, "half-width of the stick zone / a", source, width, stick, 0.5 * step + 1e-9)
        inside = np.abs(found["y"].values) < 0.9
        y = found["y"].values[inside]
        peak = friction * 2 * float(found["pressure"].sum()) * step / np.pi
        computed, expected = found["traction_y"].values[inside] / peak, closed_forms.carter_traction(y, stick)
        # The traction has a vertical slope where slip begins, between two cells.
        smooth = np.abs(y - (1 - 2 * stick)) > 2 * step
        yield compare_fields(
            case,
            "traction / (f p0), two cells from where slip begins",
            source,
            computed[smooth],
            expected[smooth],
            0.01,
            curve=Curve("y / a", "q / (f p0)", y, computed, expected),
        )


def slope_check(length: float, cells: int, case: str, modulus: float, tolerance: float) -> Check:
    """Compare the initial slope of the traction curve, per length, in the middle of two like cylinders with free ends.

    It is ``pi E' a / 2`` with the modulus E' of the pair in the plane, ``E / 2`` in plane stress, and the half-width a
    of the load there (Johnson 8.46). From the forces of two small creepages, as Carter's curve is a parabola.
    """
    steel, friction, creepage = material(1.0, 0.3), 0.3, 0.015
    gap = on_cells(lambda x, y: 0.5 * y**2 + 0 * x, (0, length), (-1.3, 1.3), (cells, LINE_CELLS))
    body = FiniteLengthSpace(length=length, material=steel)
    load = 0.25 * np.pi * 0.5 * steel.plane_strain_modulus * length
    first, second = (
        solve_contact(
            body,
            gap,
            load,
            friction,
            counterbody=Counterbody(body),
            motion=Rolling(longitudinal_creepage=number * creepage),
        ).isel(x=cells // 2)
        for number in (1, 2)
    )
    step = float(gap["y"][1] - gap["y"][0])
    forces = [step * float(found["traction_y"].sum()) for found in (first, second)]
    half_width = np.sqrt(4 * step * float(first["pressure"].sum()) / (np.pi * modulus))
    slope = (4 * forces[0] - forces[1]) / (2 * creepage)
    expected = 0.5 * np.pi * modulus * half_width
    source = "Carter (1926); Johnson (1985) 8.46"
    return compare(case, "initial slope of the force per length", source, slope, expected, tolerance, relative=True)


def slope_checks(*, full: bool) -> Iterator[Check]:
    """Plane stress of a thin disc, plane strain in the middle of a long body."""
    young, poisson = 2.6, 0.3
    yield slope_check(0.1, 2, "like discs rolling, L = 0.1 a", 0.5 * young, 5e-3)
    if full:
        yield slope_check(48.0, 96, "like cylinders rolling, L = 48 a", 0.5 * young / (1 - poisson**2), 5e-3)


def spence_checks() -> Iterator[Check]:
    """Press a rigid sphere with friction, without any shift."""
    half, reach, cells, steps = HalfSpace(material=material(1.0, 0.0)), 1.25, 40, 9
    gap = on_cells(lambda x, y: 0.05 * (x**2 + y**2), (-reach, reach), (-reach, reach), (cells, cells))
    load = 4 / 3 * half.material.plane_strain_modulus * 0.1
    found: xr.Dataset | None = None
    for part in np.linspace(0.2, 1.0, steps):  # equal steps of the radius
        found = solve_contact(half, gap, load * part**3, 0.2986, True, motion=Shift(), after=found, tolerance=1e-5)
    assert found is not None
    areas = [float(found["stick"].sum()), float((found["pressure"] > 0).sum())]
    case, source = "rigid sphere pressed on a plane, f = 0.2986", "Spence (1975) by CONTACT"
    part = np.sqrt(areas[0] / areas[1])
    yield compare(case, "radius of the stick zone over the contact's", source, part, 0.5, reach / cells)


def shift_checks() -> Iterator[Check]:
    """Shift a sphere on a plane."""
    shear, poisson, radius, load, friction, part = 200e6, 0.42, 0.05, 9.1954, 0.4, 0.875
    rubber = material(shear, poisson)
    reach, cells = 1.25e-3, 76
    gap = on_cells(lambda x, y: (x**2 + y**2) / (2 * radius), (-reach, reach), (-reach, reach), (cells, cells))
    found = solve_contact(
        HalfSpace(material=rubber),
        gap,
        load,
        friction,
        counterbody=Counterbody(HalfSpace(material=rubber)),
        motion=Shift(force_y=part * friction * load),
    )
    case, source = "sphere shifted on a plane, 7/8 of full sliding's force", "Cattaneo (1938); Mindlin (1949)"
    expected = closed_forms.mindlin_shift(part, load, friction, 1e-3, shear, poisson)
    yield compare(case, "shift", source, float(found["shift_y"]), expected, 3e-3, relative=True)
    step = 2 * reach / cells
    stick = step * np.sqrt(float(found["stick"].sum()) / np.pi)
    yield compare(case, "radius of the stick zone / a", source, stick / 1e-3, 0.5, 0.5 * step / 1e-3)


def ellipse_gap(along_x: float, along_y: float, load: float, of: Material, cells: tuple[int, int]) -> xr.DataArray:
    """Gap that two like bodies close to an ellipse of given semi-axes under a load (Johnson 3.61, 4.26)."""
    modulus = 0.5 * of.plane_strain_modulus
    peak = 1.5 * load / (np.pi * along_x * along_y)
    long, short = max(along_x, along_y), min(along_x, along_y)
    squared = 1 - (short / long) ** 2
    if squared == 0:
        gentle = steep = np.pi * peak / (4 * modulus * long)
    else:
        first, second = special.ellipk(squared), special.ellipe(squared)
        scale = peak * short / (modulus * squared * long**2)
        gentle, steep = scale * (first - second), scale * ((long / short) ** 2 * second - first)
    of_x, of_y = (gentle, steep) if along_x >= along_y else (steep, gentle)
    x_range = along_x * cells[0] / (cells[0] - 2)
    y_range = along_y * cells[1] / (cells[1] - 6)  # rolling needs cells ahead
    return on_cells(lambda x, y: of_x * x**2 + of_y * y**2, (-x_range, x_range), (-y_range, y_range), cells)


def rolling_ellipse(
    along_x: float, along_y: float, load: float, of: Material, friction: float, motion: Rolling, cells: tuple[int, int]
) -> xr.Dataset:
    """Two like bodies that touch on an ellipse, in steady rolling."""
    body = HalfSpace(material=of)
    gap = ellipse_gap(along_x, along_y, load, of, cells)
    return solve_contact(body, gap, load, friction, counterbody=Counterbody(body), motion=motion, tolerance=1e-5)


KALKER = {
    (1.0, 0.25): (4.12, 3.67, 1.47),
    (1.0, 0.5): (5.20, 3.98, 1.63),
    (0.5, 0.0): (2.88, 2.88, 0.827),
    (5.0, 0.25): (7.78, 8.14, 6.63),
}
"""Coefficients c11, c22, c23, by half-width along rolling over that across, and Poisson's ratio."""

WHOLE_RANGE = (0.1, 0.3, 1.0, 1 / 0.4, 10.0)
"""Half-width along rolling over that across, of the coefficients at the full level."""

KALKER_CELLS, LONG_CELLS = (34, 62), (62, 118)
"""Cells each way of the two grids; of an ellipse of 10 to 1 those along rolling, which would be long otherwise."""

SMALL = 1e-6
"""Creepage without slip but in a few cells."""


def kalker_checks(*, full: bool) -> Iterator[Check]:
    """Kalker's creep coefficients."""
    table_of = dict(KALKER)
    if full:
        for ratio, first, second, third in TABLE:
            if ratio in WHOLE_RANGE:
                rows = zip(POISSONS, zip(first, second, third, strict=True), strict=True)
                table_of |= {(ratio, poisson): values for poisson, values in rows}
    names = ("c11", "c22")
    motions = (Rolling(longitudinal_creepage=SMALL), Rolling(lateral_creepage=SMALL), Rolling(spin=-SMALL))
    for (ratio, poisson), table in table_of.items():
        within, counts = 0.015, KALKER_CELLS if ratio < 10 else LONG_CELLS
        across, steel = 1.0 / ratio, material(1.0, poisson)
        found = []
        for count in counts:
            cells = (count if ratio < 10 else KALKER_CELLS[0], count)
            forces = []
            for motion in motions:
                rolled = rolling_ellipse(across, 1.0, 0.01, steel, 1.0, motion, cells)
                force = float(rolled["force_y" if motion.longitudinal_creepage else "force_x"])
                forces.append(force / (SMALL * across * (np.sqrt(across) if motion.spin else 1.0)))
            found.append(forces)
        # Of first order in the cells that a semi-axis has, without the three beside the contact.
        coarse, fine = (count - 6 for count in counts)
        extrapolated = (fine * np.array(found[1][:2]) - coarse * np.array(found[0][:2])) / (fine - coarse)
        case = f"vanishing creepage, a/b = {ratio:g}, Poisson's ratio {poisson:g}"
        source = "Kalker (1990), table E.3"
        for name, computed, expected in zip(names, extrapolated, table[:2], strict=True):
            yield compare(case, f"{name}, extrapolated", source, computed, expected, within, relative=True)
        # Under spin the traction is largest at the leading edge, where the error falls faster.
        yield compare(case, "c23", source, found[1][2], table[2], within, relative=True)


CONTACT_CURVE = {4e-4: 0.2588, 1.2e-3: 0.6482, 2.0e-3: 0.8816, 2.8e-3: 0.9832}
"""Force over full sliding's, by the longitudinal creepage."""


def published_checks() -> Iterator[Check]:
    """Numbers of the program CONTACT."""
    steel, load, friction = material(82e9, 0.28), 106.7e3, 0.33
    for creepage, expected in CONTACT_CURVE.items():
        motion = Rolling(longitudinal_creepage=creepage)
        found = rolling_ellipse(12.61e-3, 6.304e-3, load, steel, friction, motion, (44, 48))
        case = f"traction curve of an ellipse 2 to 1, creepage {creepage:g}"
        force = float(found["force_y"]) / (friction * load)
        source = "CONTACT, 48 x 44 cells, which are 1.4 % off"
        yield compare(case, "force over full sliding's", source, force, expected, 0.016, relative=True)
    soft, source = material(23e9, 0.31), "Bentall and Johnson (1967) by CONTACT"
    # The creepage grows with the half-width over the pair's radius, 0.1 mm over 25 mm there and 1 here.
    scale = 0.1 / 25
    for part, expected in ((0.0, 4.294e-4), (-0.75, 2.108e-4)):
        modulus = 1 / (1 / soft.plane_strain_modulus + 1 / steel.plane_strain_modulus)
        force = part * 0.05 * 0.25 * np.pi * modulus
        rolled = line_contact(soft, steel, Rolling(force_y=force), 0.05, coupled=True)
        case = f"unlike cylinders rolling, f = 0.05, force {part:g} of full sliding's"
        computed = scale * float(rolled["longitudinal_creepage"])
        yield compare(case, "creepage", source, computed, expected, 0.015, relative=True)


def checks(*, full: bool) -> Iterator[Check]:
    """All of them; at the full level over the whole of Kalker's table, and a long body."""
    yield from carter_checks()
    yield from slope_checks(full=full)
    yield from shift_checks()
    yield from spence_checks()
    yield from kalker_checks(full=full)
    yield from published_checks()
