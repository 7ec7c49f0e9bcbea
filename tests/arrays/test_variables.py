"""The variables of all results are those of the table of variables."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import xarray as xr

import contactstudy as cs
from contactstudy import (
    InvalidInputError,
    analysis,
    bearing,
    design,
    fatigue,
    film,
    heat,
    plasticity,
    study,
    verification,
    wear,
)
from contactstudy.analysis.contact import case_numbers
from contactstudy.arrays.variables import (
    COORDINATES,
    ERROR_KIND,
    ESTIMATED,
    NOT_ESTIMATED,
    RULES,
    VARIABLES,
    describe,
    name_array,
    require,
    specification,
    variable_of,
    without_error,
)
from contactstudy.bearing.tabulation import ContactSolver, label_law
from contactstudy.fields.edge_tension import edge_tension
from contactstudy.study.parameters import PARAMETERS
from contactstudy.verification import suite
from contactstudy.verification.problems import Reference
from tests.bearing.test_energy_spline import NODES
from tests.small_study import small_study
from tests.stand_in_solver import solve_fake

Returned = dict[str, xr.Dataset]

UNCHANGED_NAME_FUNCTIONS = {"normalized", "single_case", "measure", "positions", "along_line", "in_plane"}
"""Functions whose result has the variables of their argument, possibly in other units."""


def list_dataset_functions() -> dict[str, Callable[..., object]]:
    """Public functions that return labelled data, by name."""
    packages: list[ModuleType] = [
        cs,
        analysis,
        bearing,
        design,
        fatigue,
        film,
        heat,
        plasticity,
        study,
        verification,
        wear,
    ]
    functions_by_name = {name: getattr(package, name) for package in packages for name in package.__all__}
    for module in (cs.roughness, cs.stress):
        functions_by_name |= {
            name: value for name, value in vars(module).items() if getattr(value, "__module__", "") == module.__name__
        }
    return {
        name: value
        for name, value in functions_by_name.items()
        if inspect.isfunction(value)
        and not name.startswith("_")
        and inspect.signature(value).return_annotation in ("xr.Dataset", "xr.DataArray")
    }


FUNCTIONS = list_dataset_functions()


def make_dataset(public_object: xr.Dataset | xr.DataArray) -> xr.Dataset:
    if isinstance(public_object, xr.Dataset):
        return public_object
    return (
        public_object.coords.to_dataset()
        if public_object.name in public_object.coords
        else public_object.to_dataset(name=str(public_object.name))
    )


def solve_contact_with_motion(case: cs.Case, contact: xr.Dataset, motion: cs.Rolling | cs.Shift) -> xr.Dataset:
    """The case's contact with stick and slip."""
    gap = case.gap(cs.Grid.from_centres(contact.x.values, contact.y.values))
    labelled_gap = contact.pressure.copy(data=gap).assign_attrs(units="m")
    return cs.solve_contact(case.body, labelled_gap, load=case.normal_load, friction=0.1, motion=motion)


def load_one_case(folder: Path) -> xr.Dataset:
    """A case of a study, loaded from the folder."""
    cs.run_study(small_study(sweep={"e_over_a": [0.0]}), folder, workers=0, solver=solve_fake, progress=False)
    return study.load_case(folder, str(cs.open_study(folder)["case_id"].values.item()))


