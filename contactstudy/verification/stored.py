"""Stored references by independent finite elements: stresses and contacts of bodies with free ends, plastic passes.

The files lie in ``data`` of the project and are part of the package once it is built. They were made with scikit-fem
by ``python -m tests.finite_elements.generate``, which shares no formula with the solver: Fourier in y, elements of high
order in x and z. Lengths are in units of ``a``, stresses in units of ``p0``.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import xarray as xr

from contactstudy import checks
from contactstudy.verification.load_cases import (
    CONTACT_CASES,
    LOAD_CASES,
    PASSES_CASES,
    ContactCase,
    LoadCase,
    PassesCase,
)

STRESS_FILE, CONTACT_FILE = "finite_elements_stress.nc", "finite_elements_contact.nc"
PASSES_FILE = "finite_elements_passes.nc"
"""Files of the stored finite elements."""


def data_file(name: str) -> Path:
    """Path of a data file: inside the installed package, or in the project's folder when that is what is installed.

    Examples
    --------
    >>> data_file(STRESS_FILE).exists()
    True
    """
    inside = Path(str(files("contactstudy.verification"))) / "data" / name
    return inside if inside.exists() else Path(__file__).resolve().parents[2] / "data" / name


@dataclass(frozen=True)
class StressReference:
    """A load case and its stored stresses.

    Attributes
    ----------
    case : LoadCase
        Body and load.
    stress : Dataset (x, y, z)
        Six components. It may also hold `displacement_z_young` (x, y): displacement of the top into the body times
        Young's modulus, less that of the point named in its attributes, over ``p0 a``.
    error, median_error : float
        Estimates of the largest and of the median error of any component, from solutions each made worse in one way.
    """

    case: LoadCase
    stress: xr.Dataset
    error: float
    median_error: float


def load_stress(name: str, path: Path | None = None) -> StressReference:
    """Load a stored load case.

    Parameters
    ----------
    name : str
        Its name in `LOAD_CASES`.
    path : Path, optional
        File to read instead of the package's own.

    Raises
    ------
    InvalidInputError
        If the name is unknown.

    Examples
    --------
    >>> load_stress("thin").stress.sigma_zz.dims
    ('x', 'y', 'z')
    """
    checks.known_name("name", name, LOAD_CASES)
    stress = xr.load_dataset(path or data_file(STRESS_FILE), group=name)
    attributes = stress.attrs
    return StressReference(
        LOAD_CASES[name],
        stress,
        float(attributes["error_estimate"]),
        float(attributes["error_estimate_median"]),
    )


@dataclass(frozen=True)
class ContactReference:
    """A contact and its stored solution.

    Attributes
    ----------
    case : ContactCase
        Body and roller.
    contact : Dataset
        `pressure` (x, y) at nodes of which those with ``y >= 0`` are kept, linear between them; `line_load` (x), its
        integral over y; and with ``_error`` the estimates of their errors.
    """

    case: ContactCase
    contact: xr.Dataset


def load_contact(name: str, path: Path | None = None) -> ContactReference:
    """Load a stored contact.

    Parameters
    ----------
    name : str
        Its name in `CONTACT_CASES`.
    path : Path, optional
        File to read instead of the package's own.

    Raises
    ------
    InvalidInputError
        If the name is unknown.

    Examples
    --------
    >>> load_contact("flush").contact.pressure.dims
    ('x', 'y')
    """
    checks.known_name("name", name, CONTACT_CASES)
    return ContactReference(CONTACT_CASES[name], xr.load_dataset(path or data_file(CONTACT_FILE), group=name))


@dataclass(frozen=True)
class PassesReference:
    """Passes over an elastic-plastic half-plane and what they leave.

    Attributes
    ----------
    case : PassesCase
        Contact and material.
    left : Dataset
        Residual stresses `sigma_xx` and `sigma_yy` (z) after the last pass, over the peak pressure; plastic strains
        after each pass, ``plastic_strain_xx_young`` ... (pass_number, z), times Young's modulus over it. Each with
        its `error_estimate`.
    """

    case: PassesCase
    left: xr.Dataset


def load_passes(name: str, path: Path | None = None) -> PassesReference:
    """Load stored passes.

    Parameters
    ----------
    name : str
        Their name in `PASSES_CASES`.
    path : Path, optional
        File to read instead of the package's own.

    Raises
    ------
    InvalidInputError
        If the name is unknown.

    Examples
    --------
    >>> load_passes("settling").left.sigma_yy.dims
    ('z',)
    """
    checks.known_name("name", name, PASSES_CASES)
    return PassesReference(PASSES_CASES[name], xr.load_dataset(path or data_file(PASSES_FILE), group=name))
