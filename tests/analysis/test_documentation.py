"""The code of docs/how-to/read_a_result.md runs."""

from __future__ import annotations

import re
from pathlib import Path

import matplotlib
import pytest
import xarray as xr

TEXT = (Path(__file__).resolve().parents[2] / "docs" / "how-to" / "read_a_result.md").read_text()


def test_every_python_block_runs(solved: xr.Dataset, tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"result": solved}
    for block in re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL):
        exec(compile(block, "docs/how-to/read_a_result.md", "exec"), names)
    assert float(names["life"]) == 1.0  # type: ignore[arg-type]
    assert {path.name for path in tmp_path.iterdir()} == {
        "plane.png",
        "plane.pdf",
        "case.vtr",
        "depth.csv",
        "slices.csv",
    }
    from matplotlib import pyplot

    pyplot.close("all")
