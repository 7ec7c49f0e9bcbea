"""A sphere and a cylinder near the edge of a quarter space: load, area, pressure and stress against the half-space.

Usage: ``python studies/quarter_space.py [--out FOLDER]``; about a minute on two cores. Writes ``quarter_space.nc`` and
``quarter_space.png`` and prints Markdown tables, each number with its error, and a table of checks.

The body fills x >= 0 and z >= 0; its end x = 0 is free. Two rigid shapes are pressed on its top without friction: a
sphere, whose centre is at the distance e from the edge, and a cylindrical roller, whose axis is perpendicular to the
edge and whose end is at the distance e. The roller has an edge radius, and keeps its inclination. Both are pressed as
deep as on the half-space, and with the same load. Lengths are over a: the radius of the sphere's contact on the
half-space, the Hertz half-width of the roller's mean load there. Pressures and stresses are over Hertz' p0.

The sphere's von Mises stress rises towards the edge with the same load, as published solutions report: from 0.62 p0 to
0.92 p0 at e = 0 for a Poisson's ratio of 0.3. At equal depth the stress first falls, to 0.59 p0 at e = 1.5 to 2 a,
because the load falls, and exceeds the half-space's stress only within 0.5 a, by 10 % at most. At the end of the
roller, where the pressure peaks, both pressure and stress fall towards the edge, with the same load and at equal depth.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from scipy.interpolate import RectBivariateSpline
from scipy.optimize import brentq, minimize
from threadpoolctl import threadpool_limits

import contactstudy as cs
from contactstudy.bodies import Body
from contactstudy.plots.style import MARKERS, line_styles
from contactstudy.verification.closed_forms import hertz_circle_axis
from contactstudy.verification.free_ends import EXTRA_DEFLECTION

YOUNG, RADIUS, PRESSURE = 210e9, 5e-3, 1.5e9
DISTANCES = (0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 4.0, 8.0)
HALF_SPACE = np.inf
"""Distance that stands for the half-space."""

CONDITIONS = ("depth", "load")
QUANTITIES = {
    "load": "load",
    "approach": "depth",
    "contact_area": "contact area",
    "peak_pressure": "largest pressure, of the roller's half at the edge",
    "von_mises": "largest von Mises stress, of the roller's half at the edge",
    "von_mises_depth": "depth of the largest von Mises stress",
}
RELATIVE = ("load", "approach", "contact_area")
"""Over their values on the half-space. Pressure and stress are over p0, depths of stresses over a."""


@dataclass(frozen=True, kw_only=True)
class Indenter:
    """A rigid shape and its load: SI units.

    Attributes
    ----------
    roller : Roller
        The shape.
    material : Material
        Of the body.
    load : float
        Normal load.
    half_width : float
        ``a`` of this load on the half-space.
    offset : float
        Distance from the shape's first x to its reference point, at the distance e from the edge.
    span : float
        Distance from the reference point to the last x of the evaluated pressures.
    x, z : tuple of float
        Points around the largest stress, over ``a``: along x from the reference point, and depths.
    accuracy : float
        Accuracy of the refined columns.
    """

    roller: cs.Roller
    material: cs.Material
    load: float
    half_width: float
    offset: float
    span: float
    x: tuple[float, ...]
    z: tuple[float, ...]
    accuracy: float

    def case(self, distance: float, model: str = "exact") -> cs.Case:
        """Pressed with its load at a distance over ``a``."""
        body: Body = cs.QuarterSpace(material=self.material, model=model)
        if np.isinf(distance):
            body, distance = cs.HalfSpace(material=self.material), 0.0
        start = distance * self.half_width - self.offset
        return cs.Case(body=body, roller=self.roller, load=self.load, end_distance=start)


def sphere(poisson: float = 0.3, accuracy: float = 0.004) -> Indenter:
    """Sphere with the peak pressure p0 on the half-space (K. L. Johnson, Contact Mechanics, 1985, section 4.2)."""
    material = cs.Material(YOUNG, poisson)
    a = np.pi * PRESSURE * RADIUS / (2 * material.plane_strain_modulus)
    shape = cs.Roller(radius=RADIUS, length=4 * a, profile=cs.profiles.Sphere(RADIUS))
    load = 2 / 3 * np.pi * a**2 * PRESSURE
    x, z = tuple(np.linspace(-0.6, 1.0, 17)), tuple(np.linspace(0.05, 0.8, 16))
    return Indenter(
        roller=shape, material=material, load=load, half_width=a, offset=2 * a, span=2 * a, x=x, z=z, accuracy=accuracy
    )


def cylinder(length: float = 16.0, edge_radius: float = 1.5, accuracy: float = 0.01) -> Indenter:
    """Roller with the mean load of a line contact with the peak pressure p0; lengths over ``a``."""
    material = cs.Material(YOUNG, 0.3)
    a = 2 * PRESSURE * RADIUS / material.plane_strain_modulus
    shape = cs.Roller(radius=RADIUS, length=length * a, profile=cs.profiles.Cylinder(edge_radius * a))
    load = length * a * np.pi / 2 * a * PRESSURE
    # The stress is largest under the narrow pressure peak where the edge radius begins.
    x, z = tuple(edge_radius + np.linspace(-0.2, 0.2, 33)), tuple(np.linspace(0.0, 0.15, 16))
    span = 0.5 * length * a
    return Indenter(
        roller=shape, material=material, load=load, half_width=a, offset=0.0, span=span, x=x, z=z, accuracy=accuracy
    )


class Cells(NamedTuple):
    """Refined cells of a case, the same cells halved both ways, and errors of the former."""

    coarse: cs.Grid
    fine: cs.Grid
    peak_error: float
    end_traction_residual: float


def refine_cells(case: cs.Case, accuracy: float) -> Cells:
    """Cells with a converged peak; the error is relative to the peak."""
    # A result with stresses, here at one point, contains the residual on the ends.
    refined = cs.solve(case, accuracy=accuracy, x=[0.0], y=[0.0], z=[case.hertz_half_width])
    edges = np.append(refined["x_bounds"].values[:, 0], refined["x_bounds"].values[-1, 1])
    y, step = refined["y"].values, float(refined["y"][1] - refined["y"][0])
    y_range = (float(y[0] - 0.5 * step), float(y[-1] + 0.5 * step))
    midpoints = 0.5 * (edges[1:] + edges[:-1])
    return Cells(
        cs.Grid.between(edges, y_range, y.size),
        cs.Grid.between(np.sort(np.append(edges, midpoints)), y_range, 2 * y.size),
        float(refined["peak_pressure_error"] / refined["peak_pressure"]),
        float(refined["end_traction_residual"]),
    )


def press_indenter(case: cs.Case, grid: cs.Grid, approach: float | None = None) -> xr.Dataset:
    """Contact of a case on given cells, with its load or to a given depth."""
    positions = {"x": grid.x, "y": grid.y, "x_width": ("x", grid.widths)}
    gap = xr.DataArray(case.gap(grid), coords=positions, dims=("x", "y"))
    if approach is None:
        return cs.solve_contact(case.body, gap, load=case.normal_load)
    return cs.solve_contact(case.body, gap, approach=approach)


def largest_von_mises(indenter: Indenter, case: cs.Case, contact: xr.Dataset) -> tuple[float, float]:
    """Largest von Mises stress in the plane y = 0, Pa, and its depth, metres, by a spline between the points."""
    a, edge_x = indenter.half_width, case.body.extent[0]
    x = np.unique(np.maximum(case.roller_start + indenter.offset + a * np.array(indenter.x), edge_x))
    z = a * np.array(indenter.z)
    pressure = contact["pressure"]
    stress = (
        cs.stress_field(case.body, pressure, x=x, y=[0.0], z=z, inside_cells=pressure)["von_mises"].isel(y=0).values
    )
    i, j = divmod(int(stress.argmax()), z.size)
    if i == x.size - 1 or j in (0, z.size - 1) or (i == 0 and x[0] > edge_x):
        raise ValueError(f"largest stress on the border of the points, x = {x[i] / a:g} a, z = {z[j] / a:g} a")
    spline = RectBivariateSpline(x / a, z / a, stress / PRESSURE)
    bounds = [(axis[max(position - 1, 0)] / a, axis[position + 1] / a) for axis, position in ((x, i), (z, j))]
    optimum = minimize(lambda position: -spline(*position)[0, 0], (x[i] / a, z[j] / a), bounds=bounds)
    return float(-optimum.fun * PRESSURE), float(optimum.x[1] * a)


def evaluate_contact(indenter: Indenter, case: cs.Case, contact: xr.Dataset) -> dict[str, float]:
    """Every quantity of one contact, SI units."""
    last = case.roller_start + indenter.offset + indenter.span
    pressure = contact["pressure"].sel(x=slice(None, last))
    stress, depth = largest_von_mises(indenter, case, contact)
    return {
        "load": float(contact["normal_load"]),
        "approach": float(contact["approach"]),
        "contact_area": float(cs.analysis.contact_edges(contact)["contact_area"]),
        "peak_pressure": float(pressure.max()),
        "von_mises": stress,
        "von_mises_depth": depth,
    }


def solve_with_errors(
    indenter: Indenter, distance: float, depth: float | None, condition: Sequence[str]
) -> dict[str, dict[str, float]]:
    """Every quantity with its error, pressed to a depth and with the load: the change from cells twice the size.

    The error of the peak is at least half of the error that the refinement states for the coarse cells.
    """
    with threadpool_limits(1):
        case = indenter.case(distance)
        cells = refine_cells(case, indenter.accuracy)
        solutions = {}
        for condition_name in condition:
            approach = depth if condition_name == "depth" else None
            coarse, fine = (
                evaluate_contact(indenter, case, press_indenter(case, grid, approach)) for grid in cells[:2]
            )
            errors = {f"{name}_error": abs(fine[name] - coarse[name]) for name in fine}
            min_error = 0.5 * cells.peak_error * fine["peak_pressure"]
            errors["peak_pressure_error"] = max(errors["peak_pressure_error"], min_error)
            solutions[condition_name] = fine | errors | {"end_traction_residual": cells.end_traction_residual}
        return solutions


def solve_all(indenters: dict[str, Indenter], distances: Sequence[float]) -> xr.Dataset:
    """Every quantity (indenter, held, e_over_a), the half-space last."""
    names = list(indenters)
    with ProcessPoolExecutor() as workers:
        half_space = dict(zip(names, workers.map(_on_half_space, indenters.values()), strict=True))
        tasks = list(itertools.product(names, distances))
        depths = [half_space[name]["approach"] for name, _ in tasks]
        columns = zip(*((indenters[name], distance) for name, distance in tasks), strict=True)
        solutions = dict(
            zip(tasks, workers.map(solve_with_errors, *columns, depths, itertools.repeat(CONDITIONS)), strict=True)
        )
    for name in names:
        solutions[name, HALF_SPACE] = dict.fromkeys(CONDITIONS, half_space[name])
    dims = ("indenter", "condition", "e_over_a")
    positions = [*distances, HALF_SPACE]

    def collect(key: str, quantity: str) -> list[list[list[float]]]:
        return [
            [
                [solutions[name, e][condition_name][key] / scale_of(name, quantity) for e in positions]
                for condition_name in CONDITIONS
            ]
            for name in names
        ]

    def scale_of(name: str, quantity: str) -> float:
        if quantity in RELATIVE:
            return half_space[name][quantity]
        return indenters[name].half_width if quantity == "von_mises_depth" else PRESSURE

    values: dict[str, tuple[object, ...]] = {}
    for quantity, meaning in QUANTITIES.items():
        unit = "that on the half-space" if quantity in RELATIVE else "a" if quantity == "von_mises_depth" else "p0"
        values[quantity] = (dims, collect(quantity, quantity), {"units": "1", "long_name": f"{meaning} over {unit}"})
        key = f"{quantity}_error"
        values[key] = (dims, collect(key, quantity), {"units": "1", "long_name": f"error of {meaning} over {unit}"})
    residual = [[solutions[name, e]["load"]["end_traction_residual"] for e in positions] for name in names]
    values["end_traction_residual"] = (
        ("indenter", "e_over_a"),
        residual,
        {"units": "1", "long_name": "residual traction on the free end over the peak pressure, at the given load"},
    )
    return xr.Dataset(
        values,
        coords={
            "indenter": names,
            "condition": list(CONDITIONS),
            "e_over_a": ("e_over_a", positions, {"units": "1", "long_name": "distance from the edge over a"}),
            "a": ("indenter", [indenters[name].half_width for name in names], {"units": "m"}),
            "poisson": ("indenter", [indenters[name].material.poisson for name in names], {"units": "1"}),
        },
        attrs={"Conventions": "CF-1.11", "title": "a sphere and a cylinder near the edge of a quarter space"},
    )


def _on_half_space(indenter: Indenter) -> dict[str, float]:
    """Every quantity on the half-space."""
    return solve_with_errors(indenter, HALF_SPACE, None, ("load",))["load"]


class Check(NamedTuple):
    """A number with an independent expected value."""

    name: str
    value: float
    expected: float


def far_load(poisson: float, distance: float) -> float:
    """Load over the half-space's at equal depth of a sphere far from the edge, at a distance over ``a``.

    The contact acts like a point load P: the edge adds ``kappa P / (2 pi E* e)`` to Hertz' approach. With s the load
    over the half-space's, ``s**(2/3) + 2 kappa s / (3 pi e / a) = 1``.
    """
    deflection = 2 * EXTRA_DEFLECTION[poisson] / (3 * np.pi * distance)
    return float(brentq(lambda s: s ** (2 / 3) + deflection * s - 1, 0.0, 1.0))


def checks(ball: Indenter, roller: Indenter) -> list[Check]:
    """Compare the solutions with closed forms, limits and balances."""
    with threadpool_limits(1):
        return [*_hertz_checks(ball), *_edge_checks(ball), *_roller_checks(roller)]


def _hertz_checks(ball: Indenter) -> list[Check]:
    """Sphere on a half-space, and beside a frictionless rigid wall, which mirrors the load: Hertz' contact."""
    a, poisson = ball.half_width, ball.material.poisson
    depth = a**2 / RADIUS
    solutions = solve_with_errors(ball, HALF_SPACE, depth, ("depth",))["depth"]
    z = np.linspace(0.2, 0.8, 2001) * a
    axial, radial = hertz_circle_axis(z, a, PRESSURE, poisson)
    max_index = int(np.abs(axial - radial).argmax())
    wall_case = ball.case(0.0, model="mirror")
    walled = press_indenter(wall_case, refine_cells(wall_case, ball.accuracy).fine, depth)
    area = float(cs.analysis.contact_edges(walled)["contact_area"])
    far = max(DISTANCES)
    load = solve_with_errors(ball, far, depth, ("depth",))["depth"]["load"] / ball.load
    return [
        Check("sphere, half-space: load / Hertz", solutions["load"] / ball.load, 1.0),
        Check("sphere, half-space: area / (pi a^2)", solutions["contact_area"] / (np.pi * a**2), 1.0),
        Check("sphere, half-space: peak / p0", solutions["peak_pressure"] / PRESSURE, 1.0),
        Check(
            "sphere, half-space: von Mises / p0",
            solutions["von_mises"] / PRESSURE,
            abs(axial - radial)[max_index] / PRESSURE,
        ),
        Check("sphere, half-space: its depth / a", solutions["von_mises_depth"] / a, z[max_index] / a),
        Check("sphere, e = 0, end held by a smooth wall: load / Hertz", float(walled["normal_load"]) / ball.load, 0.5),
        Check("sphere, e = 0, end held by a smooth wall: area / (pi a^2)", area / (np.pi * a**2), 0.5),
        Check(f"sphere, e = {far:g} a: load at equal depth, from a point load", load, far_load(poisson, far)),
    ]


