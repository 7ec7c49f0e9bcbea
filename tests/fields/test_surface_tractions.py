"""Tractions in both directions: operator of the top, traction-free ends, arguments."""

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
    equivalent_loads,
    stress_field,
    surface_displacement,
)
from contactstudy.bodies import Body, Counterbody
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.two_bodies import PairOperator
from contactstudy.fields.surface import surface_operator
from contactstudy.kernels.load import Load

MATERIAL = Material(1.0, 0.3)
LENGTH = 3.0
BODIES: dict[str, Body] = {
    "half-space": HalfSpace(material=MATERIAL),
    "quarter space": QuarterSpace(material=MATERIAL),
    "finite length": FiniteLengthSpace(length=LENGTH, material=MATERIAL),
    "incompressible": FiniteLengthSpace(length=LENGTH, material=Material(1.0, 0.5)),
    "mirror": FiniteLengthSpace(length=LENGTH, material=MATERIAL, model="mirror"),
}
GRIDS = {
    "uniform": Grid(x_range=(0.0, LENGTH), y_range=(-2.0, 2.0), cells_x=15, cells_y=20),
    "graded": Grid.from_edges([0.0, 0.05, 0.1, 0.2, 0.4, 0.7, 1.1, 1.5, 1.9, 2.3, 2.6, 2.8, 2.9, 3.0], (-2.0, 2.0), 20),
}
X, Y = Load.ALONG_X, Load.ALONG_Y
ALL = (Load.NORMAL, X, Y)


def make_asymmetric_traction(cells: int = 24, slope_x: float = 0.3) -> xr.DataArray:
    """A load that reaches both ends and has no symmetry."""
    grid = Grid(x_range=(0.0, LENGTH), y_range=(-2.0, 2.0), cells_x=cells, cells_y=cells)
    x, y = np.meshgrid(grid.x, grid.y, indexing="ij")
    cell_loads = np.maximum(1 - y**2, 0) * (1 + slope_x * x) * (1 + 0.2 * y)
    return xr.DataArray(cell_loads, coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))


def load_arguments(load: Load, cell_loads: xr.DataArray) -> dict[str, xr.DataArray]:
    """Arguments of a load in one direction alone."""
    names = {Load.NORMAL: "pressure", Load.ALONG_X: "traction_x", Load.ALONG_Y: "traction_y"}
    return {"pressure": 0 * cell_loads} | {names[load]: cell_loads}


@pytest.mark.parametrize(("name", "cells"), [*((name, "graded") for name in BODIES), ("finite length", "uniform")])
def test_operator_is_symmetric_and_positive(name: str, cells: str) -> None:
    body, grid = BODIES[name], GRIDS[cells]
    operator = surface_operator(body, grid, ALL, directions=ALL)
    rng = np.random.default_rng(0)
    first_loads, second_loads = ({load: rng.standard_normal(grid.shape) for load in ALL} for _ in range(2))

    def compute_works(loads: dict[Load, FloatArray], displacing_loads: dict[Load, FloatArray]) -> FloatArray:
        displacements = operator.compute_displacements(displacing_loads, ALL)
        return np.array([(grid.weights * loads[load] * displacements[load]).sum() for load in ALL])

    work, reciprocal_work = compute_works(first_loads, second_loads), compute_works(second_loads, first_loads)
    assert abs(work.sum() - reciprocal_work.sum()) < 1e-12 * np.abs(work).sum()
    for _ in range(5):
        load = {direction: rng.standard_normal(grid.shape) for direction in ALL}
        assert compute_works(load, load).sum() > 0


@pytest.mark.parametrize(
    ("name", "load"),
    [("half-space", Y), ("mirror", X), *((name, load) for name in ("quarter space", "finite length") for load in ALL)],
)
def test_surface_displacement_equals_field_on_top(name: str, load: Load) -> None:
    """The surface operator equals the harmonics of both auxiliary bodies at the depth 0."""
    body, loads = BODIES[name], load_arguments(load, make_asymmetric_traction())
    surface_result = surface_displacement(body, **loads, components="xyz")
    body_field = displacement_field(body, **loads)
    max_displacement = max(float(np.ptp(surface_result[name].values)) for name in surface_result)
    # Columns at a loaded end are averaged: under a traction along x their displacement has a logarithmic slope.
    inner_range = slice(0.3, LENGTH - 0.3) if load is Load.ALONG_X else slice(None)
    for axis in "xyz":
        difference = (surface_result[f"displacement_{axis}"] - body_field[f"u_{axis}"].isel(z=0)).sel(x=inner_range)
        assert float(np.abs(difference).max()) < 2e-3 * max_displacement, axis