@pytest.fixture(scope="module")
def returned_datasets(strip_result: Callable[..., xr.Dataset], study_dataset: xr.Dataset, tmp_path_factory) -> Returned:
    """Results of every public function, by its name."""
    steel = cs.Material(210e9, 0.3)
    steel_thermal = heat.ThermalProperties(conductivity=46.0, density=7850.0, specific_heat=470.0)
    length, half_width = 0.4e-3, 65e-6
    body = cs.FiniteLengthSpace(length=length, material=steel)
    roller = cs.Roller(radius=5e-3, length=length, material=steel)
    case = cs.Case(body=body, roller=roller, max_pressure=1.5e9, friction=0.1)
    grid = cs.Grid(x_range=(0.0, length), y_range=(-4 * half_width, 4 * half_width), cells_x=8, cells_y=24)
    depths = half_width * np.array([0.25, 0.5, 1.0])
    case_result = cs.solve(case, grid, y=grid.y[::4], x=grid.x[::4], z=depths)
    pressure = case_result["pressure"]
    contact = cs.solve_contact(body, case_result["initial_gap"], load=case.normal_load)
    coarse_result = cs.solve(case, grid.coarsened(), stresses=False)
    # Sharp rigid ends: the pressure is singular at both ends.
    half_space = cs.HalfSpace(material=steel)
    sharp_case = cs.Case(body=half_space, roller=cs.Roller(radius=5e-3, length=length), max_pressure=1.5e9)
    chamfer = cs.profiles.Chamfer(width=0.1e-3, angle=0.01)
    chamfered_case = cs.Case(
        body=half_space, roller=cs.Roller(radius=5e-3, length=length, profile=chamfer), max_pressure=1.5e9
    )
    strip = strip_result(half_width, 1.5e9)
    limits = fatigue.FatigueLimits(bending=500e6, torsion=300e6)
    criterion = fatigue.dang_van(strip, limits)
    risk = fatigue.lundberg_palmgren(strip)
    rough_result = cs.roughness.self_affine(grid, rms_height=1e-7, hurst=0.8, longest=2e-4, shortest=1e-4, seed=1)
    file = tmp_path_factory.mktemp("rough") / "map.nc"
    rough_result.to_netcdf(file)
    check = Reference("case", "closed form").compare("peak pressure", 1.0, 1.0, 0.1)
    verification = suite.Verification("full", {"one": [check]})
    law = bearing.ContactLaw(
        label_law(ContactSolver(case, 0.1, 1e-4), NODES, np.full((2, *NODES.normal_load.shape), 0.01))
    )
    smooth_roller = cs.Roller(radius=5e-3, length=length, profile=cs.profiles.Lundberg(4e-7), material=steel)
    crowned_case = cs.Case(body=half_space, roller=smooth_roller, max_pressure=1.5e9)
    oiled_case = replace(
        crowned_case,
        motion=cs.Sliding(body_speed=2.0, roller_speed=2.0),
        lubricant=cs.Lubricant.preset("heavy machine oil", 60.0).replaced(conductivity=0.14),
    )
    film_result = film.solve_film(
        oiled_case,
        accuracy=0.2,
        asperities=film.Asperities(rms=2e-7),
        resolution=film.FilmResolution(finest=1.1, finest_share=0.25, inner=0.3, columns=0.5, levels=3),
    )
    returned_values: dict[str, xr.Dataset | xr.DataArray] = {
        "solve": case_result,
        "solve on refined columns": cs.solve(sharp_case, x=[2e-4, 4e-4], y=[-1e-5, 0.0, 1e-5], z=depths, accuracy=0.1),
        "solve, chamfered": cs.solve(chamfered_case, stresses=False, accuracy=0.1),
        "solve_contact": contact,
        "solve_contact, rolling": solve_contact_with_motion(case, contact, cs.Rolling(longitudinal_creepage=1e-3)),
        "solve_contact, shifted": solve_contact_with_motion(case, contact, cs.Shift(y=1e-8)),
        "stress_field": cs.stress_field(body, pressure, z=depths),
        "displacement_field": cs.displacement_field(body, pressure, z=depths),
        "surface_displacement": cs.surface_displacement(body, pressure),
        "surface_displacement, all": cs.surface_displacement(body, pressure, components="xyz"),
        "equivalent_loads": cs.equivalent_loads(body, pressure, z=depths),
        "roller_stress": cs.roller_stress(case, pressure, z=depths),
        "wear_in": wear.wear_in(case, 1e-17, distance=[0.0, 10.0], grid=grid.coarsened()),
        "contact_law": law.table,
        "at": law.at([2e-6, 3e-6], [0.0, 1e-4]),
        "under": bearing.Raceways(law, law).under([1e4, 2e4], [0.0, 1.0]),
        "lamina_factors": bearing.lamina_factors(coarse_result, laminae=4),
        "reference_life": bearing.reference_life(crowned_case, crowned_case, (1e3, 1e3), laminae=4, accuracy=0.1),
        "best_profile": design.best_profile(
            crowned_case,
            cs.profiles.Lundberg,
            bounds={"amplitude": (1e-7, 4e-7)},
            measure=lambda result: (1.0, 1.0),
            accuracy=0.1,
            evaluations=8,
        ),
        "solve_film": film_result,
        "film_traction": film.film_traction(oiled_case, film_result, [0.0, 0.1]),
        "flash_temperature": heat.flash_temperature(
            replace(case, motion=cs.Sliding(body_speed=-1.0, roller_speed=1.0)),
            case_result,
            body=steel_thermal,
            roller=steel_thermal,
            z=depths,
        ),
        "case_numbers": xr.Dataset(case_numbers(case_result)),
        "self_affine": rough_result,
        "read_height_map": cs.roughness.read_height_map(file, grid),
        "slice_model": bearing.slice_model(case),
        "atlas": cs.atlas(100.0, 1.0, 0.2),
        "open_study": study_dataset,
        "load_case": load_one_case(tmp_path_factory.mktemp("study")),
        "collect": study_dataset.drop_dims(
            [dim for dim in study_dataset.dims if dim not in study_dataset["status"].dims]
        ),
        "verify": verification.to_dataset(),
        "load_between": analysis.load_between(case_result, 0.0, 1e-4),
        "peak": xr.merge([analysis.largest_sample(case_result, name) for name in ("pressure", "von_mises")]),
        "edge_factors": analysis.edge_factors(case_result, reference=case_result),
        "along_line": analysis.along_line(strip, (1e-4, 0.0, 2e-5), (1e-4, 0.0, 5e-5), variables="von_mises"),
        "in_plane": analysis.in_plane(strip, y=0.0, variables="von_mises"),
        "measure": analysis.measure(case_result, "tresca"),
        **{f"measure, {rank}": analysis.measure(case_result, f"principal_stress_{rank}") for rank in (1, 2, 3)},
        "edge_tension": edge_tension(case_result),
        "positions": analysis.positions(pressure, "x"),
        "discretisation_error": analysis.discretisation_error(case_result, coarse_result),
        "slices": analysis.slices(case_result, 4),
        "dang_van": criterion,
        "crossland": fatigue.crossland(strip, limits),
        "findley": fatigue.findley(strip.isel(x_field=[3, 4], z=[5, 6]), limits),
        "lundberg_palmgren": risk,
        "ioannides_harris": fatigue.ioannides_harris(criterion["dang_van"]),
        "relative_life": fatigue.relative_life(risk, risk),
        "eigenstrain_stress": plasticity.eigenstrain_stress(
            body, xr.Dataset({"plastic_strain_yy": (("x", "z"), np.ones((2, 2)))}, {"x": [1e-4, 2e-4], "z": depths[:2]})
        ),
        "residual_stress": cs.plasticity.residual_stress(
            strip.isel(x_field=[4]), body, cs.plasticity.ElasticPlastic(yield_stress=8e8), 2
        ),
        "shakedown_in_plane": fatigue.shakedown_in_plane(strip.isel(z=slice(None, None, 4)), body),
        "shakedown": fatigue.shakedown(strip.isel(x_field=[4]), axial=True),
    }
    for name in FUNCTIONS.keys() - returned_values.keys():
        returned_values[name] = FUNCTIONS[name](strip if name == "window_remainder" else case_result)  # type: ignore[assignment]
    return {name: make_dataset(value) for name, value in returned_values.items()}


