"""The schema of every Dataset of the package: each variable's dimensions, unit and meaning, in one table."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from typing import NamedTuple

import xarray as xr


class Variable(NamedTuple):
    """Specification of one variable."""

    dims: tuple[str, ...]
    units: str
    long_name: str


XY, XYZ, SCALAR = ("x", "y"), ("x", "y", "z"), ()

COORDINATES = {
    "x": Variable(("x",), "m", "position along the roller's axis, from end I"),
    "y": Variable(("y",), "m", "position along rolling and sliding, from under the roller's centre"),
    "z": Variable(("z",), "m", "depth below the loaded surface"),
}

STRESSES = ("sigma_xx", "sigma_yy", "sigma_zz", "tau_xy", "tau_xz", "tau_yz")

VARIABLES = {
    "pressure": Variable(XY, "Pa", "contact pressure"),
    "shear_traction": Variable(XY, "Pa", "shear traction on the body along +y"),
    "gap": Variable(XY, "m", "gap after deformation"),
    "initial_gap": Variable(XY, "m", "gap before deformation"),
    "displacement_z": Variable(XY, "m", "normal displacement of the top, into the body"),
    "u_x": Variable(XYZ, "m", "displacement along the roller's axis"),
    "u_y": Variable(XYZ, "m", "displacement along rolling"),
    "u_z": Variable(XYZ, "m", "displacement along depth"),
    "sigma_xx": Variable(XYZ, "Pa", "normal stress along the roller's axis"),
    "sigma_yy": Variable(XYZ, "Pa", "normal stress along rolling"),
    "sigma_zz": Variable(XYZ, "Pa", "normal stress along depth"),
    "tau_xy": Variable(XYZ, "Pa", "shear stress xy"),
    "tau_xz": Variable(XYZ, "Pa", "shear stress xz"),
    "tau_yz": Variable(XYZ, "Pa", "shear stress yz"),
    "von_mises": Variable(XYZ, "Pa", "von Mises equivalent stress"),
    "y_left": Variable(("x",), "m", "first y of the contact"),
    "y_right": Variable(("x",), "m", "last y of the contact"),
    "half_width": Variable(("x",), "m", "half-width of the contact"),
    "x_first": Variable(SCALAR, "m", "first x of the contact"),
    "x_last": Variable(SCALAR, "m", "last x of the contact"),
    "contact_length": Variable(SCALAR, "m", "length of the contact along the roller's axis"),
    "contact_area": Variable(SCALAR, "m2", "area of the contact"),
    "peak_pressure": Variable(SCALAR, "Pa", "largest contact pressure"),
    "end_pressure_first": Variable(SCALAR, "Pa", "largest pressure at the end nearer to end I"),
    "end_pressure_last": Variable(SCALAR, "Pa", "largest pressure at the end nearer to end II"),
    "half_width_middle": Variable(SCALAR, "m", "half-width of the contact at mid-length"),
    "hertz_half_width": Variable(SCALAR, "m", "half-width of the Hertz line contact of the same load per length"),
    "hertz_max_pressure": Variable(SCALAR, "Pa", "peak pressure of the Hertz line contact of the same load per length"),
    "load": Variable(SCALAR, "N", "normal load"),
    "approach": Variable(SCALAR, "m", "approach of roller and body, relative to its reference"),
    "tilt": Variable(SCALAR, "rad", "tilt relative to its reference, positive if larger x is pressed deeper"),
    "load_position": Variable(SCALAR, "m", "position x of the pressure's resultant"),
    "iterations": Variable(SCALAR, "1", "applications of the contact operator"),
    "converged": Variable(SCALAR, "1", "whether the contact iteration reached its tolerance"),
    "load_error": Variable(SCALAR, "1", "resultant of the pressure minus the load, over the load"),
    "penetration_error": Variable(
        SCALAR, "1", "largest gap or overlap under pressure, over the variation of the displacement"
    ),
    "open_pressure_error": Variable(SCALAR, "1", "largest pressure where the gap is open, over the peak pressure"),
    "end_traction_residual": Variable(SCALAR, "1", "largest traction left on the free ends, over the peak pressure"),
}


def package_version() -> str:
    """Version of the installed package."""
    try:
        return version("contactstudy")
    except PackageNotFoundError:
        return "unknown"


def describe(dataset: xr.Dataset, title: str) -> xr.Dataset:
    """Return `dataset` with units, names and CF attributes from the table; attributes already there stay.

    Examples
    --------
    >>> describe(xr.Dataset({"load": 1.0}), "a load")["load"].attrs["units"]
    'N'
    """
    described = dataset.copy()
    for name, variable in described.variables.items():
        specification = VARIABLES.get(str(name)) or COORDINATES.get(str(name))
        if specification is not None:
            variable.attrs = {
                "units": specification.units,
                "long_name": specification.long_name,
                **variable.attrs,
            }
    for name in described.coords:
        # By CF a coordinate has no missing values, and so no mark for them.
        described[name].encoding["_FillValue"] = None
    described.attrs = {
        "Conventions": "CF-1.11",
        "title": title,
        "source": f"contactstudy {package_version()}",
        **described.attrs,
    }
    return described