@pytest.mark.parametrize("body", [BODIES["quarter space"], BODIES["finite length"]], ids=["quarter", "finite"])
@pytest.mark.parametrize("load", ALL)
def test_ends_are_free_of_traction(body: Body, load: Load) -> None:
    end_positions = [end_x for end_x in body.extent if np.isfinite(end_x)]
    stress = stress_field(
        body,
        **load_arguments(load, make_asymmetric_traction(48)),
        x=end_positions,
        y=[-1.2, -0.5, 0.0, 0.7],
        z=[0.05, 0.2, 1.0, 4.0],
    )
    for name in ("sigma_xx", "tau_xy", "tau_xz"):
        assert float(np.abs(stress[name]).max()) < 1e-4, name


def test_stresses_under_a_traction_along_x_follow_from_the_displacements() -> None:
    """Hooke's law at a point of a body that the force bends."""
    body, loads = BODIES["finite length"], load_arguments(Load.ALONG_X, make_asymmetric_traction())
    position_by_axis, step = {"x": 0.4, "y": 0.3, "z": 0.6}, 0.02
    offsets, weights = np.arange(-3, 4) * step, np.array([-1, 9, -45, 0, 45, -9, 1]) / (60 * step)
    gradient = np.empty((3, 3))
    for column, axis in enumerate("xyz"):
        points = {name: [coordinate] for name, coordinate in position_by_axis.items()} | {
            axis: position_by_axis[axis] + offsets
        }
        displacement = displacement_field(body, **loads, **points)
        gradient[:, column] = [float(weights @ displacement[name].values.ravel()) for name in ("u_x", "u_y", "u_z")]
    strain = 0.5 * (gradient + gradient.T)
    nu = MATERIAL.poisson
    lame = MATERIAL.young * nu / ((1 + nu) * (1 - 2 * nu))
    expected = lame * np.trace(strain) * np.eye(3) + 2 * MATERIAL.shear_modulus * strain
    computed = stress_field(
        body, **loads, **{name: [coordinate] for name, coordinate in position_by_axis.items()}
    ).isel(x=0, y=0, z=0)
    component_indices = {"sigma_xx": (0, 0), "sigma_yy": (1, 1), "sigma_zz": (2, 2), "tau_xy": (0, 1), "tau_xz": (0, 2)}
    for name, position in component_indices.items():
        assert float(computed[name]) == pytest.approx(expected[position], abs=2e-3), name


def test_reflection_reverses_axial_traction() -> None:
    body, load = BODIES["finite length"], make_asymmetric_traction()
    reflected_load = xr.DataArray(-load.values[::-1], coords=load.coords, dims=load.dims)
    displacement = surface_displacement(body, **load_arguments(Load.ALONG_X, load), components="xyz")
    reflected_displacement = surface_displacement(
        body, **load_arguments(Load.ALONG_X, reflected_load), components="xyz"
    )
    for axis, sign in (("x", -1), ("y", 1), ("z", 1)):
        name = f"displacement_{axis}"
        assert np.abs(
            displacement[name].values - sign * reflected_displacement[name].values[::-1]
        ).max() < 1e-9 * float(np.ptp(displacement[name].values))