def test_every_public_function_has_a_result(returned_datasets: Returned) -> None:
    assert {"solve", "contact_results", "dang_van", "open_study", "slice_model", "verify"} <= FUNCTIONS.keys()
    assert FUNCTIONS.keys() <= returned_datasets.keys()


MOTION_VARIABLES = ("slip_x", "slip_y", "friction_work")
"""Variables with different units for rolling and for a shift."""


def test_table_contains_all_variables(returned_datasets: Returned) -> None:
    unknown_names, differing_names = [], []
    for function, dataset in returned_datasets.items():
        for name, array in dataset.data_vars.items():
            entry_of_table = specification(str(name)) or specification(str(name), coordinate=True)
            if entry_of_table is None:
                unknown_names.append((function, name))
            elif (
                name not in MOTION_VARIABLES
                and not str(name).startswith(("risk", "end_intensity"))  # their units depend on an exponent
                and function not in UNCHANGED_NAME_FUNCTIONS
            ):
                expected = {"units": entry_of_table.units} if entry_of_table.units else {}
                if {key: array.attrs[key] for key in ("units",) if key in array.attrs} != expected:
                    differing_names.append((function, name, array.attrs))
                if not array.attrs.get("long_name"):
                    differing_names.append((function, name, array.attrs))
    assert unknown_names == []
    assert differing_names == []


