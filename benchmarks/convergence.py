"""Errors over the grid, every setting of the quadratures and the window.

``python -m benchmarks.convergence [--out FOLDER]`` prints the tables and their checks (an order, or an error at the
value in use), writes the figure ``convergence.png`` into a folder, and exits 1 if a check fails.
"""

from __future__ import annotations

import argparse
import sys
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contactstudy.arrays.grid import Grid, Points
from contactstudy.arrays.variables import STRESSES
from contactstudy.bodies.models import FiniteLengthSpace, HalfSpace
from contactstudy.checks import FloatArray
from contactstudy.contact import ContactSettings
from contactstudy.contact.solve import solve_contact
from contactstudy.fields.stress import stress_field
from contactstudy.fields.surface import SurfaceOperator
from contactstudy.kernels.load import Load
from contactstudy.overlapping.field import STRESS, end_fields
from contactstudy.overlapping.problem import EndProblem
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.plots.style import line_styles
from contactstudy.verification import closed_forms
from contactstudy.verification.free_ends import create_pressure
from contactstudy.verification.problems import (
    LINE_LOAD,
    LOAD_CASES,
    STRESS_FILE,
    Check,
    Reference,
    components,
    load_reference,
    on_cells,
    quartic,
    unit_material,
)
from contactstudy.verification.suite import HEADING, create_panels, format_line, format_row

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, kw_only=True)
class Table:
    """Errors over the values of one setting.

    Attributes
    ----------
    title, setting, source : str
        Solved case, changed setting, and the reference of the errors.
    values : tuple of float
        Values of the setting.
    errors : dict of str to tuple of float
        Errors by quantity, one for each value.
    value_in_use : float
        Value in use, or the most accurate value of the table.
    tolerance : float, optional
        Bound on every error at `used`, if checked.
    order : float, optional
        Least order expected of the first quantity over the whole table, if the setting is a number of cells.
    """

    title: str
    setting: str
    source: str
    values: tuple[float, ...]
    errors: dict[str, tuple[float, ...]]
    value_in_use: float
    tolerance: float | None = None
    order: float | None = None

    def orders(self, quantity: str) -> FloatArray:
        """Orders observed from each value to the next."""
        errors = np.maximum(np.asarray(self.errors[quantity]), 1e-300)
        return np.asarray(-np.diff(np.log(errors)) / np.diff(np.log(np.asarray(self.values))))

    @property
    def mean_order(self) -> float:
        """Order of the first quantity from the first value to the last."""
        errors = next(iter(self.errors.values()))
        return float(np.log(errors[0] / errors[-1]) / np.log(self.values[-1] / self.values[0]))

    def checks(self) -> Iterator[Check]:
        """Compare the errors at the value in use with the tolerance, and the mean order with the expected order."""
        if self.tolerance is not None:
            index = self.values.index(self.value_in_use)
            for quantity, errors in self.errors.items():
                case = f"{self.title}; {self.setting} {self.value_in_use:g}"
                yield Reference(case, self.source).compare(f"{quantity}, error", errors[index], 0.0, self.tolerance)
        if self.order is not None:
            shortfall = min(0.0, self.mean_order - self.order)
            quantity = f"order in the {self.setting}, at least {self.order:g}, shortfall"
            yield Reference(self.title, self.source).compare(quantity, shortfall, 0.0, 0.0)


def tabulate_point_contact() -> Table:
    """Hertz point contact over the grid."""
    body, errors = HalfSpace(material=unit_material()), []
    cells = (33, 65, 129, 257)
    _, peak, approach = closed_forms.hertz_point(4 / 3, 1.0, 1.0)
    for count in cells:
        gap = on_cells(lambda x, y: 0.5 * (x**2 + y**2), (-1.5, 1.5), (-1.5, 1.5), (count, count))
        contact = solve_contact(body, gap, load=4 / 3, settings=ContactSettings(tolerance=1e-8))
        line = contact["pressure"].sel(y=0, method="nearest")
        exact = peak * np.sqrt(np.maximum(1 - line["x"] ** 2, 0))
        errors.append((abs(float(contact["approach"]) - approach), float(abs(line - exact).mean()) / peak))
    approach_errors, mean_errors = zip(*errors, strict=True)
    return Table(
        title="Hertz point contact",
        setting="number of cells across",
        source="Hertz",
        values=cells,
        errors={"approach": approach_errors, "mean error of the pressure / p0 along y = 0": mean_errors},
        tolerance=1e-3,
        value_in_use=257,
        order=1.4,
    )