def _edge_checks(ball: Indenter) -> list[Check]:
    """Sphere centred on the edge: similarity in the depth, balance of the load, and symmetry."""
    a = ball.half_width
    case = ball.case(0.0)
    cells = refine_cells(case, ball.accuracy)
    contact = press_indenter(case, cells.fine)
    pressure = contact["pressure"]
    approach = float(contact["approach"])
    deep = press_indenter(case, cells.fine, a**2 / RADIUS)
    # Gauss points of growing intervals: the region beyond 40 a carries 1e-4 of the load.
    nodes, weights = np.polynomial.legendre.leggauss(8)
    edges = a * np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 9.0, 18.0, 40.0])
    positions = (edges[:-1, None] + 0.5 * np.diff(edges)[:, None] * (nodes + 1)).ravel()
    areas = (0.5 * np.diff(edges)[:, None] * weights).ravel()
    normal_stress = (
        cs.stress_field(case.body, pressure, x=positions, y=positions, z=[a], inside_cells=pressure)["sigma_zz"]
        .isel(z=0)
        .values
    )
    resultant = -2 * float(areas @ normal_stress @ areas)
    stress = cs.stress_field(
        case.body,
        pressure,
        x=a * np.array(ball.x[6:]),
        y=a * np.array([0, 0.1, 0.3]),
        z=a * np.array(ball.z),
        inside_cells=pressure,
    )
    peaks = stress["von_mises"].max(("x", "z")).values
    return [
        Check(
            "sphere, e = 0: load at equal depth, from the depth at equal load",
            float(deep["normal_load"]) / ball.load,
            (approach * RADIUS / a**2) ** -1.5,
        ),
        Check("sphere, e = 0: load carried by the plane z = a", resultant / ball.load, 1.0),
        Check(
            "sphere, e = 0: pressure at -y less that at y, over p0",
            float(np.abs(pressure.values - pressure.values[:, ::-1]).max()) / PRESSURE,
            0.0,
        ),
        Check("sphere, e = 0: y / a of the largest von Mises stress", float(stress["y"][int(peaks.argmax())]) / a, 0.0),
        Check("sphere, e = 0: residual traction on the end, over the peak", cells.end_traction_residual, 0.0),
    ]