def test_tables_contain_all_coordinates(returned_datasets: Returned) -> None:
    known_names = {*PARAMETERS}
    unknown_names = [
        (function, name)
        for function, dataset in returned_datasets.items()
        for name in dataset.coords
        if name not in known_names and specification(str(name), coordinate=True) is None
    ]
    assert unknown_names == []


def test_dimensions_match_table(returned_datasets: Returned) -> None:
    """Variables of studies, slices and contact laws have other dimensions than the table; a cut field has fewer."""
    differing_names = []
    for function, dataset in returned_datasets.items():
        for name, array in dataset.data_vars.items():
            if name not in VARIABLES:
                continue
            dims = {re.sub(r"^([xyz])(_field)?(_index|_over_a)?$", r"\1", str(dim)) for dim in array.dims}
            distance_dims = {"distance"} if function in ("along_line", "wear_in") else set()
            law_dims = {"approach", "normal_load", "moment"}
            further_dims = {*PARAMETERS, "case", "slice", "pass_number", *law_dims, *distance_dims}
            if not dims - further_dims <= {*VARIABLES[str(name)].dims}:
                differing_names.append((function, name, array.dims))
    assert differing_names == []


def test_results_cover_variable_table(returned_datasets: Returned) -> None:
    names = {str(name) for dataset in returned_datasets.values() for name in dataset.data_vars}
    assert VARIABLES.keys() - names == set()
    coordinates = {str(name) for dataset in returned_datasets.values() for name in dataset.coords}
    assert COORDINATES.keys() - coordinates - {"case"} == set()
    for pattern in RULES:
        start, end = pattern.split("{name}")
        matching_names = {name for name in names | coordinates if name.startswith(start) and name.endswith(end)}
        assert matching_names - VARIABLES.keys(), pattern


def test_listed_cases_have_case_coordinate() -> None:
    from contactstudy.study.plan import cube_of_axes

    assert set(cube_of_axes([], np.zeros(1, dtype=np.int64)).labels) == {"case"}


def test_labels_contain_no_braces(returned_datasets: Returned) -> None:
    for dataset in returned_datasets.values():
        for array in dataset.variables.values():
            assert "{" not in str(array.attrs.get("long_name", "")) + str(array.attrs.get("units", ""))


def test_unknown_name_keeps_attributes() -> None:
    dataset = xr.Dataset({"luck": ("y", [1.0])}, {"y": [0.0]})
    labelled_dataset = describe(dataset)
    assert labelled_dataset["luck"].attrs == {}
    assert labelled_dataset["y"].attrs["units"] == "m"
    assert dataset["y"].attrs == {}
    assert specification("peak_luck") is None
    assert specification("peak_") is None


def test_derived_labels_use_array_attributes() -> None:
    base = variable_of("luck", {"units": "K", "long_name": "fortune"})
    assert name_array("peak_luck", xr.DataArray(1.0, attrs={"units": "m"}), base).attrs == {
        "units": "K",
        "long_name": "largest fortune",
    }


def test_derived_quantity_labels() -> None:
    criterion = VARIABLES["dang_van"]
    entry = specification("utilisation", criterion)
    assert entry is not None
    assert entry.long_name == "Dang Van's equivalent shear stress, over its limit"
    template_entry = specification("peak_utilisation")
    assert template_entry is not None
    assert template_entry.long_name == "largest value, over its limit"
    over_a = specification("x_field_over_a", coordinate=True)
    assert over_a is not None
    assert (over_a.dims, over_a.symbol) == (("x_field",), "x/a")
    text_without_symbol = variable_of("stick_over_a", {})
    assert (text_without_symbol.symbol, text_without_symbol.long_name) == ("", "whether the surfaces stick over a")


