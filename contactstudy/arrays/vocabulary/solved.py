"""What :func:`contactstudy.solve` returns: coordinates, the contact, fields in the body and their measures."""

from __future__ import annotations

from contactstudy.arrays.vocabulary.variable import EVALUATION, PARAMETER, SCALAR, SLICE, XY, XYZ, XZ, YZ, Variable, X

COORDINATES = {
    "x": Variable(X, "m", "x", "position along the axis", "from end I of the body"),
    "y": Variable(("y",), "m", "y", "position along rolling", "from under the roller's centre"),
    "z": Variable(("z",), "m", "z", "depth", "below the loaded surface"),
    "x_field": Variable(("x_field",), "m", "x", "position along the axis", "of the stresses, from end I of the body"),
    "y_field": Variable(("y_field",), "m", "y", "position along rolling", "of the stresses"),
    "x_bounds": Variable(("x", "bounds"), "m", "", "edges of the cells", "along the axis"),
    "x_width": Variable(X, "m", "w", "width of the cells", "along the axis"),
    "e_over_a": Variable(
        SCALAR, "1", "e/a", "end distance over a", "distance e of roller end and free end over Hertz half-width a"
    ),
    "friction": Variable(SCALAR, "1", "f", "coefficient of friction"),
    "gamma": Variable(SCALAR, "1", r"\gamma", "length over radius", "of the body over that of the roller"),
    "profile": Variable(SCALAR, "", "", "roller profile"),
    "distance": Variable(("distance",), "m", "s", "distance", "along the line, or slid or rolled"),
    "slice": Variable(SLICE, "1", "k", "slice from end I", "its number"),
    "principal": Variable(("principal",), "1", "", "principal stress", "its rank, 1 the largest"),
    "axis": Variable(("axis",), "", "", "component along this axis"),
    "case": Variable(("case",), "1", "", "number of the case"),
    "model": Variable(("model",), "", "", "model of the contacts"),
    "evaluation": Variable(EVALUATION, "1", "", "number of the design"),
    "case_load": Variable(("case",), "N", "W", "normal load of the case"),
    "case_tilt": Variable(("case",), "rad", r"\vartheta", "tilt of the case"),
    "parameter": Variable(PARAMETER, "", "", "parameter of the profile"),
    "parameter_units": Variable(PARAMETER, "", "", "unit of the parameter", "empty where it is not known"),
    "raceway": Variable(("raceway",), "", "", "raceway"),
    "roller": Variable(("roller",), "1", "j", "number of the roller"),
    "approach": Variable(("approach",), "m", r"\delta", "approach", "of roller and body, relative to its reference"),
    "tilt": Variable(
        ("tilt",), "rad", r"\vartheta", "tilt", "relative to its reference, positive if larger x is pressed deeper"
    ),
    "normal_load": Variable(("normal_load",), "N", "W", "normal load"),
    "moment": Variable(("moment",), "N m", "M", "moment", "of the pressure, positive for a load at larger x"),
    "pass_number": Variable(("pass_number",), "1", "N", "number of the pass"),
}
"""Coordinates of results; swept parameters stand in :data:`contactstudy.study.parameters.PARAMETERS`."""

