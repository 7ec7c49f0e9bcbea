"""The load of a problem with free ends: columns, parity, wavenumbers along y, in any unit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contactstudy import Grid, InvalidInputError
from contactstudy.checks import FloatArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.problem import (
    BENDING_POLES,
    FIRST_PANEL_FACTOR,
    MIN_LENGTH_RATIO,
    POLE_PANEL_FACTOR,
    POLES,
    EndProblem,
    lateral_panels,
    split_by_parity,
)
from contactstudy.overlapping.quadrature import Resolution

EDGES = np.array([0.0, 0.2, 0.5, 1.0, 1.7, 2.1, 2.4])
UNIT = 2.0**-17


def make_problem(
    *,
    unit: float = 1.0,
    edges: FloatArray = EDGES,
    length: float = 2.4,
    load: Load = Load.NORMAL,
    pressure: float = 1.0,
) -> EndProblem:
    """A load on cells of width 0.25 from -0.5 to 0.75 along y."""
    grid = Grid.between(unit * edges, (-unit, unit), 8)
    cell_loads = (
        pressure * np.where((grid.y / unit > -0.5) & (grid.y / unit < 0.75), 1.0, 0.0) * (1 + np.arange(6.0))[:, None]
    )
    return EndProblem(
        length=unit * length, poisson=0.3, cell_loads=cell_loads, loads=(load,), grid=grid, resolution=Resolution()
    )


@pytest.mark.parametrize("load", [Load.NORMAL, Load.ALONG_X])
@pytest.mark.parametrize("reference", [None, 24.0])
@pytest.mark.parametrize("length", [2.4, np.inf])
def test_wavenumbers_along_y_depend_on_window_and_positions(load: Load, reference: float | None, length: float) -> None:
    """The first wavenumber depends on the smallest of the lengths of body, window and positions, the last on the finest
    cell."""
    y, poles = np.array([-0.4, 1.5]), BENDING_POLES if load is Load.ALONG_X else POLES
    panel_factor = FIRST_PANEL_FACTOR if reference is None else POLE_PANEL_FACTOR[poles]
    for shortest_distance, finest in ((1e-3, 0.125), (0.2, 0.2)):
        # The window ends at 1.0, the positions at 1.5.
        first_wavenumber = panel_factor / min(length, 4 * max(2.4, 1.0 + 1.5))
        last_wavenumber = Resolution().lateral_reach / finest
        expected = lateral_panels(first_wavenumber, 1.0 + 1.5, last_wavenumber, Resolution(), reference, poles)
        for unit in (1.0, UNIT):
            computed = make_problem(unit=unit, load=load, length=length).panels(
                unit * y, unit * shortest_distance, None if reference is None else unit * reference
            )
            assert len(computed) == len(expected)
            for computed_panel, expected_panel in zip(computed, expected, strict=True):
                assert unit * computed_panel.nodes == pytest.approx(expected_panel.nodes)
                assert unit * computed_panel.fine_nodes == pytest.approx(expected_panel.fine_nodes)
                assert computed_panel.poles == expected_panel.poles


def test_distant_points_determine_first_wavenumber() -> None:
    distant_panels = make_problem(length=1e4).panels(np.array([0.0, 20.0]), 0.2)
    assert distant_panels[0].nodes.max() < FIRST_PANEL_FACTOR / (4 * 21.0) < distant_panels[1].nodes.max()


def test_columns_between_ends_are_symmetric() -> None:
    for unit in (1.0, UNIT, 2.0**-40):
        problem = make_problem(unit=unit)
        edges, cell_loads = problem.column_edges, problem.cell_loads[problem.cell_of_column]
        assert edges + edges[::-1] == pytest.approx(edges[-1])
        assert (edges[0], edges[-1]) == (0.0, problem.length)
        # 0.2, 0.5, 1.0, 1.7, 2.1 and their images 0.3, 0.7, 1.4, 1.9, 2.2
        assert edges / unit == pytest.approx(np.array([0, 0.2, 0.3, 0.5, 0.7, 1, 1.4, 1.7, 1.9, 2.1, 2.2, 2.4]))
        centres = 0.5 * (edges[1:] + edges[:-1]) / unit
        assert np.array_equal(cell_loads, problem.cell_loads[np.searchsorted(EDGES, centres) - 1])
    # Edges equal to images within rounding are one edge.
    rounded_edges = np.array([0.0, 0.7, 1.2 + 1e-14, 1.7 + 3e-14, 2.0, 2.2, 2.4])
    problem = make_problem(edges=rounded_edges)
    edges = problem.column_edges
    assert edges == pytest.approx(np.array([0, 0.2, 0.4, 0.7, 1.2, 1.7, 2.0, 2.2, 2.4]))
    assert problem.cell_of_column.size == edges.size - 1
    assert np.array_equal(make_problem(edges=EDGES, length=np.inf).column_edges, EDGES)


@pytest.mark.parametrize("sign_x", [1, -1])
@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
def test_parity_components_sum_to_load(sign_x: int, unit: float) -> None:
    """Parity and symmetry are opposite for a load along x, whose image is reversed; negligible components are
    omitted."""
    cell_loads = unit * np.random.default_rng(0).random((6, 4))
    parity_loads = split_by_parity(cell_loads, sign_x)
    assert set(parity_loads) == {1, -1}
    assert sum(parity_loads.values()) == pytest.approx(cell_loads)
    for parity, parity_load in parity_loads.items():
        assert parity_load[::-1] == pytest.approx(sign_x * parity * parity_load)
    even_load = cell_loads + cell_loads[::-1]
    assert set(split_by_parity(even_load, sign_x)) == {sign_x}
    assert set(split_by_parity(even_load * (1 + 1e-15 * np.arange(6.0))[:, None], sign_x)) == {sign_x}
    assert set(split_by_parity(even_load * (1 + 1e-11 * np.arange(6.0))[:, None], sign_x)) == {1, -1}


def test_too_thin_body_raises_error() -> None:
    """The width of the five loaded cells of 0.25 is independent of their position."""
    problem = make_problem()
    for shift in (0, 1, -2):
        cell_loads = np.roll(problem.cell_loads, shift, axis=1)
        replace(problem, cell_loads=cell_loads, length=1.001 * MIN_LENGTH_RATIO * 1.25)
        with pytest.raises(InvalidInputError, match=r"width of the contact, 1\.25 m"):
            replace(problem, cell_loads=cell_loads, length=0.999 * MIN_LENGTH_RATIO * 1.25)
    replace(problem, cell_loads=np.zeros(problem.cell_loads.shape), length=1e-9)
