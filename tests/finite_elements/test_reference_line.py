"""Displacements of the top relative to the material line at the reference depth, against finite elements."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import legendre

from benchmarks.finite_elements import superpose
from benchmarks.finite_elements.harmonics import HarmonicBody, Line
from contactstudy import FiniteLengthSpace, displacement_field
from contactstudy.verification.problems import Linear, on_cells, quartic, unit_material

LENGTH, POISSON = 2.5, 0.3
RESOLUTION = superpose.Resolution(order=4, nodes=5, growth=2.0, panels=superpose.PANELS[:-2])


def solve_finite_elements(depths: tuple[float, ...]) -> np.ndarray:
    """``E u_z`` at mid-length of the top less the mean along the line at each depth."""
    mesh = RESOLUTION.make_mesh_x(LENGTH), RESOLUTION.make_mesh_z()
    body = HarmonicBody(*(Line(edges=edges, order=RESOLUTION.order) for edges in mesh), POISSON)
    node, weight = legendre.leggauss(8)
    mid_length = body.x.evaluate([0.5 * LENGTH])[0]
    line_matrix, depth_matrix = body.x.evaluate(0.5 * LENGTH * (1 + node))[0], body.z.evaluate(depths)[0]
    edges = np.array(RESOLUTION.panels, dtype=float)
    gauss_nodes = legendre.leggauss(RESOLUTION.nodes)[0]
    wavenumbers = (edges[:-1, None] + 0.5 * np.diff(edges)[:, None] * (gauss_nodes + 1)).ravel()
    response = []
    for k in wavenumbers:
        displacement = body.solve(float(k), [(Linear(), "z")])[0, 2]
        line_mean = 0.5 * weight @ (line_matrix @ (depth_matrix @ displacement.T).T)
        response.append(2 * ((mid_length @ (displacement @ body.top))[0] - line_mean))
    responses = np.array(response)
    summed_displacement = np.zeros(len(depths))
    for panel, _, weights, interpolate in superpose._make_panels(RESOLUTION, superpose.transform_quartic):
        summed_displacement += weights @ interpolate @ responses[panel]
    return (1 + POISSON) * summed_displacement


@pytest.mark.slow
def test_surface_displacement_relative_to_reference_depth_equals_finite_elements() -> None:
    """The approach of a contact is this difference, see `tests/contact/normal/test_contact_reference.py`."""
    depths = (0.5 * LENGTH, LENGTH, 3 * LENGTH)
    material = unit_material(POISSON)
    load = on_cells(lambda x, y: quartic(y) + 0 * x, (0.0, LENGTH), (-1.25, 1.25), (80, 120))
    node, weight = legendre.leggauss(8)
    x = np.append(0.5 * LENGTH, 0.5 * LENGTH * (1 + node))
    body = FiniteLengthSpace(length=LENGTH, material=material)
    displacement = displacement_field(body, load, x=x, y=[0.0], z=[0.0, *depths], inside_cells=load).u_z.values[:, 0]
    difference = material.young * (displacement[0, 0] - 0.5 * weight @ displacement[1:, 1:])
    np.testing.assert_allclose(difference, solve_finite_elements(depths), rtol=1e-3)