def _roller_checks(roller: Indenter) -> list[Check]:
    """Middle of the roller far from the edge: Hertz' line contact of the pressure there."""
    case = roller.case(max(DISTANCES))
    contact = press_indenter(case, refine_cells(case, roller.accuracy).fine)
    middle = case.roller_start + 0.5 * case.roller.length
    half_width = float(cs.analysis.contact_edges(contact)["half_width"].sel(x=middle, method="nearest"))
    pressure = float(contact["pressure"].sel(x=middle, method="nearest").max())
    hertz = case.modulus * half_width / (2 * case.roller.radius)
    name = f"cylinder, e = {max(DISTANCES):g} a, mid-length: pressure over that of Hertz' line contact as wide"
    return [Check(name, pressure / hertz, 1.0)]


def check_table(solutions: Sequence[Check]) -> str:
    """Markdown: every check."""
    lines = ["| check | found | expected | difference |", "|---|---|---|---|"]
    lines += [
        f"| {name} | {value:.4f} | {expected:.4f} | {value - expected:.1e} |" for name, value, expected in solutions
    ]
    return "\n".join(lines)


def format_value(value: float, error: float) -> str:
    """Value with its error, rounded up."""
    return f"{value:.3f} ± {np.ceil(max(1e3 * error, 1.0)) / 1e3:.3f}"


