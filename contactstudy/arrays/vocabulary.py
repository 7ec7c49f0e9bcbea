"""Every variable that the package returns: dimensions, unit, symbol and meaning, in one table.

Quantities that no formula uses have no symbol; texts, and quantities whose unit depends on the row, have no unit.
"""

from __future__ import annotations

from typing import NamedTuple


class Variable(NamedTuple):
    """Specification of one variable."""

    dims: tuple[str, ...]  # dimensions in a result of one case; a study puts its swept parameters in front
    units: str  # SI, in the spelling of the CF conventions
    symbol: str  # LaTeX, without dollar signs
    long_name: str
    """Meaning. In a derived quantity ``{variable}`` stands for the meaning of the original variable, and ``{symbol}``
    for its symbol, or its meaning without a symbol. Meanings of coordinates are short: in figures
    xarray breaks the label of an axis after 30 characters, and the second line is cut off."""
    comment: str = ""  # addition to the short meaning

    @property
    def attrs(self) -> dict[str, str]:
        """Attributes of the variable in a Dataset."""
        attributes = {"units": self.units, "long_name": self.long_name, "comment": self.comment}
        return {name: text for name, text in attributes.items() if text}


X, XY, XZ, YZ, XYZ, SCALAR = ("x",), ("x", "y"), ("x", "z"), ("y", "z"), ("x", "y", "z"), ()
SLICE_DIMS, CHECK_DIMS = ("slice",), ("check",)
LAW, DISTANCE_X_DIMS = ("approach", "tilt"), ("distance", "x")
EVALUATION_DIMS, PARAMETER_DIMS, SLIDE_ROLL_DIMS = ("evaluation",), ("parameter",), ("slide_roll_ratio",)
AXES = ("x", "y", "z")  # along the roller's axis, along rolling, and into the body
STRESSES = ("sigma_xx", "sigma_yy", "sigma_zz", "tau_xy", "tau_xz", "tau_yz")  # the order in every array
COORDINATES = {  # coordinates of results; for swept parameters see :data:`contactstudy.study.parameters.PARAMETERS`
    "x": Variable(X, "m", "x", "position along the axis", "from end I of the body"),
    "y": Variable(("y",), "m", "y", "position along rolling", "from under the roller's centre"),
    "z": Variable(("z",), "m", "z", "depth", "below the loaded surface"),
    "x_field": Variable(("x_field",), "m", "x", "position along the axis", "of the stresses, from end I of the body"),
    "y_field": Variable(("y_field",), "m", "y", "position along rolling", "of the stresses"),
    "x_bounds": Variable(("x", "bounds"), "m", "", "edges of the cells", "along the axis"),
    "x_width": Variable(X, "m", "w", "width of the cells", "along the axis"),
    "e_over_a": Variable(SCALAR, "1", "e/a", "end distance over a", "roller end to free end over Hertz half-width"),
    "length_over_a": Variable(SCALAR, "1", "L/a", "length over a", "of the roller"),
    "crown": Variable(SCALAR, "1", "", "crown", "amplitude of the logarithmic profile over a**2 / R"),
    "tilt_ratio": Variable(SCALAR, "1", "", "drop of an end by the tilt", "over a**2 / R"),
    "poisson": Variable(SCALAR, "1", r"\nu", "Poisson's ratio", "of the body"),
    "friction": Variable(SCALAR, "1", "f", "coefficient of friction"),
    "gamma": Variable(SCALAR, "1", r"\gamma", "length over radius", "of the body over that of the roller"),
    "profile": Variable(SCALAR, "", "", "roller profile"),
    "distance": Variable(("distance",), "m", "s", "distance", "along the line, or slid or rolled"),
    "slice": Variable(SLICE_DIMS, "1", "k", "slice from end I", "its number"),
    "principal": Variable(("principal",), "1", "", "principal stress", "its rank, 1 the largest"),
    "axis": Variable(("axis",), "", "", "component along this axis"),
    "case": Variable(("case",), "1", "", "number of the case"),
    "model": Variable(("model",), "", "", "model of the contacts"),
    "evaluation": Variable(EVALUATION_DIMS, "1", "", "number of the design"),
    "case_load": Variable(("case",), "N", "W", "normal load of the case"),
    "case_tilt": Variable(("case",), "rad", r"\vartheta", "tilt of the case"),
    "case_load_position": Variable(("case",), "m", "x_W", "load position of the case"),
    "parameter": Variable(PARAMETER_DIMS, "", "", "parameter of the profile"),
    "parameter_units": Variable(PARAMETER_DIMS, "", "", "unit of the parameter", "empty where it is not known"),
    "raceway": Variable(("raceway",), "", "", "raceway"),
    "roller": Variable(("roller",), "1", "j", "number of the roller"),
    "approach": Variable(("approach",), "m", r"\delta", "approach", "of roller and body, relative to reference_depth"),
    "tilt": Variable(("tilt",), "rad", r"\vartheta", "tilt", "from reference_depth, positive if larger x is deeper"),
    "normal_load": Variable(("normal_load",), "N", "W", "normal load"),
    "slide_roll_ratio": Variable(SLIDE_ROLL_DIMS, "1", "S", "slide-roll ratio"),
    "moment": Variable(("moment",), "N m", "M", "moment", "of the pressure, positive for a load at larger x"),
    "pass_number": Variable(("pass_number",), "1", "N", "number of the pass"),
}

