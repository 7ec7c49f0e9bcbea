"""Displacements under a loaded rectangle: point loads from far away, symmetry, and the surface's own functions."""

import numpy as np
import pytest

from contactstudy.kernels.patch import normal_displacement_corner, tangential_displacement_corner
from contactstudy.kernels.patch_displacement import normal_displacement_inside, tangential_displacement_inside

NU = 0.3


def on_rectangle(corner, x, y, z, size=(1e-3, 1e-3)):
    edges_x, edges_y = (at + 0.5 * length * np.array([-1, 1]) for at, length in zip((x, y), size, strict=True))
    corners = corner(edges_x[:, None], edges_y[None, :], z, NU)
    return np.diff(np.diff(corners, axis=1), axis=2)[:, 0, 0] / (size[0] * size[1])


@pytest.mark.parametrize("point", [(0.7, -0.4, 0.5), (-0.2, 0.3, 0.05), (1.0, 2.0, 0.0)])
def test_small_rectangle_is_boussinesqs_and_cerrutis_point_load(point):
    x, y, z = point
    r = np.sqrt(x * x + y * y + z * z)
    free = 1 - 2 * NU
    inward = z / r**3 - free / (r * (r + z))
    np.testing.assert_allclose(
        on_rectangle(normal_displacement_inside, *point),
        [x * inward, y * inward, 2 * (1 - NU) / r + z * z / r**3],
        rtol=1e-4,
        atol=1e-6,
    )
    along = 1 / r + y * y / r**3 + free * (1 / (r + z) - y * y / (r * (r + z) ** 2))
    across = x * y * (1 / r**3 - free / (r * (r + z) ** 2))
    np.testing.assert_allclose(
        on_rectangle(tangential_displacement_inside, *point),
        [across, along, y * (z / r**3 + free / (r * (r + z)))],
        rtol=1e-4,
        atol=1e-6,
    )


def test_on_the_surface_they_are_the_surfaces_functions():
    x, y = np.meshgrid([-0.7, 0.2, 1.1], [-0.3, 0.4, 0.9])
    pressure = normal_displacement_inside(x, y, 0.0, NU)[2]
    np.testing.assert_allclose(pressure, 2 * (1 - NU) * normal_displacement_corner(x, y), rtol=1e-13)

    def mixed_difference(values):
        return np.diff(np.diff(values, axis=0), axis=1)

    sliding = tangential_displacement_inside(x, y, 0.0, NU)[2]
    expected = (1 - 2 * NU) * tangential_displacement_corner(x, y)
    np.testing.assert_allclose(mixed_difference(sliding), mixed_difference(expected), rtol=1e-12)