def tabulate_stress_grid() -> Table:
    """Stresses under a smooth load over the grid."""
    case = LOAD_CASES["full_sliding"]
    reference_stress = load_reference(STRESS_FILE, "full_sliding").sel(z=slice(0.0999, None))
    points = {axis: reference_stress[axis].values.astype(float) for axis in "xyz"}
    expected = np.array([reference_stress[name].transpose("x", "y", "z").values for name in STRESSES])
    body = FiniteLengthSpace(length=case.length, material=unit_material(case.poisson))
    cells = (8, 16, 32, 64)
    errors = []
    for count in cells:
        load = create_pressure(case, count)
        stress = stress_field(body, load, friction=case.friction, **points, inside_cells=load)
        difference = np.abs(components(stress) - expected)
        errors.append((float(difference.max()), float(difference.mean())))
    max_errors, mean_errors = zip(*errors, strict=True)
    return Table(
        title="stresses under a smooth load on both ends, L = 8a, f = 0.3, z >= 0.1a",
        setting="number of cells over its width",
        source="finite elements",
        values=cells,
        errors={"largest difference / p0": max_errors, "mean difference / p0": mean_errors},
        tolerance=5e-4,
        value_in_use=64,
        order=1.8,
    )


def tabulate_contact_grid() -> Table:
    """Contact of a cylinder with a body of equal length over the grid."""
    body = FiniteLengthSpace(length=8.0, material=unit_material())
    counts = (4, 8, 16, 32)
    end_distances = np.array([0.25, 0.5, 1.0, 2.0])  # distances from an end: edges of cells on every grid

    def end_loads(count: int) -> FloatArray:
        gap = on_cells(lambda x, y: y**2 + 0 * x, (0, 8), (-1.75, 1.75), (8 * count, 7 * count // 2 + 1 - count % 2))
        load = (
            solve_contact(body, gap, load=8 * LINE_LOAD, settings=ContactSettings(tolerance=1e-8))["pressure"].sum("y")
            * 3.5
            / gap["y"].size
        )
        cumulative_load = np.append(0.0, np.cumsum(load.values)) * 8 / load.size
        return np.asarray(cumulative_load[np.round(end_distances * count).astype(int)])

    reference = end_loads(96)
    errors = np.array([np.abs(end_loads(count) - reference) for count in counts])
    return Table(
        title="rigid cylinder on a body of the same length, 8a",
        setting="number of cells per a",
        source="96 cells per a",
        values=counts,
        errors={
            f"load on the last {end_distance:g}a / (p0 a^2)": tuple(column)
            for end_distance, column in zip(end_distances, errors.T, strict=True)
        },
        tolerance=5e-3,
        value_in_use=16,
        order=1.0,
    )


FINEST_RESOLUTION = Resolution(
    step=0.12,
    angle=np.pi / 6.5,
    reach=1000.0,
    ray_reach=200.0,
    modes=12,
    lateral_nodes=20,
    lateral_ratio=2.0,
    lateral_order=32,
    lateral_reach=20.0,
)
"""Reference of the errors: every setting finer than its default."""

SETTINGS: dict[str, tuple[Any, ...]] = {
    "step": (0.44, 0.33, 0.22, 0.16),
    "angle": (np.pi / 12, np.pi / 8, np.pi / 6, np.pi / 5.5),
    "reach": (12.5, 50.0, 200.0, 800.0),
    "ray_reach": (6.25, 12.5, 50.0, 200.0),
    "modes": (2, 4, 8, 16),
    "lateral_nodes": (3, 5, 7, 14),
    "lateral_ratio": (12.0, 8.0, 5.5, 3.0),
    "lateral_order": (4, 8, 16, 32),
    "lateral_reach": (2.5, 5.0, 10.0, 20.0),
}
"""Tested values of every field of `Resolution`; the default is one of them."""


QUADRATURE_CASE = "smooth load on both ends, L = 8a"
"""Case of the errors of the quadratures."""


@lru_cache(maxsize=4)
def _compute_end_fields(resolution: Resolution) -> tuple[FloatArray, FloatArray]:
    """Stresses of the end correction, and the displacement of the top, for the settings of the quadratures."""
    grid = Grid(x_range=(0.0, 8.0), y_range=(-1.0, 1.0), cells_x=32, cells_y=24)
    pressure = np.broadcast_to(quartic(grid.y), grid.shape)
    points = (np.array([0.0, 0.1, 1.0, 4.0]), np.array([0.0, 0.5]), np.array([0.05, 0.5, 3.0]))
    body = FiniteLengthSpace(length=8.0, material=unit_material())
    stress = end_fields(
        EndProblem(
            length=8.0,
            poisson=0.3,
            cell_loads=pressure,
            loads=(Load.NORMAL, Load.ALONG_Y),
            grid=grid,
            resolution=resolution,
        ),
        STRESS,
        [Points(*points)],
    )[0]
    operator = SurfaceOperator.of(body, grid, resolution=resolution)
    return np.stack([stress[load] for load in stress]), operator({Load.NORMAL: pressure})


def _quadrature_errors(resolution: Resolution) -> tuple[float, float]:
    """Largest errors of the stresses and of the displacement, against `FINEST_RESOLUTION`."""
    stress, displacement_error = (
        float(np.abs(field_values - finest_values).max())
        for field_values, finest_values in zip(
            _compute_end_fields(resolution), _compute_end_fields(FINEST_RESOLUTION), strict=True
        )
    )
    return stress, displacement_error


def check_quadratures() -> Iterator[Check]:
    """Errors of the quadratures with the default settings."""
    source = "every setting of the quadratures finer"
    for quantity, error in zip(("stresses / p0", "E* u_z / (p0 a)"), _quadrature_errors(Resolution()), strict=True):
        yield Reference(QUADRATURE_CASE, source).compare(
            f"{quantity}, error with the settings in use", error, 0.0, 2e-5
        )


def tabulate_quadratures() -> Iterator[Table]:
    """Errors over every setting of the quadratures, with the other settings at their defaults."""
    for name, values in SETTINGS.items():
        errors = [_quadrature_errors(replace(Resolution(), **{name: value})) for value in values]
        stresses, displacements = zip(*errors, strict=True)
        yield Table(
            title=f"quadratures, {QUADRATURE_CASE}",
            setting=name,
            source="every setting finer",
            values=values,
            errors={"stresses / p0": stresses, "E* u_z / (p0 a)": displacements},
            value_in_use=getattr(Resolution(), name),
        )


def tabulate_window() -> Table:
    """Contact over the window in y: the pressure outside the contact is zero, so the window has no effect."""
    body = FiniteLengthSpace(length=8.0, material=unit_material())
    widths = (1.3125, 1.75, 2.625, 3.5)

    def solve_pressure(half_window: float) -> FloatArray:
        gap = on_cells(lambda x, y: y**2 + 0 * x, (0, 8), (-half_window, half_window), (64, round(32 * half_window)))
        pressure = solve_contact(body, gap, load=8 * LINE_LOAD, settings=ContactSettings(tolerance=1e-8))["pressure"]
        return pressure.sel(y=slice(-1.3, 1.3)).values

    reference = solve_pressure(7.0)
    errors = tuple(float(np.abs(solve_pressure(width) - reference).max()) for width in widths)
    return Table(
        title="rigid cylinder on a body of the same length, 8a, 16 cells per a across",
        setting="half of the window over a",
        source="half of the window 7a",
        values=widths,
        errors={"pressure / p0": errors},
        tolerance=1e-4,
        value_in_use=1.75,
    )


def tables() -> Iterator[Table]:
    """Every table."""
    yield tabulate_point_contact()
    yield tabulate_stress_grid()
    yield tabulate_contact_grid()
    yield tabulate_window()
    yield from tabulate_quadratures()


def format_markdown(table: Table) -> str:
    """Markdown table of a convergence study."""
    cells = [f"**{value:.4g}**" if value == table.value_in_use else f"{value:.4g}" for value in table.values]
    rows = [format_row([table.setting, *cells]), "|---" * (len(cells) + 1) + "|"]
    for quantity, errors in table.errors.items():
        rows.append(format_row([quantity, *(f"{error:.1e}" for error in errors)]))
        if table.order is not None:
            rows.append(format_row(["... order", "", *(f"{order:.1f}" for order in table.orders(quantity))]))
    return f"**{table.title}**, against {table.source}\n\n" + "\n".join(rows)


def plot_convergence(tables: list[Table]) -> Figure:
    """Draw the errors over every setting, its values at equal distances; a large dot marks the value in use."""
    figure, axes = create_panels(len(tables))
    for ax, table in zip(axes, tables, strict=True):
        value_index = table.values.index(table.value_in_use)
        for style, (quantity, errors) in zip(line_styles(len(table.errors)), table.errors.items(), strict=True):
            visible = np.maximum(errors, 1e-12)
            ax.plot(visible, marker=".", label=textwrap.shorten(quantity, 30), **style)
            ax.plot(value_index, visible[value_index], marker="o", color=style["color"])
        ax.set_yscale("log")
        ax.set_xticks(range(len(table.values)), [f"{value:.3g}" for value in table.values])
        ax.set_xlabel(table.setting)
        ax.set_ylabel("error")
        ax.set_title("\n".join(textwrap.wrap(table.title, 36)), fontsize="small")
        ax.legend(fontsize="x-small")
        ax.grid(alpha=0.3)
    return figure


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, help="folder of the figure")
    options = parser.parse_args()
    all_tables = list(tables())
    checks = [*check_quadratures(), *(check for table in all_tables for check in table.checks())]
    for table in all_tables:
        print(f"\n{format_markdown(table)}")
    print(f"\n{HEADING}")
    for check in checks:
        print(format_line(check))
    if options.out is not None:
        options.out.mkdir(parents=True, exist_ok=True)
        plot_convergence(all_tables).savefig(options.out / "convergence.png", dpi=110)
    return 0 if all(check.passed for check in checks) else 1


if __name__ == "__main__":
    sys.exit(main())