def format_table(solutions: xr.Dataset, indenter: str, condition: str) -> str:
    """Markdown: a row for each distance."""
    free = "approach" if condition == "load" else "load"
    rows = solutions.sel(indenter=indenter, condition=condition)
    names = (free, "contact_area", "peak_pressure", "von_mises", "von_mises_depth")
    lines = [f"| e / a | {QUANTITIES[free]} | area | peak / p0 | von Mises / p0 | stress depth / a |", "|---" * 6 + "|"]
    for row in range(rows.sizes["e_over_a"]):
        cells = [format_value(float(rows[name][row]), float(rows[f"{name}_error"][row])) for name in names]
        distance = float(rows["e_over_a"][row])
        lines.append(f"| {'half-space' if np.isinf(distance) else f'{distance:g}'} | {' | '.join(cells)} |")
    return "\n".join(lines)


def poisson_table(solutions: xr.Dataset) -> str:
    """Markdown: load at equal depth and von Mises stress at equal depth and load of spheres of any Poisson's ratio."""
    spheres = solutions.isel(indenter=[str(name).startswith("sphere") for name in solutions["indenter"].values])
    spheres = spheres.sortby("poisson")
    headings = [f"nu = {float(nu):g}: load, von Mises at equal depth, at equal load" for nu in spheres["poisson"]]
    lines = [f"| e / a | {' | '.join(headings)} |", "|---" * (len(headings) + 1) + "|"]
    for distance in spheres["e_over_a"].values:
        cells = []
        for i in range(spheres.sizes["indenter"]):
            row = spheres.isel(indenter=i).sel(e_over_a=distance)
            pairs = [("load", "depth"), ("von_mises", "depth"), ("von_mises", "load")]
            values = [
                (
                    float(row[name].sel(condition=condition_name)),
                    float(row[f"{name}_error"].sel(condition=condition_name)),
                )
                for name, condition_name in pairs
            ]
            cells.append(", ".join(format_value(*value) for value in values))
        lines.append(f"| {'half-space' if np.isinf(distance) else f'{distance:g}'} | {' | '.join(cells)} |")
    return "\n".join(lines)


