"""Checks of many passes: shakedown limits, eigenstrains, residual stress on either side of a limit, steady states."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr
from scipy import optimize

from contactstudy.arrays.variables import STRESSES
from contactstudy.bodies import FiniteLengthSpace, HalfSpace, Material
from contactstudy.checks import FloatArray
from contactstudy.fatigue import shakedown, shakedown_limit
from contactstudy.plasticity import ElasticPlastic, eigenstrain_stress, residual_stress
from contactstudy.verification.closed_forms import hertz_strip, rectangle_in_half_plane, von_mises
from contactstudy.verification.problems import PASSES_CASES, PASSES_FILE, Check, Curve, Reference, load_reference

STIFF = Material(1000.0, 0.3)  # Young's modulus is a thousand times the peak pressure of the contacts
# Allowed differences of residual stress, and of shear summed over depth. Above the limit errors accumulate
TOLERANCES = {
    "settling": (0.06, 0.03),
    "settling_sliding": (0.06, 0.05),
    "flowing": (0.15, 0.12),
    "flowing_sliding": (0.2, 0.12),
}
QUICK_CASES = ("settling", "settling_sliding")  # Passes of the quick level


def line_contact(friction: float, y: FloatArray, z: FloatArray, poisson: float = 0.3) -> xr.Dataset:
    """Hertz' line contact of half-width and peak pressure 1 in plane strain."""
    stress = hertz_strip(y[:, None], z, 1.0, 1.0, poisson, friction=friction)
    fields = {name: (("x", "y", "z"), values[None]) for name, values in stress.items()}
    return xr.Dataset(fields, {"x": [0.0], "y": y, "z": z})


def contact_from_top(friction: float) -> xr.Dataset:
    """Stresses of the line contact from the top down, with the contact's peak pressure."""
    contact = line_contact(friction, np.linspace(-5.0, 5.0, 161), np.linspace(0.0, 1.75, 71))
    return contact.assign(hertz_max_pressure=1.0)


def top_stresses(friction: float) -> tuple[float, float]:
    """Least shear yield stress, on the top under the line contact, without yield and for shakedown with rho_yy."""
    stress = hertz_strip(np.linspace(-1, 1, 20001), 0.0, 1.0, 1.0, 0.3, friction=friction)

    def find_maximum(rho: float) -> float:
        return float(von_mises(stress | {"sigma_yy": stress["sigma_yy"] + rho}).max() / np.sqrt(3.0))

    return find_maximum(0.0), float(optimize.minimize_scalar(find_maximum, bounds=(-2, 2), options={"xatol": 1e-9}).fun)


def shakedown_checks() -> Iterator[Check]:
    """Limits of line contacts."""
    case, quantity = "line contact without friction", "p0 / k"
    plane_limits, axial_limits = (shakedown_limit(contact_from_top(0.0), axial=axial) for axial in (False, True))
    first_yield_limit, limit = plane_limits["first_yield_limit"], axial_limits["shakedown_limit"]
    on_axis = von_mises(hertz_strip(0.0, np.linspace(0.5, 1.0, 5001), 1.0, 1.0, 0.3)).max() / np.sqrt(3.0)
    yield_quantity = f"{quantity} at first yield"
    yield Reference(case, "McEwen (1949)").compare(yield_quantity, first_yield_limit, 1 / on_axis, 2e-3, relative=True)
    yield Reference(case, "Johnson (1962)").compare(f"{quantity} at shakedown", limit, 4.0, 2e-3, relative=True)
    for friction in (0.4, 0.6):
        top = shakedown(contact_from_top(friction)).isel(x=0, z=0)
        reference = Reference(f"top of a line contact, friction {friction:g}", "closed form, one-dimensional search")
        for name, expected in zip(("first_yield_stress", "shakedown_stress"), top_stresses(friction), strict=True):
            yield reference.compare(f"{name} / p0", top[name], expected, 1e-3)


