"""Loads in three directions between free ends: all nine displacements of the top at single wavenumbers."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.finite_elements.harmonics import HarmonicBody, Line
from benchmarks.finite_elements.superpose import Resolution as MeshResolution
from contactstudy import Material
from contactstudy.bodies.models import FreeEnds
from contactstudy.checks import FloatArray
from contactstudy.kernels.load import Load, Response
from contactstudy.overlapping.equations import axial_modes
from contactstudy.overlapping.quadrature import Resolution, panel_nodes
from contactstudy.overlapping.surface import EndRequest, PositionWaves, sampled_kernel
from contactstudy.verification.problems import Bump

LENGTH, POISSON, FINEST = 4.0, 0.3, 0.02
P, X, Y = Load.NORMAL, Load.ALONG_X, Load.ALONG_Y
AXIAL = np.pi / LENGTH * np.arange(400.0)
NAMES = {P: "z", X: "x", Y: "y"}
X_POSITIONS = np.array([0.02, 0.05, 0.4, 1.3, 2.0, 3.1, 3.9])


def compute_series_terms(direction: Load, x: FloatArray) -> FloatArray:
    """Terms of the series of a load or displacement in a direction: array (wavenumber, x)."""
    return (np.cos if direction.sign_x > 0 else np.sin)(np.outer(AXIAL, x))


def compute_mirrored_half_space(lateral: float, response: Response) -> FloatArray:
    """``2 G u`` of the mirrored half-space per unit term of the series of the load."""
    k = np.sqrt(AXIAL**2 + lateral**2)
    c, s, surface_factor = AXIAL / k, lateral / k, 1 - 2 * POISSON
    factor = {
        (P, P): 2 * (1 - POISSON) + 0 * k,
        (X, P): -c * surface_factor,
        (Y, P): s * surface_factor,
        (P, Y): -s * surface_factor,
        (Y, Y): 2 * (1 - POISSON) * s**2 + 2 * c**2,
        (X, Y): -2 * POISSON * c * s,
        (P, X): -c * surface_factor,
        (X, X): 2 * (1 - POISSON) * c**2 + 2 * s**2,
        (Y, X): 2 * POISSON * c * s,
    }[response.displacement, response.load]
    return np.asarray(factor / k)


def compute_package_displacement(load_shape: Bump, lateral: float, response: Response) -> FloatArray:
    """``2 G u`` of the top at `AT` under ``bump(x) cos(k y)``; components odd in y as the factor of -sin(k y)."""
    material, resolution = Material(2 * (1 + POISSON), POISSON), Resolution().for_loads([X])  # G is 1
    request = EndRequest(FreeEnds(LENGTH), material, 0.1, 1, LENGTH, FINEST, (response,), 40.0, resolution)
    low, high = (float(np.clip(load_shape.centre + sign * load_shape.half_width, 0.0, LENGTH)) for sign in (-1, 1))
    nodes, weights = panel_nodes(np.linspace(low, high, 33), 16)
    forces = weights * load_shape(nodes)
    weight = np.where(AXIAL == 0, 1.0, 2.0) / LENGTH
    spectrum = weight * (compute_series_terms(response.load, nodes) @ forces)
    summed_displacement = compute_series_terms(response.displacement, X_POSITIONS).T @ (
        compute_mirrored_half_space(lateral, response) * spectrum
    )
    for modes in axial_modes(LENGTH, lateral, FINEST, resolution):
        waves = PositionWaves(modes, np.concatenate([nodes, X_POSITIONS]), (response,))
        kernel = sampled_kernel(waves, lateral, request, 0.5 * FINEST)[0]
        summed_displacement += 2 * kernel[nodes.size :, : nodes.size] @ forces
    return np.asarray(summed_displacement)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("load_shape", "lateral"),
    [(Bump(1.0, 1.0), 0.05), (Bump(2.0, 1.5), 0.5), (Bump(1.0, 1.0), 3.0)],
    ids=["long wave to the end", "centred", "short wave to the end"],
)
def test_displacements_of_top_equal_finite_elements(load_shape: Bump, lateral: float) -> None:
    mesh = MeshResolution(growth=2.0, smallest=0.02)
    depth = mesh.make_mesh_z()
    depth_count = int(np.searchsorted(depth, 40 / lateral)) + 1
    body = HarmonicBody(
        Line(edges=mesh.make_mesh_x(LENGTH), order=6), Line(edges=depth[:depth_count], order=6), POISSON
    )
    amplitudes = body.solve(lateral, [(load_shape, NAMES[load]) for load in NAMES])
    for index, load in enumerate(NAMES):
        result = {
            component: body.surface(amplitudes, X_POSITIONS.tolist(), "xyz".index(NAMES[component]))[index]
            for component in NAMES
        }
        maximum = max(float(np.abs(component).max()) for component in result.values())
        for direction, expected in result.items():
            # Odd in y, the package has the factor of -sin(k y); under a traction along y the elements have -cos(k y).
            sign = -1 if Y in (direction, load) else 1
            displacement = sign * compute_package_displacement(load_shape, lateral, Response(direction, load))
            assert np.abs(displacement - expected).max() < 1e-3 * maximum, (load, direction)
