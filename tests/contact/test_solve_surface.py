"""Contact with a user's surface operator: two bodies, a thin and a thick layer."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from scipy.sparse.linalg import LinearOperator, aslinearoperator

from contactstudy import Counterbody, FiniteLengthSpace, Grid, HalfSpace, InvalidInputError, Material, solve_contact
from contactstudy.case.motion import Rolling
from contactstudy.contact import ContactSettings
from contactstudy.operators import surface_displacement

RADIUS = 5e-3
POLYMER = Material(3e9, 0.35)
GRID = Grid(x_range=(-0.16e-3, 0.16e-3), y_range=(-0.16e-3, 0.16e-3), cells_x=64, cells_y=64)


def label_cells(grid: Grid, cells: np.ndarray) -> xr.DataArray:
    return xr.DataArray(cells, {"x": grid.x, "y": grid.y}, ("x", "y"))


SPHERE_GAP = label_cells(GRID, (GRID.x[:, None] ** 2 + GRID.y**2) / (2 * RADIUS))


def make_layer_operator(material: Material, thickness: float, grid: Grid) -> LinearOperator:
    """Displacement of the top of a layer on a rigid base, periodic with twice the window."""
    shape = (2 * grid.cells_x, 2 * grid.cells_y)
    k_x, k_y = np.fft.fftfreq(shape[0], grid.dx), np.fft.rfftfreq(shape[1], grid.dy)
    k = np.maximum(2 * np.pi * np.hypot(k_x[:, None], k_y), 1e-3 / thickness)
    kappa, depth_factor = 3 - 4 * material.poisson, np.minimum(2 * k * thickness, 50.0)
    factor = (2 * kappa * np.sinh(depth_factor) - 2 * depth_factor) / (
        2 * kappa * np.cosh(depth_factor) + depth_factor**2 + 1 + kappa**2
    )
    compliance = 2 * factor / (material.plane_strain_modulus * k)

    def displacement(pressure: np.ndarray) -> np.ndarray:
        spectrum = compliance * np.fft.rfft2(pressure.reshape(grid.shape), shape)
        return np.fft.irfft2(spectrum, shape)[: grid.cells_x, : grid.cells_y].ravel()

    return LinearOperator((grid.cells_x * grid.cells_y,) * 2, displacement, rmatvec=displacement)


def test_surface_operator_sums_two_bodies() -> None:
    length, grid = 1e-3, Grid(x_range=(0.0, 1e-3), y_range=(-0.1e-3, 0.1e-3), cells_x=32, cells_y=32)
    first_body, second_body = (
        FiniteLengthSpace(length=length, material=Material(*elastic_constants))
        for elastic_constants in ((210e9, 0.3), (310e9, 0.26))
    )
    waves = 0.2e-6 * np.cos(3 * np.pi * grid.x / length) + 0.1e-6 * np.cos(5 * np.pi * grid.x / length + 0.4)
    gap = label_cells(grid, (waves.max() - waves)[:, None] + grid.y**2 / (2 * RADIUS))
    surface = surface_displacement(first_body, grid) + surface_displacement(second_body, grid)
    settings = ContactSettings(load_position=0.5 * length)
    contact = solve_contact(first_body, gap, load=60.0, surface=surface, settings=settings)
    pair_contact = solve_contact(first_body, gap, load=60.0, settings=settings, counterbody=Counterbody(second_body))
    assert bool(contact.converged)
    assert np.abs(contact.pressure - pair_contact.pressure).max() < 1e-5 * pair_contact.pressure.max()


def test_thin_layer_equals_winkler_foundation() -> None:
    thickness, approach, nu = 2e-6, 1e-6, POLYMER.poisson
    contact = solve_contact(
        HalfSpace(material=POLYMER),
        SPHERE_GAP,
        approach=approach,
        surface=make_layer_operator(POLYMER, thickness, GRID),
    )
    stiffness = POLYMER.young * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / thickness
    assert float(contact.normal_load) == pytest.approx(np.pi * RADIUS * stiffness * approach**2, rel=2e-3)
    assert float(contact.pressure.max()) == pytest.approx(stiffness * approach, rel=3e-3)


def test_thick_layer_equals_half_space() -> None:
    load = 0.2
    contact = solve_contact(
        HalfSpace(material=POLYMER), SPHERE_GAP, load=load, surface=make_layer_operator(POLYMER, 1e-3, GRID)
    )
    hertz_pressure = (6 * load * POLYMER.plane_strain_modulus**2 / (np.pi**3 * RADIUS**2)) ** (1 / 3)
    assert float(contact.pressure.max()) == pytest.approx(hertz_pressure, rel=3e-3)


def test_invalid_operator_raises_error() -> None:
    body, surface = HalfSpace(material=POLYMER), make_layer_operator(POLYMER, 1e-6, GRID)
    with pytest.raises(InvalidInputError, match="surface"):
        solve_contact(body, SPHERE_GAP, load=1.0, surface=aslinearoperator(np.eye(3)))
    with pytest.raises(InvalidInputError, match="counterbody"):
        solve_contact(body, SPHERE_GAP, load=1.0, surface=surface, counterbody=Counterbody(body))
    with pytest.raises(InvalidInputError, match="motion"):
        solve_contact(body, SPHERE_GAP, load=1.0, friction=0.1, surface=surface, motion=Rolling())
