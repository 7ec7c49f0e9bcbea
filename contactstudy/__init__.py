"""Rolling-sliding contact of a roller on an elastic body with free end faces.

Names are imported when they are first used, so that ``import contactstudy`` stays fast.
"""

from __future__ import annotations

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from contactstudy import analysis, export, fatigue, plots, profiles, roughness, slices
    from contactstudy.bodies import Body, FiniteLengthSpace, HalfSpace, QuarterSpace
    from contactstudy.case import Case, choose_grid
    from contactstudy.contact import solve_contact
    from contactstudy.displacement import displacement_field
    from contactstudy.equivalent import equivalent_loads
    from contactstudy.errors import (
        ContactStudyError,
        ConvergenceWarning,
        InvalidInputError,
        WindowError,
    )
    from contactstudy.grid import Grid
    from contactstudy.invariants import (
        hydrostatic,
        maximum_shear,
        orthogonal_shear_range,
        principal_stresses,
        tresca,
        von_mises,
    )
    from contactstudy.material import Material
    from contactstudy.roller import Roller
    from contactstudy.solution import roller_stress, solve
    from contactstudy.stress import stress_field
    from contactstudy.study.definition import Study
    from contactstudy.study.errors import LockedError, StoreError, StudyFileError
    from contactstudy.study.opened import open_study
    from contactstudy.study.run import run_study
    from contactstudy.summary import summarize
    from contactstudy.surface import surface_displacement

_HOME = {
    "Body": "bodies",
    "Case": "case",
    "ContactStudyError": "errors",
    "ConvergenceWarning": "errors",
    "FiniteLengthSpace": "bodies",
    "Grid": "grid",
    "HalfSpace": "bodies",
    "InvalidInputError": "errors",
    "LockedError": "study.errors",
    "Material": "material",
    "QuarterSpace": "bodies",
    "Roller": "roller",
    "StoreError": "study.errors",
    "Study": "study.definition",
    "StudyFileError": "study.errors",
    "WindowError": "errors",
    "analysis": "",
    "choose_grid": "case",
    "displacement_field": "displacement",
    "equivalent_loads": "equivalent",
    "export": "",
    "fatigue": "",
    "hydrostatic": "invariants",
    "maximum_shear": "invariants",
    "open_study": "study.opened",
    "orthogonal_shear_range": "invariants",
    "plots": "",
    "principal_stresses": "invariants",
    "profiles": "",
    "roller_stress": "solution",
    "roughness": "",
    "run_study": "study.run",
    "slices": "",
    "solve": "solution",
    "solve_contact": "contact",
    "stress_field": "stress",
    "summarize": "summary",
    "surface_displacement": "surface",
    "tresca": "invariants",
    "von_mises": "invariants",
}

__all__ = [
    "Body",
    "Case",
    "ContactStudyError",
    "ConvergenceWarning",
    "FiniteLengthSpace",
    "Grid",
    "HalfSpace",
    "InvalidInputError",
    "LockedError",
    "Material",
    "QuarterSpace",
    "Roller",
    "StoreError",
    "Study",
    "StudyFileError",
    "WindowError",
    "analysis",
    "choose_grid",
    "displacement_field",
    "equivalent_loads",
    "export",
    "fatigue",
    "hydrostatic",
    "maximum_shear",
    "open_study",
    "orthogonal_shear_range",
    "plots",
    "principal_stresses",
    "profiles",
    "roller_stress",
    "roughness",
    "run_study",
    "slices",
    "solve",
    "solve_contact",
    "stress_field",
    "summarize",
    "surface_displacement",
    "tresca",
    "von_mises",
]


def __getattr__(name: str) -> Any:
    """Import a public name from its module on first use."""
    if name not in _HOME:
        raise AttributeError(f"module 'contactstudy' has no attribute {name!r}")
    home = _HOME[name]
    if not home:
        return import_module(f"contactstudy.{name}")
    value = getattr(import_module(f"contactstudy.{home}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Public names, for completion."""
    return list(__all__)


if "xarray" in sys.modules:
    # Who has xarray already gets Dataset.contact at once; else it comes with the first Dataset of ours.
    import_module("contactstudy.accessor")
