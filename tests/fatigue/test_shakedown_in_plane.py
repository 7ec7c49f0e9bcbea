"""Melan's bound with residual stress in the plane (x, z), between free ends."""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module

import numpy as np
import pytest
import xarray as xr

from benchmarks.finite_elements.shakedown import list_point_positions, minimize_shear_yield_stress
from contactstudy import (
    ConvergenceWarning,
    FiniteLengthSpace,
    HalfSpace,
    InvalidInputError,
    Material,
    fatigue,
    stress_field,
)
from contactstudy.arrays.variables import STRESSES
from contactstudy.verification.closed_forms import hertz_strip

DEPTHS = np.linspace(0, 3, 25)
UNIT_MATERIAL = Material(1.0, 0.3)


@pytest.fixture(scope="module")
def line_contact_weaker_at_ends() -> Callable[[float, float], xr.Dataset]:
    """Make Hertz' line contact whose stress is reduced towards both ends, by half by default."""

    def make_contact(length: float, friction: float, reduction: float = 0.5) -> xr.Dataset:
        x, y = np.linspace(0, length, 9), np.linspace(-4, 4, 81)
        result = hertz_strip(y[:, None], DEPTHS, 1.0, 1.0, 0.3, friction)
        distribution = 1 - reduction * np.clip(1 - np.minimum(x, length - x) / (0.4 * length), 0, 1)[:, None, None]
        fields = {name: (("x", "y", "z"), distribution * values) for name, values in result.items()}
        return xr.Dataset(fields, {"x": x, "y": y, "z": DEPTHS})

    return make_contact


def test_line_contact_limit_of_a_long_body(line_contact_weaker_at_ends) -> None:
    """The ends have no influence: the stress along x reverses below the critical depth (Johnson's 4.0)."""
    stress = line_contact_weaker_at_ends(16.0, 0.2)
    result = fatigue.shakedown_in_plane(stress, FiniteLengthSpace(length=16.0, material=UNIT_MATERIAL))
    line_contact_limit = fatigue.shakedown(stress.isel(x=[4]), axial=True)["shakedown_stress"].max()
    assert float(result["peak_shakedown_stress"]) == pytest.approx(float(line_contact_limit), rel=1e-3)
    assert float(result["program_gap"]) < 1e-3


def test_short_body_has_a_lower_limit(line_contact_weaker_at_ends) -> None:
    """The residual stress along x vanishes at the ends; rho_yy is not constrained."""
    rolling_limits, in_plane_limits = [], []
    for length in (0.4, 16.0):
        stress = line_contact_weaker_at_ends(length, 0.0, 0.15)
        rolling_limits.append(float(fatigue.shakedown(stress)["shakedown_stress"].max()))
        result = fatigue.shakedown_in_plane(stress, FiniteLengthSpace(length=length, material=UNIT_MATERIAL))
        in_plane_limits.append(float(result["peak_shakedown_stress"]))
    assert rolling_limits[0] == pytest.approx(rolling_limits[1])
    assert in_plane_limits[1] < 0.9 * rolling_limits[1]
    assert in_plane_limits[1] * 1.01 < in_plane_limits[0] < rolling_limits[0]


def make_sphere_passage(counts: tuple[int, int], max_depth: float) -> xr.Dataset:
    """Stresses of Hertz' frictionless sphere, half-width and largest pressure 1, at (x, z) positions."""
    edges = np.linspace(-1.2, 1.2, 49)
    x = (0.5 * (edges[1:] + edges[:-1]))[:, None] + (edges[1] - edges[0]) * ((np.arange(8) + 0.5) / 8 - 0.5)
    square = (1 - x.reshape(-1, 1) ** 2 - x.ravel() ** 2).clip(0)
    cells = 0.5 * (edges[1:] + edges[:-1])
    pressure = xr.DataArray(np.sqrt(square).reshape(48, 8, 48, 8).mean((1, 3)), {"x": cells, "y": cells}, ("x", "y"))
    positions = {"x": np.linspace(-3, 3, counts[0]), "z": np.linspace(0, max_depth, counts[1])}
    return stress_field(
        HalfSpace(material=UNIT_MATERIAL), pressure, inside_cells=pressure, y=np.linspace(-3, 3, 41), **positions
    )


@pytest.mark.slow
def test_limit_of_sphere_equals_published_value() -> None:
    """The ratio p0 / k is 4.68 without friction; the bound converges with more positions, without a gap."""
    yield_limits = []
    for counts, max_depth in (((19, 13), 2.4), ((31, 25), 3.0)):
        bound = fatigue.shakedown_in_plane(make_sphere_passage(counts, max_depth), HalfSpace(material=UNIT_MATERIAL))
        assert float(bound["program_gap"]) < 1e-4
        yield_limits.append(1 / float(bound["peak_shakedown_stress"]))
    assert yield_limits[1] == pytest.approx(4.68, rel=0.01)
    assert yield_limits[1] > yield_limits[0]


