"""Harmonics of the auxiliary bodies at one wavenumber along y: Hooke's law, equilibrium, conditions on the faces."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.overlapping import field as end_field
from contactstudy.overlapping.equations import AuxiliaryLoads, AxialModes, SingleMirrorModes, coupling_core

LATERAL, POISSON, LENGTH = 0.7, 0.3, 2.3
RAY = np.exp(0.4j) * np.array([0.3, 1.1, 2.6])
RNG = np.random.default_rng(0)
WEIGHTS = RNG.standard_normal((8, 2)) + 1j * RNG.standard_normal((8, 2))
MODES = {
    "one end": AxialModes(length=np.inf, parity=0, discrete=np.zeros(0), ray=RAY, weights=np.ones(3, np.complex128)),
    "even": AxialModes(
        length=LENGTH,
        parity=1,
        discrete=np.pi / LENGTH * np.array([0.0, 2.0]),
        ray=RAY,
        weights=np.ones(3, np.complex128),
    ),
    "odd": AxialModes(
        length=LENGTH,
        parity=-1,
        discrete=np.pi / LENGTH * np.array([1.0, 3.0]),
        ray=RAY,
        weights=np.ones(3, np.complex128),
    ),
    "even, mirrored once": SingleMirrorModes(
        length=LENGTH, parity=1, discrete=np.zeros(0), ray=RAY, weights=np.ones(3, np.complex128)
    ),
    "odd, mirrored once": SingleMirrorModes(
        length=LENGTH, parity=-1, discrete=np.zeros(0), ray=RAY, weights=np.ones(3, np.complex128)
    ),
}
X, Z = np.array([0.3, 0.9, 1.4]), np.array([0.2, 0.8, 1.9])
STEP = 1e-4
Field = Callable[[FloatArray, FloatArray], FloatArray]


def make_loads(
    modes: AxialModes, *, equivalent: ComplexArray, depth: ComplexArray, face: ComplexArray
) -> AuxiliaryLoads:
    """Loads of one direction on the auxiliary bodies."""
    return AuxiliaryLoads(
        modes=modes,
        lateral=np.array([LATERAL]),
        poisson=POISSON,
        equivalent_load=[equivalent[None]],
        depth=depth,
        counts=[depth.size],
        face_load=[face],
    )


def make_field_of_h(modes: AxialModes, field: Callable[..., FloatArray]) -> Field:
    """Field of H under an equivalent load of two columns."""
    loads = make_loads(modes, equivalent=WEIGHTS[: modes.wavenumbers.size], depth=RAY[:2], face=WEIGHTS[:2])
    return lambda x, z: field(loads, modes.cosine(x), modes.sine(x), z)[0, ..., 0, :]


def make_field_of_v(
    modes: AxialModes, field: Callable[..., FloatArray], depth: ComplexArray = RAY[:2], load: ComplexArray = WEIGHTS[:2]
) -> Field:
    """Field of V under face loads of two columns."""
    loads = make_loads(modes, equivalent=WEIGHTS[: modes.wavenumbers.size], depth=depth, face=load)
    return lambda x, z: field(loads, x, z)[0, ..., 0, :]


def compute_derivative(field: Field, axis: int) -> FloatArray:
    """Derivative along x (0) or z (1) at the points."""
    field_ahead, field_behind = (field(X + step, Z) if axis == 0 else field(X, Z + step) for step in (STEP, -STEP))
    return np.asarray((field_ahead - field_behind) / (2 * STEP))


FIELDS = (end_field._stress_of_face_load, end_field._displacement_of_face_load)
BODIES = {
    "below": (make_field_of_h, end_field._displacement_of_equivalent_load, end_field._stress_of_equivalent_load),
    "beside": (make_field_of_v, end_field._displacement_of_face_load, end_field._stress_of_face_load),
}


@pytest.mark.parametrize("name", MODES)
@pytest.mark.parametrize("body", BODIES)
def test_stresses_follow_hookes_law_in_equilibrium(body: str, name: str) -> None:
    """Even components are proportional to ``cos(k y)``, odd ones to ``-sin(k y)``; displacements are times ``2 G``."""
    create_field, displacement_harmonic, stress_harmonic = BODIES[body]
    displacement, stress = create_field(MODES[name], displacement_harmonic), create_field(MODES[name], stress_harmonic)
    (ux, uy, uz), derivative_x, derivative_z = (
        displacement(X, Z),
        compute_derivative(displacement, 0),
        compute_derivative(displacement, 1),
    )
    direct_strains = np.array([derivative_x[0], -LATERAL * uy, derivative_z[2]])
    normal = direct_strains + POISSON / (1 - 2 * POISSON) * direct_strains.sum(axis=0)
    shear = 0.5 * np.array(
        [LATERAL * ux + derivative_x[1], derivative_z[0] + derivative_x[2], derivative_z[1] + LATERAL * uz]
    )
    computed = stress(X, Z)
    yy, xy, yz = computed[[1, 3, 5]]
    assert computed == pytest.approx(np.concatenate([normal, shear]), abs=1e-6 * np.abs(computed).max())
    stress_derivative_x, stress_derivative_z = compute_derivative(stress, 0), compute_derivative(stress, 1)
    balance = (
        stress_derivative_x[0] - LATERAL * xy + stress_derivative_z[4],
        stress_derivative_x[3] + LATERAL * yy + stress_derivative_z[5],
        stress_derivative_x[4] - LATERAL * yz + stress_derivative_z[2],
    )
    assert np.abs(balance).max() < 1e-5 * np.abs(stress_derivative_x).max()


@pytest.mark.parametrize("name", MODES)
def test_top_of_h_carries_equivalent_load(name: str) -> None:
    modes = MODES[name]
    computed = make_field_of_h(modes, end_field._stress_of_equivalent_load)(X, np.zeros(1))[:, :, 0]
    load = np.real(modes.cosine(X).T @ WEIGHTS[: modes.wavenumbers.size])
    assert computed[2] == pytest.approx(-load)
    assert np.abs(computed[4:]).max() < 1e-12 * np.abs(computed).max()


@pytest.mark.parametrize("name", MODES)
def test_faces_and_top_of_v_have_no_shear(name: str) -> None:
    modes = MODES[name]
    faces = np.array([0.0, modes.length]) if modes.parity else np.zeros(1)
    computed = make_field_of_v(modes, end_field._stress_of_face_load)(faces, Z)
    kappa = np.sqrt(RAY[:2] ** 2 + LATERAL**2)
    face_stress = np.real(np.exp(1j * np.outer(Z, RAY[:2])) @ WEIGHTS[:2])
    if isinstance(modes, SingleMirrorModes):
        # Each half-space has a load; the load on the opposite half-space causes normal stress and shear on the face.
        applied_stress = np.exp(1j * np.outer(Z, RAY[:2])) @ (modes.load_on_face(kappa)[:, None] * WEIGHTS[:2])
        single_mirror = SingleMirrorModes(length=1e3, parity=1, discrete=np.zeros(0), ray=RAY, weights=modes.weights)
        assert make_field_of_v(single_mirror, end_field._stress_of_face_load)(faces[:1], Z)[0, 0] == pytest.approx(
            face_stress
        )
        assert np.abs(np.real(applied_stress) - face_stress).max() > 1e-3 * np.abs(face_stress).max()
    else:
        assert np.abs(computed[3:5]).max() < 1e-12 * np.abs(computed).max()
    assert computed[0, 0] == pytest.approx(face_stress)
    if modes.parity:
        assert computed[0, 1] == pytest.approx(modes.parity * face_stress)
    # For cosines along z the top has neither shear nor a normal displacement.
    real_rays, top_depth = (RAY[:2].real + 0j, WEIGHTS[:2].real + 0j), np.zeros(1)
    stress, displacement = (
        create_field(modes, harmonic, *real_rays)
        for create_field, harmonic in zip([make_field_of_v] * 2, FIELDS, strict=True)
    )
    assert np.abs(stress(X, top_depth)[4:]).max() < 1e-12 * np.abs(stress(X, Z)).max()
    assert np.abs(displacement(X, top_depth)[2]).max() < 1e-12 * np.abs(displacement(X, Z)).max()


def compute_weighted_spectrum(modes: AxialModes, load: Callable[[FloatArray], FloatArray]) -> ComplexArray:
    """Weighted spectrum of a load on the top between the ends, by Gauss's rule."""
    nodes, rule = np.polynomial.legendre.leggauss(80)
    x = 0.5 * modes.length * (nodes + 1)
    return np.asarray(modes.load_weights * (modes.cosine(x) @ (0.5 * modes.length * rule * load(x))))


@pytest.mark.parametrize("name", ["even", "odd"])
def test_normal_stress_of_v_on_top_equals_its_spectrum(name: str) -> None:
    """The spectrum contains the stress per scaled face load for each discrete wavenumber."""
    modes = MODES[name]
    depth = np.array([0.4, 1.7])
    kappa = np.sqrt(depth**2 + LATERAL**2)
    factor = np.real(modes.face_factor(kappa))
    core = coupling_core(modes.wavenumbers, depth, LATERAL, POISSON)
    computed = modes.load_on_top(core, depth, LATERAL, POISSON)
    for index in range(2):
        unit_load, wavenumber = np.ones((1, 1), np.complex128), depth[index : index + 1] + 0j
        stress = make_field_of_v(modes, end_field._stress_of_face_load, wavenumber, unit_load)

        def load(x: FloatArray, stress: Field = stress) -> FloatArray:
            return np.asarray(stress(x, np.zeros(1))[2, :, 0, 0])

        expected = compute_weighted_spectrum(modes, load) * kappa[index] / factor[index]
        assert computed[: modes.discrete.size, index] == pytest.approx(expected[: modes.discrete.size])
