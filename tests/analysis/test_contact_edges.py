import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import (
    Case,
    FiniteLengthSpace,
    HalfSpace,
    InvalidInputError,
    Material,
    Roller,
    choose_grid,
    solve,
    solve_contact,
)
from contactstudy.analysis import contact_edges
from contactstudy.analysis.axial import EDGE_UNCERTAINTY
from contactstudy.profiles import Cylinder, FullCrown

UNIT_HALF_SPACE = HalfSpace(material=Material(0.75, 0.5))


def make_ellipsoid_contact(window: float, cells: int, curvature_ratio: float = 1.0) -> xr.Dataset:
    """Contact of contact radius 1 under a sphere, or of an ellipsoid whose curvature along x is multiplied."""
    centres = window * (2 * np.arange(cells) + 1 - cells) / cells
    gap = xr.DataArray(
        0.5 * (curvature_ratio * centres[:, None] ** 2 + centres**2),
        coords={"x": centres, "y": centres},
        dims=("x", "y"),
    )
    return solve_contact(UNIT_HALF_SPACE, gap, load=4 / 3)


@given(st.floats(1.7, 2.0))
def test_edges_of_sphere_equal_hertz_circle(window):
    contact = make_ellipsoid_contact(window, 64)
    step = float(contact.y[1] - contact.y[0])
    edges = contact_edges(contact)
    column = np.abs(contact.x) < 0.5
    expected = np.sqrt(1 - contact.x.values[column] ** 2)
    assert np.abs(edges.half_width.values[column] - expected).max() < EDGE_UNCERTAINTY * step
    assert abs(float(edges.contact_length) - 2) < 2 * EDGE_UNCERTAINTY * step
    assert float(edges.contact_area) == pytest.approx(np.pi, rel=3e-3)


def test_fitted_edges_are_closer_than_counted_cells():
    fitted_errors, counted_errors = [], []
    for window in np.linspace(1.75, 1.85, 11):
        contact = make_ellipsoid_contact(float(window), 64)
        mid_section = contact.isel(x=32)
        step = float(contact.y[1] - contact.y[0])
        expected = np.sqrt(1 - float(mid_section.x) ** 2)
        fitted_errors.append(float(contact_edges(contact).half_width[32]) - expected)
        counted_errors.append(0.5 * step * int((mid_section.pressure > 0).sum()) - expected)
    assert np.abs(fitted_errors).max() < 0.1 * np.abs(counted_errors).max()


def test_edges_of_mirrored_contact_are_mirrored():
    contact = make_ellipsoid_contact(1.8, 48, curvature_ratio=0.8)
    shifted_contact = contact.assign_coords(x=contact.x + 0.3, y=contact.y + 0.2)
    mirrored_contact = shifted_contact.assign_coords(x=-shifted_contact.x, y=-shifted_contact.y).sortby(["x", "y"])
    edges, mirrored_edges = contact_edges(shifted_contact), contact_edges(mirrored_contact)
    np.testing.assert_allclose(mirrored_edges.y_left.values[::-1], -edges.y_right.values, atol=1e-12)
    assert float(mirrored_edges.x_first) == pytest.approx(-float(edges.x_last), abs=1e-12)


def test_area_of_ellipse_equals_product_of_axes():
    edges = contact_edges(make_ellipsoid_contact(1.9, 96, curvature_ratio=0.7))
    width_y, length_x = 2 * float(edges.half_width.max()), float(edges.contact_length)
    assert float(edges.contact_area) == pytest.approx(np.pi / 4 * width_y * length_x, rel=2e-3)


def test_edges_reach_free_ends(on_cells):
    body = FiniteLengthSpace(length=4.0, material=Material(1.0, 0.3))
    gap = on_cells(lambda x, y: 0.5 * y**2 + 0 * x, (0.0, 4.0), (-2.0, 2.0), (32, 32))
    edges = contact_edges(solve_contact(body, gap, load=2.0))
    assert (float(edges.x_first), float(edges.x_last)) == pytest.approx((0.0, 4.0))
    half_width = edges.half_width.values
    assert np.ptp(half_width) < 0.5
    assert float(edges.contact_area) == pytest.approx(2 * half_width.mean() * 4.0, rel=1e-3)


