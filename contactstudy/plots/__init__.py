"""Figures of solved cases and of studies; lengths over the Hertz half-width a, stresses over p0, or in mm and MPa.

Every function takes results of :func:`contactstudy.solve`, or one case selected from :func:`contactstudy.open_study`,
and draws into the axes `ax` or a new figure. Colours keep their order in grey; lines differ by their dashes.
"""

from contactstudy.plots.axial import (
    plot_axial_pressure,
    plot_comparison,
    plot_depth,
    plot_film_line,
    plot_profile,
    plot_profiles,
    plot_wear,
)
from contactstudy.plots.stress import plot_end_face, plot_stress_plane
from contactstudy.plots.study_lines import plot_edge_effect, plot_study_lines, plot_traction_curve, study_figures
from contactstudy.plots.study_map import plot_study_map
from contactstudy.plots.style import COLORS, save
from contactstudy.plots.surface_maps import (
    plot_film_map,
    plot_pressure_map,
    plot_stick_and_slip,
    plot_temperature_map,
    plot_traction_map,
)

__all__ = [
    "COLORS",
    "plot_axial_pressure",
    "plot_comparison",
    "plot_depth",
    "plot_edge_effect",
    "plot_end_face",
    "plot_film_line",
    "plot_film_map",
    "plot_pressure_map",
    "plot_profile",
    "plot_profiles",
    "plot_stick_and_slip",
    "plot_stress_plane",
    "plot_study_lines",
    "plot_study_map",
    "plot_temperature_map",
    "plot_traction_curve",
    "plot_traction_map",
    "plot_wear",
    "save",
    "study_figures",
]