LABELS = {
    "load": "load",
    "approach": "depth",
    "contact_area": "contact area",
    "peak_pressure": "largest pressure",
    "von_mises": "largest von Mises stress",
}


def draw(solutions: xr.Dataset, indenters: Sequence[str] = ("sphere", "cylinder")) -> plt.Figure:
    """Every quantity over its value on the half-space against the distance: a panel for each shape and condition."""
    figure, axes = plt.subplots(2, len(indenters), figsize=(8.0, 7.0), layout="constrained", sharex=True)
    distances = solutions["e_over_a"].values[np.isfinite(solutions["e_over_a"].values)]
    for (row, condition), (column, indenter) in itertools.product(enumerate(CONDITIONS), enumerate(indenters)):
        ax, case = axes[row, column], solutions.sel(indenter=indenter, condition=condition)
        ratio = case.sel(e_over_a=distances) / case.sel(e_over_a=HALF_SPACE)
        ax.axhline(1.0, color="0.7", linewidth=0.8)
        names = [name for name in LABELS if name != ("approach" if condition == "depth" else "load")]
        for name, style, marker in zip(names, line_styles(len(names)), MARKERS, strict=False):
            ax.plot(distances, ratio[name], marker=marker, markersize=5, label=LABELS[name], **style)
        if indenter == "sphere" and condition == "depth":
            far_distances = np.linspace(2.0, distances[-1], 61)
            line = [far_load(float(case["poisson"]), float(e)) for e in far_distances]
            ax.plot(far_distances, line, color="0.6", linewidth=3, zorder=0, label="load, point load far from the edge")
        ax.set_title(f"{indenter}, equal {condition}", fontsize="medium")
        ax.legend(frameon=False, fontsize="small")
        if column == 0:
            ax.set_ylabel("over the half-space")
        if row == 1:
            end = "centre" if indenter.startswith("sphere") else "roller's end"
            ax.set_xlabel(f"distance of the {end} from the edge, $e/a$")
    return figure


def main() -> None:
    """Solve, check, print, draw, write."""
    parser = argparse.ArgumentParser(description="A sphere and a cylinder near the edge of a quarter space.")
    parser.add_argument("--out", type=Path, default=Path("results/quarter_space"))
    options = parser.parse_args()
    indenters = {
        "sphere": sphere(),
        "cylinder": cylinder(),
        "sphere, nu = 0": sphere(0.0, accuracy=0.01),
        "sphere, nu = 0.5": sphere(0.5, accuracy=0.01),
    }
    solutions = solve_all(indenters, DISTANCES)
    options.out.mkdir(parents=True, exist_ok=True)
    solutions.to_netcdf(options.out / "quarter_space.nc")
    draw(solutions).savefig(options.out / "quarter_space.png", dpi=110)
    for indenter, condition in itertools.product(("sphere", "cylinder"), CONDITIONS):
        text = format_table(solutions, indenter, condition)
        print(f"{indenter.capitalize()}, {condition} as on the half-space:\n\n{text}\n")
    print(f"Spheres:\n\n{poisson_table(solutions)}\n")
    print(check_table(checks(indenters["sphere"], indenters["cylinder"])))


if __name__ == "__main__":
    main()