CONTACT = {
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
    "approach": Variable(SCALAR, "m", r"\delta", "approach of roller and body, relative to its reference"),
    "tilt": Variable(
        SCALAR, "rad", r"\vartheta", "tilt relative to its reference, positive if larger x is pressed deeper"
    ),
    "load_position": Variable(SCALAR, "m", "x_W", "position x of the pressure's resultant"),
    "force_x": Variable(SCALAR, "N", "F_x", "force on the body along the roller's axis"),
    "force_y": Variable(SCALAR, "N", "F_y", "force on the body along +y"),
    "moment_z": Variable(SCALAR, "N m", "M_z", "moment on the body about the normal through the roller's middle"),
    "longitudinal_creepage": Variable(
        SCALAR, "1", r"\xi", "velocity of the roller against the body along +y, over rolling"
    ),
    "lateral_creepage": Variable(SCALAR, "1", r"\eta", "velocity of the roller against the body along x, over rolling"),
    "spin": Variable(SCALAR, "rad/m", r"\varphi", "angular velocity of the roller about z, over rolling"),
    "shift_x": Variable(SCALAR, "m", "", "shift of the roller against the body along x"),
    "shift_y": Variable(SCALAR, "m", "", "shift of the roller against the body along y"),
    "sticking_part": Variable(SCALAR, "1", "", "area that sticks over that of the contact"),
    "friction_work": Variable(SCALAR, "", "A", "frictional work per distance rolled, or of a shift"),
    "friction_steps": Variable(SCALAR, "1", "", "steps of Newton's method for stick and slip"),
    "bound_error": Variable(SCALAR, "1", "", "largest traction above the friction's bound, over the largest bound"),
    "slip_error": Variable(
        SCALAR, "1", "", "largest slip where surfaces stick, or across or against the traction, over the rigid slip"
    ),
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
    "end_traction_residual": Variable(
        SCALAR, "1", "", "largest traction left on the free ends, over the peak pressure"
    ),
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
    "end_intensity": Variable(SCALAR, "Pa m0.5", "K", "intensity of the pressure at the sharper singular end"),
    "end_intensity_first": Variable(SCALAR, "Pa m0.5", r"K_\mathrm{I}", "intensity at a singular end nearer to end I"),
    "end_intensity_last": Variable(SCALAR, "Pa m0.5", r"K_\mathrm{II}", "intensity at a singular end nearer to end II"),
    "end_exponent": Variable(SCALAR, "1", "m", "exponent of the pressure at the sharper singular end"),
    "end_exponent_first": Variable(SCALAR, "1", r"m_\mathrm{I}", "exponent at a singular end nearer to end I"),
    "end_exponent_last": Variable(SCALAR, "1", r"m_\mathrm{II}", "exponent at a singular end nearer to end II"),
    "half_width_middle": Variable(SCALAR, "m", r"b_\mathrm{m}", "half-width of the contact at mid-length"),
}
"""The contact: of a case, of a shape with a body, and of a rough surface."""

SLICE_MODEL = {
    "load_per_length": Variable(X, "N/m", "w", "load per length of each slice"),
    "deflection": Variable(X, "m", "d_k", "deflection of each slice"),
    "edge_factor": Variable(X, "1", "", "stress riser of ISO/TS 16281, a factor on the load"),
}
"""What the slice model alone returns."""

FIELDS = {
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
}
"""Fields in the body, and the loads on the auxiliary bodies that make them."""

MEASURES = {
    "von_mises": Variable(XYZ, "Pa", r"\sigma_{vM}", "von Mises stress"),
    "tresca": Variable(XYZ, "Pa", r"\sigma_{T}", "Tresca stress"),
    "maximum_shear": Variable(XYZ, "Pa", r"\tau_{max}", "maximum shear stress"),
    "hydrostatic": Variable(XYZ, "Pa", r"\sigma_h", "hydrostatic stress"),
    "principal_stress": Variable((*XYZ, "principal"), "Pa", r"\sigma_i", "principal stress, largest first"),
    "principal_direction": Variable((*XYZ, "principal", "axis"), "1", "n_i", "unit vector along the principal stress"),
    "orthogonal_shear_range": Variable(XZ, "Pa", r"2\tau_0", "orthogonal shear range"),
    "orthogonal_shear_amplitude": Variable(XZ, "Pa", r"\tau_0", "orthogonal shear amplitude"),
    "y_of_largest_shear": Variable(XZ, "m", "", "where tau_yz is largest"),
    "y_of_smallest_shear": Variable(XZ, "m", "", "where tau_yz is smallest"),
}
"""Measures of stress."""
