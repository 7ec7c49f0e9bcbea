"""Stress invariants: states with known values, rotations, bounds, and the line contact of Hertz."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import InvalidInputError
from contactstudy.arrays.variables import STRESSES
from contactstudy.stress import (
    hydrostatic,
    maximum_shear,
    orthogonal_shear_range,
    principal_stresses,
    tresca,
    von_mises,
)
from contactstudy.verification import closed_forms as ref

Array = np.ndarray

COMPONENT_INDICES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def make_state(tensor: Array) -> xr.Dataset:
    return xr.Dataset({name: float(tensor[index]) for name, index in zip(STRESSES, COMPONENT_INDICES, strict=True)})


def make_uniform_state(**components: float) -> xr.Dataset:
    return xr.Dataset({name: components.get(name, 0.0) for name in STRESSES})


@st.composite
def draw_tensor(draw: st.DrawFn) -> Array:
    # The squares of these stresses are finite numbers.
    component = st.floats(-1e9, 1e9).map(lambda value: value if abs(value) > 1e-3 else 0.0)
    values = draw(st.lists(component, min_size=6, max_size=6))
    tensor = np.zeros((3, 3))
    for value, (i, j) in zip(values, COMPONENT_INDICES, strict=True):
        tensor[i, j] = tensor[j, i] = value
    return tensor


@st.composite
def draw_rotation(draw: st.DrawFn) -> Array:
    quaternion = np.array(draw(st.lists(st.floats(-1, 1), min_size=4, max_size=4))) + np.array([1.5, 0, 0, 0])
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


@pytest.mark.parametrize(
    ("stress", "expected"),
    [
        (make_uniform_state(sigma_xx=3.0), (3.0, 3.0, 1.5, 1.0, [3, 0, 0])),
        (make_uniform_state(sigma_zz=-3.0), (3.0, 3.0, 1.5, -1.0, [0, 0, -3])),
        (make_uniform_state(tau_yz=2.0), (2 * np.sqrt(3), 4.0, 2.0, 0.0, [2, 0, -2])),
        (make_uniform_state(sigma_xx=-1.0, sigma_yy=-1.0, sigma_zz=-1.0), (0.0, 0.0, 0.0, -1.0, [-1, -1, -1])),
        # Mohr's circle of (5, -1, 4) has the centre 2 and the radius 5.
        (make_uniform_state(sigma_xx=5.0, sigma_yy=-1.0, tau_xy=4.0), (np.sqrt(79), 10.0, 5.0, 4 / 3, [7, 0, -3])),
    ],
    ids=["tension", "compression", "shear", "pressure", "mohr"],
)
def test_invariants_of_simple_states(
    stress: xr.Dataset, expected: tuple[float, float, float, float, list[float]]
) -> None:
    mises, equivalent, shear, mean, principal = expected
    assert float(von_mises(stress)) == pytest.approx(mises, abs=1e-12)
    assert float(tresca(stress)) == pytest.approx(equivalent, abs=1e-12)
    assert float(maximum_shear(stress)) == pytest.approx(shear, abs=1e-12)
    assert float(hydrostatic(stress)) == pytest.approx(mean, abs=1e-12)
    assert principal_stresses(stress)["principal_stress"].values == pytest.approx(principal, abs=1e-12)


def test_principal_directions_match_mohrs_circle() -> None:
    result = principal_stresses(make_uniform_state(sigma_xx=5.0, sigma_yy=-1.0, tau_xy=4.0))
    first_direction = result["principal_direction"].sel(principal=1)
    angle = 0.5 * np.arctan2(2 * 4.0, 6.0)
    alignment = abs(
        float(first_direction.sel(axis="x") * np.cos(angle) + first_direction.sel(axis="y") * np.sin(angle))
    )
    assert alignment == pytest.approx(1, abs=1e-12)
    assert abs(float(result["principal_direction"].sel(principal=2, axis="z"))) == pytest.approx(1, abs=1e-12)


@given(tensor=draw_tensor(), rotation=draw_rotation())
def test_invariants_do_not_depend_on_the_axes(tensor: Array, rotation: Array) -> None:
    scale = np.abs(tensor).max() + 1e-300
    original_state, rotated_state = make_state(tensor), make_state(rotation @ tensor @ rotation.T)
    # Von Mises' stress of an almost hydrostatic state is the root of a cancelled difference.
    assert abs(float(von_mises(original_state)) ** 2 - float(von_mises(rotated_state)) ** 2) <= 1e-12 * scale**2
    for invariant in (tresca, maximum_shear, hydrostatic):
        assert abs(float(invariant(original_state)) - float(invariant(rotated_state))) <= 1e-12 * scale
    values = [principal_stresses(stress)["principal_stress"].values for stress in (original_state, rotated_state)]
    assert np.abs(values[0] - values[1]).max() <= 1e-12 * scale


@given(tensor=draw_tensor())
def test_tresca_and_von_mises_stresses_are_within_bounds(tensor: Array) -> None:
    stress, scale = make_state(tensor), np.abs(tensor).max() + 1e-300
    mises, equivalent = float(von_mises(stress)), float(tresca(stress))
    assert mises <= equivalent + 1e-6 * scale
    assert equivalent <= 2 / np.sqrt(3) * mises + 1e-6 * scale
    result = principal_stresses(stress)
    principal, directions = result["principal_stress"].values, result["principal_direction"].values
    assert abs(principal.sum() - np.trace(tensor)) <= 1e-12 * scale
    assert np.all(np.diff(principal) <= 0)
    assert np.abs(directions @ directions.T - np.eye(3)).max() < 1e-12
    assert np.abs(directions.T @ np.diag(principal) @ directions - tensor).max() <= 1e-12 * scale


@pytest.fixture
def make_strip() -> Callable[..., xr.Dataset]:
    def make_dataset(friction: float = 0.0, dims: tuple[str, str, str] = ("x", "y", "z")) -> xr.Dataset:
        y = np.linspace(-3, 3, 1201)
        z = np.linspace(0.3, 1.0, 71)
        fields = ref.hertz_strip(y[:, None], z, 1.0, 1.0, 0.3, friction)
        return xr.Dataset(
            {name: (dims, np.stack([values, values])) for name, values in fields.items()},
            coords={dims[0]: [0.0, 1.0], dims[1]: y, dims[2]: z},
        )

    return make_dataset


@pytest.mark.parametrize("dims", [("x", "y", "z"), ("x_field", "y_field", "z")])
def test_orthogonal_shear_of_line_contact_equals_closed_form(
    make_strip: Callable[..., xr.Dataset], dims: tuple[str, str, str]
) -> None:
    cycle = orthogonal_shear_range(make_strip(dims=dims))
    assert cycle["orthogonal_shear_range"].dims == (dims[0], "z")
    amplitude = cycle["orthogonal_shear_amplitude"].isel({dims[0]: 0})
    assert float(amplitude.max()) == pytest.approx(0.25, abs=1e-5)
    depth = amplitude.idxmax("z")
    assert float(depth) == pytest.approx(0.5, abs=0.011)
    line = cycle.isel({dims[0]: 0}).sel(z=depth)
    assert abs(float(line["y_of_largest_shear"])) == pytest.approx(np.sqrt(0.75), abs=0.006)
    assert float(line["y_of_largest_shear"]) == pytest.approx(-float(line["y_of_smallest_shear"]), abs=1e-9)
    assert {variable.attrs["units"] for variable in cycle.data_vars.values()} == {"Pa", "m"}


def test_largest_orthogonal_shear_range_is_independent_of_friction(make_strip: Callable[..., xr.Dataset]) -> None:
    """At the depth of the largest range, friction shifts both extremes equally."""
    largest_ranges = [
        float(orthogonal_shear_range(make_strip(friction))["orthogonal_shear_range"].isel(x=0).max())
        for friction in (0, 0.1)
    ]
    assert largest_ranges[1] == pytest.approx(largest_ranges[0], rel=5e-3)


def test_max_shear_and_von_mises_of_line_contact_equal_published_values(make_strip: Callable[..., xr.Dataset]) -> None:
    stress = make_strip()
    assert float(maximum_shear(stress).max()) == pytest.approx(0.300, abs=5e-4)
    assert float(von_mises(stress).max()) == pytest.approx(0.5575, abs=1e-4)
    assert maximum_shear(stress).dims == ("x", "y", "z")


@pytest.mark.parametrize("invariant", [von_mises, tresca, maximum_shear, principal_stresses, hydrostatic])
def test_missing_component_raises(invariant: Callable[[xr.Dataset], object]) -> None:
    with pytest.raises(InvalidInputError, match="sigma_yy"):
        invariant(make_uniform_state().drop_vars("sigma_yy"))
    with pytest.raises(InvalidInputError, match="Dataset"):
        invariant(np.zeros((3, 3)))


def test_invariants_have_units_and_names() -> None:
    for invariant in (von_mises, tresca, maximum_shear, hydrostatic):
        result = invariant(make_uniform_state(sigma_xx=1.0))
        assert result.name == invariant.__name__
        assert result.attrs["units"] == "Pa"
        assert result.attrs["long_name"]


@pytest.mark.parametrize(
    ("stress", "message"),
    [
        (xr.Dataset({"tau_xz": 1.0}), "tau_yz"),
        (xr.Dataset({"tau_yz": ("x", [1.0])}), "rolling direction"),
        (xr.Dataset({"tau_yz": ("y", [1.0, 2.0])}), "positions"),
        (xr.Dataset({"tau_yz": ("y", [1.0, np.nan])}, coords={"y": [0.0, 1.0]}), "finite"),
    ],
)
def test_invalid_shear_history_raises(stress: xr.Dataset, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        orthogonal_shear_range(stress)


def test_nonfinite_stress_raises() -> None:
    with pytest.raises(InvalidInputError, match="finite"):
        principal_stresses(make_uniform_state(sigma_xx=np.nan))
