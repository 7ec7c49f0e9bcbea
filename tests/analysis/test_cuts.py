"""Lines and planes through a body: interpolation is exact for linear fields and stays within the result."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from hypothesis import assume, given
from hypothesis import strategies as st

from contactstudy import InvalidInputError, analysis

fractions = st.floats(0, 1)
points = st.tuples(fractions, fractions, fractions)


def make_linear_field() -> xr.Dataset:
    x, y, z = (xr.DataArray(np.linspace(0, 1, size), dims=axis) for axis, size in zip("xyz", (3, 4, 5), strict=True))
    field = (2 * x - 3 * y + z).assign_coords(x=x, y=y, z=z).assign_attrs(units="Pa")
    surface = (x + y).assign_coords(x=x, y=y)
    return xr.Dataset({"von_mises": field, "pressure": surface})


@given(start=points, end=points)
def test_line_through_linear_field_is_exact(start, end) -> None:
    assume(not np.allclose(start, end))
    cut = analysis.along_line(make_linear_field(), start, end, points=7)
    assert cut["von_mises"].values == pytest.approx((2 * cut["x"] - 3 * cut["y"] + cut["z"]).values, abs=1e-12)
    assert float(cut["distance"][-1]) == pytest.approx(np.linalg.norm(np.subtract(end, start)))
    assert cut["von_mises"].attrs["units"] == "Pa"


@pytest.mark.parametrize(("axis", "plane_axes"), [("x", ("y", "z")), ("y", ("x", "z")), ("z", ("x", "y"))])
def test_plane_through_linear_field_is_exact(axis: str, plane_axes: tuple[str, str]) -> None:
    plane = analysis.in_plane(make_linear_field(), **{axis: 0.3})
    assert plane["von_mises"].dims == plane_axes
    expected = 2 * plane["x"] - 3 * plane["y"] + plane["z"]
    assert np.allclose(plane["von_mises"], expected.transpose(*plane_axes))
    assert float(plane[axis]) == 0.3


def test_cut_contains_stresses_or_named_surface() -> None:
    assert list(analysis.along_line(make_linear_field(), (0, 0, 0), (1, 1, 1))) == ["von_mises"]
    line = analysis.along_line(make_linear_field(), (0, 0), (1, 1), variables="pressure", points=3)
    assert line["pressure"].values == pytest.approx([0, 1, 2])
    assert "z" not in line.coords
    assert list(analysis.in_plane(make_linear_field().drop_vars("von_mises"), y=0.5)) == ["pressure"]


def test_plane_does_not_depend_on_order_of_positions() -> None:
    shuffled_field = make_linear_field().isel(z=[3, 0, 4, 1, 2])
    assert np.allclose(
        analysis.in_plane(shuffled_field, z=0.3)["von_mises"],
        analysis.in_plane(make_linear_field(), z=0.3)["von_mises"],
    )


def test_single_plane_result_has_cut_in_its_plane_only(study_dataset: xr.Dataset) -> None:
    study_case = study_dataset.sel(e_over_a=1, friction=0.1, body="finite-length")
    plane = analysis.in_plane(study_case, y=0.0, variables=["von_mises", "tresca"])
    assert plane["tresca"].dims == ("x_field", "z")
    with pytest.raises(InvalidInputError, match="this plane only"):
        analysis.in_plane(study_case, y=1e-5)


def test_line_value_equals_nearest_sample(case_result: xr.Dataset) -> None:
    a = float(case_result["hertz_half_width"])
    line = analysis.along_line(case_result, (0.26e-3, 0, 0), (0.26e-3, 0, 1.5 * a), points=7)
    expected = case_result["von_mises"].sel(x_field=0.26e-3, y_field=0, z=0.75 * a, method="nearest")
    assert float(line["von_mises"][3]) == pytest.approx(float(expected), rel=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda dataset: analysis.along_line(dataset, (0, 0, 0), (0, 0, 2)),
            "z = .*: must be within the result, 0 to 1 m",
        ),
        (lambda dataset: analysis.along_line(dataset, (0, 0), (1, 1)), r"\(x, y, z\) for fields below"),
        (lambda dataset: analysis.along_line(dataset, (0, 0, 0), (1, 1)), "both"),
        (lambda dataset: analysis.along_line(dataset, (0, 0, 0), (0, 0, 0)), "different from start"),
        (lambda dataset: analysis.along_line(dataset, (0, 0, np.nan), (0, 0, 0)), "start"),
        (lambda dataset: analysis.along_line(dataset, "here", (0, 0, 0)), "start"),
        (lambda dataset: analysis.along_line(dataset, (0, 0, 0), (1, 1, 1), points=1), "points"),
        (
            lambda dataset: analysis.along_line(dataset, (0, 0, 0), (1, 1, 1), variables=["von_mises", "pressure"]),
            "same points",
        ),
        (lambda dataset: analysis.in_plane(dataset), "exactly one"),
        (lambda dataset: analysis.in_plane(dataset, x=0.1, y=0.1), "exactly one"),
        (lambda dataset: analysis.in_plane(dataset, z=0.1, variables="pressure"), "fields along z"),
        (lambda dataset: analysis.in_plane(dataset, y="middle"), "y = 'middle'"),
        (lambda dataset: analysis.in_plane(dataset, y=-0.5), "y = -0.5"),
    ],
)
def test_invalid_line_or_plane_raises(call, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        call(make_linear_field())
