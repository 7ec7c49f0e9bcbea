"""What a result says to an engineer: functions that take and return Datasets.

They work on results of :func:`contactstudy.solve`, on surfaces without stresses, on files reopened with xarray, and,
where that has a meaning, on a whole study opened by :func:`contactstudy.open_study`.
"""

from contactstudy.analysis.axes import dimension_along, positions, single_case
from contactstudy.analysis.axial import (
    axial_pressure,
    axial_profiles,
    half_width,
    line_load,
    load_between,
    unloaded_gap,
)
from contactstudy.analysis.certainty import certainty
from contactstudy.analysis.citations import citations
from contactstudy.analysis.contact import contact_results, edge_pressure
from contactstudy.analysis.cuts import along_line, in_plane
from contactstudy.analysis.discretisation import discretisation_error
from contactstudy.analysis.edges import contact_edges
from contactstudy.analysis.factors import edge_factors
from contactstudy.analysis.largest import largest
from contactstudy.analysis.measures import MEASURES, measure
from contactstudy.analysis.peaks import peak, section_peak
from contactstudy.analysis.provenance import solved_case
from contactstudy.analysis.scaling import normalized, positions_over_a
from contactstudy.analysis.short import short
from contactstudy.analysis.slices import slices
from contactstudy.near_names import suggest

__all__ = [
    "MEASURES",
    "along_line",
    "axial_pressure",
    "axial_profiles",
    "certainty",
    "citations",
    "contact_edges",
    "contact_results",
    "dimension_along",
    "discretisation_error",
    "edge_factors",
    "edge_pressure",
    "half_width",
    "in_plane",
    "largest",
    "line_load",
    "load_between",
    "measure",
    "normalized",
    "peak",
    "positions",
    "positions_over_a",
    "section_peak",
    "short",
    "single_case",
    "slices",
    "solved_case",
    "unloaded_gap",
]

suggest(__name__, __all__)