def residual_checks() -> Iterator[Check]:
    """Residual stress of given eigenstrains."""
    body = HalfSpace(material=STIFF)
    edges = np.linspace(-0.7, 0.7, 15), np.linspace(0.1, 1.5, 15)
    x, z = (0.5 * (axis_edges[1:] + axis_edges[:-1]) for axis_edges in edges)
    in_rectangle = ((np.abs(x) < 0.3)[:, None] & (np.abs(z - 0.8) < 0.3)).astype(float)
    eigenstrain = (1.0, 0.5, -0.3, 0.4)
    pairs = zip(("xx", "yy", "zz", "xz"), eigenstrain, strict=True)
    fields = {f"plastic_strain_{pair}": (("x", "z"), value * in_rectangle) for pair, value in pairs}
    strains = xr.Dataset(fields, {"x": x, "z": z})
    at_x, at_z = np.array([-0.9, -0.15, 0.05, 0.45]), np.array([0.05, 0.35, 0.75, 0.9, 1.4])
    stress = eigenstrain_stress(body, strains, at_x, at_z, x_edges=edges[0], z_edges=edges[1])
    source = "Muskhelishvili's forces in a half-plane, on the sides of the rectangle"
    reference = Reference("eigenstrain in a rectangle of a half-space", source)
    expected = rectangle_in_half_plane(
        at_x[:, None], at_z, (-0.3, 0.3), (0.5, 1.1), eigenstrain, young=STIFF.young, poisson=STIFF.poisson
    )
    max_stress_exact = np.abs(expected).max()
    for name, exact in zip(("sigma_xx", "sigma_yy", "sigma_zz", "tau_xz"), expected, strict=True):
        computed, exact = stress[name] / max_stress_exact, exact / max_stress_exact
        yield reference.compare(f"{name} over the largest stress", computed, exact, 1e-4)
    finite_body = FiniteLengthSpace(length=1.0, material=STIFF)
    depth_edges = np.array([0.0, 0.2, 0.5, 1.0, 2.0, 4.0, 6.0])
    x, z = np.array([0.125, 0.375, 0.625, 0.875]), 0.5 * (depth_edges[1:] + depth_edges[:-1])
    uniform = (("x", "z"), np.ones((4, 6)))
    thermal_strain = xr.Dataset({"plastic_strain_xx": uniform, "plastic_strain_zz": uniform}, {"x": x, "z": z})
    stress = eigenstrain_stress(finite_body, thermal_strain, x=[0.05, 0.4], z=[0.02, 0.3], z_edges=depth_edges)
    max_stress = max(float(abs(stress[name]).max()) for name in STRESSES) / STIFF.young
    case = "uniform eigenstrains xx and zz in a body between ends"
    yield Reference(case, "compatible strain").compare("largest stress / E", max_stress, 0.0, 1e-5)
    plastic_strain = xr.Dataset({"plastic_strain_yy": uniform}, {"x": x, "z": z})
    stress = eigenstrain_stress(finite_body, plastic_strain, x=[0.05, 0.4], z=[0.02, 0.3], z_edges=depth_edges)
    axial = float(stress["sigma_yy"].mean()) / STIFF.young
    reference = Reference("uniform eigenstrain yy in a body between ends", "Hooke's law")
    yield reference.compare("sigma_yy / E", axial, -1.0, 1e-5)


def pass_checks() -> Iterator[Check]:
    """Flow on either side of the shakedown limit."""
    contact = contact_from_top(0.0).drop_vars("hertz_max_pressure").isel(z=slice(8, None, 2))
    body = HalfSpace(material=STIFF)
    reference = Reference("passes of a line contact without friction", "Melan; Johnson's p0 = 4 k")
    settling = ElasticPlastic(yield_stress=np.sqrt(3.0) / 4 * 1.03)
    flow = residual_stress(contact, body, settling, passes=5)["plastic_flow"].values
    yield reference.compare("last flow over the first, 3 % below the limit", flow[-1] / flow[0], 0.0, 1e-3)
    yielding_material = ElasticPlastic(yield_stress=np.sqrt(3.0) / 4 * 0.97, kinematic_hardening=5.0)
    flow = residual_stress(contact, body, yielding_material, passes=5)["plastic_flow"].values
    yield reference.compare("fifth flow over the fourth, 3 % above the limit", flow[-1] / flow[-2], 1.0, 0.05)


def finite_element_checks(name: str) -> Iterator[Check]:
    """Residual stress and plastic shear of each pass against finite elements."""
    case, stored = PASSES_CASES[name], load_reference(PASSES_FILE, name)
    z, tolerances = stored["z"].values, TOLERANCES[name]
    contact = line_contact(case.friction, np.linspace(-4.0, 4.0, 129), z, case.poisson)
    hardening = STIFF.young * case.kinematic_hardening
    plastic = ElasticPlastic(yield_stress=np.sqrt(3.0) * case.shear_yield_stress, kinematic_hardening=hardening)
    body = HalfSpace(material=Material(STIFF.young, case.poisson))
    passes = residual_stress(contact, body, plastic, case.passes).isel(x=0)
    # The passes end once the residual stress is steady.
    passes = passes.reindex(pass_number=np.arange(1, case.passes + 1), method="ffill")
    last_pass = passes.isel(pass_number=-1)
    max_residual = max(float(np.abs(stored[component]).max()) for component in ("sigma_xx", "sigma_yy"))
    label = f"{name}: p0 = {1 / case.shear_yield_stress:.3g} k, f = {case.friction:g}, {case.passes} passes"
    origin = "finite elements (scikit-fem), own error"
    for component in ("sigma_xx", "sigma_yy"):
        computed, expected = last_pass[component].values / max_residual, stored[component].values / max_residual
        source = f"{origin} {stored[component].attrs['error_estimate'] / max_residual:.0e}"
        quantity = f"residual {component} over the largest"
        curve = Curve(("z / a", quantity), z, computed, expected) if component == "sigma_yy" else None
        yield Reference(label, source).compare(quantity, computed, expected, tolerances[0], curve=curve)
    strain, computed = stored["plastic_strain_yz_young"], STIFF.young * passes["plastic_strain_yz"].values
    sums, expected = (fields.sum(axis=-1) for fields in (computed, strain.values))
    source = f"{origin} {strain.attrs['error_estimate'] / float(np.abs(strain).max()):.0e} of the largest shear"
    quantity = "plastic shear yz summed over depth, after every pass, over the largest"
    max_expected = np.abs(expected).max()
    yield Reference(label, source).compare(quantity, sums / max_expected, expected / max_expected, tolerances[1])
