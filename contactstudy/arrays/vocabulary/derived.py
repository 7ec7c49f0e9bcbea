"""What is calculated from results, and what studies and checks add to them."""

from __future__ import annotations

from contactstudy.arrays.vocabulary.variable import (
    CHECK,
    ENTRY,
    EVALUATION,
    PARAMETER,
    SCALAR,
    SLICE,
    XY,
    XYZ,
    XZ,
    Variable,
    X,
)

ANALYSIS = {
    "axial_pressure": Variable(X, "Pa", r"\max_y p", "largest pressure across y"),
    "line_load": Variable(X, "N/m", "w", "load per length along the axis"),
    "half_width": Variable(X, "m", "b", "half-width of the contact"),
    "contact_middle": Variable(X, "m", r"y_\mathrm{m}", "y of the contact's middle"),
    "unloaded_gap": Variable(X, "m", r"\min_y g_0", "smallest gap across y before deformation"),
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
    "position": Variable(SLICE, "m", "x_k", "middle of the slice"),
    "width": Variable(SLICE, "m", "", "width of the slice"),
}
"""What :mod:`contactstudy.analysis` reads off a result."""

FATIGUE = {
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
    "residual_sigma_yy": Variable(
        XZ, "Pa", r"\rho_{yy}", "residual stress along rolling that lets the point shake down"
    ),
    "residual_sigma_xx": Variable(
        XZ, "Pa", r"\rho_{xx}", "residual stress along the axis that lets the point shake down"
    ),
    "residual_sigma_zz": Variable(XZ, "Pa", r"\rho_{zz}", "residual stress along depth that lets the point shake down"),
    "residual_tau_xz": Variable(XZ, "Pa", r"\rho_{xz}", "residual shear stress xz that lets the point shake down"),
    "program_gap": Variable(SCALAR, "1", "", "part of the yield stress that the convex program could still gain"),
    "shakedown_limit": Variable(SCALAR, "1", "p_0/k", "pressure p0 over the least yield stress k for shakedown"),
    "first_yield_limit": Variable(SCALAR, "1", "p_0/k", "pressure p0 over the least yield stress k for no yield"),
}
"""What :mod:`contactstudy.fatigue` returns. The unit of a risk has the exponents of its life theory in it."""

HEAT = {
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
}
"""What :func:`contactstudy.flash_temperature` returns."""

LAW = ("approach", "tilt")

BEARING = {
    "strain_energy": Variable(LAW, "J", "U", "strain energy of the contact"),
    "normal_stiffness": Variable(LAW, "N/m", r"\partial Q/\partial\delta", "change of the load with the approach"),
    "coupling_stiffness": Variable(
        LAW,
        "N/rad",
        r"\partial Q/\partial\vartheta",
        "change of the load with the tilt, and of the moment with approach",
    ),
    "tilting_stiffness": Variable(
        LAW, "N m/rad", r"\partial M/\partial\vartheta", "change of the moment with the tilt"
    ),
    "relative_load_error": Variable(LAW, "1", "", "error of the contact law's load, over the load"),
    "relative_moment_error": Variable(LAW, "1", "", "error of the contact law's moment, over load times length"),
    "accuracy": Variable(SCALAR, "1", "", "accuracy to which the peak pressure is settled"),
    "inner_approach": Variable(SCALAR, "m", "", "approach of the contact with the inner raceway"),
    "inner_tilt": Variable(SCALAR, "rad", "", "tilt of the contact with the inner raceway"),
    "outer_approach": Variable(SCALAR, "m", "", "approach of the contact with the outer raceway"),
    "outer_tilt": Variable(SCALAR, "rad", "", "tilt of the contact with the outer raceway"),
    "hertz_load_per_length": Variable(
        SLICE, "N/m", "", "load per length of the line contact that has the solved pressure"
    ),
    "stress_riser": Variable(
        ("model", "raceway", "roller", "slice"), "1", "f_k", "factor on the load of a lamina, from solved pressures"
    ),
    "lamina_equivalent_load": Variable(
        ("model", "raceway", "slice"), "N", "q_{ke}", "dynamic equivalent load of a lamina"
    ),
    "reference_life": Variable(("model",), "1", "L_{10r}", "basic reference rating life, revolutions"),
    "raceway_life": Variable(("model", "raceway"), "1", "", "revolutions that 9 of 10 raceways survive"),
}
"""What :mod:`contactstudy.bearing` returns."""