@pytest.mark.parametrize(
    ("name", "symbol", "units"),
    [
        ("peak_pressure", r"\max p", "Pa"),
        ("peak_pressure_error", "", "Pa"),
        ("peak_tau_yz_z", "", "m"),
        ("load_error", "", "1"),
        ("half_width_middle_error", "", "m"),
    ],
)
def test_entries_of_derived_names_follow_rules(name: str, symbol: str, units: str) -> None:
    entry = specification(name)
    assert entry is not None
    assert (entry.symbol, entry.units) == (symbol, units)


def test_axis_labels_are_short() -> None:
    """xarray breaks labels of figures after 30 characters and cuts off the second line."""
    for name, entry in (*COORDINATES.items(), *PARAMETERS.items()):
        attributes = entry.attrs
        assert len(f"{attributes['long_name']} [{attributes.get('units', '')}]") <= 30, name


def test_numbers_without_error_are_marked(case_result: xr.Dataset) -> None:
    """Every scalar in SI of a result or its summary has an error, is an input, or has the mark "not estimated"."""
    input_names = ("normal_load", "hertz_half_width", "hertz_max_pressure", "tilt", "end_traction_residual")
    input_names += ("reference_depth",)
    for dataset in (case_result, analysis.contact_results(case_result), analysis.edge_factors(case_result)):
        for name, value in dataset.data_vars.items():
            is_number = value.ndim == 0 and value.dtype.kind == "f" and not str(name).endswith("_error")
            if is_number and name not in input_names and f"{name}_error" not in dataset:
                assert value.attrs[ERROR_KIND] == NOT_ESTIMATED, name
    values = (case_result["load_position"], *analysis.axial_profiles(case_result).data_vars.values())
    assert all(value.attrs[ERROR_KIND] == NOT_ESTIMATED for value in values)


@pytest.mark.parametrize(
    ("missing", "hint"),
    [
        ("tau_yz", "tau_yz is missing; a study keeps it at level 'fields'"),
        ("pressure", "pressure is missing; a study keeps it at level 'surface'"),
        ("hertz_half_width", "hertz_half_width is missing"),
    ],
)
def test_require_message_contains_study_level(missing: str, hint: str) -> None:
    with pytest.raises(InvalidInputError) as caught:
        require(xr.Dataset({"gap": 0.0}), "gap", missing, argument="result")
    assert caught.value.hint == hint
    assert str(caught.value).startswith("result = ['gap']")


def test_require_suggests_the_nearest_variable() -> None:
    with pytest.raises(InvalidInputError, match=r"variable = 'peak_vonmises'.*did you mean 'peak_von_mises'\?"):
        require(xr.Dataset({"gap": 0.0, "peak_von_mises": 0.0}), "peak_vonmises")


def test_require_message_contains_case_failure() -> None:
    failed_case = xr.Dataset({"status": "failed", "message": "too narrow"})
    with pytest.raises(InvalidInputError, match=r"a failed case.*too narrow"):
        require(failed_case, "pressure")


def test_require_raises_for_wrong_type() -> None:
    with pytest.raises(InvalidInputError, match=r"list.*Dataset"):
        require([], argument="result")


def test_error_kind_follows_from_error_variable() -> None:
    marked_result = without_error(
        xr.Dataset({"peak_pressure": 1.0, "peak_pressure_error": 0.1, "approach": 1.0}), "approach"
    )
    kinds = {name: value.attrs.get(ERROR_KIND) for name, value in describe(marked_result).data_vars.items()}
    assert kinds == {"peak_pressure": ESTIMATED, "peak_pressure_error": None, "approach": NOT_ESTIMATED}
    unknown_error = describe(xr.Dataset({"peak_pressure": 1.0, "peak_pressure_error": np.nan}))
    assert unknown_error["peak_pressure"].attrs[ERROR_KIND] == NOT_ESTIMATED
