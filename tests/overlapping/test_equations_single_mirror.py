"""The scheme with one pair of images and two vertical half-spaces: freed tractions, residuals, long bodies."""

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
    solve_contact,
    stress_field,
    surface_displacement,
)
from contactstudy.arrays.grid import Points
from contactstudy.arrays.variables import STRESSES
from contactstudy.fields.loads import sliding
from contactstudy.fields.stress import end_traction_residual, stresses_at
from contactstudy.kernels.load import Load
from contactstudy.overlapping.field import STRESS, end_fields
from contactstudy.overlapping.problem import EndProblem
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.verification.problems import LINE_LOAD

FRICTION = 0.3
DEPTHS = np.array([0.02, 0.1, 0.3, 1.0, 3.0])
Y = np.array([0.0, 0.5, 1.2])


def make_body(length: float, material: Material) -> FiniteLengthSpace:
    return FiniteLengthSpace(length=length, material=material, model="single-mirror")


@pytest.fixture(scope="module")
def eccentric_load(strip_pressure) -> xr.DataArray:
    """A strip load, larger at end II than at end I by a third, on a body of four half-widths."""
    pressure = strip_pressure(4.0, (32, 48))
    return pressure * (1 + 0.3 * (pressure.x / 4.0 - 0.5))


def test_single_mirror_ends_keep_shear(eccentric_load: xr.DataArray, unit_material: Material) -> None:
    grid = Grid.from_centres(eccentric_load.x.values, eccentric_load.y.values)
    body = make_body(4.0, unit_material)
    position = Points(np.array([0.0, 4.0]), Y, DEPTHS)
    (stress,) = stresses_at(body, sliding(eccentric_load.values, FRICTION), grid, [position], eccentric_load.values)
    assert np.abs(stress[0]).max() < 6e-5
    assert np.abs(stress[4]).max() > 3e-3


def test_top_traction_equals_load(eccentric_load: xr.DataArray) -> None:
    """The tractions of H under the added load and of V under the face loads cancel on the top."""
    grid = Grid.from_centres(eccentric_load.x.values, eccentric_load.y.values)
    loads = (Load.NORMAL, Load.ALONG_Y)
    problem = EndProblem(
        length=4.0,
        poisson=0.3,
        cell_loads=eccentric_load.values,
        loads=loads,
        grid=grid,
        resolution=Resolution(),
        mirrored_once=True,
    )
    fields = end_fields(problem, STRESS, [Points(np.array([0.05, 0.5, 1.7, 3.5]), np.array([0.0, 0.9]), np.zeros(1))])[
        0
    ]
    correction_stress = np.stack([fields[load] for load in loads])
    assert np.abs(correction_stress[:, [2, 4, 5]]).max() < 3e-6
    assert np.abs(correction_stress[:, 0]).max() > 0.03


def test_equivalent_load_displaces_half_space_equally(on_cells, unit_material: Material) -> None:
    """The reference is a half-space under three copies of the equivalent load, side by side.

    The added load decreases like 1/y, so the window along y is wide. At the ends the added load is proportional to a
    logarithm: the error of the cells is some tenths of a percent of the displacement, and half as large on cells of
    half the width.
    """
    body, half_space = make_body(4.0, unit_material), HalfSpace(material=unit_material)
    window, middle_rows = (-24.0, 24.0), slice(110, 130)
    pressure = on_cells(lambda x, y: np.maximum(1 - (x - 2.2) ** 2 - y**2, 0), (0.0, 4.0), window, (32, 240))
    load = equivalent_loads(body, pressure, z=[1.0])["P_h1"].values
    mirrored_cells = on_cells(lambda x, y: 0 * x * y, (-4.0, 8.0), window, (96, 240))
    image_displacement = surface_displacement(
        half_space, mirrored_cells + np.concatenate([load[::-1], load, load[::-1]])
    )
    displacement = surface_displacement(body, pressure.isel(y=middle_rows)).values
    difference = displacement - image_displacement.values[32:64, middle_rows]
    assert np.abs(difference).max() < 1e-2
    cell_pressure = pressure.values
    pressure_displacement = surface_displacement(
        half_space, mirrored_cells + np.concatenate([cell_pressure[::-1], cell_pressure, cell_pressure[::-1]])
    )
    assert np.abs(displacement - pressure_displacement.values[32:64, middle_rows]).max() > 0.1


