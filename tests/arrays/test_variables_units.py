"""Units on labelled input are converted or rejected, never ignored."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import dask
import dask.array as da
import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    Grid,
    HalfSpace,
    InvalidInputError,
    Material,
    Roller,
    Study,
    solve,
    solve_contact,
    stress_field,
    surface_displacement,
)
from contactstudy.arrays.variables import in_si, require_in_si
from contactstudy.bearing import contact_law
from contactstudy.case.motion import AxialFriction, Sliding, check_friction
from contactstudy.plasticity import ElasticPlastic
from contactstudy.profiles import FullCrown, Measured
from contactstudy.roughness import heights_on

OnCells = Callable[..., xr.DataArray]


def test_contact_of_gap_in_other_units_is_equal(on_cells: OnCells, half_space: HalfSpace) -> None:
    gap = on_cells(lambda x, y: 0.5 * (x**2 + y**2), (-1.5, 1.5), (-1.5, 1.5), (24, 24))
    gap_in_mm = (1e3 * gap).assign_attrs(units="mm").assign_coords(x=1e6 * gap.x, y=1e6 * gap.y)
    for axis in ("x", "y"):
        gap_in_mm[axis].attrs["units"] = "um"
    expected, computed = (solve_contact(half_space, input_gap, load=4 / 3) for input_gap in (gap, gap_in_mm))
    np.testing.assert_allclose(computed["pressure"], expected["pressure"], rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(computed["x"], expected["x"], rtol=1e-12)


def test_fields_of_pressure_in_gigapascals_are_equal(on_cells: OnCells, half_space: HalfSpace) -> None:
    pressure = on_cells(lambda x, y: 1.0 + 0 * x + 0 * y, (-1.0, 1.0), (-1.0, 1.0), (8, 8))
    pressure_in_gpa = (1e-9 * pressure).assign_attrs(units="GPa")
    displacements = [surface_displacement(half_space, load) for load in (pressure_in_gpa, pressure)]
    np.testing.assert_allclose(*displacements, rtol=1e-12)
    stresses = [stress_field(half_space, load, z=[0.5]).sigma_zz for load in (pressure_in_gpa, pressure)]
    np.testing.assert_allclose(*stresses, rtol=1e-12)


@pytest.mark.parametrize("unit", ["inch", "Pa", "", 7])
def test_unknown_units_raise(unit: object) -> None:
    with pytest.raises(InvalidInputError, match=r"gap.attrs\['units'\]"):
        in_si("gap", xr.DataArray([1.0], attrs={"units": unit}), "m")


@pytest.mark.parametrize("values", [np.ones((4, 4)) * 1j, np.zeros((4, 4), "datetime64[ns]"), np.full((4, 4), "a")])
def test_arrays_without_real_numbers_raise(values: np.ndarray, half_space: HalfSpace) -> None:
    cells = np.arange(4.0)
    array = xr.DataArray(values, coords={"x": cells, "y": cells}, dims=("x", "y"))
    with pytest.raises(InvalidInputError, match=r"pressure.dtype = .* real numbers"):
        surface_displacement(half_space, array)
    complex_cells = xr.DataArray(np.ones((4, 4)), coords={"x": cells * 1j, "y": cells}, dims=("x", "y"))
    with pytest.raises(InvalidInputError, match=r"x = .* numbers"):
        surface_displacement(half_space, complex_cells)


def test_friction_and_roughness_are_converted_or_refused(half_space: HalfSpace) -> None:
    friction = xr.DataArray([10.0, 20.0], {"x": ("x", [0.0, 2.0], {"units": "mm"})}, "x", attrs={"units": "%"})
    assert check_friction(friction, Sliding(), coupled=False) == AxialFriction((0.0, 2e-3), (0.1, 0.2))
    cells = Grid(x_range=(0.0, 4e-3), y_range=(0.0, 2e-3), cells_x=4, cells_y=2)
    heights = xr.DataArray(np.arange(8.0).reshape(4, 2), {"x": 1e3 * cells.x, "y": 1e3 * cells.y}, ("x", "y"))
    for axis in "xy":
        heights[axis].attrs["units"] = "mm"
    np.testing.assert_allclose(heights_on(cells, heights.assign_attrs(units="um")), 1e-6 * heights.values)
    for invalid in (
        heights.assign_attrs(units="GPa"),
        heights.assign_coords(x=heights.x.assign_attrs(units="1")),
    ):
        with pytest.raises(InvalidInputError, match=r"roughness.*attrs\['units'\]"):
            heights_on(cells, invalid)
    with pytest.raises(InvalidInputError, match=r"friction.attrs\['units'\] = 'N'"):
        check_friction(friction.assign_attrs(units="N"), Sliding(), coupled=False)


def test_stresses_at_depths_in_micrometres_are_equal(on_cells: OnCells, half_space: HalfSpace) -> None:
    pressure = on_cells(lambda x, y: 1.0 + 0 * x + 0 * y, (-1.0, 1.0), (-1.0, 1.0), (8, 8))
    depths = xr.DataArray([0.5e6], dims="z", attrs={"units": "um"})
    expected, computed = (stress_field(half_space, pressure, z=z) for z in ([0.5], depths))
    xr.testing.assert_allclose(computed, expected)
    with pytest.raises(InvalidInputError, match=r"z.attrs\['units'\] = '1'"):
        stress_field(half_space, pressure, z=depths.assign_attrs(units="1"))


def test_yield_stress_over_depth_is_converted() -> None:
    yield_stress = xr.DataArray([600.0, 400.0], {"z": ("z", [0.0, 1.0], {"units": "mm"})}, "z", attrs={"units": "MPa"})
    material = ElasticPlastic(yield_stress=yield_stress)
    for material_variant in (material, replace(material, isotropic_hardening=1e9)):
        np.testing.assert_allclose(material_variant.yield_stress_at(np.array([0.5e-3])), 500e6)
    hardness = xr.DataArray([750.0], {"z": [0.0]}, "z", attrs={"units": "HV"})
    assert ElasticPlastic.from_hardness(hardness).yield_stress_at(np.zeros(1))[0] == pytest.approx(750 * 9.80665e6 / 3)
    with pytest.raises(InvalidInputError, match="HV, or left out"):
        ElasticPlastic.from_hardness(hardness.assign_attrs(units="HRC"))


def test_converted_variable_has_si_units() -> None:
    converted_gap = in_si(
        "gap", xr.DataArray([1.0], {"x": ("x", [2.0], {"units": "mm"})}, "x", attrs={"units": "um"}), "m"
    )
    assert (converted_gap.attrs["units"], converted_gap["x"].attrs["units"]) == ("m", "m")
    xr.testing.assert_identical(in_si("gap", converted_gap, "m"), converted_gap)


def test_dataset_positions_are_converted() -> None:
    position = ("x", [0.0, 2.0], {"units": "mm"})
    pressure = xr.DataArray([1.0, 2.0], {"x": position}, "x", attrs={"units": "GPa"})
    dataset = xr.Dataset({"pressure": pressure, "gap": xr.zeros_like(pressure).assign_attrs(units="um")})
    converted_gap = require_in_si(dataset, "pressure")
    assert (converted_gap.pressure.values.tolist(), converted_gap.x.values.tolist()) == ([1e9, 2e9], [0.0, 2e-3])
    assert (converted_gap.pressure.attrs["units"], converted_gap.x.attrs["units"]) == ("Pa", "m")
    assert require_in_si(converted_gap, "pressure") is converted_gap
    for invalid_unit, message in (("1", "in SI, pressure in Pa"), ("psi", r"result.pressure.attrs\['units'\] = 'psi'")):
        with pytest.raises(InvalidInputError, match=message):
            require_in_si(
                dataset.assign(pressure=pressure.assign_attrs(units=invalid_unit)), "pressure", argument="result"
            )
    with pytest.raises(InvalidInputError, match="traction_y is missing"):
        require_in_si(dataset, "traction_y")


def test_inputs_of_contact_law_and_measured_profile_are_converted() -> None:
    steel = Material(210e9, 0.3)
    roller = Roller(radius=5e-3, length=0.3e-3, profile=FullCrown(crown_radius=0.1))
    case = Case(body=HalfSpace(material=steel), roller=roller, load=30.0)
    tilts = xr.DataArray(np.linspace(-0.2, 0.2, 5), dims="tilt", attrs={"units": "mrad"})
    approaches = xr.DataArray(np.linspace(1.0, 1.8, 5), dims="approach", attrs={"units": "um"})
    law = contact_law(case, tilts, approaches, accuracy=0.1)
    np.testing.assert_allclose(law.table["tilt"], 1e-3 * tilts)
    np.testing.assert_allclose(law.table["approach"], 1e-6 * approaches)
    x = xr.DataArray(np.linspace(0.0, 0.3, 6), dims="x", attrs={"units": "mm"})
    measured_profile = Measured(x, xr.DataArray(np.full(6, 2.0), dims="x", attrs={"units": "micron"}))
    assert measured_profile == Measured(1e-3 * x.values, np.full(6, 2.0) * 1e-6)


def make_lazy_array(value: float) -> da.Array:
    """Return a number as a lazy array, as in a file opened with chunks."""
    return da.from_array(np.array(value))


def make_scalar(value: object, units: str | None = None) -> xr.DataArray:
    return xr.DataArray(value, attrs={} if units is None else {"units": units})


STEEL = Material(210e9, 0.3)
SCALARS: dict[str, tuple[Callable[[object], object], float, str, float]] = {
    "young": (lambda value: Material(value, 0.3).young, 210.0, "GPa", 210e9),
    "radius": (lambda value: Roller(radius=value, length=1e-3).radius, 5.0, "mm", 5e-3),
    "length": (lambda value: Roller(radius=5e-3, length=value).length, 1.0, "mm", 1e-3),
    "crown_radius": (lambda value: FullCrown(value).crown_radius, 1000.0, "mm", 1.0),
    "load": (lambda value: case_with(load=value).load, 0.1, "kN", 100.0),
    "max_pressure": (lambda value: case_with(max_pressure=value).max_pressure, 1500.0, "MPa", 1.5e9),
    "approach": (lambda value: case_with(approach=value).approach, 1.0, "um", 1e-6),
    "tilt": (lambda value: case_with(load=100.0, tilt=value).tilt, 0.1, "mrad", 1e-4),
    "friction": (lambda value: case_with(load=100.0, friction=value).friction, 10.0, "%", 0.1),
    "end_distance": (lambda value: case_with(load=100.0, end_distance=value).end_distance, 0.5, "mm", 0.5e-3),
}


def case_with(**parameters) -> Case:
    return Case(body=HalfSpace(material=STEEL), roller=Roller(radius=5e-3, length=1e-3), **parameters)


@pytest.mark.parametrize("name", SCALARS)
def test_scalar_argument_is_converted(name: str) -> None:
    read_argument, value, units, si_value = SCALARS[name]
    for argument in (
        make_scalar(value, units),
        make_scalar(si_value),
        np.array(si_value),
        make_scalar(make_lazy_array(si_value)),
        make_scalar(make_lazy_array(value), units),
    ):
        argument_value = read_argument(argument)
        assert type(argument_value) is float
        assert argument_value == pytest.approx(si_value, rel=1e-15)
    with pytest.raises(InvalidInputError, match=rf"{name}.attrs\['units'\] = 'furlong': must be one of") as caught:
        read_argument(make_scalar(value, "furlong"))
    assert len(str(caught.value)) < 200


def test_lazy_scalar_is_accepted_as_pressure(tmp_path: Path) -> None:
    xr.Dataset({"pressure": ("x", [1e9, 2e9], {"units": "Pa"})}).to_netcdf(tmp_path / "a.nc")
    with xr.open_dataset(tmp_path / "a.nc", chunks={}) as result:
        assert case_with(max_pressure=result.pressure.max(keep_attrs=True)) == case_with(max_pressure=2e9)


def test_messages_do_not_compute_lazy_arrays() -> None:
    unevaluated_array = da.from_delayed(dask.delayed(pytest.fail)("computed"), (), float)
    for value, type_name in (
        (unevaluated_array, "Array"),
        (make_scalar(unevaluated_array, "N"), "DataArray"),
        (make_scalar(unevaluated_array).expand_dims(x=3), ""),
    ):
        with pytest.raises(InvalidInputError, match=rf"case = lazy {type_name}.*type float64: must be a Case"):
            solve(value)


def test_result_scalar_is_accepted_as_load() -> None:
    load = xr.DataArray(123.0, coords={"friction": 0.1}, attrs={"units": "N", "long_name": "normal load"})
    assert case_with(load=load) == case_with(load=123.0)


def test_study_converts_scalars_with_units() -> None:
    base = {"young": make_scalar(210, "GPa"), "poisson": 0.3, "radius": make_scalar(5, "mm"), "roller_length": 1e-3}
    study = Study(name="a", base=base | {"e_over_a": 0}, sweep={"max_pressure": [make_scalar(1500, "MPa"), 1e9]})
    assert (study.base["young"], study.base["radius"], study.sweep["max_pressure"]) == (210e9, 5e-3, [1.5e9, 1e9])
    with pytest.raises(InvalidInputError, match=r"young.attrs\['units'\] = 'mm'"):
        Study(name="a", base={"young": make_scalar(210, "mm")})


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (make_scalar(np.ones((40, 20)), "m"), "DataArray of shape (40, 20) and type float64"),
        (np.ones(3), "ndarray of shape (3,) and type float64"),
        (make_scalar(-5.0, "mm"), "-5.0 mm"),
        (np.float64(-1.0), "-1.0"),
        (make_scalar(True), "True"),
        (make_scalar("a"), "'a'"),
        (xr.Dataset({"a": 1, "b": 2}), "Dataset of 2 variables"),
        ([np.ones((2, 2))], "[array([[1., 1.], [1., 1.]])]"),
        (make_scalar(make_lazy_array(-5.0), "mm"), "lazy DataArray of type float64"),
        (make_scalar(da.ones((40, 20))), "lazy DataArray of shape (40, 20) and type float64"),
        (xr.Dataset, repr(xr.Dataset)),
        (da.Array, repr(da.Array)),
    ],
)
def test_messages_abbreviate_arrays(value: object, message: str) -> None:
    with pytest.raises(InvalidInputError) as caught:
        Roller(radius=value, length=1e-3)
    assert str(caught.value) == f"radius = {message}: must be a positive finite number (metres)"
