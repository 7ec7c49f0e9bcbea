"""Residual stress of labelled eigenstrains."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import FiniteLengthSpace, HalfSpace, InvalidInputError, Material
from contactstudy.plasticity import eigenstrain_stress
from contactstudy.verification.closed_forms import rectangle_in_half_plane

TEST_MATERIAL = Material(2.0, 0.3)


@pytest.fixture(scope="module")
def square_eigenstrain() -> xr.Dataset:
    """A square of eigenstrain, surrounded by cells without eigenstrain."""
    x, z = -0.45 + 0.1 * np.arange(10), 0.35 + 0.1 * np.arange(10)
    is_inside = ((np.abs(x) < 0.3)[:, None] & (np.abs(z - 0.8) < 0.3)).astype(float)
    strains = {"xx": 1.0, "zz": -0.4, "xz": 0.3}
    fields = {f"plastic_strain_{component}": (("x", "z"), value * is_inside) for component, value in strains.items()}
    return xr.Dataset(fields, {"x": x, "z": z})


def test_stress_of_square_in_half_space_equals_closed_form(square_eigenstrain) -> None:
    x, z = np.array([-0.9, -0.1, 0.05]), np.array([0.2, 0.7, 0.85, 1.6])
    result = eigenstrain_stress(
        HalfSpace(material=TEST_MATERIAL), square_eigenstrain, x, z, z_edges=np.linspace(0.3, 1.3, 11)
    )
    ranges = (-0.3, 0.3), (0.5, 1.1)
    expected = rectangle_in_half_plane(
        x[:, None], z, *ranges, (1.0, 0.0, -0.4, 0.3), TEST_MATERIAL.young, TEST_MATERIAL.poisson
    )
    names = ("sigma_xx", "sigma_yy", "sigma_zz", "tau_xz")
    computed = np.stack([result[name].values for name in names])
    assert np.abs(computed - expected).max() < 1e-4 * np.abs(expected).max()
    assert result["sigma_xx"].attrs["units"] == "Pa"


def test_cells_reach_the_ends_by_default() -> None:
    body = FiniteLengthSpace(length=2.0, material=TEST_MATERIAL)
    x, z = 0.1 + 0.2 * np.arange(10), 0.1 + 0.2 * np.arange(6)
    strain = xr.Dataset({"plastic_strain_xx": (("x", "z"), np.outer(x, z))}, {"x": x, "z": z})
    edges = {"x_edges": np.linspace(0, 2, 11), "z_edges": np.linspace(0, 1.2, 7)}
    result_with_edges, result_without_edges = (
        eigenstrain_stress(body, strain, x=[0.0, 1.05], z=[0.0, 0.65], **options) for options in (edges, {})
    )
    assert np.allclose(result_with_edges["sigma_yy"], result_without_edges["sigma_yy"])
    assert np.abs(result_without_edges["sigma_xx"].sel(x=0.0)).max() < 1e-9
    assert np.abs(result_without_edges["sigma_zz"].sel(z=0.0)).max() < 1e-9


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda data: {"eigenstrain": data.drop_vars(list(data.data_vars))}, "with one of"),
        (lambda data: {"eigenstrain": data * np.nan}, "not finite"),
        (lambda data: {"eigenstrain": data.isel(x=[0])}, "x_edges"),
        (lambda data: {"z_edges": np.linspace(0, 1, 4)}, "edges, increasing"),
        (lambda data: {"z_edges": np.linspace(-1, 3, 11)}, "inside the body"),
        (lambda data: {"z_edges": np.linspace(2, 3, 11)}, "holds its position"),
        (lambda data: {"z": [-1.0]}, "outside"),
    ],
)
def test_invalid_argument_raises(square_eigenstrain, change, message) -> None:
    arguments = {"body": HalfSpace(material=TEST_MATERIAL), "eigenstrain": square_eigenstrain} | change(
        square_eigenstrain
    )
    with pytest.raises(InvalidInputError, match=message):
        eigenstrain_stress(**arguments)