def test_edges_of_flat_punch_equal_punch(on_cells):
    shape = on_cells(
        lambda x, y: np.where((np.abs(x) < 1) & (np.abs(y) < 0.5), 0.0, np.inf), (-2.0, 2.0), (-2.0, 2.0), (32, 32)
    )
    edges = contact_edges(solve_contact(UNIT_HALF_SPACE, shape, load=1.0))
    assert float(edges.contact_length) == pytest.approx(2.0)
    np.testing.assert_allclose(edges.half_width.dropna("x"), 0.5)
    assert float(edges.contact_area) == pytest.approx(2.0)


def test_no_contact_has_no_edges():
    contact = make_ellipsoid_contact(1.8, 16)
    edges = contact_edges(contact.assign(pressure=0 * contact.pressure))
    assert np.isnan(edges.half_width).all()
    assert (float(edges.contact_length), float(edges.contact_area)) == (0.0, 0.0)


def test_every_variable_has_a_unit():
    edges = contact_edges(make_ellipsoid_contact(1.8, 32))
    assert {variable.attrs["units"] for variable in edges.data_vars.values()} == {"m", "m2"}


@pytest.mark.parametrize("missing", ["pressure", "gap"])
def test_missing_pressure_or_gap_raises(missing):
    with pytest.raises(InvalidInputError, match=missing):
        contact_edges(make_ellipsoid_contact(1.8, 16).drop_vars(missing))


def test_argument_without_dataset_raises():
    with pytest.raises(InvalidInputError, match="Dataset"):
        contact_edges([1.0])


def test_contact_area_with_small_fillet_depends_little_on_cells():
    """At a small fillet the pressure is concentrated: the fitted border may lie within the outermost loaded column."""
    material, modulus = Material(210e9, 0.3), 0.5 * Material(210e9, 0.3).plane_strain_modulus
    half_width = 2 * 1.5e9 * 5e-3 / modulus
    roller = Roller(
        radius=5e-3, length=10 * half_width, profile=Cylinder(fillet_radius=0.2e-3), material=material, ends="none"
    )
    case = Case(body=HalfSpace(material=material), roller=roller, max_pressure=1.5e9)
    areas = []
    for cells in (6, 7, 8, 9):
        contact = solve(case, choose_grid(case, cells_x=cells, cells_y=16, window=2.2), stresses=False)
        areas.append(float(contact_edges(contact).contact_area))
        counted_area = int((contact.pressure > 0).sum()) * float(np.diff(contact.x[:2])[0] * np.diff(contact.y[:2])[0])
        assert areas[-1] == pytest.approx(counted_area, rel=0.05)
    np.testing.assert_allclose(areas, areas[-1], rtol=0.03)


def test_study_case_has_contact_edges(study_dataset):
    study_case = study_dataset.sel(e_over_a=1, friction=0.1, body="finite-length")
    assert float(study_case.contact.contact_edges()["contact_length"]) > 0


def test_area_of_contact_with_narrow_middle_equals_integral():
    x, y = -4 + 0.1 * (np.arange(80) + 0.5), 0.05 * (np.arange(40) - 19.5)
    half_width = 0.3 + 0.3 * np.exp(-((np.abs(x) - 3.5) ** 2) / 0.1)
    border_function = y**2 - half_width[:, None] ** 2
    contact = xr.Dataset(
        {
            "pressure": (("x", "y"), np.sqrt(np.maximum(-border_function, 0.0))),
            "gap": (("x", "y"), np.maximum(border_function, 0.0) ** 1.5),
        },
        coords={"x": x, "y": y},
    )
    assert float(contact_edges(contact).contact_area) == pytest.approx(0.2 * half_width.sum(), rel=0.01)


def test_contact_length_on_uniform_cells_is_at_most_roller_length() -> None:
    """The pressure of a flat crown decreases towards flush ends; its extrapolation is 0 a little beyond the ends."""
    steel = Material(210e9, 0.3)
    roller = Roller(radius=5e-3, length=1e-3, profile=FullCrown(crown_radius=0.5))
    case = Case(body=FiniteLengthSpace(length=1e-3, material=steel), roller=roller, max_pressure=1e9)
    edges = contact_edges(solve(case, choose_grid(case), stresses=False))
    assert float(edges.x_first) >= 0
    assert float(edges.x_last) <= 1e-3
    assert float(edges.contact_length) == pytest.approx(1e-3)
