"""End correction of the displacements: symmetric about mid-length, reciprocal, independent of units."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Grid, Material
from contactstudy.bodies.models import FreeEnds
from contactstudy.checks import FloatArray
from contactstudy.kernels.load import Load, Response
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.overlapping.surface import EndCorrection, EndRequest, end_kernel

MATERIAL = Material(1.0, 0.3)
EDGES = np.array([0.0, 0.2, 0.5, 1.0, 1.7, 2.1, 2.4])
RESPONSES = tuple(Response(displacement, load) for displacement in Load for load in Load)
LENGTH = 2.0**-17
"""A unit of length, a power of two."""


def make_request(
    edges: FloatArray, *, unit: float = 1.0, end_kernels: int = 2, responses: tuple[Response, ...] = RESPONSES
) -> EndRequest:
    grid = Grid.between(unit * edges, (-unit, unit), 6)
    free_ends = FreeEnds(unit * float(edges[-1]) if end_kernels == 2 else np.inf)
    return EndRequest.of(free_ends, MATERIAL, grid, responses, 24.0 * unit, Resolution())


def compute_kernel(edges: FloatArray, response: Response, *, unit: float = 1.0, end_kernels: int = 2) -> FloatArray:
    """Displacements averaged over cells from forces on cells: array (wavenumber, cell, cell)."""
    summed_kernel = np.zeros((7, edges.size - 1, edges.size - 1))
    end_kernel(make_request(edges, unit=unit, end_kernels=end_kernels)).add_to(summed_kernel, response, unit * edges)
    return summed_kernel


@pytest.mark.parametrize(
    "response", RESPONSES, ids=lambda response: f"{response.displacement.name} by {response.load.name}"
)
@pytest.mark.parametrize(("end_kernels", "unit"), [(1, LENGTH), (2, LENGTH), (1, 2.0**7)])
def test_unit_of_length_scales_kernel(end_kernels: int, unit: float, response: Response) -> None:
    """Transformed along y, displacements over forces per length have no unit."""
    baseline, variant = (
        compute_kernel(EDGES, response, end_kernels=end_kernels),
        compute_kernel(EDGES, response, unit=unit, end_kernels=end_kernels),
    )
    assert variant == pytest.approx(baseline, abs=1e-7 * np.abs(baseline).max())


@pytest.mark.parametrize(
    "response", RESPONSES, ids=lambda response: f"{response.displacement.name} by {response.load.name}"
)
def test_mirrored_columns_have_the_mirrored_kernel(response: Response) -> None:
    """The kernel of the mirrored columns is mirrored; quantities that a reflection reverses change their sign."""
    sign = response.displacement.sign_x * response.load.sign_x
    mirrored_edges = EDGES[-1] - EDGES[::-1]
    computed, expected = compute_kernel(mirrored_edges, response), compute_kernel(EDGES, response)
    assert computed == pytest.approx(sign * expected[:, ::-1, ::-1], abs=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("end_kernels", [1, 2])
def test_loads_and_displacements_are_reciprocal(end_kernels: int) -> None:
    """The work of one load on the displacement of another is symmetric; the omitted factor i changes its sign."""
    for direction in Load:
        for load in Load:
            kernel, reciprocal_kernel = (
                compute_kernel(EDGES, Response(direction, load), end_kernels=end_kernels),
                compute_kernel(EDGES, Response(load, direction), end_kernels=end_kernels),
            )
            sign = -1 if (direction.sign_y < 0) != (load.sign_y < 0) else 1
            assert reciprocal_kernel.transpose(0, 2, 1) == pytest.approx(sign * kernel, abs=2e-4 * np.abs(kernel).max())


@pytest.mark.parametrize("cells", [6, 7])
@pytest.mark.parametrize("direction", Load)
def test_correction_on_cells_equals_kernel_between_columns(direction: Load, cells: int) -> None:
    """The correction uses the symmetry about mid-length, for an even and an odd number of cells."""
    edges = np.linspace(0.0, 2.4, cells + 1)
    grid = Grid.between(edges, (-1.0, 1.0), 6)
    end_kernels = end_kernel(make_request(edges))
    correction = EndCorrection.on_grid(grid, end_kernels)
    rng = np.random.default_rng(0)
    transforms = {load: rng.standard_normal((cells, 7)) + 1j * rng.standard_normal((cells, 7)) for load in Load}
    projected_loads = {load: correction.project_loads(load, transform) for load, transform in transforms.items()}
    computed = correction.compute_displacement(direction, projected_loads, cells)
    expected = np.zeros((cells, 7), np.complex128)
    for load, transform in transforms.items():
        response = Response(direction, load)
        factor = 1.0 if response.sign_y > 0 else 1j
        column_kernel = np.zeros((7, cells, cells))
        end_kernels.add_to(column_kernel, response, edges)
        expected += factor * np.einsum("kij,jk->ik", column_kernel, transform) * grid.dx
    assert computed == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())


def test_end_cells_determine_kernel_resolution() -> None:
    """The finest length is the width of uniform cells, the width of a cell along y, or an eighth of it at narrow end
    cells."""
    dy = 2.0 / 6
    assert make_request(np.linspace(0.0, 2.4, 9)).finest == pytest.approx(0.3)
    narrow_end_edges = np.array([0.0, 0.1, 0.5, 1.5, 2.6, 3.7])
    wide_end_edges = np.array([0.0, 0.7, 1.4, 1.6, 2.3, 3.0])
    assert (
        make_request(narrow_end_edges).finest
        == make_request(narrow_end_edges[-1] - narrow_end_edges[::-1]).finest
        == pytest.approx(dy / 8)
    )
    assert make_request(wide_end_edges).finest == pytest.approx(dy)
    assert make_request(narrow_end_edges, end_kernels=1).finest == pytest.approx(dy / 8)
    assert make_request(narrow_end_edges[-1] - narrow_end_edges[::-1], end_kernels=1).finest == pytest.approx(dy)
    assert make_request(EDGES).resolution.lateral_nodes == Resolution().lateral_nodes + 2
    for unit in (LENGTH, 2.0**10):
        assert make_request(narrow_end_edges, unit=unit).finest / unit == pytest.approx(dy / 8)
        assert make_request(wide_end_edges, unit=unit).finest / unit == pytest.approx(dy)


def test_lateral_cells_bound_lateral_wavenumbers() -> None:
    """Finer quadratures do not change the kernel, also for wide cells along x."""
    edges = np.linspace(0.0, 6.0, 5)
    baseline = make_request(edges, responses=(Response(Load.NORMAL, Load.NORMAL),))
    assert baseline.finest > 4 * baseline.dy
    computed, fine_kernel = (
        np.sum(
            [
                variant.moments(edges)[0].T @ samples @ variant.moments(edges)[0]
                for samples in variant.samples[baseline.responses[0]]
            ],
            axis=0,
        )
        for variant in (end_kernel(baseline), end_kernel(baseline._replace(finest=baseline.dy)))
    )
    assert computed == pytest.approx(fine_kernel, abs=1e-3 * np.abs(fine_kernel).max())
