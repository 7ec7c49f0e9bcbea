"""The files in `data`: attributes of the file, and one group for each case."""

from __future__ import annotations

from pathlib import Path

import netCDF4
import numpy as np
import scipy
import skfem  # type: ignore[import-untyped]
import xarray as xr


def create_file(path: Path, kind: str, **attributes: str) -> None:
    """Write a new file without groups; `kind` is the argument of `generate`."""
    path.unlink(missing_ok=True)
    modules = {"numpy": np, "scipy": scipy, "scikit-fem": skfem, "netCDF4": netCDF4}
    attributes |= {
        "software": ", ".join(f"{name} {module.__version__}" for name, module in modules.items()),
        "regenerate": f"python -m benchmarks.finite_elements.generate {kind}",
    }
    xr.Dataset(attrs=attributes).to_netcdf(path)


def append_case(path: Path, name: str, solution: xr.Dataset) -> None:
    """Add a case: fields in single precision, coordinates in double precision."""
    dataset = solution.astype("float32").assign_coords(dict(solution.coords))
    encoding = {key: {"_FillValue": None, "zlib": True, "complevel": 4} for key in dataset.data_vars}
    dataset.to_netcdf(path, mode="a", group=name, encoding=encoding)