def test_program_without_convergence_warns(line_contact_weaker_at_ends, monkeypatch) -> None:
    monkeypatch.setattr(import_module("contactstudy.fatigue.shakedown"), "MAX_CONE_PROGRAMS", 1)
    with pytest.warns(ConvergenceWarning, match="gap of"):
        bound = fatigue.shakedown_in_plane(line_contact_weaker_at_ends(16.0, 0.2), HalfSpace(material=UNIT_MATERIAL))
    assert float(bound["program_gap"]) > 1e-4


@pytest.mark.slow
def test_equilibrium_elements_give_a_similar_limit() -> None:
    """An independent program with linear stresses in triangles has fewer degrees of freedom and a slightly lower
    limit."""
    length, x_edges, z_edges = 0.5, np.linspace(0, 0.5, 7), np.linspace(0, 2.4, 11)
    x, z, y = list_point_positions(x_edges, 0), list_point_positions(z_edges, 1), np.linspace(-2.4, 2.4, 25)
    result = hertz_strip(y[:, None], z, 1.0, 1.0, 0.3, 0.0)
    distribution = 1 - 0.2 * np.abs(2 * x / length - 1)[:, None, None] ** 2
    stress = xr.Dataset(
        {name: (("x", "y", "z"), distribution * values) for name, values in result.items()}, {"x": x, "y": y, "z": z}
    )
    rows = [stress[name].transpose("x", "z", "y").values.reshape(-1, y.size) for name in STRESSES]
    history = np.stack([np.pad(row, ((0, 0), (0, 1))) for row in rows], axis=-1)
    element_limit = 1 / minimize_shear_yield_stress(history, x_edges, z_edges)
    body = FiniteLengthSpace(length=length, material=UNIT_MATERIAL)
    spline_limit = 1 / float(fatigue.shakedown_in_plane(stress, body)["peak_shakedown_stress"])
    rolling_limits = 1 / float(fatigue.shakedown(stress)["shakedown_stress"].max())
    assert rolling_limits * 1.03 < element_limit < spline_limit < element_limit * 1.03


def test_flush_roller_satisfies_melan(short_body, strip_pressure) -> None:
    """Ends and top are free, no point yields at the computed k, and the loaded corner bounds the limit."""
    pressure, friction = strip_pressure(8.0, (32, 16)), 0.1
    pressure = pressure * (0.4 + 0.6 * np.minimum(1, np.minimum(pressure.x, 8 - pressure.x) / 2))
    x, y, z = np.linspace(0, 8, 13), np.linspace(-3, 3, 33), np.linspace(0, 1.8, 10)
    stress = stress_field(short_body, pressure, friction=friction, x=x, y=y, z=z, inside_cells=pressure)
    result = fatigue.shakedown_in_plane(stress, short_body)
    peak_stress = float(result["peak_shakedown_stress"])
    assert peak_stress < 0.97 * float(fatigue.shakedown(stress)["shakedown_stress"].max())
    corner_limit = 0.4 / float(result["shakedown_stress"].isel(x=0, z=0))
    assert corner_limit < 2 / np.sqrt(1 + 4 * friction**2) * 1.01
    residual = {
        name: result[name.replace("sigma", "residual_sigma").replace("tau", "residual_tau")]
        for name in ("sigma_xx", "sigma_yy", "sigma_zz", "tau_xz")
    }
    max_residual = float(abs(residual["sigma_xx"]).max())
    for name in ("sigma_xx", "tau_xz"):
        assert float(abs(residual[name].isel(x=[0, -1])).max()) < 1e-9 * max_residual
    for name in ("sigma_zz", "tau_xz"):
        assert float(abs(residual[name].isel(z=0)).max()) < 1e-9 * max_residual
    # The history with the residual stress yields nowhere at k.
    total_stress = stress.assign({name: stress[name] + value for name, value in residual.items()})
    xx, yy, zz, xy, xz, yz = (total_stress[name] for name in STRESSES)
    squared_stress = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy**2 + xz**2 + yz**2)
    max_stress = np.sqrt(squared_stress.max("y") / 3)
    assert (max_stress <= result["shakedown_stress"] * (1 + 1e-6)).all()
    assert float(max_stress.max()) == pytest.approx(peak_stress, rel=1e-6)


def test_limit_scales_with_load(line_contact_weaker_at_ends) -> None:
    stress, body = line_contact_weaker_at_ends(8.0, 0.1), HalfSpace(material=UNIT_MATERIAL)
    unit_limit, scaled_limit = (
        float(fatigue.shakedown_in_plane(factor * stress, body)["peak_shakedown_stress"]) for factor in (1, 3e9)
    )
    assert scaled_limit == pytest.approx(3e9 * unit_limit, rel=1e-3)


def test_too_few_positions_are_rejected(line_contact_weaker_at_ends) -> None:
    with pytest.raises(InvalidInputError, match="5 or more increasing"):
        fatigue.shakedown_in_plane(
            line_contact_weaker_at_ends(8.0, 0.1).isel(x=[0, 2, 4]), HalfSpace(material=UNIT_MATERIAL)
        )


def test_missing_solver_raises(line_contact_weaker_at_ends, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "clarabel", None)
    with pytest.raises(ImportError, match=r"contactstudy\[shakedown\]"):
        fatigue.shakedown_in_plane(line_contact_weaker_at_ends(8.0, 0.1), HalfSpace(material=UNIT_MATERIAL))
