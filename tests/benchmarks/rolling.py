"""Rows on stick and slip in steady rolling, on a half-space and between free ends."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
import xarray as xr

from contactstudy import Body, FiniteLengthSpace, HalfSpace, Rolling, solve_contact
from contactstudy.bodies import Counterbody
from contactstudy.verification.friction import ellipse_gap, material
from tests.benchmarks.timing import Report, Row, medians, nudge, show

STEEL, FRICTION, LOAD = material(82e9, 0.28), 0.33, 106.7e3
ACROSS, ALONG = 12.61e-3, 6.304e-3  # half-widths, metres
PUBLISHED = {3148: (0.3, 0.3), 50796: (22.6, 6.0)}
"""Cells in contact of CONTACT's published times: its seconds (one thread, 2016), and our bar."""


def wider(gap: xr.DataArray, rows: int) -> xr.DataArray:
    """Continue a paraboloid's gap along y: between free ends the contact is wider."""
    y, step = gap["y"].values, float(gap["y"][1] - gap["y"][0])
    more = step * np.arange(1, rows + 1)
    along = np.concatenate([y[0] - more[::-1], y, y[-1] + more])
    curved = np.polyfit(y**2, gap.values[0] - gap.values[0, 0], 1)[0]
    at_rest = gap.values[:, :1] - curved * y[0] ** 2
    return xr.DataArray(at_rest + curved * along**2, coords={"x": gap["x"], "y": along}, dims=("x", "y"))


def steady_rolling(repeats: int, report: Report) -> Iterator[Row]:
    """Stick and slip of an ellipse: time of a contact with them, less that of the pressure."""
    for cells, (published, bar) in PUBLISHED.items():
        side = round(np.sqrt(4 * cells / np.pi))
        gap = wider(ellipse_gap(ACROSS, ALONG, LOAD, STEEL, (side + 2, side + 6)), side // 8)
        step = float(gap["x"][1] - gap["x"][0])
        length = step * (side + 2)
        ended = gap.assign_coords(x=gap["x"] + 0.5 * length)
        bodies: dict[str, tuple[Body, xr.DataArray]] = {
            "half-space": (HalfSpace(material=STEEL), gap),
            "free ends": (FiniteLengthSpace(length=length, material=STEEL), ended),
        }
        works: dict[str, Callable[[], object]] = {}
        for name, (body, own) in bodies.items():
            pressed = partial(solve_contact, body, own, counterbody=Counterbody(body), tolerance=1e-5)
            works[name] = lambda pressed=pressed: pressed(LOAD * nudge())
            rolls = Rolling(longitudinal_creepage=8e-4)
            works[f"{name}, rolling"] = lambda pressed=pressed, rolls=rolls: pressed(
                LOAD * nudge(), FRICTION, motion=rolls
            )
        seconds = medians(works, min(repeats, 3) if cells > 10_000 else repeats)
        taken = {name: seconds[f"{name}, rolling"] - seconds[name] for name in bodies}
        found = works["half-space, rolling"]()
        assert isinstance(found, xr.Dataset)
        if not bool(found["converged"]):
            report.remark(f"not converged: rolling on {cells} cells")
        ratio = taken["free ends"] / taken["half-space"]
        yield Row(
            f"steady rolling, {int((found['pressure'] > 0).sum())} cells in contact, half-space",
            show(taken["half-space"]),
            f"CONTACT {published} s, published in 2016",
            bar=f"{bar} s",
            met=taken["half-space"] <= bar,
            notes="without the pressure's own time",
        )
        yield Row(
            "... between free ends",
            show(taken["free ends"]),
            f"our half-space {show(taken['half-space'])}",
            f"{ratio:.2f}",
            "2x the half-space",
            ratio <= 2,
        )
