"""The interpolation on contacts in closed form."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy.bearing import ContactLaw
from contactstudy.bearing.energy_spline import EnergySpline, Nodes, fit_errors

STIFFNESS, ARM = 3e12, 1e-3
"""Two springs of power 3/2 to either side of the middle, N / m**1.5 and m."""


def springs(approaches: np.ndarray, tilts: np.ndarray) -> Nodes:
    delta, theta = np.meshgrid(approaches, tilts, indexing="ij")
    depths = delta + ARM * theta, delta - ARM * theta
    forces = [STIFFNESS * np.maximum(depth, 0.0) ** 1.5 for depth in depths]
    energy = 0.4 * sum(force * np.maximum(depth, 0.0) for force, depth in zip(forces, depths, strict=True))
    return Nodes(approaches, tilts, energy, forces[0] + forces[1], ARM * (forces[0] - forces[1]))


NODES = springs(np.geomspace(1e-6, 5e-6, 7), np.linspace(-5e-4, 5e-4, 7))


@pytest.mark.parametrize(("delta", "theta"), [(1.3e-6, 1e-4), (4.1e-6, -4.3e-4), (2e-6, 0.0)])
def test_load_moment_and_stiffness_of_two_springs(delta: float, theta: float) -> None:
    found = EnergySpline.fitted(NODES)(np.array(delta), np.array(theta))
    right, left = (1.5 * STIFFNESS * np.sqrt(delta + side * ARM * theta) for side in (1, -1))
    exact = springs(np.array([delta]), np.array([theta]))
    assert float(found.load) == pytest.approx(float(exact.load[0, 0]), rel=2e-4)
    assert float(found.moment) == pytest.approx(float(exact.moment[0, 0]), abs=2e-4 * ARM * float(exact.load[0, 0]))
    assert float(found.normal) == pytest.approx(right + left, rel=5e-3)
    assert float(found.coupling) == pytest.approx(ARM * (right - left), abs=5e-3 * ARM * (right + left))
    assert float(found.tilting) == pytest.approx(ARM**2 * (right + left), rel=1e-2)


def test_stiffness_is_the_derivative() -> None:
    spline = EnergySpline.fitted(NODES)
    delta, theta, step = 2.2e-6, 1.7e-4, 1e-4
    at = spline(np.array(delta), np.array(theta))
    more, less = (spline(np.array(delta * (1 + side * step)), np.array(theta)) for side in (1, -1))
    assert float(more.load - less.load) / (2 * step * delta) == pytest.approx(float(at.normal), rel=1e-5)
    assert float(more.moment - less.moment) / (2 * step * delta) == pytest.approx(float(at.coupling), rel=1e-5)
    more, less = (spline(np.array(delta), np.array(theta * (1 + side * step))) for side in (1, -1))
    assert float(more.load - less.load) / (2 * step * theta) == pytest.approx(float(at.coupling), rel=1e-5)
    assert float(more.moment - less.moment) / (2 * step * theta) == pytest.approx(float(at.tilting), rel=1e-5)


@pytest.mark.parametrize(("approaches", "tilts"), [(5, 5), (6, 7), (8, 9)])
@pytest.mark.parametrize("largest_tilt", [5e-4, 1e-3, 1.5e-3])
def test_errors_between_nodes(largest_tilt: float, approaches: int, tilts: int) -> None:
    """At the largest tilts one spring leaves the surface: a kink in the stiffness."""
    nodes = springs(np.geomspace(1e-6, 5e-6, approaches), np.linspace(-largest_tilt, largest_tilt, tilts))
    stated, both = fit_errors(nodes, 2 * ARM), ("approach", "tilt")
    arrays = {
        "normal_load": nodes.load,
        "moment": nodes.moment,
        "strain_energy": nodes.energy,
        "relative_load_error": stated[0],
        "relative_moment_error": stated[1],
    }
    table = xr.Dataset({name: (both, values) for name, values in arrays.items()} | {"contact_length": 2 * ARM})
    law = ContactLaw(table.assign_coords(approach=nodes.approaches, tilt=nodes.tilts))
    fine = springs(np.geomspace(1e-6, 5e-6, 21), np.linspace(-largest_tilt, largest_tilt, 25))
    found = law.at(fine.approaches, fine.tilts)
    load, moment = np.abs(found.normal_load - fine.load), np.abs(found.moment - fine.moment)
    assert bool((load <= found.normal_load_error).all())
    assert bool((moment <= found.moment_error).all())
    # Not far too large where it matters: at the kink.
    assert float((load / found.normal_load_error).max()) > 0.04
