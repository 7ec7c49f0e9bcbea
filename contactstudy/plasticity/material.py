"""Elastic-plastic materials: von Mises' yield condition with linear hardening, uniform or over depth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import in_si
from contactstudy.case.magnitudes import warn_of_values
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError


@dataclass(frozen=True, kw_only=True, eq=False)
class ElasticPlastic:
    """Yield stress and linear hardening.

    Parameters
    ----------
    yield_stress : float or DataArray (z)
        Yield stress in tension, Pa; over depth with the coordinate `z` in metres, linear between the depths.
    isotropic_hardening : float
        Growth of the yield stress per equivalent plastic strain, Pa; 0 for none.
    kinematic_hardening : float
        Growth of the back stress in tension per plastic strain, Pa (Prager); 0 for none.

    Raises
    ------
    InvalidInputError
        If a yield stress is not positive, or a hardening modulus is negative.

    Warns
    -----
    MagnitudeWarning
        If the yield stress lies outside its usual range, which suggests a wrong unit.

    Examples
    --------
    >>> steel = ElasticPlastic(yield_stress=1.8e9, kinematic_hardening=10e9)
    >>> round(steel.shear_yield_stress / 1e9, 3)
    1.039
    """

    yield_stress: float | xr.DataArray
    isotropic_hardening: float = 0.0
    kinematic_hardening: float = 0.0

    def __post_init__(self) -> None:
        if isinstance(self.yield_stress, xr.DataArray):
            profile = in_si("yield_stress", self.yield_stress, "Pa")
            if profile.dims != ("z",) or "z" not in profile.coords:
                raise InvalidInputError("yield_stress.dims", profile.dims, "('z',) with depths z in metres")
            checks.increasing("yield_stress.z", profile["z"].values, "metres")
            checks.positive("yield_stress", float(checks.coordinates("yield_stress", profile.values, "Pa").min()), "Pa")
            checks.store(self, yield_stress=profile)
        else:
            checks.store(self, yield_stress=checks.positive("yield_stress", self.yield_stress, "Pa"))
        for name in ("isotropic_hardening", "kinematic_hardening"):
            checks.store(self, **{name: checks.not_negative(name, getattr(self, name), "Pa")})
        warn_of_values(stacklevel=4, yield_stress=np.asarray(self.yield_stress))

    @classmethod
    def from_hardness(cls, vickers: xr.DataArray, **hardening: float) -> ElasticPlastic:
        """Return a material whose yield stress is a third of its hardness (Tabor), such as case-hardened steel.

        Parameters
        ----------
        vickers : DataArray (z)
            Vickers hardness HV (kgf/mm2) over depth, coordinate `z` in metres.
        **hardening : float
            `isotropic_hardening`, `kinematic_hardening`.

        Examples
        --------
        >>> case = xr.DataArray([750.0, 450.0], {"z": [0.0, 1e-3]}, "z")
        >>> float(ElasticPlastic.from_hardness(case).yield_stress_at(np.array([0.5e-3]))[0].round(-7))
        1960000000.0
        """
        checks.instance("vickers", vickers, xr.DataArray, "an xarray.DataArray with the dimension z")
        if vickers.attrs.get("units", "HV") not in ("HV", "1"):
            raise InvalidInputError("vickers.attrs['units']", vickers.attrs["units"], "HV, or left out")
        # HV is in kgf/mm2; hardness over yield stress is 3 (D. Tabor, The Hardness of Metals, 1951).
        yield_stress = (vickers * (9.80665 * 1e6 / 3.0)).assign_attrs(units="Pa")
        return cls(yield_stress=yield_stress, **hardening)

    @property
    def shear_yield_stress(self) -> float:
        """Least yield stress in shear, ``k``, over sqrt(3) of that in tension, Pa."""
        return float(np.min(self.yield_stress)) / float(np.sqrt(3.0))

    def yield_stress_at(self, z: FloatArray) -> FloatArray:
        """Yield stress in tension at depths, Pa; beyond the given depths the nearest value."""
        if isinstance(self.yield_stress, xr.DataArray):
            return np.asarray(np.interp(z, self.yield_stress["z"].values, self.yield_stress.values))
        return np.full(z.shape, self.yield_stress)