def test_displacement_is_continuous_at_top(eccentric_load: xr.DataArray, unit_material: Material) -> None:
    body = make_body(4.0, unit_material)
    top_displacement = surface_displacement(body, eccentric_load, FRICTION)
    body_field = displacement_field(body, eccentric_load, friction=FRICTION, y=eccentric_load.y.values[[24, 30]])
    difference = np.abs(top_displacement.values[:, [24, 30]] - body_field.u_z.values[..., 0]).max()
    assert difference < 5e-4 * float(top_displacement.max())
    assert "reference_distance" not in top_displacement.attrs
    assert "reference_distance" not in body_field.u_z.attrs


def test_residual_shear_decreases_with_length(strip_pressure, unit_material: Material) -> None:
    """Largest traction on the ends over the peak pressure; uniform strip, friction 0.3, depths 0.02a to 2L.

    ======  =============  =======
    L / a   single-mirror  exact
    ======  =============  =======
    2.5     2.6e-2         7e-6
    4       1.1e-2         5e-6
    8       5.1e-3         5e-6
    16      2.7e-3         5e-6
    ======  =============  =======
    """
    residual_shear = {}
    for length in (2.5, 4.0, 8.0):
        pressure = strip_pressure(length, (int(8 * length), 32))
        grid = Grid.from_centres(pressure.x.values, pressure.y.values)
        depths = np.append(DEPTHS, [length, 2 * length])
        residual_shear[length] = [
            end_traction_residual(body, sliding(pressure.values, FRICTION), grid, Y, depths)
            for body in (make_body(length, unit_material), FiniteLengthSpace(length=length, material=unit_material))
        ]
    residuals = np.array(list(residual_shear.values()))
    assert (residuals[:, 1] < 1e-4).all()
    assert (residuals[:, 0] > 10 * residuals[:, 1]).all()
    assert (np.diff(residuals[:, 0]) < 0).all()


def test_long_body_equals_exact_model(on_cells, unit_material: Material) -> None:
    pressure = on_cells(lambda x, y: np.maximum(1 - (x - 1) ** 2 - y**2, 0), (0.0, 60.0), (-1.5, 1.5), (240, 16))
    points = {"x": [0.0, 0.4, 1.0, 2.0, 50.0], "y": [0.0, 0.6], "z": [0.05, 0.5, 2.0]}
    stress = stress_field(make_body(60.0, unit_material), pressure, friction=FRICTION, **points)
    exact_stress = stress_field(
        FiniteLengthSpace(length=60.0, material=unit_material), pressure, friction=FRICTION, **points
    )
    for name in STRESSES:
        assert np.abs(stress[name] - exact_stress[name]).max() < 3e-4, name


def test_contact_converges_to_exact_model_with_length(cylinder_gap, unit_material: Material) -> None:
    difference = []
    for length in (2.5, 8.0, 24.0):
        gap = cylinder_gap(length, (int(4 * length), 24))
        pressures = [
            solve_contact(body, gap, load=length * LINE_LOAD)["pressure"].max("y").values
            for body in (FiniteLengthSpace(length=length, material=unit_material), make_body(length, unit_material))
        ]
        assert pressures[1].max() > 1.0
        assert np.abs(pressures[1] - pressures[1][::-1]).max() < 1e-4
        difference.append(np.abs(pressures[1] - pressures[0]).max())
    assert difference[0] > difference[1] > difference[2] > 1e-4
    assert difference[2] < 5e-3


def test_single_end_raises_error(unit_material: Material) -> None:
    with pytest.raises(InvalidInputError, match=r"model = 'single-mirror'.*exact for one end"):
        QuarterSpace(material=unit_material, model="single-mirror")