DESIGN = {
    "optimum": Variable(PARAMETER, "", "", "best value of the parameter"),
    "at_bound": Variable(PARAMETER, "", "", "whether the best value is a bound"),
    "flat_from": Variable(PARAMETER, "", "", "least value of the parameter that is as good within the errors"),
    "flat_to": Variable(PARAMETER, "", "", "largest value of the parameter that is as good within the errors"),
    "lower_bound": Variable(PARAMETER, "", "", "least value of the parameter that is looked at"),
    "upper_bound": Variable(PARAMETER, "", "", "largest value of the parameter that is looked at"),
    "measure": Variable(SCALAR, "", "", "measure of the best design in its worst case"),
    "design": Variable(("evaluation", "parameter"), "", "", "parameters of a design that was looked at"),
    "design_measure": Variable(EVALUATION, "", "", "measure of a design in its worst case"),
    "case_measure": Variable(("evaluation", "case"), "", "", "measure of a design in one case"),
}
"""What :mod:`contactstudy.design` returns. Units are those of the measure."""

DISTANCE_X = ("distance", "x")

WEAR = {
    "wear_depth": Variable(DISTANCE_X, "m", "h", "depth worn off the roller's profile"),
    "profile_drop": Variable(DISTANCE_X, "m", "d", "drop of the worn profile"),
    "worn_volume": Variable(("distance",), "m3", "V", "volume worn off the roller"),
    "wear_error": Variable(("distance",), "1", "", "estimated error of the worn depth, over the largest depth"),
    "next_step": Variable(("distance",), "m", "", "distance of the step that would follow"),
    "volume_error": Variable(SCALAR, "1", "", "worn volume minus what the law gives for it, over the latter"),
}
"""What :func:`contactstudy.wear.wear_in` returns."""

PASSES = {
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
}
"""What :mod:`contactstudy.passes` returns."""

STUDIES = {
    "status": Variable(SCALAR, "", "", "state of the case"),
    "message": Variable(SCALAR, "", "", "why the case is not ok"),
    "case_id": Variable(SCALAR, "", "", "identity of the case"),
    "seconds": Variable(SCALAR, "s", "", "time of solving"),
}
"""What a study adds to its cases."""

VERIFICATION = {
    "group": Variable(CHECK, "", "", "group of the check"),
    "case": Variable(CHECK, "", "", "what was solved"),
    "quantity": Variable(CHECK, "", "", "what is compared, with its unit"),
    "source": Variable(CHECK, "", "", "where the reference comes from"),
    "computed": Variable(CHECK, "", "", "value of the package, in the unit of the quantity"),
    "expected": Variable(CHECK, "", "", "value of the reference, in the unit of the quantity"),
    "difference": Variable(CHECK, "", "", "what is compared with the tolerance"),
    "tolerance": Variable(CHECK, "", "", "largest difference that passes"),
    "passed": Variable(CHECK, "", "", "whether the difference is within the tolerance"),
    "convergence_title": Variable(ENTRY, "", "", "convergence table of the entry"),
    "convergence_setting": Variable(ENTRY, "", "", "setting that is varied"),
    "convergence_against": Variable(ENTRY, "", "", "where the reference comes from"),
    "convergence_of": Variable(ENTRY, "", "", "quantity whose error is given"),
    "convergence_value": Variable(ENTRY, "", "", "value of the setting"),
    "convergence_error": Variable(ENTRY, "", "", "error of the quantity with this value of the setting"),
}
"""What :func:`contactstudy.verification.verify` returns."""
