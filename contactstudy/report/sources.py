"""Sources of the methods that a result used, to be cited with the result."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import xarray as xr

from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, STUDY_ATTRIBUTE, attribute
from contactstudy.arrays.variables import STRESSES, require
from contactstudy.case.serialization import tables_within

Source = tuple[str, str]

LINE_CONTACT = ("line contact", "K. L. Johnson, Contact Mechanics, Cambridge University Press (1985)")
FREE_ENDS = (
    ("free ends", "M. Hetenyi, J. Appl. Mech. 37 (1970), the alternating scheme of the quarter space"),
    ("free ends", "Z. M. Zhang, W. Wang, P. L. Wong, Int. J. Solids Struct. 50 (2013) 976, both faces at once"),
)
MIRROR_FACTOR = ("mirror factor", "R. Guilbault, J. Tribology 133 (2011) 031402")
CONTACT = (
    ("contact iteration", "I. A. Polonsky, L. M. Keer, Wear 231 (1999) 206"),
    ("preconditioner", "J. Zhao, E. A. H. Vollebregt, C. W. Oosterlee, Math. Comput. Sci. 9 (2015) 375"),
    ("convolution", "S. Liu, Q. Wang, G. Liu, Wear 243 (2000) 101"),
)
ROLLING = ("stick and slip", "J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact, Kluwer (1990)")
SUBSURFACE = ("stresses", "A. E. H. Love, Phil. Trans. R. Soc. Lond. A 228 (1929) 377, and K. L. Johnson")
FILTER = ("filter of the measured profile", "ISO 16610-21, ends by the moment criterion of ISO 16610-28")
PROFILES = {  # Sources of profiles by their class
    "Lundberg": "G. Lundberg, Forschung auf dem Gebiet des Ingenieurwesens 10 (1939)",
    "JohnsGohar": "P. M. Johns, R. Gohar, Tribology International 14 (1981) 131",
    "FujiwaraKawase": "H. Fujiwara, T. Kawase, NTN Technical Review 75 (2007) 140",
    "IsoCylindrical": "ISO/TS 16281:2008",
    "IsoTapered": "ISO/TS 16281:2008",
    "Measured": "H. T. Huynh, SIAM J. Numer. Anal. 30 (1993) 57, its interpolation",
}


@dataclass(frozen=True)
class Citations:
    """Methods and their sources; prints as a list."""

    entries: tuple[Source, ...]

    def __repr__(self) -> str:
        return "\n".join(f"{method}: {source}" for method, source in self.entries)

    def _repr_html_(self) -> str:
        return "<ul>" + "".join(f"<li>{method}: {source}</li>" for method, source in self.entries) + "</ul>"


def citations(dataset: xr.Dataset) -> Citations:
    """Return the sources of the methods that a result used.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`, its file, or a study.

    Returns
    -------
    Citations
        This package first. For a study or one of its cases the sources of all cases; without inputs, of the variables.

    Examples
    --------
    >>> citations(xr.Dataset({"pressure": 1.0})).entries[1]
    ('line contact', 'K. L. Johnson, Contact Mechanics, Cambridge University Press (1985)')
    """
    require(dataset)
    study = attribute(dataset, STUDY_ATTRIBUTE)
    case = attribute(dataset, INPUTS_ATTRIBUTE).get("case", {})
    models, profile = _models_of_study(study) if study else _models_of_case(case)
    sources: list[Source] = [("program", str(dataset.attrs.get("source", "contactstudy"))), LINE_CONTACT]
    if models & {"exact", "single-mirror"}:
        sources += FREE_ENDS
    if "mirror-factor" in models:
        sources.append(MIRROR_FACTOR)
    if "pressure" in dataset:
        sources += CONTACT
    if "stick" in dataset:
        sources.append(ROLLING)
    if any(name in dataset for name in STRESSES):
        sources.append(SUBSURFACE)
    profile_tables = list(tables_within(profile))
    kinds = {_normalize(table["kind"]) for table in profile_tables}
    sources += [(f"profile {kind}", source) for kind, source in sorted(PROFILES.items()) if _normalize(kind) in kinds]
    if any(_normalize(table["kind"]) == "measured" and "cutoff" in table for table in profile_tables):
        sources.append(FILTER)
    return Citations(tuple(dict.fromkeys(sources)))


def _models_of_case(case: dict[str, Any]) -> tuple[set[str], Any]:
    """Models of the free ends, and the profile, of a case."""
    body, roller = case.get("body", {}), case.get("roller", {})
    models = {str(body["model"])} if "model" in body and body.get("kind") != "HalfSpace" else set()
    if "material" in roller and roller.get("ends") == "free":
        models.add("exact")
    return models, roller.get("profile", {})


def _models_of_study(study: dict[str, Any]) -> tuple[set[str], Any]:
    """Models of the free ends, and the profiles, of all cases of a study."""

    def collect_values(name: str, default: str) -> list[Any]:
        scalars = [table[name] for table in (study.get("base", {}), *study.get("cases", [])) if name in table]
        lists = [table.get(name, []) for table in (study.get("sweep", {}), *study.get("zip", []))]
        return [*scalars, *(value for entries in lists for value in entries)] or [default]

    has_ends = any(body != "half-space" for body in collect_values("body", "finite-length"))
    models = {str(model) for model in collect_values("model", "exact")} if has_ends else set()
    if "finite-length" in collect_values("roller_body", "rigid"):
        models.add("exact")
    profiles = collect_values("profile", "cylinder")
    return models, [{"kind": profile} if isinstance(profile, str) else profile for profile in profiles]


def _normalize(kind: str) -> str:
    """Kind of a profile in the spelling that classes and study files share."""
    return str(kind).replace("-", "").lower()
