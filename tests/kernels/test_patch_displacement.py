"""Displacements under a loaded rectangle: point loads from far away, symmetry, and the surface's own functions."""

import numpy as np
import pytest

from contactstudy.kernels.load import Load, Response
from contactstudy.kernels.patch_displacement import (
    DISPLACEMENT_CORNERS,
    normal_displacement_inside,
    tangential_displacement_inside,
)
from contactstudy.kernels.surface import SURFACE_CORNERS

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


@pytest.mark.parametrize("load", list(Load))
def test_on_the_surface_they_are_the_surfaces_functions(load: Load):
    x, y = np.meshgrid([-0.7, 0.0, 0.2, 1.1], [-0.3, 0.0, 0.4, 0.9], indexing="ij")

    def mixed_difference(values):
        return np.diff(np.diff(values, axis=0), axis=1)

    inside = DISPLACEMENT_CORNERS[load](x, y, 0.0, NU)
    for direction, expected in zip((Load.ALONG_X, Load.ALONG_Y, Load.NORMAL), inside, strict=True):
        found = mixed_difference(SURFACE_CORNERS[Response(direction, load)](x, y, NU))
        np.testing.assert_allclose(found, mixed_difference(expected), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("load", list(Load))
@pytest.mark.parametrize("at", [(0.5, 0.0), (0.0, -0.5), (0.0, 0.0)])
def test_on_the_lines_through_a_corner_they_are_continuous(load: Load, at: tuple[float, float]):
    corner, (x, y) = DISPLACEMENT_CORNERS[load], at
    found = corner(np.array([x]), np.array([y]), 0.0, NU)
    beside = corner(np.array([x + 1e-9]), np.array([y + 1e-9]), 0.0, NU)
    np.testing.assert_allclose(found, beside, atol=1e-7)