def test_displacement_does_not_depend_on_window() -> None:
    """The reference of the displacement belongs to the body, not to the window."""
    body = BODIES["finite length"]
    displacements = []
    for half_window, cells in ((2.0, 20), (5.0, 50)):
        grid = Grid(x_range=(0.0, LENGTH), y_range=(-half_window, half_window), cells_x=15, cells_y=cells)
        load = xr.DataArray(np.zeros(grid.shape), coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
        load[:, cells // 2 - 3 : cells // 2 + 3] = 1.0
        displacements.append(surface_displacement(body, **load_arguments(Load.ALONG_X, load), components="xyz"))
    narrow_window, wide_window = displacements[0], displacements[1].sel(y=displacements[0].y, method="nearest")
    for name in narrow_window:
        assert np.abs(narrow_window[name].values - wide_window[name].values).max() < 2e-4 * float(
            np.ptp(narrow_window["displacement_x"].values)
        )


def test_long_body_has_axial_displacement_of_half_space() -> None:
    grid = Grid(x_range=(0.0, 60.0), y_range=(-1.5, 1.5), cells_x=240, cells_y=12)
    x, y = np.meshgrid(grid.x, grid.y, indexing="ij")
    # The load has no resultant, which would bend a body of any length.
    cell_loads = np.where(np.abs(x - 30) < 1.5, np.sin(np.pi * (x - 30) / 1.5), 0.0) * (1 - y**2 / 2.25)
    load = xr.DataArray(cell_loads, coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    finite_field, half_space_field = (
        surface_displacement(body, **load_arguments(Load.ALONG_X, load), components="xyz").sel(x=slice(28, 32))
        for body in (FiniteLengthSpace(length=60.0, material=MATERIAL), HalfSpace(material=MATERIAL))
    )
    for name in half_space_field:
        assert float(np.abs(finite_field[name] - half_space_field[name]).max()) < 2e-3 * float(
            np.abs(half_space_field["displacement_x"]).max()
        ), name


def test_mirrored_traction_mirrors_equivalent_loads() -> None:
    load = make_asymmetric_traction()
    reflected_load = xr.DataArray(-load.values[::-1], coords=load.coords, dims=load.dims)
    body = BODIES["finite length"]
    computed, reflected_loads = (
        equivalent_loads(body, **load_arguments(Load.ALONG_X, applied_load), z=[0.3, 1.0])
        for applied_load in (load, reflected_load)
    )
    max_load = float(np.abs(computed.P_v1).max())
    assert float(np.abs(computed.P_v1 - reflected_loads.P_v2).max()) < 1e-6 * max_load
    assert np.abs(computed.P_h1.values - reflected_loads.P_h1.values[::-1]).max() < 1e-6 * float(
        np.abs(computed.P_h1).max()
    )


def test_equal_bodies_do_not_couple_pressure_and_traction() -> None:
    grid = GRIDS["uniform"]
    body = BODIES["finite length"]
    pair_operator = PairOperator.of(body, Counterbody(body), grid, ALL, ALL)
    pressure = np.random.default_rng(2).random(grid.shape)
    displacements = pair_operator.compute_displacements({Load.NORMAL: pressure}, ALL)
    for direction in (Load.ALONG_X, Load.ALONG_Y):
        assert np.abs(displacements[direction]).max() < 1e-12 * np.abs(displacements[Load.NORMAL]).max()
    axial_displacement = pair_operator.compute_displacements({Load.ALONG_X: pressure}, ALL)
    single_displacement = surface_operator(body, grid, ALL, directions=ALL).compute_displacements(
        {Load.ALONG_X: pressure}, ALL
    )
    assert axial_displacement[Load.ALONG_X] == pytest.approx(2 * single_displacement[Load.ALONG_X], rel=1e-12)
    assert np.abs(axial_displacement[Load.NORMAL]).max() < 1e-12 * np.abs(single_displacement[Load.ALONG_X]).max()


def test_displacements_of_tractions_and_pressure_add_up() -> None:
    load = make_asymmetric_traction()
    body = BODIES["quarter space"]
    displacement_of_friction = surface_displacement(body, load, 0.2)
    displacement_of_traction = surface_displacement(body, load, traction_y=0.2 * load)
    assert np.allclose(displacement_of_friction, displacement_of_traction, rtol=1e-12)
    joint_displacement = surface_displacement(body, load, traction_x=0.1 * load, components="xz")
    sum_of_displacements = surface_displacement(body, load, components="xz") + 0.1 * surface_displacement(
        body, 0 * load, traction_x=load, components="xz"
    )
    for name in ("displacement_x", "displacement_z"):
        assert np.allclose(joint_displacement[name], sum_of_displacements[name], atol=1e-12)
    assert set(joint_displacement) == {"displacement_x", "displacement_z"}
    assert joint_displacement["displacement_x"].attrs["units"] == "m"


def test_invalid_input_raises_error() -> None:
    load = make_asymmetric_traction()
    body = BODIES["finite length"]
    with pytest.raises(InvalidInputError, match=r"friction = 0.1.*traction_y"):
        surface_displacement(body, load, 0.1, traction_y=load)
    with pytest.raises(InvalidInputError, match=r"traction_x.coords.*those of the pressure"):
        stress_field(body, load, traction_x=make_asymmetric_traction(12))
    with pytest.raises(InvalidInputError, match="components = 'w'"):
        surface_displacement(body, load, components="xw")
    with pytest.raises(InvalidInputError, match="components = \\[\\]"):
        surface_displacement(body, load, components=[])
    single_mirror = FiniteLengthSpace(length=LENGTH, material=MATERIAL, model="single-mirror")
    with pytest.raises(InvalidInputError, match=r"body.model = 'single-mirror'"):
        surface_displacement(single_mirror, load, components="x")
