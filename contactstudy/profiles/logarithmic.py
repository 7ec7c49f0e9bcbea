"""Logarithmic profiles: Lundberg, Johns and Gohar, Fujiwara and Kawase, and the references of ISO/TS 16281."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any, Self

import numpy as np

from contactstudy import checks
from contactstudy.bodies import hertz
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import NOT_NEGATIVE_LENGTH, POSITIVE_LENGTH, Shape

EDGE_FACTOR = 0.5 / math.sqrt(math.e)  # Johns and Gohar's 0.3033, ``1 / (2 sqrt(e))``. Physics.


def logarithmic_drop(amplitude: float, t: FloatArray, factor: float = 1.0) -> FloatArray:
    """Drop ``A ln(1 / (1 - factor t**2))`` (m); at ``factor = 1`` infinite from ``|t| = 1`` on; 0 without amplitude."""
    if amplitude == 0:
        return np.zeros(np.shape(t))
    with np.errstate(divide="ignore"):
        return np.asarray(-amplitude * np.log1p(-factor * np.minimum(t**2, 1.0)))


class Logarithmic(Shape):
    """Base of the profiles with an amplitude from a design load."""

    amplitude: float

    @classmethod
    def for_pressure(cls, max_pressure: float, *, radius: float, modulus: float, **parameters: float) -> Self:
        """Profile with the amplitude ``A = R (p0 / E*)**2 = q / (pi E*)`` of a Hertz pressure at the design load.

        Parameters
        ----------
        max_pressure : float
            Peak pressure ``p0`` of the Hertz line contact at the design load, Pa.
        radius : float
            Roller radius, metres.
        modulus : float
            Contact modulus ``E*``, Pa.
        **parameters
            Further parameters of the profile.
        """
        pressure = checks.positive("max_pressure", max_pressure, "Pa")
        radius, modulus = checks.positive("radius", radius, "metres"), checks.positive("modulus", modulus, "Pa")
        half_width = hertz.line_half_width(pressure, radius, modulus)
        design_parameters = {"amplitude": radius * (pressure / modulus) ** 2, "half_width": half_width}
        profile_class: Any = cls
        names = [entry.name for entry in fields(profile_class) if entry.name in design_parameters]
        profile: Self = profile_class(**{name: design_parameters[name] for name in names} | parameters)
        return profile

    @classmethod
    def for_load(cls, load: float, *, length: float, radius: float, modulus: float, **parameters: float) -> Self:
        """Profile for a design load (N) on a roller.

        Parameters
        ----------
        load : float
            Design load, N.
        length : float
            Length of the loaded roller, metres.
        radius, modulus, **parameters
            As for ``for_pressure``.

        Examples
        --------
        >>> round(1e6 * Lundberg.for_load(1532.0, length=10e-3, radius=5e-3, modulus=230.77e9).amplitude, 4)
        0.2113
        """
        line_load = checks.positive("load", load, "N") / checks.positive("length", length, "metres")
        radius, modulus = checks.positive("radius", radius, "metres"), checks.positive("modulus", modulus, "Pa")
        pressure = hertz.line_max_pressure(line_load, radius, modulus)
        return cls.for_pressure(pressure, radius=radius, modulus=modulus, **parameters)


@dataclass(frozen=True, repr=False)
class Lundberg(Logarithmic):
    """Lundberg's logarithmic profile, ``drop = delta * A * ln(1 / (1 - (2 x / length)**2))``.

    With ``delta = 1`` the pressure of the design load on a half-space is uniform. The drop is infinite at the ends.

    Parameters
    ----------
    amplitude : float
        ``A = q / (pi E*) = R (p0 / E*)**2``, metres, see :meth:`for_pressure` and :meth:`for_load`. Not negative.
    delta : float
        Modification factor on the amplitude. Not negative; 0 is the cylinder.

    Raises
    ------
    InvalidInputError
        If a value is negative.

    References
    ----------
    G. Lundberg, Elastische Beruehrung zweier Halbraeume, Forschung auf dem Gebiet des Ingenieurwesens 10 (1939).

    Examples
    --------
    >>> profile = Lundberg.for_pressure(1.5e9, radius=5e-3, modulus=230.77e9)
    >>> round(1e6 * profile.amplitude, 4)
    0.2112
    """

    amplitude: float = field(metadata=NOT_NEGATIVE_LENGTH)
    delta: float = field(default=1.0, metadata=checks.number(checks.not_negative))

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length; infinite at the very ends."""
        return logarithmic_drop(self.delta * self.amplitude, 2 * np.asarray(x) / length)


@dataclass(frozen=True, repr=False)
class JohnsGohar(Logarithmic):
    """Johns and Gohar's profile: Lundberg's with a finite drop at the ends.

    ``drop = A ln(1 / (1 - (1 - 0.3033 b / h) (x / h)**2))`` with half the length ``h`` and
    ``0.3033 = 1 / (2 sqrt(e))``; the end drop is ``A ln(2 sqrt(e) h / b)``.

    Parameters
    ----------
    amplitude : float
        ``A = q / (pi E*)``, metres, as for :class:`Lundberg`. Not negative.
    half_width : float
        Hertz half-width ``b`` at the design load, metres. Not negative; 0 is Lundberg's profile; at most 3.3 h.

    Raises
    ------
    InvalidInputError
        If a value is negative, or (on use) the half-width is too large for the roller.

    References
    ----------
    P. M. Johns, R. Gohar, Roller bearings under radial and eccentric loads, Tribology International 14 (1981)
    131-136.

    Examples
    --------
    >>> profile = JohnsGohar.for_pressure(1.5e9, radius=5e-3, modulus=230.77e9)
    >>> round(1e6 * profile.edge_drop(length=10e-3), 3)
    1.169
    """

    amplitude: float = field(metadata=NOT_NEGATIVE_LENGTH)
    half_width: float = field(metadata=NOT_NEGATIVE_LENGTH)

    def edge_drop(self, length: float) -> float:
        """Drop (m) at the ends of a roller of the given `length` (m)."""
        return float(self.drop(np.array([length / 2]), length)[0])

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        factor = float(1 - EDGE_FACTOR * self.half_width / (length / 2))
        if factor < 0:
            allowed = f"at most 3.3 half lengths of the roller, {length / 2 / EDGE_FACTOR:g} m"
            raise InvalidInputError("half_width", self.half_width, allowed)
        return logarithmic_drop(self.amplitude, 2 * np.asarray(x) / length, factor)


