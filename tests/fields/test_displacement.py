"""Displacements inside the body: Hooke's law with the stresses, displacement of the top, reference distance."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    InvalidInputError,
    Material,
    QuarterSpace,
    displacement_field,
    stress_field,
    surface_displacement,
)
from contactstudy.arrays.grid import Points
from contactstudy.fields.displacement import displacement_under, normal_influence
from contactstudy.fields.loads import TopLoad
from contactstudy.kernels.load import Load

MATERIAL = Material(young=0.91, poisson=0.3)
BODIES = {
    "half-space": HalfSpace(material=MATERIAL),
    "quarter space": QuarterSpace(material=MATERIAL),
    "finite length": FiniteLengthSpace(length=4.0, material=MATERIAL),
    "mirror": FiniteLengthSpace(length=4.0, material=MATERIAL, model="mirror"),
}


@pytest.fixture(scope="module")
def eccentric_load(on_cells) -> xr.DataArray:
    """Hertz pressure about x = 1.3 on cells from 0 to 4."""
    return on_cells(lambda x, y: np.sqrt(np.maximum(1 - (x - 1.3) ** 2 - y**2, 0.0)), (0.0, 4.0), (-1.5, 1.5), (64, 48))


def compute_strain(body, pressure, friction: float, point: tuple[float, float, float], step: float = 1e-3):
    """Strain tensor at a point, by central differences of the displacements."""
    axes = {axis: coordinate + step * np.array([-1.0, 0.0, 1.0]) for axis, coordinate in zip("xyz", point, strict=True)}
    field = displacement_field(body, pressure, friction=friction, **axes)
    gradient = np.empty((3, 3))
    for i, name in enumerate(("u_x", "u_y", "u_z")):
        for j, axis in enumerate("xyz"):
            axis_values = field[name].isel({other_axis: 1 for other_axis in "xyz" if other_axis != axis}).values
            gradient[i, j] = (axis_values[2] - axis_values[0]) / (2 * step)
    return 0.5 * (gradient + gradient.T)


@pytest.mark.parametrize("name", BODIES)
def test_strains_obey_hookes_law_with_the_stresses(name: str, eccentric_load: xr.DataArray) -> None:
    friction = 0.4
    body, shear, nu = BODIES[name], MATERIAL.shear_modulus, MATERIAL.poisson
    for point in ((0.25, 0.2, 0.4), (1.5, -0.6, 0.8), (3.7, 0.1, 1.5)):
        strain = compute_strain(body, eccentric_load, friction, point)
        expected = 2 * shear * (strain + nu / (1 - 2 * nu) * np.trace(strain) * np.eye(3))
        stress = stress_field(body, eccentric_load, friction=friction, x=point[:1], y=point[1:2], z=point[2:]).squeeze()
        for i, j, component in (
            *((0, 0, "sigma_xx"), (1, 1, "sigma_yy"), (2, 2, "sigma_zz")),
            *((0, 1, "tau_xy"), (0, 2, "tau_xz"), (1, 2, "tau_yz")),
        ):
            assert float(stress[component]) == pytest.approx(expected[i, j], abs=2e-4), (point, component)


@pytest.mark.parametrize("name", BODIES)
def test_displacement_field_equals_surface_displacement_on_top(name: str, eccentric_load: xr.DataArray) -> None:
    friction = 0.4
    displacement = surface_displacement(BODIES[name], eccentric_load, friction)
    field_on_top = displacement_field(BODIES[name], eccentric_load, friction=friction)["u_z"].sel(z=0.0, drop=True)
    tolerance = {"half-space": 1e-12, "mirror": 1e-7}.get(name, 1e-3)
    assert float(np.abs(field_on_top - displacement).max()) < tolerance * float(displacement.max() - displacement.min())
    smooth_displacement = displacement_field(
        BODIES[name], eccentric_load, friction=friction, inside_cells=eccentric_load
    )["u_z"].sel(z=0.0, drop=True)
    assert float(np.abs(smooth_displacement - displacement).max()) < 2e-3 * float(
        displacement.max() - displacement.min()
    )


def test_symmetric_load_displaces_symmetrically(on_cells) -> None:
    pressure = on_cells(lambda x, y: np.maximum(1 - (x - 2) ** 2 - y**2, 0.0), (0.0, 4.0), (-1.5, 1.5), (32, 24))
    field = displacement_field(BODIES["finite length"], pressure, z=[0.0, 0.7])
    for name, sign_x, sign_y in (("u_x", -1, 1), ("u_y", 1, -1), ("u_z", 1, 1)):
        displacement = field[name].values
        np.testing.assert_allclose(displacement[::-1], sign_x * displacement, atol=1e-6)
        np.testing.assert_allclose(displacement[:, ::-1], sign_y * displacement, atol=1e-6)


def test_displacement_vanishes_at_reference_distance(eccentric_load: xr.DataArray) -> None:
    field = displacement_field(BODIES["finite length"], eccentric_load, y=[0.0, 40.0])
    assert field.u_z.attrs["reference_distance"] == pytest.approx(40.0)
    ratio = np.abs(field.u_z.sel(y=40.0)).max() / field.u_z.sel(y=0.0).max()
    assert float(ratio) < 2e-3


def test_displacements_have_unit_of_length(eccentric_load: xr.DataArray) -> None:
    field = displacement_field(BODIES["half-space"], eccentric_load, x=[0.0], y=[0.0], z=[1.0])
    assert [field[name].attrs["units"] for name in ("u_x", "u_y", "u_z")] == ["m"] * 3


@pytest.mark.parametrize(
    ("arguments", "parameter"),
    [
        ({"x": [-0.1]}, "x"),
        ({"x": [4.1]}, "x"),
        ({"z": [-1.0]}, "z"),
        ({"y": [np.nan]}, "y"),
        ({"friction": np.inf}, "friction"),
    ],
)
def test_invalid_input_raises_error(arguments, parameter: str, eccentric_load: xr.DataArray) -> None:
    with pytest.raises(InvalidInputError, match=parameter):
        displacement_field(BODIES["finite length"], eccentric_load, **arguments)


def test_displacement_does_not_depend_on_further_positions() -> None:
    # Pressure near an end: the end correction at a distant point depends on wavelengths of this distance.
    body = FiniteLengthSpace(length=1.0, material=Material(1.0, 0.3))
    edges = [0.0, 0.005, 0.007, 0.01, 0.02, 0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0]
    grid = Grid.between(edges, (-0.01, 0.01), 8)
    cells = np.zeros(grid.shape)
    cells[1] = 1.0
    loads = {Load.NORMAL: TopLoad(cells)}

    def compute_displacement(x: list[float], z: list[float]) -> float:
        points = Points(np.array(x), np.zeros(1), np.array(z))
        return float(displacement_under(body, loads, grid, points)[2, -1, 0, -1])

    single_displacement = compute_displacement([0.6], [1.0])
    assert compute_displacement([0.001, 0.6], [0.001, 1.0]) == pytest.approx(single_displacement, rel=1e-6)
    assert compute_displacement([0.1, 0.6], [1.0]) == pytest.approx(single_displacement, rel=1e-6)


def test_influence_on_a_plane_sums_to_the_displacement() -> None:
    body = FiniteLengthSpace(length=1.0, material=Material(1.0, 0.3))
    grid = Grid.between([0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0], (-0.2, 0.2), 4)
    cells = np.random.default_rng(2).random(grid.shape)
    x = np.array([0.2, 0.7])
    for load in Load:
        points = Points(x, np.zeros(1), np.array([0.8]))
        expected = displacement_under(body, {load: TopLoad(cells)}, grid, points)[2, :, 0, 0]
        summed_influence = np.tensordot(normal_influence(body, grid, load, x, 0.8), cells, axes=2)
        np.testing.assert_allclose(summed_influence, expected, atol=1e-5 * np.abs(expected).max())
