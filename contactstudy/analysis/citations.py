"""Sources of the methods that made a result, to cite beside it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import xarray as xr

from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, STUDY_ATTRIBUTE, attribute
from contactstudy.arrays.required import require
from contactstudy.arrays.variables import STRESSES

HERTZ = ("line contact", "K. L. Johnson, Contact Mechanics, Cambridge University Press (1985)")
ENDS = (
    ("free ends", "M. Hetenyi, J. Appl. Mech. 37 (1970), the alternating scheme of the quarter space"),
    ("free ends", "Z. M. Zhang, W. Wang, P. L. Wong, Int. J. Solids Struct. 50 (2013) 976, solved at once"),
)
CONTACT = (
    ("contact iteration", "I. A. Polonsky, L. M. Keer, Wear 231 (1999) 206"),
    (
        "preconditioner",
        "J. Zhao, E. A. H. Vollebregt, C. W. Oosterlee, Math. Comput. Sci. 9 (2015) 375",
    ),
    ("convolution", "S. Liu, Q. Wang, G. Liu, Wear 243 (2000) 101"),
)
ROLLING = ("stick and slip", "J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact, Kluwer (1990)")
GUILBAULT = ("mirror factor", "R. Guilbault, J. Tribology 133 (2011) 031402")
PROFILES = {
    "Lundberg": "G. Lundberg, Forschung auf dem Gebiet des Ingenieurwesens 10 (1939)",
    "JohnsGohar": "P. M. Johns, R. Gohar, Tribology International 14 (1981) 131",
    "FujiwaraKawase": "H. Fujiwara, T. Kawase, NTN Technical Review 75 (2007) 140",
    "IsoCylindrical": "ISO/TS 16281:2008",
    "IsoTapered": "ISO/TS 16281:2008",
    "Measured": "F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300, its interpolation",
}
"""Sources of profiles by their class."""

FILTER = ("filter of the measured profile", "ISO 16610-21, ends by the moment criterion of ISO 16610-28")


@dataclass(frozen=True)
class Citations:
    """What was used, and its source; prints as a list.

    Examples
    --------
    >>> Citations((("profile", "ISO/TS 16281:2008"),))
    profile: ISO/TS 16281:2008
    """

    entries: tuple[tuple[str, str], ...]

    def __repr__(self) -> str:
        return "\n".join(f"{used}: {source}" for used, source in self.entries)

    def _repr_html_(self) -> str:
        return "<ul>" + "".join(f"<li>{used}: {source}</li>" for used, source in self.entries) + "</ul>"


def citations(dataset: xr.Dataset) -> Citations:
    """Return the sources of the methods that were used for this result.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`, a file of it, or a study.

    Returns
    -------
    Citations
        This package first. Of a study, or of a case selected from it, what its cases used. Of a Dataset that does not
        say what was solved, only what its variables show.

    Examples
    --------
    >>> citations(xr.Dataset({"pressure": 1.0})).entries[1]
    ('line contact', 'K. L. Johnson, Contact Mechanics, Cambridge University Press (1985)')
    """
    require(dataset)
    study = attribute(dataset, STUDY_ATTRIBUTE)
    models, profile = _of_study(study) if study else _of_case(attribute(dataset, INPUTS_ATTRIBUTE).get("case", {}))
    program = str(dataset.attrs.get("source", "contactstudy"))
    found: list[tuple[str, str]] = [("program", program), HERTZ]
    if not models.isdisjoint({"exact", "single-mirror"}):
        found += ENDS
    if "mirror-factor" in models:
        found.append(GUILBAULT)
    if "pressure" in dataset:
        found += CONTACT
    if "stick" in dataset:
        found.append(ROLLING)
    if any(name in dataset for name in STRESSES):
        found.append(("stresses", "A. E. H. Love, Phil. Trans. R. Soc. Lond. A 228 (1929) 377, and K. L. Johnson"))
    kinds = {_plain(kind) for kind in _kinds(profile)}
    found += [(f"profile {kind}", source) for kind, source in sorted(PROFILES.items()) if _plain(kind) in kinds]
    if _filtered(profile):
        found.append(FILTER)
    return Citations(tuple(dict.fromkeys(found)))


def _of_case(case: dict[str, Any]) -> tuple[set[str], Any]:
    """How free ends are treated, and the profile, in the inputs of a case."""
    body, roller = case.get("body", {}), case.get("roller", {})
    models = {str(body["model"])} if "model" in body and body.get("kind") != "HalfSpace" else set()
    if "material" in roller and roller.get("ends") == "free":
        models.add("exact")
    return models, roller.get("profile", {})


def _of_study(study: dict[str, Any]) -> tuple[set[str], Any]:
    """How free ends are treated, and the profiles, in all cases of a study."""

    def taken(name: str, default: str) -> list[Any]:
        single = [table[name] for table in (study.get("base", {}), *study.get("cases", [])) if name in table]
        several = [table.get(name, []) for table in (study.get("sweep", {}), *study.get("zip", []))]
        return [*single, *(value for values in several for value in values)] or [default]

    with_ends = any(body != "half-space" for body in taken("body", "finite-length"))
    models = {str(model) for model in taken("model", "exact")} if with_ends else set()
    if "finite-length" in taken("roller_body", "rigid"):
        models.add("exact")
    return models, [{"kind": each} if isinstance(each, str) else each for each in taken("profile", "cylinder")]


def _plain(kind: str) -> str:
    """Name of a profile without what studies and classes write differently."""
    return kind.replace("-", "").lower()


def _filtered(entry: Any) -> bool:
    """Whether a profile, or one within it, is measured and filtered."""
    if isinstance(entry, dict):
        own = _plain(str(entry.get("kind", ""))) == "measured" and "cutoff" in entry
        return own or any(_filtered(value) for value in entry.values())
    return isinstance(entry, list) and any(_filtered(value) for value in entry)


def _kinds(entry: Any) -> set[str]:
    """Return the kinds of all profiles within a profile."""
    if isinstance(entry, dict):
        own = {str(entry["kind"])} if "kind" in entry else set()
        return own.union(*(_kinds(value) for value in entry.values()))
    return set().union(*(_kinds(value) for value in entry)) if isinstance(entry, list) else set()
