"""Settings and nodes of the quadratures."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import InvalidInputError
from contactstudy.overlapping.quadrature import Resolution, scale_nodes


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("step", 0.0),
        ("step", np.nan),
        ("modes", 8.5),
        ("modes", 0),
        ("lateral_nodes", 1),
        ("lateral_order", -3),
        ("reach", 0.0),
        ("ray_reach", np.nan),
        ("lateral_reach", -1.0),
        ("lateral_ratio", 1.0),
        ("angle", np.pi / 4),
        ("angle", 0.0),
    ],
)
def test_invalid_resolution_raises_error(name: str, value: float):
    with pytest.raises(InvalidInputError, match=name):
        Resolution(**{name: value})


def test_scale_nodes_integrate_an_algebraic_decay() -> None:
    nodes, weights = scale_nodes(1.0, 1e6, 0.25)
    assert weights @ (1 + nodes) ** -2.0 == pytest.approx(1.0, abs=3e-6)