VARIABLES = {  # all variables by subject, except the names of `RULES`
    # The contact: of a case, of a shape with a body, and of a rough surface
    "pressure": Variable(XY, "Pa", "p", "contact pressure"),
    "traction_x": Variable(XY, "Pa", "q_x", "traction on the body along the roller's axis"),
    "traction_y": Variable(XY, "Pa", "q_y", "traction on the body along +y"),
    "slip_x": Variable(XY, "", "s_x", "slip of the roller against the body along x, per distance rolled or of a shift"),
    "slip_y": Variable(XY, "", "s_y", "slip of the roller against the body along y, per distance rolled or of a shift"),
    "stick": Variable(XY, "1", "", "whether the surfaces stick"),
    "gap": Variable(XY, "m", "g", "gap after deformation"),
    "initial_gap": Variable(XY, "m", "g_0", "gap before deformation"),
    "displacement_z": Variable(XY, "m", "u_z", "normal displacement of the top, into the body"),
    "displacement_x": Variable(XY, "m", "u_x", "displacement of the top along the roller's axis"),
    "displacement_y": Variable(XY, "m", "u_y", "displacement of the top along rolling"),
    "height": Variable(XY, "m", "h", "height of the rough surface, positive towards the other body"),
    "normal_load": Variable(SCALAR, "N", "W", "normal load"),
    "approach": Variable(SCALAR, "m", r"\delta", "approach of roller and body, relative to reference_depth"),
    "tilt": Variable(SCALAR, "rad", r"\vartheta", "tilt from reference_depth, positive if larger x is pressed deeper"),
    "reference_depth": Variable(SCALAR, "m", "d", "depth of the body's line to which approach and tilt refer"),
    "roller_reference_depth": Variable(SCALAR, "m", "", "depth of the elastic roller's line, from the contact"),
    "load_position": Variable(SCALAR, "m", "x_W", "position x of the pressure's resultant"),
    "force_x": Variable(SCALAR, "N", "F_x", "force on the body along the roller's axis"),
    "force_y": Variable(SCALAR, "N", "F_y", "force on the body along +y"),
    "moment_z": Variable(SCALAR, "N m", "M_z", "moment on the body about the normal through the roller's middle"),
    "longitudinal_creepage": Variable(SCALAR, "1", r"\xi", "relative velocity of the roller along +y, over rolling"),
    "lateral_creepage": Variable(SCALAR, "1", r"\eta", "relative velocity of the roller along x, over rolling"),
    "spin": Variable(SCALAR, "rad/m", r"\varphi", "angular velocity of the roller about z, over rolling"),
    "shift_x": Variable(SCALAR, "m", "", "shift of the roller against the body along x"),
    "shift_y": Variable(SCALAR, "m", "", "shift of the roller against the body along y"),
    "sticking_part": Variable(SCALAR, "1", "", "area that sticks over that of the contact"),
    "friction_work": Variable(SCALAR, "", "A", "frictional work per distance rolled, or of a shift"),
    "friction_steps": Variable(SCALAR, "1", "", "steps of Newton's method for stick and slip"),
    "bound_error": Variable(SCALAR, "1", "", "largest traction above the friction's bound, over the largest bound"),
    "slip_error": Variable(SCALAR, "1", "", "largest slip that contradicts stick or traction, over the rigid slip"),
    "force_error": Variable(SCALAR, "1", "", "resultant of the tractions minus the prescribed one, over the largest"),
    "iterations": Variable(SCALAR, "1", "", "applications of the contact operator"),
    "converged": Variable(SCALAR, "1", "", "whether the iteration reached its tolerance"),
    "load_error": Variable(SCALAR, "1", "", "resultant of the pressure minus the load, over the load"),
    "penetration_error": Variable(
        SCALAR, "1", "", "largest gap or overlap under pressure, over the variation of the displacement"
    ),
    "open_pressure_error": Variable(SCALAR, "1", "", "largest pressure where the gap is open, over the peak pressure"),
    "load_position_error": Variable(
        SCALAR, "1", "", "distance of the pressure's resultant from load_position, over the length of the contact"
    ),
    "end_traction_residual": Variable(SCALAR, "1", "", "largest traction on the free ends, over the peak pressure"),
    "hertz_half_width": Variable(SCALAR, "m", "a", "half-width of the Hertz line contact of the same load per length"),
    "hertz_max_pressure": Variable(
        SCALAR, "Pa", "p_0", "peak pressure of the Hertz line contact of the same load per length"
    ),
    "peak_pressure_first": Variable(SCALAR, "Pa", "", "largest pressure on the half nearer to end I"),
    "peak_pressure_last": Variable(SCALAR, "Pa", "", "largest pressure on the half nearer to end II"),
    "end_pressure_first": Variable(SCALAR, "Pa", r"p_\mathrm{I}", "largest pressure at the end nearer to end I"),
    "end_pressure_last": Variable(SCALAR, "Pa", r"p_\mathrm{II}", "largest pressure at the end nearer to end II"),
    "end_load_first": Variable(SCALAR, "N", r"W_\mathrm{I}", "load on the last half-width a nearer to end I"),
    "end_load_last": Variable(SCALAR, "N", r"W_\mathrm{II}", "load on the last half-width a nearer to end II"),
    "end_intensity": Variable(SCALAR, "", "K", "intensity of the pressure at the sharper singular end"),
    "end_intensity_first": Variable(SCALAR, "", r"K_\mathrm{I}", "intensity at a singular end nearer to end I"),
    "end_intensity_last": Variable(SCALAR, "", r"K_\mathrm{II}", "intensity at a singular end nearer to end II"),
    "corner_x": Variable(SCALAR, "m", "x_c", "x of the loaded convex corner of the largest intensity"),
    "corner_slope": Variable(SCALAR, "1", "s", "jump of the slope of the generatrix at the corner"),
    "corner_intensity": Variable(SCALAR, "Pa", r"E^* s / 2\pi", "intensity of the logarithmic pressure at the corner"),
    "corner_distance": Variable(SCALAR, "m", "d_0", "distance d0 in the law of the pressure at the corner"),
    "end_exponent": Variable(SCALAR, "1", "m", "exponent of the pressure at the sharper singular end"),
    "end_exponent_first": Variable(SCALAR, "1", r"m_\mathrm{I}", "exponent at a singular end nearer to end I"),
    "end_exponent_last": Variable(SCALAR, "1", r"m_\mathrm{II}", "exponent at a singular end nearer to end II"),
    "half_width_middle": Variable(SCALAR, "m", r"b_\mathrm{m}", "half-width of the contact at mid-length"),
    # The slice model
    "load_per_length": Variable(X, "N/m", "w", "load per length of each slice"),
    "deflection": Variable(X, "m", "d_k", "deflection of each slice"),
    "edge_factor": Variable(X, "1", "", "stress riser of ISO/TS 16281, a factor on the load"),
    # Fields in the body, and the equivalent loads on the auxiliary bodies
    "u_x": Variable(XYZ, "m", "u_x", "displacement along the roller's axis"),
    "u_y": Variable(XYZ, "m", "u_y", "displacement along rolling"),
    "u_z": Variable(XYZ, "m", "u_z", "displacement along depth"),
    "sigma_xx": Variable(XYZ, "Pa", r"\sigma_{xx}", "normal stress along the roller's axis"),
    "sigma_yy": Variable(XYZ, "Pa", r"\sigma_{yy}", "normal stress along rolling"),
    "sigma_zz": Variable(XYZ, "Pa", r"\sigma_{zz}", "normal stress along depth"),
    "tau_xy": Variable(XYZ, "Pa", r"\tau_{xy}", "shear stress xy"),
    "tau_xz": Variable(XYZ, "Pa", r"\tau_{xz}", "shear stress xz"),
    "tau_yz": Variable(XYZ, "Pa", r"\tau_{yz}", "shear stress yz"),
    "P_h1": Variable(XY, "Pa", "P_{h1}", "equivalent pressure on the top, P_h1"),
    "P_v1": Variable(YZ, "Pa", "P_{v1}", "equivalent pressure on end plane I, P_v1"),
    "P_v2": Variable(YZ, "Pa", "P_{v2}", "equivalent pressure on end plane II, P_v2"),
    # Measures of stress
    "von_mises": Variable(XYZ, "Pa", r"\sigma_{vM}", "von Mises stress"),
    "tresca": Variable(XYZ, "Pa", r"\sigma_{T}", "Tresca stress"),
    "maximum_shear": Variable(XYZ, "Pa", r"\tau_{max}", "maximum shear stress"),
    "hydrostatic": Variable(XYZ, "Pa", r"\sigma_h", "hydrostatic stress"),
    "principal_stress_1": Variable(XYZ, "Pa", r"\sigma_1", "largest principal stress"),
    "principal_stress_2": Variable(XYZ, "Pa", r"\sigma_2", "middle principal stress"),
    "principal_stress_3": Variable(XYZ, "Pa", r"\sigma_3", "smallest principal stress"),
    "principal_stress": Variable((*XYZ, "principal"), "Pa", r"\sigma_i", "principal stress, largest first"),
    "principal_direction": Variable((*XYZ, "principal", "axis"), "1", "n_i", "unit vector along the principal stress"),
    "orthogonal_shear_range": Variable(XZ, "Pa", r"2\tau_0", "orthogonal shear range"),
    "orthogonal_shear_amplitude": Variable(XZ, "Pa", r"\tau_0", "orthogonal shear amplitude"),
    "y_of_largest_shear": Variable(XZ, "m", "", "where tau_yz is largest"),
    "y_of_smallest_shear": Variable(XZ, "m", "", "where tau_yz is smallest"),
    # Of :mod:`contactstudy.analysis`
    "axial_pressure": Variable(X, "Pa", r"\max_y p", "largest pressure across y"),
    "line_load": Variable(X, "N/m", "w", "load per length along the axis"),
    "half_width": Variable(X, "m", "b", "half-width of the contact"),
    "contact_middle": Variable(X, "m", r"y_\mathrm{m}", "y of the contact's middle"),
    "unloaded_gap": Variable(X, "m", r"\min_y g_0", "smallest gap across y before deformation"),
    "edge_tension": Variable(X, "Pa", r"\sigma_\mathrm{t}", "tension at the trailing edge"),
    "trailing_edge": Variable(X, "m", r"y_\mathrm{t}", "y of the trailing edge"),
    "y_left": Variable(X, "m", r"y_\mathrm{l}", "first y of the contact"),
    "y_right": Variable(X, "m", r"y_\mathrm{r}", "last y of the contact"),
    "x_first": Variable(SCALAR, "m", "", "first x of the contact"),
    "x_last": Variable(SCALAR, "m", "", "last x of the contact"),
    "contact_length": Variable(SCALAR, "m", "", "length of the contact along the roller's axis"),
    "contact_width": Variable(SCALAR, "m", "", "width of the contact along rolling, in whole cells"),
    "contact_area": Variable(SCALAR, "m2", "A", "area of the contact"),
    "contact_length_loss": Variable(SCALAR, "m", "", "length where roller and body face each other without load"),
    "edge_pressure_first": Variable(SCALAR, "Pa", "", "pressure in the first loaded cells along x"),
    "edge_pressure_last": Variable(SCALAR, "Pa", "", "pressure in the last loaded cells along x"),
    "end_pressure_over_p0_first": Variable(SCALAR, "1", "", "pressure at the end nearer to end I, over p0"),
    "end_pressure_over_p0_last": Variable(SCALAR, "1", "", "pressure at the end nearer to end II, over p0"),
    "end_pressure_over_p0": Variable(SCALAR, "1", "", "mean of the pressures at both ends, over p0"),
    "resultant": Variable(SCALAR, "N", "W", "resultant of the pressure"),
    "moment": Variable(SCALAR, "N m", "M", "moment of the pressure, positive for a load at larger x"),
    "end_over_middle_first": Variable(SCALAR, "1", "", "{variable} at the first end, over that in the middle"),
    "end_over_middle_last": Variable(SCALAR, "1", "", "{variable} at the last end, over that in the middle"),
    "over_reference_first": Variable(SCALAR, "1", "", "{variable} at the first end, over that of the reference"),
    "over_reference_last": Variable(SCALAR, "1", "", "{variable} at the last end, over that of the reference"),
    "over_reference_middle": Variable(SCALAR, "1", "", "{variable} in the middle, over that of the reference"),
    "over_reference_peak": Variable(SCALAR, "1", "", "{variable} at its largest, over that of the reference"),
    "position": Variable(SLICE_DIMS, "m", "x_k", "middle of the slice"),
    "width": Variable(SLICE_DIMS, "m", "", "width of the slice"),
    # Of :mod:`contactstudy.fatigue`. The exponents in the unit of a risk are those of its life theory
    "window_remainder": Variable(XZ, "1", "", "stress at the borders of the window over the largest of the passage"),
    "dang_van": Variable(XZ, "Pa", r"\tau + \alpha \sigma_h", "Dang Van's equivalent shear stress"),
    "dang_van_shear": Variable(XZ, "Pa", r"\tau", "shear at the worst instant"),
    "dang_van_hydrostatic": Variable(XZ, "Pa", r"\sigma_h", "hydrostatic stress at the worst instant"),
    "dang_van_y": Variable(XZ, "m", "", "y of the worst instant"),
    "crossland": Variable(XZ, "Pa", r"\sqrt{J_{2,a}} + A \sigma_{h,max}", "Crossland's equivalent shear stress"),
    "crossland_shear": Variable(XZ, "Pa", r"\sqrt{J_{2,a}}", "amplitude of the root of J2"),
    "crossland_hydrostatic": Variable(XZ, "Pa", r"\sigma_{h,max}", "largest hydrostatic stress of the history"),
    "findley": Variable(XZ, "Pa", r"\tau_a + k \sigma_{n,max}", "Findley's sum on the worst plane"),
    "findley_shear": Variable(XZ, "Pa", r"\tau_a", "shear amplitude on the worst plane"),
    "findley_normal": Variable(XZ, "Pa", r"\sigma_{n,max}", "largest normal stress on the worst plane"),
    "findley_plane": Variable((*XZ, "axis"), "1", "n", "unit normal of the worst plane"),
    "utilisation": Variable(XZ, "1", "", "{variable}, over its limit"),
    "shear_amplitude": Variable(X, "Pa", r"\tau_0", "largest amplitude of the orthogonal shear"),
    "shear_depth": Variable(X, "m", "z_0", "depth of the largest amplitude"),
    "mean_depth": Variable(X, "m", "z'", "stress-weighted mean depth of the risk"),
    "risk_density": Variable(X, "Pa**c m**(1 - h)", "", "risk of fatigue per length of the roller and of the raceway"),
    "risk": Variable(SCALAR, "Pa**c m**(2 - h)", "", "risk of fatigue per length of the raceway"),
    "relative_life": Variable(SCALAR, "1", "", "life over that of the reference"),
    "first_yield_stress": Variable(XZ, "Pa", "k_e", "yield stress in shear below which the first passage yields"),
    "shakedown_stress": Variable(XZ, "Pa", "k_s", "yield stress in shear below which every passage yields"),
    "residual_sigma_yy": Variable(XZ, "Pa", r"\rho_{yy}", "residual stress along rolling for the point's shakedown"),
    "residual_sigma_xx": Variable(XZ, "Pa", r"\rho_{xx}", "residual stress along the axis for the point's shakedown"),
    "residual_sigma_zz": Variable(XZ, "Pa", r"\rho_{zz}", "residual stress along depth for the point's shakedown"),
    "residual_tau_xz": Variable(XZ, "Pa", r"\rho_{xz}", "residual shear stress xz for the point's shakedown"),
    "program_gap": Variable(SCALAR, "1", "", "part of the yield stress that the convex program could still gain"),
    "shakedown_limit": Variable(SCALAR, "1", "p_0/k", "pressure p0 over the least yield stress k for shakedown"),
    "first_yield_limit": Variable(SCALAR, "1", "p_0/k", "pressure p0 over the least yield stress k for no yield"),
    # Of :func:`contactstudy.heat.flash_temperature`
    "temperature_rise": Variable(XY, "K", "T", "temperature rise of the body's surface"),
    "roller_temperature_rise": Variable(XY, "K", "T_2", "temperature rise of the roller's surface"),
    "body_temperature_rise": Variable(XYZ, "K", "T", "temperature rise in the body"),
    "frictional_heat": Variable(XY, "W m-2", r"\dot{q}", "heat that friction makes, per area"),
    "heat_into_body": Variable(XY, "W m-2", r"\dot{q}_1", "heat that goes into the body, per area"),
    "heat_partition": Variable(XY, "1", r"\dot{q}_1/\dot{q}", "part of the frictional heat that goes into the body"),
    "body_heat_share": Variable(SCALAR, "1", "", "part of the whole frictional heat that goes into the body"),
    "max_temperature_rise": Variable(SCALAR, "K", r"\max T", "largest temperature rise of the surfaces"),
    "max_temperature_rise_error": Variable(SCALAR, "K", "", "estimated error of the largest temperature rise"),
    "max_temperature_rise_x": Variable(SCALAR, "m", "", "x of the largest temperature rise"),
    "max_temperature_rise_y": Variable(SCALAR, "m", "", "y of the largest temperature rise"),
    "friction_power": Variable(SCALAR, "W", "", "power that friction turns into heat"),
    "heat_error": Variable(SCALAR, "1", "", "heat into both bodies minus the frictional power, over the latter"),
    "temperature_mismatch": Variable(
        SCALAR, "1", "", "largest difference of the surfaces' temperatures where they touch, over the largest rise"
    ),
    # Film thickness and derived quantities
    "film_thickness": Variable(XY, "m", "h", "film thickness", "mean height between rough surfaces"),
    "asperity_pressure": Variable(XY, "Pa", r"p_\mathrm{c}", "pressure of the asperities"),
    "central_film": Variable(SCALAR, "m", r"h_\mathrm{c}", "film thickness in the middle of the contact"),
    "least_film": Variable(SCALAR, "m", r"h_\mathrm{m}", "least film thickness"),
    "least_film_x": Variable(SCALAR, "m", "", "x of the least film thickness"),
    "least_film_y": Variable(SCALAR, "m", "", "y of the least film thickness"),
    "least_film_middle": Variable(SCALAR, "m", "", "least film thickness in the middle section"),
    "least_film_first": Variable(SCALAR, "m", "", "least film thickness in the half nearer to end I"),
    "least_film_last": Variable(SCALAR, "m", "", "least film thickness in the half nearer to end II"),
    "least_film_first_x": Variable(SCALAR, "m", "", "x of the least film thickness in the half nearer to end I"),
    "least_film_last_x": Variable(SCALAR, "m", "", "x of the least film thickness in the half nearer to end II"),
    "flow_x": Variable(XY, "m2 s-1", "", "flow along the roller's axis per width, at ambient density"),
    "flow_y": Variable(XY, "m2 s-1", "", "flow along +y per width, at ambient density"),
    "end_flow_first": Variable(SCALAR, "m3 s-1", "", "flow out of the film through end I, at ambient density"),
    "end_flow_last": Variable(SCALAR, "m3 s-1", "", "flow out of the film through end II, at ambient density"),
    "entrainment_speed": Variable(SCALAR, "m s-1", r"u_\mathrm{m}", "mean speed of the surfaces along +y"),
    "slide_roll_ratio": Variable(SCALAR, "1", "S", "difference of the surfaces' speeds over their mean"),
    "moes_load": Variable(SCALAR, "1", "M", "Moes' load number of the largest load per length"),
    "moes_lubricant": Variable(SCALAR, "1", "L", "Moes' lubricant number"),
    "asperity_load_share": Variable(SCALAR, "1", "", "part of the load that the asperities carry"),
    "roughness_rms": Variable(SCALAR, "m", r"\sigma", "composite rms roughness"),
    "mass_error": Variable(
        SCALAR, "1", "", "largest net outflow of a full cell, over the central flow times the cell's width"
    ),
    "film_balance_error": Variable(SCALAR, "1", "", "inflow less outflow of the whole film, over the central flow"),
    "film_load_error": Variable(SCALAR, "1", "", "error of load and moment of the film, over the load"),
    "film_complementarity_error": Variable(SCALAR, "1", "", "largest net inflow or pressure of a cavitated cell"),
    "newton_steps": Variable(SCALAR, "1", "", "Newton steps of the film on all levels"),
    "linear_steps": Variable(SCALAR, "1", "", "steps of the linear systems of the film on all levels"),
    "film_levels": Variable(SCALAR, "1", "", "levels of cells of the film"),
    "end_film_ratio": Variable(SCALAR, "1", "", "least film thickness over that of the middle section"),
    "least_film_ratio": Variable(SCALAR, "1", r"\Lambda_\mathrm{m}", "least film thickness over the roughness"),
    "slice_film": Variable(X, "m", "", "film of each slice by Moes' formula, from the dry load per length"),
    "viscosity_ratio": Variable(SCALAR, "1", r"\kappa", "viscosity ratio of ISO 281, from the middle section's film"),
    "film_ratio": Variable(X, "1", r"\Lambda", "least film thickness across y over the composite roughness"),
    "traction_coefficient": Variable(SLIDE_ROLL_DIMS, "1", r"\mu", "traction over the load"),
    "power_loss": Variable(SLIDE_ROLL_DIMS, "W", "", "power loss of sliding and rolling"),
    "thermal_reduction": Variable(SLIDE_ROLL_DIMS, "1", r"\varphi_T", "film with heated inlet over isothermal film"),
    "rolling_force": Variable((), "N", "", "force along y on either surface from the film's pressure gradient"),
    "rolling_moment": Variable((), "N m", "t", "moment of the rolling force about the roller's axis"),
    # Contacts of the atlas, in units of the Hertz line contact
    "peak_pressure_ratio": Variable(SCALAR, "1", "", "largest pressure over the Hertz pressure"),
    "peak_von_mises_ratio": Variable(SCALAR, "1", "", "largest von Mises stress over the Hertz pressure"),
    "approach_ratio": Variable(SCALAR, "1", "", "approach over a**2 / R, relative to the depth of the body's length"),
    "stiffness_ratio": Variable(SCALAR, "1", "", "stiffness over E* L, to the depth of the body's length"),
    "end_load_ratio": Variable(SCALAR, "1", "", "load on the last half-width over the mean load per half-width"),
    # Of :mod:`contactstudy.bearing`
    "strain_energy": Variable(LAW, "J", "U", "strain energy of the contact"),
    "normal_stiffness": Variable(LAW, "N/m", r"\partial Q/\partial\delta", "change of the load with the approach"),
    "coupling_stiffness": Variable(LAW, "N/rad", r"\partial Q/\partial\vartheta", "change of the load with the tilt"),
    "tilting_stiffness": Variable(LAW, "N m/rad", r"\partial M/\partial\vartheta", "change of the moment with tilt"),
    "relative_load_error": Variable(LAW, "1", "", "error of the contact law's load, over the load"),
    "relative_moment_error": Variable(LAW, "1", "", "error of the contact law's moment, over load times length"),
    "accuracy": Variable(SCALAR, "1", "", "accuracy to which the peak pressure is settled"),
    "hertz_load_per_length": Variable(SLICE_DIMS, "N/m", "", "load per length of a line contact of equal pressure"),
    "stress_riser": Variable(
        ("model", "raceway", "roller", "slice"), "1", "f_k", "factor on the load of a lamina, from solved pressures"
    ),
    "lamina_equivalent_load": Variable(("model", "raceway", "slice"), "N", "q_{ke}", "equivalent load of a lamina"),
    "reference_life": Variable(("model",), "1", "L_{10r}", "basic reference rating life, revolutions"),
    "raceway_life": Variable(("model", "raceway"), "1", "", "revolutions that 9 of 10 raceways survive"),
    # Of :mod:`contactstudy.design`; the unit is the unit of the measure
    "optimum": Variable(PARAMETER_DIMS, "", "", "best value of the parameter"),
    "at_bound": Variable(PARAMETER_DIMS, "", "", "whether the best value is a bound"),
    "flat_from": Variable(PARAMETER_DIMS, "", "", "least value of the parameter that is as good within the errors"),
    "flat_to": Variable(PARAMETER_DIMS, "", "", "largest value of the parameter that is as good within the errors"),
    "lower_bound": Variable(PARAMETER_DIMS, "", "", "least value of the parameter that is looked at"),
    "upper_bound": Variable(PARAMETER_DIMS, "", "", "largest value of the parameter that is looked at"),
    "measure": Variable(SCALAR, "", "", "measure of the best design in its worst case"),
    "design": Variable(("evaluation", "parameter"), "", "", "parameters of a design that was looked at"),
    "design_measure": Variable(EVALUATION_DIMS, "", "", "measure of a design in its worst case"),
    "case_measure": Variable(("evaluation", "case"), "", "", "measure of a design in one case"),
    # Of :func:`contactstudy.wear.wear_in`
    "wear_depth": Variable(DISTANCE_X_DIMS, "m", "h", "depth worn off the roller's profile"),
    "profile_drop": Variable(DISTANCE_X_DIMS, "m", "d", "drop of the worn profile"),
    "worn_volume": Variable(("distance",), "m3", "V", "volume worn off the roller"),
    "wear_error": Variable(("distance",), "1", "", "estimated error of the worn depth, over the largest depth"),
    "next_step": Variable(("distance",), "m", "", "distance of the step that would follow"),
    "volume_error": Variable(SCALAR, "1", "", "relative difference of the worn volume from Archard's law"),
    # Of :mod:`contactstudy.plasticity`
    "plastic_strain_xx": Variable(XZ, "1", r"\varepsilon^p_{xx}", "plastic strain along the roller's axis"),
    "plastic_strain_yy": Variable(XZ, "1", r"\varepsilon^p_{yy}", "plastic strain along rolling"),
    "plastic_strain_zz": Variable(XZ, "1", r"\varepsilon^p_{zz}", "plastic strain along depth"),
    "plastic_strain_xy": Variable(XZ, "1", r"\varepsilon^p_{xy}", "plastic shear strain xy, of the tensor"),
    "plastic_strain_xz": Variable(XZ, "1", r"\varepsilon^p_{xz}", "plastic shear strain xz, of the tensor"),
    "plastic_strain_yz": Variable(XZ, "1", r"\varepsilon^p_{yz}", "plastic shear strain yz, of the tensor"),
    "equivalent_plastic_strain": Variable(XZ, "1", r"\alpha", "equivalent plastic strain, accumulated"),
    "plastic_flow": Variable(SCALAR, "1", "", "largest equivalent plastic strain of the pass"),
    "residual_displacement_z": Variable(X, "m", "", "normal displacement that passes leave on the top, into the body"),
    "residual_displacement_y": Variable(X, "m", "", "displacement along +y that passes leave on the top"),
    # Of a study's cases
    "status": Variable(SCALAR, "", "", "state of the case"),
    "message": Variable(SCALAR, "", "", "why the case is not ok"),
    "case_id": Variable(SCALAR, "", "", "identity of the case"),
    "seconds": Variable(SCALAR, "s", "", "time of solving"),
    # Of :func:`contactstudy.verification.verify`
    "group": Variable(CHECK_DIMS, "", "", "group of the check"),
    "case": Variable(CHECK_DIMS, "", "", "solved problem"),
    "quantity": Variable(CHECK_DIMS, "", "", "compared quantity, with its unit"),
    "source": Variable(CHECK_DIMS, "", "", "origin of the reference value"),
    "computed": Variable(CHECK_DIMS, "", "", "value of the package, in the unit of the quantity"),
    "expected": Variable(CHECK_DIMS, "", "", "value of the reference, in the unit of the quantity"),
    "difference": Variable(CHECK_DIMS, "", "", "difference that the tolerance bounds"),
    "tolerance": Variable(CHECK_DIMS, "", "", "largest difference that passes"),
    "passed": Variable(CHECK_DIMS, "", "", "whether the difference is within the tolerance"),
}

RULES = {  # names derived from another variable or coordinate, whose unit, symbol and meaning fill the braces
    "peak_{name}": Variable(SCALAR, "{units}", r"\max {symbol}", "largest {variable}"),
    "largest_{name}": Variable(SCALAR, "{units}", "", "largest sample of the {variable}"),
    **{
        f"{prefix}_{{name}}_{axis}": Variable(SCALAR, "m", "", f"{meaning} of the largest {{variable}}")
        for prefix in ("peak", "largest")
        for axis, meaning in (("x", "x"), ("y", "y"), ("z", "depth"))
    },
    "{name}_error": Variable(SCALAR, "{units}", "", "estimated discretisation error of the {variable}"),
    "inner_{name}": Variable(SCALAR, "{units}", "", "{variable}, at the inner raceway"),
    "outer_{name}": Variable(SCALAR, "{units}", "", "{variable}, at the outer raceway"),
    "{name}_over_a": Variable(("{name}",), "1", "{symbol}/a", "{symbol} over a", "{variable}"),
}
