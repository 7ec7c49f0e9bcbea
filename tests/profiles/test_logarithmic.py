"""Logarithmic profiles and the references of ISO/TS 16281."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import InvalidInputError, Material
from contactstudy.bodies.hertz import line_load
from contactstudy.profiles import Cylinder, FujiwaraKawase, IsoCylindrical, IsoTapered, JohnsGohar, Lundberg
from tests.profiles.conftest import LENGTH, PRESSURE, RADIUS, list_axial_results

HALF_LENGTH = LENGTH / 2


def test_lundberg_equals_two_logarithms(positions: np.ndarray) -> None:
    """The drop is a sum of logarithms of the distances to both ends."""
    profile = Lundberg(amplitude=2e-7, delta=1.5)
    inner_positions = positions[1:-1]
    expected = (
        -1.5
        * 2e-7
        * (np.log(HALF_LENGTH - inner_positions) + np.log(HALF_LENGTH + inner_positions) - 2 * np.log(HALF_LENGTH))
    )
    np.testing.assert_allclose(profile.drop(inner_positions, LENGTH), expected, rtol=1e-12, atol=1e-20)
    assert np.isinf(profile.drop(positions[[0, -1]], LENGTH)).all()


def test_lundberg_amplitude_follows_from_the_load(steel: Material) -> None:
    modulus = steel.plane_strain_modulus
    half_width = 2 * PRESSURE * RADIUS / modulus
    load_per_length = 0.5 * np.pi * half_width * PRESSURE
    amplitude = Lundberg.for_pressure(PRESSURE, radius=RADIUS, modulus=modulus).amplitude
    assert amplitude == pytest.approx(load_per_length / (np.pi * modulus))


def test_zero_amplitude_has_no_drop(positions: np.ndarray) -> None:
    for profile in (Lundberg(0.0), Lundberg(1e-6, delta=0.0), JohnsGohar(0.0, 1e-5)):
        np.testing.assert_array_equal(profile.drop(positions, LENGTH), 0.0)


def test_lundberg_pressure_is_flat_at_the_design_load(solve_profile, steel: Material) -> None:
    """On a half-space the pressure is flat to 1.2 % over nine tenths of a length of 62 half-widths.

    The pressure of a sharp cylinder varies by 11 %, that of a delta of 0.7 or 1.4 by more than twice 1.2 %.
    """

    def compute_variation(profile) -> float:
        position, peak, _ = list_axial_results(solve_profile(profile, 4e-3))
        inner_peaks = peak[np.abs(position) < 0.9]
        return float(np.ptp(inner_peaks))

    def make_lundberg(delta: float) -> Lundberg:
        return Lundberg.for_pressure(PRESSURE, radius=RADIUS, modulus=steel.plane_strain_modulus, delta=delta)

    reference_variation = compute_variation(make_lundberg(1.0))
    assert reference_variation < 0.012
    assert compute_variation(Cylinder()) > 0.1
    assert min(compute_variation(make_lundberg(0.7)), compute_variation(make_lundberg(1.4))) > 2 * reference_variation


def test_lundberg_pressure_decreases_outwards_below_the_design_load(solve_profile, steel: Material) -> None:
    profile = Lundberg.for_pressure(2 * PRESSURE, radius=RADIUS, modulus=steel.plane_strain_modulus)
    position, peak, _ = list_axial_results(solve_profile(profile, 4e-3))
    second_half = position > 0
    assert (np.diff(peak[second_half]) <= 0).all()
    assert np.interp(0.9, position, peak) < 0.8
    assert peak[-40] == 0.0


def test_end_drop_of_johns_and_gohar(steel: Material) -> None:
    """The published end drop is A ln(2 sqrt(e) h / b) = A (1.1932 + ln(h / b)), h half the length."""
    profile = JohnsGohar.for_pressure(PRESSURE, radius=RADIUS, modulus=steel.plane_strain_modulus)
    expected = profile.amplitude * (1.1932 + np.log(HALF_LENGTH / profile.half_width))
    assert profile.edge_drop(LENGTH) == pytest.approx(expected, rel=1e-5)
    assert profile.half_width == pytest.approx(65e-6)


def test_johns_gohar_profile_equals_formula_with_rounded_constant(positions: np.ndarray) -> None:
    profile = JohnsGohar(amplitude=2e-7, half_width=1e-4)
    expected = 2e-7 * np.log(1 / (1 - (1 - 0.3033 * 1e-4 / HALF_LENGTH) * (2 * positions / LENGTH) ** 2))
    np.testing.assert_allclose(profile.drop(positions, LENGTH), expected, rtol=1e-4, atol=1e-22)


@given(st.floats(1e-9, 1e-5), st.floats(1e-7, 1e-3))
def test_fujiwara_and_kawase_contain_johns_and_gohar(amplitude: float, half_width: float) -> None:
    x = HALF_LENGTH * np.linspace(-1, 1, 41)
    johns_gohar = JohnsGohar(amplitude, half_width)
    fujiwara_kawase = FujiwaraKawase(amplitude, edge_drop=johns_gohar.edge_drop(LENGTH))
    np.testing.assert_allclose(
        fujiwara_kawase.drop(x, LENGTH), johns_gohar.drop(x, LENGTH), rtol=1e-7, atol=1e-9 * amplitude
    )


@given(st.floats(1e-9, 1e-5))
def test_johns_gohar_and_fujiwara_contain_lundberg(amplitude: float) -> None:
    x = HALF_LENGTH * np.linspace(-0.999, 0.999, 41)
    lundberg_drop = Lundberg(amplitude).drop(x, LENGTH)
    np.testing.assert_allclose(JohnsGohar(amplitude, 0.0).drop(x, LENGTH), lundberg_drop, rtol=1e-12)
    deep_profile = FujiwaraKawase(amplitude, edge_drop=60 * amplitude)
    np.testing.assert_allclose(deep_profile.drop(x, LENGTH), lundberg_drop, rtol=1e-9, atol=1e-12 * amplitude)


def test_fujiwara_and_kawase_equals_paper(positions: np.ndarray) -> None:
    """The formula of the paper: crowned length a' of one side, distance y from the roller's end."""
    amplitude, k1, k2, end_drop = 1.3e-7, 2.0, 0.6, 4e-6
    profile = FujiwaraKawase(amplitude, end_drop, k1, k2)
    crown_length = k2 * HALF_LENGTH
    end_distance = HALF_LENGTH - np.abs(positions)
    scaled_distance = np.where(end_distance < crown_length, 1 - end_distance / crown_length, 0.0)
    expected = k1 * amplitude * np.log(1 / (1 - (1 - np.exp(-end_drop / (k1 * amplitude))) * scaled_distance**2))
    np.testing.assert_allclose(profile.drop(positions, LENGTH), expected, rtol=1e-7, atol=1e-20)
    assert profile.drop(positions, LENGTH)[[0, -1]] == pytest.approx(end_drop)
    assert (profile.drop(positions, LENGTH)[end_distance > crown_length] == 0).all()


def test_design_pressure_of_fujiwara_kawase_determines_amplitude(steel: Material) -> None:
    contact = {"radius": RADIUS, "modulus": steel.plane_strain_modulus}
    profile = FujiwaraKawase.for_pressure(PRESSURE, edge_drop=1e-6, k1=2.0, k2=0.5, **contact)
    assert profile == FujiwaraKawase(Lundberg.for_pressure(PRESSURE, **contact).amplitude, 1e-6, 2.0, 0.5)


@pytest.mark.parametrize(
    ("create", "message"),
    [
        (lambda: Lundberg(-1e-6), "amplitude = -1e-06"),
        (lambda: Lundberg(1e-6, delta=np.inf), "delta = inf"),
        (lambda: Lundberg.for_pressure(-1.0, radius=1.0, modulus=1.0), "max_pressure = -1.0"),
        (lambda: Lundberg.for_pressure(1.0, radius=0.0, modulus=1.0), "radius = 0.0"),
        (lambda: Lundberg.for_pressure(1.0, radius=1.0, modulus="steel"), "modulus = 'steel'"),
        (lambda: JohnsGohar(1e-6, -1e-6), "half_width = -1e-06"),
        (lambda: JohnsGohar(1e-6, 0.1).drop(np.zeros(1), LENGTH), "half_width = 0.1: must be at most"),
        (lambda: FujiwaraKawase(0.0, 1e-6), "amplitude = 0.0"),
        (lambda: FujiwaraKawase(1e-6, -1e-6), "edge_drop = -1e-06"),
        (lambda: FujiwaraKawase(1e-6, 1e-6, k1=0.0), "k1 = 0.0"),
        (lambda: FujiwaraKawase(1e-6, 1e-6, k2=1.5), "k2 = 1.5: must be at most 1"),
    ],
)
def test_invalid_argument_raises(create, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        create()


@pytest.mark.parametrize(
    ("profile_class", "parameters"),
    [(Lundberg, {"delta": 0.9}), (JohnsGohar, {}), (FujiwaraKawase, {"edge_drop": 1e-6})],
)
def test_design_load_gives_the_hertz_pressure(profile_class, parameters: dict[str, float], steel: Material) -> None:
    contact = {"radius": RADIUS, "modulus": steel.plane_strain_modulus}
    load = line_load(PRESSURE, **contact) * 0.8 * LENGTH
    profile_by_load = profile_class.for_load(load, length=0.8 * LENGTH, **contact, **parameters)
    profile_by_pressure = profile_class.for_pressure(PRESSURE, **contact, **parameters)
    assert profile_by_load.amplitude == pytest.approx(profile_by_pressure.amplitude, rel=1e-12)
    x = np.linspace(-0.49, 0.49, 11) * LENGTH
    np.testing.assert_allclose(profile_by_load.drop(x, LENGTH), profile_by_pressure.drop(x, LENGTH), rtol=1e-9)
    with pytest.raises(InvalidInputError, match="length = 0"):
        profile_class.for_load(load, length=0, **contact, **parameters)


DIAMETER = 10e-3


def test_short_iso_profile_equals_standard() -> None:
    """The formula of the standard in millimetres, with the decadic logarithm."""
    length, x = 12.0, np.linspace(-5.9, 5.9, 31)
    expected = 0.00035 * 10.0 * np.log10(1 / (1 - (2 * x / length) ** 2)) * np.log(10)
    np.testing.assert_allclose(1e3 * IsoCylindrical(DIAMETER).drop(1e-3 * x, 12e-3), expected, rtol=1e-12)


def test_long_iso_profile_equals_standard() -> None:
    length = 40.0
    x = np.linspace(-19.9, 19.9, 81)
    crowned_distance = np.abs(x) - (length - 25.0) / 2
    expected = np.where(crowned_distance > 0, 0.0005 * 10 * np.log(1 / (1 - (crowned_distance / 12.5) ** 2)), 0.0)
    np.testing.assert_allclose(1e3 * IsoCylindrical(DIAMETER).drop(1e-3 * x, 40e-3), expected, rtol=1e-9, atol=1e-18)


def test_tapered_drop_is_nine_sevenths_of_the_cylindrical() -> None:
    x = np.linspace(-5e-3, 5e-3, 21)[1:-1]
    ratio = IsoTapered(DIAMETER).drop(x, 10e-3)[:9] / IsoCylindrical(DIAMETER).drop(x, 10e-3)[:9]
    np.testing.assert_allclose(ratio, 9 / 7)


@given(st.floats(-0.999, 0.999))
def test_iso_branches_differ_by_their_amplitudes(position: float) -> None:
    """At length = 2.5 D the straight middle vanishes; the standard's amplitudes are 0.00035 and 0.0005."""
    length = 2.5 * DIAMETER
    x = np.array([position * length / 2])
    profile = IsoCylindrical(DIAMETER)
    drop_at_limit, drop_above_limit = profile.drop(x, length), profile.drop(x, length * (1 + 1e-13))
    np.testing.assert_allclose(drop_above_limit, drop_at_limit * 0.0005 / 0.00035, rtol=1e-8, atol=1e-16)


def test_short_iso_profile_is_lundbergs_for_3000_megapascals() -> None:
    """The formula contains two bodies of steel with the 207 GPa and 0.3 of the standard."""
    modulus = 207e9 / (2 * (1 - 0.3**2))
    lundberg_profile = Lundberg.for_pressure(3000e6, radius=DIAMETER / 2, modulus=modulus)
    x = np.array([3e-3, 4.5e-3])
    np.testing.assert_allclose(IsoCylindrical(DIAMETER).drop(x, 10e-3), lundberg_profile.drop(x, 10e-3), rtol=1e-2)


def test_iso_drops_are_infinite_at_the_ends() -> None:
    for profile in (IsoCylindrical(DIAMETER), IsoTapered(DIAMETER)):
        for length in (10e-3, 40e-3):
            assert np.isinf(profile.drop(np.array([-length / 2, length / 2]), length)).all()


@pytest.mark.parametrize("profile_class", [IsoCylindrical, IsoTapered])
@pytest.mark.parametrize("diameter", [0.0, -1e-3, np.nan, "thick", True])
def test_invalid_diameter_raises(profile_class, diameter) -> None:
    with pytest.raises(InvalidInputError, match="diameter = "):
        profile_class(diameter)