@dataclass(frozen=True, repr=False)
class FujiwaraKawase(Logarithmic):
    """Fujiwara and Kawase's profile: a straight middle and a logarithmic crown with a given end drop.

    ``drop = K1 A ln(1 / (1 - (1 - exp(-z_m / (K1 A))) t**2))`` with ``t = (|x| - h) / (K2 h) + 1`` and half the
    length ``h``, and 0 where ``t < 0``; the end drop is ``z_m``.

    Parameters
    ----------
    amplitude : float
        ``A = q / (pi E*)``, metres, as for :class:`Lundberg`. Positive.
    edge_drop : float
        Drop ``z_m`` at the ends, metres. Not negative.
    k1 : float
        Factor ``K1`` on the design load. Positive.
    k2 : float
        Crowned fraction ``K2`` of each half of the roller; above 0, at most 1.

    Raises
    ------
    InvalidInputError
        If a value is out of range.

    References
    ----------
    H. Fujiwara, T. Kawase, Logarithmic profiles of rollers in roller bearings and optimization of the profiles,
    NTN Technical Review 75 (2007) 140-148.

    Examples
    --------
    >>> profile = FujiwaraKawase(amplitude=0.2e-6, edge_drop=5e-6, k1=2.0, k2=0.5)
    >>> profile.drop(np.array([0.0, 2.5e-3, 5e-3]), length=10e-3).round(12).tolist()
    [0.0, 0.0, 5e-06]
    """

    amplitude: float = field(metadata=POSITIVE_LENGTH)
    edge_drop: float = field(metadata=NOT_NEGATIVE_LENGTH)
    k1: float = field(default=1.0, metadata=checks.number(checks.positive))
    k2: float = field(default=1.0, metadata=checks.number(checks.positive))

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.k2 > 1:
            raise InvalidInputError("k2", self.k2, "at most 1, the whole half of the roller")

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        half_length = length / 2
        scale = self.k1 * self.amplitude
        t = np.clip((np.abs(x) - half_length) / (self.k2 * half_length) + 1, 0.0, 1.0)
        end = np.exp(-self.edge_drop / scale)
        # two forms of 1 - (1 - end) t**2: exact near 1, and near 0
        with np.errstate(divide="ignore"):
            logarithm = np.where(t < 0.5, np.log1p((end - 1) * t**2), np.log((1 - t) * (1 + t) + end * t**2))
        return np.asarray(np.clip(-scale * logarithm, 0.0, self.edge_drop))


@dataclass(frozen=True, repr=False)
class IsoCylindrical(Shape):
    """Reference profile of a cylindrical roller.

    For ``length <= 2.5 D``: ``drop = 0.00035 D ln(1 / (1 - (2 x / length)**2))``. For a longer roller: straight for
    ``|x| <= (length - 2.5 D) / 2``, then ``drop = 0.0005 D ln(1 / (1 - ((2 |x| - length + 2.5 D) / (2.5 D))**2))``.

    Parameters
    ----------
    diameter : float
        Diameter ``D`` of the roller, metres. The length is the effective length, without corners.

    Raises
    ------
    InvalidInputError
        If the diameter is not positive.

    References
    ----------
    ISO/TS 16281:2008.

    Examples
    --------
    >>> (1e6 * IsoCylindrical(diameter=10e-3).drop(np.array([0.0, 4e-3]), length=10e-3)).round(3).tolist()
    [0.0, 3.576]
    """

    diameter: float = field(metadata=POSITIVE_LENGTH)

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length; infinite at the very ends."""
        max_crowned_length = 2.5 * self.diameter  # Length up to which the whole roller is crowned
        if length <= max_crowned_length:
            return logarithmic_drop(0.00035 * self.diameter, 2 * np.asarray(x) / length)
        distance = np.maximum(2 * np.abs(x) - (length - max_crowned_length), 0.0)
        return logarithmic_drop(0.0005 * self.diameter, distance / max_crowned_length)


@dataclass(frozen=True, repr=False)
class IsoTapered(Shape):
    """Reference profile of a tapered roller: ``drop = 0.00045 D ln(1 / (1 - (2 x / length)**2))``.

    The drop is relative to the cone; add :class:`Tapered` for a cone on a surface parallel to the axis.

    Parameters
    ----------
    diameter : float
        Mean diameter ``D`` of the roller, metres. The length is the effective length, without corners.

    Raises
    ------
    InvalidInputError
        If the diameter is not positive.

    References
    ----------
    ISO/TS 16281:2008.

    Examples
    --------
    >>> (1e6 * IsoTapered(diameter=10e-3).drop(np.array([0.0, 4e-3]), length=10e-3)).round(3).tolist()
    [0.0, 4.597]
    """

    diameter: float = field(metadata=POSITIVE_LENGTH)

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length; infinite at the very ends."""
        return logarithmic_drop(0.00045 * self.diameter, 2 * np.asarray(x) / length)
