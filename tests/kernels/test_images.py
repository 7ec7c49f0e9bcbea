"""Sums over all mirror images against separate images, in any unit."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy.checks import FloatArray
from contactstudy.kernels.images import cell_kernel, image_kernel, interpolation_points, mirrored_kernel


def make_corner(depth: float):  # type: ignore[no-untyped-def]
    """Corner function of ``h / R**3``, the decaying influence of a load on a point below."""

    def corner(x: FloatArray, y: FloatArray) -> FloatArray:
        return np.asarray(np.arctan2(x * y, depth * np.sqrt(x * x + y * y + depth * depth)))

    return corner


@pytest.mark.parametrize(("length", "unit"), [(0.5, 2.0**-17), (2.0, 1.0), (12.0, 2.0**17)])
def test_kernel_with_images_equals_sum_over_images(length: float, unit: float) -> None:
    dx, dy = 0.25 * unit, 0.2 * unit
    x = dx * np.arange(-int(length / 0.25), int(length / 0.25) + 1.0)
    y = dy * np.arange(-12, 13.0)
    corner = make_corner(0.3 * unit)
    image_numbers = np.concatenate([-np.arange(1500, 0, -1), np.arange(1, 1501)])
    image_sum = np.zeros((x.size, y.size))
    for image_number in image_numbers:
        image_sum += cell_kernel(corner, x - 2 * length * unit * image_number, y, dx, dy)
    cell_influence = cell_kernel(corner, x, y, dx, dy)
    computed = mirrored_kernel(corner, x, y, dx, dy, length * unit, 0.0)
    # A uniform line load on either side replaces the images beyond 1500 periods.
    truncation_error = 0.3 * 0.25 * 0.2 / (2 * length) / (3001 * length) ** 2
    assert computed == pytest.approx(
        cell_influence + image_sum + truncation_error, abs=5e-6 * np.abs(cell_influence).max()
    )
    far_images = image_kernel(corner, x, y, dx, dy, length * unit, nearest=4 * length * unit)
    near_images = sum(cell_kernel(corner, x - shift * length * unit, y, dx, dy) for shift in (-2, 2))
    assert computed - cell_influence == pytest.approx(far_images + near_images, abs=4e-6 * np.abs(cell_influence).max())


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("middle", [0.0, 7.0, -7.0])
def test_interpolation_of_distant_loads_has_tolerance(unit: float, middle: float) -> None:
    positions = unit * (middle + np.linspace(-2.0, 2.0, 200))
    points, matrix = interpolation_points(positions, 2.0 * unit, 1e-6)
    assert matrix is not None
    assert points.size < 20
    assert points.min() >= positions.min()
    assert points.max() <= positions.max()
    for load_position in (middle - 4.0, middle + 4.0):
        assert matrix @ (1 / np.abs(points / unit - load_position)) == pytest.approx(
            1 / np.abs(positions / unit - load_position), abs=1e-6
        )
    points, no_matrix = interpolation_points(positions[:4], 2.0 * unit, 1e-12)
    assert no_matrix is None
    assert points is not None
    assert np.array_equal(points, positions[:4])
