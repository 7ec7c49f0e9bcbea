"""Displacements of the surface between mirrors: zero at the reference, in any unit."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy.kernels.load import Load, Response
from contactstudy.kernels.surface import row_level, surface_kernel

P, X, Y = Load.NORMAL, Load.ALONG_X, Load.ALONG_Y


@pytest.mark.parametrize("unit", [2.0**-17, 1.0, 2.0**10])
@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("response", [Response(P, P), Response(Y, Y)])
def test_a_row_of_images_displaces_nothing_at_the_reference(response: Response, poisson: float, unit: float) -> None:
    """And about that, like a line load: ``2 (1 - nu) / L ln(r / y)`` per force."""
    length, reference, cell = 0.8 * unit, 8.0 * unit, 0.1 * unit
    x, y = cell * np.arange(4.0), cell * np.array([40.0, 80.0, 160.0])
    found = np.stack(
        [surface_kernel(response, poisson, x, one * np.ones(1), (cell, cell), length, reference)[:, 0] for one in y]
    )
    row = cell**2 * 2 * (1 - poisson) / length
    expected = row * np.log(reference / y)[:, None] * np.ones(4)
    assert found == pytest.approx(expected, abs=2e-3 * cell**2 / length)


def test_rows_without_a_net_load_need_no_level() -> None:
    for displacement in (P, X, Y):
        for load in (P, X, Y):
            found = row_level(Response(displacement, load), 0.3, 0.8, 8.0)
            assert (found != 0) == ((displacement, load) in ((P, P), (Y, Y)))
