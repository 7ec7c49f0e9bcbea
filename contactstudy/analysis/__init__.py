"""Numbers from Datasets: functions that take and return Datasets of results, files and opened studies."""

from contactstudy.analysis.axes import dimension_along, normalized, positions, positions_over_a, single_case
from contactstudy.analysis.axial import (
    axial_pressure,
    axial_profiles,
    contact_edges,
    half_width,
    line_load,
    load_between,
    unloaded_gap,
)
from contactstudy.analysis.contact import contact_results, cut_ends, edge_factors, edge_pressure
from contactstudy.analysis.cuts import along_line, in_plane
from contactstudy.analysis.discretisation import discretisation_error
from contactstudy.analysis.peaks import MEASURES, largest_sample, measure, peak
from contactstudy.analysis.provenance import solved_case
from contactstudy.analysis.slices import slices

__all__ = [
    "MEASURES",
    "along_line",
    "axial_pressure",
    "axial_profiles",
    "contact_edges",
    "contact_results",
    "cut_ends",
    "dimension_along",
    "discretisation_error",
    "edge_factors",
    "edge_pressure",
    "half_width",
    "in_plane",
    "largest_sample",
    "line_load",
    "load_between",
    "measure",
    "normalized",
    "peak",
    "positions",
    "positions_over_a",
    "single_case",
    "slices",
    "solved_case",
    "unloaded_gap",
]
