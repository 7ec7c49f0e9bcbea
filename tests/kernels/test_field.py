"""A field at positions along x that lie in many different ways, which is interpolated, as at each of them alone."""

from __future__ import annotations

import numpy as np

from contactstudy import Grid
from contactstudy.kernels import stress
from contactstudy.kernels.field import half_space_field
from contactstudy.kernels.influence import Influence
from contactstudy.kernels.load import Load
from contactstudy.kernels.patch import STRESS_CORNERS


def test_interpolated_positions_have_the_field_of_each_alone() -> None:
    """Under a load without steps along x; two cell centres fewer around each position leave twenty times as much."""
    grid = Grid((0.0, 8.0), (-2.0, 2.0), 80, 16)
    load = (1 - (grid.y / 2.0) ** 2) * np.ones(grid.shape)
    x, z = np.sort(np.random.default_rng(0).uniform(0.0, 8.0, 25)), np.array([0.05, 0.5])
    influence = Influence.of(STRESS_CORNERS[Load.NORMAL], 0.3, Load.NORMAL, stress.UNDER_PRESSURE)
    together, *alone = (
        half_space_field(load, influence, grid, each, grid.y[::4], z, extent=(0.0, 8.0)) for each in (x, *x[:, None])
    )
    np.testing.assert_allclose(together, np.concatenate(alone, axis=1), rtol=0, atol=2e-8 * np.abs(together).max())
