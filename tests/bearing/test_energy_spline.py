"""Interpolation of the strain energy for two springs in closed form."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy.bearing import ContactLaw
from contactstudy.bearing.energy_spline import EnergySpline, Nodes, estimate_fit_errors

STIFFNESS, ARM = 3e12, 1e-3
"""Two springs of power 3/2 on either side of mid-length, N / m**1.5 and m."""


def compute_forces_of_two_springs(approaches: np.ndarray, tilts: np.ndarray) -> Nodes:
    delta, theta = np.meshgrid(approaches, tilts, indexing="ij")
    depths = delta + ARM * theta, delta - ARM * theta
    forces = [STIFFNESS * np.maximum(depth, 0.0) ** 1.5 for depth in depths]
    energy = 0.4 * sum(force * np.maximum(depth, 0.0) for force, depth in zip(forces, depths, strict=True))
    return Nodes(approaches, tilts, energy, forces[0] + forces[1], ARM * (forces[0] - forces[1]))


NODES = compute_forces_of_two_springs(np.geomspace(1e-6, 5e-6, 7), np.linspace(-5e-4, 5e-4, 7))


@pytest.mark.parametrize(("delta", "theta"), [(1.3e-6, 1e-4), (4.1e-6, -4.3e-4), (2e-6, 0.0)])
def test_interpolated_loads_and_stiffnesses_equal_two_springs(delta: float, theta: float) -> None:
    motion = EnergySpline.fit(NODES)(np.array(delta), np.array(theta))
    right_stiffness, left_stiffness = (1.5 * STIFFNESS * np.sqrt(delta + sign * ARM * theta) for sign in (1, -1))
    exact_nodes = compute_forces_of_two_springs(np.array([delta]), np.array([theta]))
    assert float(motion.normal_load) == pytest.approx(float(exact_nodes.normal_load[0, 0]), rel=2e-4)
    assert float(motion.moment) == pytest.approx(
        float(exact_nodes.moment[0, 0]), abs=2e-4 * ARM * float(exact_nodes.normal_load[0, 0])
    )
    assert float(motion.normal_stiffness) == pytest.approx(right_stiffness + left_stiffness, rel=5e-3)
    assert float(motion.coupling_stiffness) == pytest.approx(
        ARM * (right_stiffness - left_stiffness), abs=5e-3 * ARM * (right_stiffness + left_stiffness)
    )
    assert float(motion.tilting_stiffness) == pytest.approx(ARM**2 * (right_stiffness + left_stiffness), rel=1e-2)


def test_stiffness_equals_difference_quotient() -> None:
    spline = EnergySpline.fit(NODES)
    delta, theta, step = 2.2e-6, 1.7e-4, 1e-4
    motion = spline(np.array(delta), np.array(theta))
    upper_nodes, lower_nodes = (spline(np.array(delta * (1 + sign * step)), np.array(theta)) for sign in (1, -1))
    assert float(upper_nodes.normal_load - lower_nodes.normal_load) / (2 * step * delta) == pytest.approx(
        float(motion.normal_stiffness), rel=1e-5
    )
    assert float(upper_nodes.moment - lower_nodes.moment) / (2 * step * delta) == pytest.approx(
        float(motion.coupling_stiffness), rel=1e-5
    )
    upper_nodes, lower_nodes = (spline(np.array(delta), np.array(theta * (1 + sign * step))) for sign in (1, -1))
    assert float(upper_nodes.normal_load - lower_nodes.normal_load) / (2 * step * theta) == pytest.approx(
        float(motion.coupling_stiffness), rel=1e-5
    )
    assert float(upper_nodes.moment - lower_nodes.moment) / (2 * step * theta) == pytest.approx(
        float(motion.tilting_stiffness), rel=1e-5
    )


@pytest.mark.parametrize(("approaches", "tilts"), [(5, 5), (6, 7), (8, 9)])
@pytest.mark.parametrize("tilt_scale", [5e-4, 1e-3, 1.5e-3])
def test_errors_cover_values_between_nodes(tilt_scale: float, approaches: int, tilts: int) -> None:
    """At the largest tilts one spring leaves the surface: the stiffness has a kink."""
    nodes = compute_forces_of_two_springs(
        np.geomspace(1e-6, 5e-6, approaches), np.linspace(-tilt_scale, tilt_scale, tilts)
    )
    errors, dims = estimate_fit_errors(nodes, 2 * ARM), ("approach", "tilt")
    arrays = {
        "normal_load": nodes.normal_load,
        "moment": nodes.moment,
        "strain_energy": nodes.energy,
        "relative_load_error": errors[0],
        "relative_moment_error": errors[1],
    }
    table = xr.Dataset({name: (dims, values) for name, values in arrays.items()} | {"contact_length": 2 * ARM})
    law = ContactLaw(table.assign_coords(approach=nodes.approaches, tilt=nodes.tilts))
    exact_nodes = compute_forces_of_two_springs(np.geomspace(1e-6, 5e-6, 21), np.linspace(-tilt_scale, tilt_scale, 25))
    motion = law.at(exact_nodes.approaches, exact_nodes.tilts)
    load_difference, moment_difference = (
        np.abs(motion.normal_load - exact_nodes.normal_load),
        np.abs(motion.moment - exact_nodes.moment),
    )
    assert bool((load_difference <= motion.normal_load_error).all())
    assert bool((moment_difference <= motion.moment_error).all())
    # The stated error exceeds the difference at the kink by a moderate factor only.
    assert float((load_difference / motion.normal_load_error).max()) > 0.04
