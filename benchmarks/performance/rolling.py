"""Rows on stick and slip in steady rolling, on a half-space and between free ends."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
import xarray as xr

from benchmarks.performance.timing import Report, Row, compute_medians, format_time, nudge
from contactstudy import FiniteLengthSpace, HalfSpace, Rolling, solve_contact
from contactstudy.bodies import Body, Counterbody
from contactstudy.contact import ContactSettings
from contactstudy.verification.tribology import ellipse_gap, material

STEEL, FRICTION, LOAD = material(82e9, 0.28), 0.33, 106.7e3
HALF_WIDTH_X, HALF_WIDTH_Y = 12.61e-3, 6.304e-3  # of the ellipse, metres
PUBLISHED_SECONDS = {3148: (0.3, 0.3), 50796: (22.6, 6.0)}
"""Cells in contact of CONTACT's published times: seconds of CONTACT (one thread, 2016), and the bar of this package."""


def widen_gap(gap: xr.DataArray, rows: int) -> xr.DataArray:
    """Continue a paraboloid's gap along y: between free ends the contact is wider."""
    y, step = gap["y"].values, float(gap["y"][1] - gap["y"][0])
    added_y = step * np.arange(1, rows + 1)
    edges_y = np.concatenate([y[0] - added_y[::-1], y, y[-1] + added_y])
    curvature = np.polyfit(y**2, gap.values[0] - gap.values[0, 0], 1)[0]
    gap_at_centre = gap.values[:, :1] - curvature * y[0] ** 2
    return xr.DataArray(gap_at_centre + curvature * edges_y**2, coords={"x": gap["x"], "y": edges_y}, dims=("x", "y"))


def steady_rolling(repeats: int, report: Report) -> Iterator[Row]:
    """Stick and slip of an ellipse: time beyond the time of the normal contact."""
    for cells, (published_seconds, bar) in PUBLISHED_SECONDS.items():
        cells_across = round(np.sqrt(4 * cells / np.pi))
        gap = widen_gap(
            ellipse_gap(HALF_WIDTH_X, HALF_WIDTH_Y, LOAD, STEEL, (cells_across + 2, cells_across + 6)),
            cells_across // 8,
        )
        step = float(gap["x"][1] - gap["x"][0])
        length = step * (cells_across + 2)
        shifted_gap = gap.assign_coords(x=gap["x"] + 0.5 * length)
        bodies: dict[str, tuple[Body, xr.DataArray]] = {
            "half-space": (HalfSpace(material=STEEL), gap),
            "free ends": (FiniteLengthSpace(length=length, material=STEEL), shifted_gap),
        }
        timed_functions: dict[str, Callable[[], object]] = {}
        for name, (body, body_gap) in bodies.items():
            solve_normal = partial(
                solve_contact,
                body,
                body_gap,
                counterbody=Counterbody(body),
                settings=ContactSettings(tolerance=1e-5),
            )
            timed_functions[name] = lambda solve_normal=solve_normal: solve_normal(load=LOAD * nudge())
            rolling_motion = Rolling(longitudinal_creepage=8e-4)
            timed_functions[f"{name}, rolling"] = lambda solve_normal=solve_normal, rolling_motion=rolling_motion: (
                solve_normal(load=LOAD * nudge(), friction=FRICTION, motion=rolling_motion)
            )
        seconds = compute_medians(timed_functions, min(repeats, 3) if cells > 10_000 else repeats)
        rolling_seconds = {name: seconds[f"{name}, rolling"] - seconds[name] for name in bodies}
        solution = timed_functions["half-space, rolling"]()
        assert isinstance(solution, xr.Dataset)
        if not bool(solution["converged"]):
            report.add_remark(f"not converged: rolling on {cells} cells")
        ratio = rolling_seconds["free ends"] / rolling_seconds["half-space"]
        yield Row(
            work=f"steady rolling, {int((solution['pressure'] > 0).sum())} cells in contact, half-space",
            ours=format_time(rolling_seconds["half-space"]),
            peers=f"CONTACT {published_seconds} s, published in 2016",
            bar=f"{bar} s",
            met=rolling_seconds["half-space"] <= bar,
            notes="without the time of the normal contact",
        )
        yield Row(
            work="... between free ends",
            ours=format_time(rolling_seconds["free ends"]),
            peers=f"our half-space {format_time(rolling_seconds['half-space'])}",
            ratio=f"{ratio:.2f}",
            bar="2x the half-space",
            met=ratio <= 2,
        )
