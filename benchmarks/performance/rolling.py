"""Rows on stick and slip in steady rolling, on a half-space and between free ends."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
import xarray as xr

from benchmarks.performance.timing import Report, Row, medians, nudge, show
from contactstudy import FiniteLengthSpace, HalfSpace, Rolling, solve_contact
from contactstudy.bodies import Body, Counterbody
from contactstudy.contact import ContactSettings
from contactstudy.verification.tribology import ellipse_gap, material

STEEL, FRICTION, LOAD = material(82e9, 0.28), 0.33, 106.7e3
ACROSS, ALONG_Y = 12.61e-3, 6.304e-3  # half-widths, metres
PUBLISHED = {3148: (0.3, 0.3), 50796: (22.6, 6.0)}
"""Cells in contact of CONTACT's published times: its seconds (one thread, 2016), and our bar."""


def widen_gap(gap: xr.DataArray, rows: int) -> xr.DataArray:
    """Continue a paraboloid's gap along y: between free ends the contact is wider."""
    y, step = gap["y"].values, float(gap["y"][1] - gap["y"][0])
    more = step * np.arange(1, rows + 1)
    edges_y = np.concatenate([y[0] - more[::-1], y, y[-1] + more])
    curvature = np.polyfit(y**2, gap.values[0] - gap.values[0, 0], 1)[0]
    at_rest = gap.values[:, :1] - curvature * y[0] ** 2
    return xr.DataArray(at_rest + curvature * edges_y**2, coords={"x": gap["x"], "y": edges_y}, dims=("x", "y"))


def steady_rolling(repeats: int, report: Report) -> Iterator[Row]:
    """Stick and slip of an ellipse: time beyond the time of the normal contact."""
    for cells, (published, bar) in PUBLISHED.items():
        side = round(np.sqrt(4 * cells / np.pi))
        gap = widen_gap(ellipse_gap(ACROSS, ALONG_Y, LOAD, STEEL, (side + 2, side + 6)), side // 8)
        step = float(gap["x"][1] - gap["x"][0])
        length = step * (side + 2)
        shifted_gap = gap.assign_coords(x=gap["x"] + 0.5 * length)
        bodies: dict[str, tuple[Body, xr.DataArray]] = {
            "half-space": (HalfSpace(material=STEEL), gap),
            "free ends": (FiniteLengthSpace(length=length, material=STEEL), shifted_gap),
        }
        works: dict[str, Callable[[], object]] = {}
        for name, (body, operator_body) in bodies.items():
            solve_normal = partial(
                solve_contact,
                body,
                operator_body,
                counterbody=Counterbody(body),
                settings=ContactSettings(tolerance=1e-5),
            )
            works[name] = lambda solve_normal=solve_normal: solve_normal(load=LOAD * nudge())
            rolls = Rolling(longitudinal_creepage=8e-4)
            works[f"{name}, rolling"] = lambda solve_normal=solve_normal, rolls=rolls: solve_normal(
                load=LOAD * nudge(), friction=FRICTION, motion=rolls
            )
        seconds = medians(works, min(repeats, 3) if cells > 10_000 else repeats)
        durations = {name: seconds[f"{name}, rolling"] - seconds[name] for name in bodies}
        solution = works["half-space, rolling"]()
        assert isinstance(solution, xr.Dataset)
        if not bool(solution["converged"]):
            report.add_remark(f"not converged: rolling on {cells} cells")
        ratio = durations["free ends"] / durations["half-space"]
        yield Row(
            work=f"steady rolling, {int((solution['pressure'] > 0).sum())} cells in contact, half-space",
            ours=show(durations["half-space"]),
            peers=f"CONTACT {published} s, published in 2016",
            bar=f"{bar} s",
            met=durations["half-space"] <= bar,
            notes="without the pressure's own time",
        )
        yield Row(
            work="... between free ends",
            ours=show(durations["free ends"]),
            peers=f"our half-space {show(durations['half-space'])}",
            ratio=f"{ratio:.2f}",
            bar="2x the half-space",
            met=ratio <= 2,
        )
