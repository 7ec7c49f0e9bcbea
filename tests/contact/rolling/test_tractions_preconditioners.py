"""The approximate inverse of the tangential compliance against dense matrices of periodic unit loads."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Grid, HalfSpace, Material
from contactstudy.checks import FloatArray, IntArray
from contactstudy.contact.rolling.tractions import tangential_inverse
from contactstudy.fields.surface import surface_operator
from contactstudy.kernels.load import Load

MATERIALS = [Material(210e9, 0.3), Material(70e9, 0.2)]
TANGENTIAL = (Load.ALONG_X, Load.ALONG_Y)
ROWS, COLUMNS = 3, 4
DY = 2e-5
STEP = 3e-5
GRADED_EDGES = 1e-5 * np.cumsum([0.0, 1.0, 2.0, 4.0])


def compute_displacements(edges: FloatArray, row: int) -> FloatArray:
    """Displacements (direction, load, row, offset along y) of two half-spaces under a unit traction on a row."""
    grid = Grid.between(edges, (-(COLUMNS + 0.5) * DY, (COLUMNS + 0.5) * DY), 2 * COLUMNS + 1)
    unit, computed = np.zeros(grid.shape), np.zeros((2, 2, *grid.shape))
    unit[row, COLUMNS] = 1.0
    for material in MATERIALS:
        operator = surface_operator(HalfSpace(material=material), grid, TANGENTIAL, TANGENTIAL)
        for index, load in enumerate(TANGENTIAL):
            displacements = operator.compute_displacements({load: unit}, TANGENTIAL)
            computed[:, index] += np.stack([displacements[direction] for direction in TANGENTIAL])
    return computed


def compute_periodic_offsets(period: int) -> IntArray:
    """Offsets between all cells of a period, in the interval (-period / 2, period / 2]."""
    cell_indices = np.arange(period)
    return (np.subtract.outer(cell_indices, cell_indices) + period // 2 - 1) % period - (period // 2 - 1)


def compute_periodic_compliance(*, is_uniform: bool) -> FloatArray:
    """Compliance (direction, row, column, load, row, column) on cells with a period of twice the patch."""
    offsets_y = compute_periodic_offsets(2 * COLUMNS)
    if is_uniform:
        table = compute_displacements(STEP * np.arange(2 * ROWS + 2.0), ROWS)
        offsets_x = compute_periodic_offsets(2 * ROWS)
        computed = table[:, :, (offsets_x + ROWS)[:, :, None, None], (offsets_y + COLUMNS)[None, None]]
        return computed.transpose(0, 2, 4, 1, 3, 5)
    tables = np.stack([compute_displacements(GRADED_EDGES, row) for row in range(ROWS)], axis=3)
    # The cell half a period away has the mean of both neighbouring periods.
    tables[..., 0] = tables[..., -1] = 0.5 * (tables[..., 0] + tables[..., -1])
    return tables[..., offsets_y + COLUMNS].transpose(0, 2, 4, 1, 3, 5)


@pytest.mark.parametrize("is_uniform", [True, False])
@pytest.mark.parametrize("is_rolling", [False, True])
def test_preconditioner_inverts_periodic_compliance(*, is_uniform: bool, is_rolling: bool) -> None:
    edges = STEP * np.arange(ROWS + 3.0) if is_uniform else np.concatenate([[-4e-5], GRADED_EDGES, [12e-5]])
    grid = Grid.between(edges, (0.0, (COLUMNS + 2) * DY), COLUMNS + 2)
    mask = np.zeros(grid.shape, bool)
    mask[1 : 1 + ROWS, 1 : 1 + COLUMNS] = True
    mask[1, COLUMNS] = False
    cells = np.argwhere(mask).T
    matrix = compute_periodic_compliance(is_uniform=is_uniform)
    shape, size = matrix.shape[:3], matrix[..., 0, 0, 0].size
    matrix = matrix.reshape(size, size)
    if is_rolling:  # minus the displacement of the cell ahead; constants change a little
        period = 2 * COLUMNS
        change = (1 + 1.5 * 2 * np.pi / period) * np.eye(period) - np.roll(np.eye(period), 1, axis=1)
        matrix = np.kron(np.eye(size // period), change / DY) @ matrix
    # Tractions begin as a root behind the leading edge of each row.
    length = mask.sum(axis=1)[cells[0]]
    root_factor = np.sqrt((length - (cells[1] - 1) - 0.5) / length) if is_rolling else np.ones(cells.shape[1])
    slip = np.random.default_rng(1).standard_normal((2, cells.shape[1]))
    scaled_slip = np.zeros(shape)
    scaled_slip[:, cells[0] - 1, cells[1] - 1] = slip / root_factor
    expected = np.linalg.solve(matrix, scaled_slip.ravel()).reshape(shape)[:, cells[0] - 1, cells[1] - 1] * root_factor
    computed = tangential_inverse(MATERIALS, cells, grid, rolling=is_rolling)(slip)
    assert computed == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())
    assert tangential_inverse(MATERIALS, cells, grid, rolling=is_rolling)(3e-9 * slip) == pytest.approx(
        3e-9 * expected, abs=3e-14 * np.abs(expected).max()
    )
