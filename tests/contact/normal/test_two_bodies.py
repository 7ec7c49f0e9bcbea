"""The operator of two bodies; a body with an odd number of cells has no coarse cells."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import FiniteLengthSpace, Grid, HalfSpace, Material
from contactstudy.bodies import Counterbody
from contactstudy.contact.normal.two_bodies import CellTransfer, PairOperator
from contactstudy.fields.surface import surface_operator
from contactstudy.kernels.load import Load

STEEL, SOFT = Material(210e9, 0.3), Material(70e9, 0.3)
GRID = Grid(x_range=(0.0, 1.6e-3), y_range=(-4e-4, 4e-4), cells_x=16, cells_y=12)
BODY = FiniteLengthSpace(material=STEEL, length=1.6e-3, model="mirror")


def make_random_load(grid: Grid = GRID) -> dict[Load, np.ndarray]:
    return {Load.NORMAL: np.random.default_rng(0).random(grid.shape)}


@pytest.mark.parametrize("cells", [8, 9])
def test_coarse_operator_matches_fine_operator(cells: int) -> None:
    """The operator of the first body replaces both bodies if the second body has an odd number of cells."""
    counterbody = Counterbody(FiniteLengthSpace(material=SOFT, length=cells * 1e-4, model="mirror"), 4e-4)
    operator = PairOperator.of(BODY, counterbody, GRID, (Load.NORMAL,))
    assert operator.has_paired_cells == (cells % 2 == 0)
    smooth_pressure = np.exp(-(((GRID.x[:, None] - 8e-4) / 2e-4) ** 2) - (GRID.y / 1e-4) ** 2)
    coarse_pressure = smooth_pressure.reshape(8, 2, 6, 2).mean(axis=(1, 3))
    fine_displacement = operator({Load.NORMAL: smooth_pressure}).reshape(8, 2, 6, 2).mean(axis=(1, 3))
    computed = operator.coarse({Load.NORMAL: coarse_pressure})
    is_loaded = coarse_pressure > 0.1
    assert computed[is_loaded] == pytest.approx(fine_displacement[is_loaded], rel=0.25 if cells % 2 else 0.03)


def test_compliances_of_half_spaces_add_up() -> None:
    half_space = HalfSpace(material=STEEL)
    body_operator = surface_operator(half_space, GRID)
    unlike_operator = PairOperator.of(half_space, Counterbody(HalfSpace(material=SOFT)), GRID, (Load.NORMAL,))
    factor = 1 + STEEL.plane_strain_modulus / SOFT.plane_strain_modulus
    scaled_operator, load = PairOperator(body_operator, None, None, factor), make_random_load()
    assert unlike_operator(load) == pytest.approx(factor * body_operator(load))
    assert scaled_operator(load) == pytest.approx(unlike_operator(load))
    gap = make_random_load()[Load.NORMAL]
    assert unlike_operator.precondition(gap) == pytest.approx(body_operator.precondition(gap) / factor)
    assert scaled_operator.precondition(gap) == pytest.approx(unlike_operator.precondition(gap))
    coarse_load = {Load.NORMAL: load[Load.NORMAL][::2, ::2]}
    assert scaled_operator.coarse(coarse_load) == pytest.approx(factor * body_operator.coarse(coarse_load))


@pytest.mark.parametrize("unit", [1.0, 1e-3, 1e6])
def test_transfer_ignores_rounding_of_cells(unit: float) -> None:
    grid = Grid(x_range=(0.0, 1.6 * unit), y_range=(-unit, unit), cells_x=16, cells_y=4)
    for start, has_equal_cells in ((0.4, True), (0.4 + 1e-13, True), (0.4 + 1e-7, False), (0.45, False)):
        counterbody = Counterbody(FiniteLengthSpace(material=SOFT, length=0.8 * unit), start * unit)
        full_counterbody = Counterbody(FiniteLengthSpace(material=SOFT, length=1.6 * unit), (start - 0.4) * unit)
        assert CellTransfer.of(counterbody, grid) is not None  # the counterbody has fewer cells
        assert (CellTransfer.of(full_counterbody, grid) is None) == has_equal_cells


def test_coarse_transfer_matches_fine_transfer() -> None:
    counterbody = Counterbody(FiniteLengthSpace(material=SOFT, length=0.8e-3), 4.3e-4)
    operator = PairOperator.of(BODY, counterbody, GRID, (Load.NORMAL,))
    transfer, coarse_transfer = operator._transfer, operator.coarse._transfer
    load = np.repeat(np.random.default_rng(0).random(8), 2)
    assert coarse_transfer.to_counterbody @ load[::2] == pytest.approx(
        (transfer.to_counterbody @ load).reshape(-1, 2).mean(axis=1)
    )
    expected = np.repeat(np.random.default_rng(1).random(coarse_transfer.to_counterbody.shape[0]), 2)
    assert coarse_transfer.to_body @ expected[::2] == pytest.approx(
        (transfer.to_body @ expected).reshape(-1, 2).mean(axis=1)
    )
