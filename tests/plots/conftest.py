"""Fixtures for figures; figures are closed after each test."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import matplotlib.axes
import matplotlib.figure
import matplotlib.lines
import numpy as np
import pytest
import xarray as xr


@pytest.fixture
def study_case(study_dataset: xr.Dataset) -> xr.Dataset:
    """One case of a study: padded positions, stresses in one plane."""
    return study_dataset.sel(e_over_a=1, friction=0.1, body="finite-length")


@pytest.fixture(autouse=True)
def _close_figures() -> Iterator[None]:
    from matplotlib import pyplot

    yield
    pyplot.close("all")


@pytest.fixture
def assert_nothing_clipped() -> Callable[[matplotlib.figure.Figure], None]:
    """Check that all artists lie within the figure."""

    def check_artists(figure: matplotlib.figure.Figure) -> None:
        figure.canvas.draw()
        frame = figure.bbox
        for ax in figure.get_axes():
            if not ax.get_visible():
                continue
            box = ax.get_tightbbox()
            assert box.x0 >= frame.x0 - 1
            assert box.y0 >= frame.y0 - 1
            assert box.x1 <= frame.x1 + 1
            assert box.y1 <= frame.y1 + 1

    return check_artists


@pytest.fixture
def lines_of() -> Callable[[matplotlib.axes.Axes], list[matplotlib.lines.Line2D]]:
    """Lines of axes without the ends of error bars, which matplotlib stores in the same list."""
    return lambda ax: [line for line in ax.lines if line.get_marker() != "_"]


@pytest.fixture
def draw_pixels() -> Callable[[matplotlib.figure.Figure], np.ndarray]:
    """Draw a figure and return its pixels (row, column, rgb)."""

    def draw_figure(figure: matplotlib.figure.Figure) -> np.ndarray:
        figure.canvas.draw()
        return np.asarray(figure.canvas.buffer_rgba())[..., :3]

    return draw_figure
