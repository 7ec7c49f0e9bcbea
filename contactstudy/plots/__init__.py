"""Figures of solved cases and of studies; lengths over the Hertz half-width a, stresses over p0, or in mm and MPa.

Every function takes results of :func:`contactstudy.solve`, or of :func:`contactstudy.open_study` with one case
selected, and draws into given axes or a new figure. Colours keep their order in grey, lines differ by their dashes.
"""

from contactstudy.near_names import suggest
from contactstudy.plots.comparison import plot_comparison, plot_depth
from contactstudy.plots.edge_effect import plot_edge_effect
from contactstudy.plots.pressure import plot_axial_pressure, plot_pressure_map
from contactstudy.plots.profile import plot_profile, plot_profiles
from contactstudy.plots.stress import plot_end_face, plot_stress_plane
from contactstudy.plots.study_lines import plot_study_lines, study_figures
from contactstudy.plots.study_map import plot_study_map
from contactstudy.plots.style import COLORS, save
from contactstudy.plots.temperature import plot_temperature_map
from contactstudy.plots.tractions import plot_stick_and_slip, plot_traction_curve, plot_traction_map
from contactstudy.plots.wear import plot_wear

__all__ = [
    "COLORS",
    "plot_axial_pressure",
    "plot_comparison",
    "plot_depth",
    "plot_edge_effect",
    "plot_end_face",
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

suggest(__name__, __all__)
