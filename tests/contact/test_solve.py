"""Contact: effects of a free end, friction, invalid input; `verification/test_suite_checks` has closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from contactstudy import (
    ConvergenceWarning,
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    InvalidInputError,
    Material,
    WindowError,
    solve_contact,
)
from contactstudy.contact import ContactSettings
from contactstudy.verification import closed_forms as ref
from contactstudy.verification.problems import LINE_LOAD


def make_sphere_gap(cells: int, window: float = 1.5) -> xr.DataArray:
    centres = window * (2 * (np.arange(cells) + 0.5) / cells - 1)
    return xr.DataArray(
        0.5 * (centres[:, None] ** 2 + centres**2), coords={"x": centres, "y": centres}, dims=("x", "y")
    )


def test_sphere_on_even_cells_matches_hertz(half_space: HalfSpace) -> None:
    """No cell centre lies at the centre of the contact, unlike in the checks of the suite."""
    cells = 64
    radius, peak, _ = ref.hertz_point(load=4 / 3, radius=1.0, modulus=1.0)
    contact = solve_contact(half_space, make_sphere_gap(cells), load=4 / 3)
    area = float((contact["pressure"] > 0).sum()) * (3 / cells) ** 2
    assert np.sqrt(area / np.pi) == pytest.approx(radius, rel=2e-2)
    x, y = contact["x"].values[:, None], contact["y"].values
    hertz_pressure = peak * np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    is_inside = x**2 + y**2 < 0.9**2
    assert np.abs(contact["pressure"].values - hertz_pressure)[is_inside].max() < 1e-2 * peak


def test_load_is_exact_and_the_certificate_holds(short_body: FiniteLengthSpace, cylinder_gap) -> None:
    contact = solve_contact(short_body, cylinder_gap(8.0, (96, 48)), load=8 * LINE_LOAD)
    assert bool(contact["converged"])
    total_load = float(contact["pressure"].sum()) * (8 / 96) * (4 / 48)
    assert total_load == pytest.approx(8 * LINE_LOAD, rel=1e-12)
    assert abs(float(contact["load_error"])) < 1e-10
    assert float(contact["penetration_error"]) < 3e-6
    assert float(contact["open_pressure_error"]) == 0.0


def test_free_end_reduces_end_pressure(short_body: FiniteLengthSpace, half_space: HalfSpace, cylinder_gap) -> None:
    peaks = {}
    for cells in (64, 128):
        gap = cylinder_gap(8.0, (cells, 64))
        axial_pressure = solve_contact(short_body, gap, load=8 * LINE_LOAD)["pressure"].max("y")
        peaks[cells] = float(
            solve_contact(HalfSpace(material=half_space.material), surround_with_infinite_gap(gap), load=8 * LINE_LOAD)[
                "pressure"
            ].max()
        )
        assert np.all(np.diff(axial_pressure.values[: cells // 2]) > 0)
        assert 0.55 < float(axial_pressure[0]) < 0.72
        assert float(axial_pressure[cells // 2]) == pytest.approx(1.0239, abs=1e-3)
    assert peaks[64] > 2.5
    assert peaks[128] > 1.3 * peaks[64]


def surround_with_infinite_gap(gap: xr.DataArray) -> xr.DataArray:
    """Surround a gap by cells with an infinite gap, which cannot touch the half-space."""
    step = float(gap.x[1] - gap.x[0])
    x = np.concatenate([gap.x[:2].values - 2 * step, gap.x.values, gap.x[-2:].values + 2 * step])
    return gap.reindex(x=x, fill_value=np.inf)


@settings(max_examples=10)
@given(length=st.floats(1.5, 12.0), poisson=st.floats(0.05, 0.5), factor=st.floats(0.3, 2.0))
def test_end_pressure_stays_below_mid_length_pressure(length: float, poisson: float, factor: float) -> None:
    body = FiniteLengthSpace(length=length, material=Material(1 - poisson**2, poisson))
    y = np.linspace(-1.9375 * factor, 1.9375 * factor, 32)
    x = length * (np.arange(16) + 0.5) / 16
    gap = xr.DataArray(np.broadcast_to(y**2, (16, 32)), coords={"x": x, "y": y}, dims=("x", "y"))
    contact = solve_contact(body, gap, load=length * LINE_LOAD * factor**2)
    line_maxima = contact["pressure"].max("y")
    assert bool(contact["converged"])
    assert float(line_maxima[0]) <= float(line_maxima[8]) * (1 + 1e-6)
    assert abs(float(contact["load_error"])) < 1e-10


def test_pressure_converges_with_cells(short_body: FiniteLengthSpace, cylinder_gap) -> None:
    mid_pressures = [
        float(
            solve_contact(short_body, cylinder_gap(8.0, cells), load=8 * LINE_LOAD)["pressure"].sel(
                x=4, y=0, method="nearest"
            )
        )
        for cells in ((32, 33), (64, 65), (128, 129))
    ]
    assert abs(mid_pressures[2] - mid_pressures[1]) < 2e-3
    assert abs(mid_pressures[2] - mid_pressures[1]) < abs(mid_pressures[1] - mid_pressures[0])


def test_friction_moves_the_contact_only_when_coupled(short_body: FiniteLengthSpace, cylinder_gap) -> None:
    gap = cylinder_gap(8.0, (48, 64))
    uncoupled_contact = solve_contact(short_body, gap, load=8 * LINE_LOAD, friction=0.4)
    coupled_contact = solve_contact(
        short_body, gap, load=8 * LINE_LOAD, friction=0.4, settings=ContactSettings(coupled=True)
    )
    assert np.allclose(uncoupled_contact["traction_y"], 0.4 * uncoupled_contact["pressure"])

    def compute_pressure_centre(contact: xr.Dataset) -> float:
        return float((contact["pressure"] * contact["y"]).sum() / contact["pressure"].sum())

    assert abs(compute_pressure_centre(uncoupled_contact)) < 1e-6
    # The traction along +y raises the surface behind and lowers it ahead, so the contact moves back.
    assert -0.2 < compute_pressure_centre(coupled_contact) < -0.02
    assert bool(coupled_contact["converged"])
    assert float(coupled_contact["penetration_error"]) < 1e-6


def test_coupling_vanishes_for_an_incompressible_half_space(cylinder_gap) -> None:
    body = HalfSpace(material=Material(0.75, 0.5))
    gap = make_sphere_gap(48)
    uncoupled_contact = solve_contact(body, gap, load=4 / 3, friction=0.3)
    coupled_contact = solve_contact(body, gap, load=4 / 3, friction=0.3, settings=ContactSettings(coupled=True))
    assert np.abs(uncoupled_contact["pressure"] - coupled_contact["pressure"]).max() < 1e-5


def test_early_stop_warns_and_is_not_converged(half_space: HalfSpace) -> None:
    with pytest.warns(ConvergenceWarning, match="max_iterations"):
        contact = solve_contact(half_space, make_sphere_gap(64), load=4 / 3, settings=ContactSettings(max_iterations=2))
    assert not bool(contact["converged"])


def test_contact_at_window_edge_raises_error(
    half_space: HalfSpace, short_body: FiniteLengthSpace, cylinder_gap
) -> None:
    with pytest.raises(WindowError, match=r"y_min.*widen"):
        solve_contact(half_space, make_sphere_gap(32, window=0.8), load=4 / 3)
    with pytest.raises(WindowError, match="y_min"):
        solve_contact(short_body, cylinder_gap(8.0, (32, 32), window=0.9), load=8 * LINE_LOAD)


def solve_with_settings(
    coupled: bool = False, tolerance: float = 1e-6, max_iterations: int = 500, **arguments: object
) -> None:
    """Contact with settings and arguments given as keywords."""
    settings = ContactSettings(coupled=coupled, tolerance=tolerance, max_iterations=max_iterations)
    solve_contact(**arguments, settings=settings)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"load": 0.0}, "load = 0.0: must be a positive"),
        ({"load": np.nan}, "load = nan"),
        ({"load": "much"}, "load = 'much'"),
        ({"friction": np.inf}, "friction = inf"),
        ({"coupled": "yes"}, "coupled = 'yes'"),
        ({"tolerance": -1.0}, "tolerance = -1.0"),
        ({"max_iterations": 0}, "max_iterations = 0"),
        ({"body": "steel"}, "body = 'steel'"),
    ],
)
def test_invalid_arguments_raise_error(half_space: HalfSpace, change: dict[str, object], message: str) -> None:
    arguments = {"body": half_space, "gap": make_sphere_gap(16), "load": 1.0} | change
    with pytest.raises(InvalidInputError, match=message):
        solve_with_settings(**arguments)  # type: ignore[arg-type]


def test_invalid_gaps_raise_error(half_space: HalfSpace, short_body: FiniteLengthSpace) -> None:
    gap = make_sphere_gap(16)
    with pytest.raises(InvalidInputError, match=r"nan at x = .*finite everywhere"):
        solve_contact(half_space, gap.where(gap > 0.1), load=1.0)
    with pytest.raises(InvalidInputError, match=r"xarray\.DataArray"):
        solve_contact(half_space, gap.values, load=1.0)  # type: ignore[arg-type]
    with pytest.raises(InvalidInputError, match=r"gap.dims"):
        solve_contact(half_space, gap.rename(x="u"), load=1.0)
    with pytest.raises(InvalidInputError, match="uniformly spaced"):
        solve_contact(half_space, gap.assign_coords(x=gap.x**3), load=1.0)
    with pytest.raises(InvalidInputError, match="increasing"):
        solve_contact(half_space, gap.assign_coords(x=-gap.x), load=1.0)
    with pytest.raises(InvalidInputError, match="at least two"):
        solve_contact(half_space, gap[:1], load=1.0)
    with pytest.raises(InvalidInputError, match="non-empty"):
        solve_contact(half_space, gap[:0], load=1.0)
    with pytest.raises(InvalidInputError, match="infinite everywhere"):
        solve_contact(half_space, gap * np.inf, load=1.0)
    with pytest.raises(InvalidInputError, match="begin at the free end"):
        solve_contact(short_body, gap, load=1.0)
    with pytest.raises(InvalidInputError, match="end at the free end"):
        solve_contact(short_body, gap.assign_coords(x=gap.x + 1.5), load=1.0)


@pytest.mark.parametrize("load", [1.0, 1e45])
def test_full_window_raises_error_without_warning(short_body, cylinder_gap, load: float) -> None:
    """All cells of the coarse initial guess are in contact and have equal displacements."""
    with pytest.raises(WindowError, match="y_min"):
        solve_contact(short_body, cylinder_gap(8.0, (16, 16)) * (0.0 if load == 1 else 1.0), load=load)


@pytest.mark.parametrize(
    ("window", "cells", "message"),
    [(1e6, (16, 16), "y = 'a window of 2e\\+06 m'"), (1e4, (10**5, 4), "cells of .*sides in a ratio")],
)
def test_disproportionate_windows_raise_error(short_body, window, cells, message: str) -> None:
    y = window * (2 * (np.arange(cells[1]) + 0.5) / cells[1] - 1)
    x = 8.0 * (np.arange(cells[0]) + 0.5) / cells[0]
    gap = xr.DataArray(np.broadcast_to(y**2, cells), coords={"x": x, "y": y}, dims=("x", "y"))
    with pytest.raises(InvalidInputError, match=message):
        solve_contact(short_body, gap, load=1.0)


def test_too_many_cells_raise_error_before_allocation() -> None:
    with pytest.raises(InvalidInputError, match=r"at most 1e\+08 cells"):
        Grid(x_range=(0.0, 1.0), y_range=(-1.0, 1.0), cells_x=10**6, cells_y=10**6)
    with pytest.raises(InvalidInputError, match="not closer than rounding"):
        Grid(x_range=(1.0, 1.0 + 1e-15), y_range=(-1.0, 1.0), cells_x=4, cells_y=4)
    with pytest.raises(InvalidInputError, match="not closer than rounding"):
        Grid(x_range=(0.0, 1.0), y_range=(-5e-324, 5e-324), cells_x=4, cells_y=4)


@pytest.mark.parametrize("poisson", [0.0, 0.49])
def test_strongly_coupled_contact_meets_tolerance(poisson: float, cylinder_gap) -> None:
    body = FiniteLengthSpace(material=Material(1.0, poisson), length=8.0)
    coupled_contact = solve_contact(
        body, cylinder_gap(8.0, (32, 48)), load=8 * LINE_LOAD, friction=1.0, settings=ContactSettings(coupled=True)
    )
    assert bool(coupled_contact["converged"])
    assert float(coupled_contact["penetration_error"]) <= 1e-6
