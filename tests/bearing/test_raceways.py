"""Two contacts in series."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError
from contactstudy.bearing import ContactLaw, Raceways

ARM = 1e-3


def springs(stiffness: float, arm: float = ARM) -> ContactLaw:
    """Two springs to either side of the middle."""
    approach, tilt = np.geomspace(5e-7, 2e-5, 9), np.linspace(-5e-4, 5e-4, 9)
    delta, theta = np.meshgrid(approach, tilt, indexing="ij")
    both = ("approach", "tilt")
    tilting = stiffness * arm**2
    table = xr.Dataset(
        {
            "normal_load": (both, stiffness * delta),
            "moment": (both, tilting * theta),
            "strain_energy": (both, 0.5 * stiffness * delta**2 + 0.5 * tilting * theta**2),
            "relative_load_error": 0.01,
            "relative_moment_error": 0.02,
            "contact_length": 2 * ARM,
        },
        {"approach": approach, "tilt": tilt},
    )
    return ContactLaw(table)


def test_compliances_of_two_raceways_add_up(short_law: ContactLaw) -> None:
    both = Raceways(short_law, short_law)
    found, one = both.at(3.2e-6, 8e-4), short_law.at(1.6e-6, 4e-4)
    assert float(found.inner_approach) == pytest.approx(1.6e-6, rel=1e-5)
    assert float(found.outer_tilt) == pytest.approx(4e-4, rel=1e-4)
    assert float(found.normal_load) == pytest.approx(float(one.normal_load), rel=1e-5)
    assert float(found.coupling_stiffness) == pytest.approx(0.5 * float(one.coupling_stiffness), rel=1e-3)
    under = both.under(float(one.normal_load), float(one.moment))
    assert float(under.approach) == pytest.approx(3.2e-6, rel=1e-5)
    assert float(under.tilt) == pytest.approx(8e-4, rel=1e-4)


def test_springs_in_series() -> None:
    both = Raceways(springs(2e7), springs(6e7))
    found = both.at(8e-6, 4e-4)
    assert float(found.inner_approach) == pytest.approx(6e-6, rel=2e-2)
    assert float(found.normal_load) == pytest.approx(1.5e7 * 8e-6, rel=2e-2)
    assert float(found.normal_stiffness) == pytest.approx(1.5e7, rel=5e-2)
    assert float(found.tilting_stiffness) == pytest.approx(1.5e7 * ARM**2, rel=0.1)
    assert float(found.normal_load_error) == pytest.approx(0.01 * float(found.normal_load))


def test_arguments_broadcast(short_law: ContactLaw) -> None:
    found = Raceways(short_law, short_law).at([2.5e-6, 4e-6], [0.0, 1e-4, 2e-4])
    assert dict(found.sizes) == {"approach": 2, "tilt": 3}
    assert bool((found.normal_load.diff("approach") > 0).all())
    under = Raceways(short_law, short_law).under([80.0, 100.0], [0.0, 4e-4, 8e-4])
    assert dict(under.approach.sizes) == {"normal_load": 2, "moment": 3}
    assert dict(under.normal_load_error.sizes) == {"normal_load": 2, "moment": 3}
    assert bool((under.tilt.diff("moment") > 0).all())


def test_stiffness_in_series(short_law: ContactLaw) -> None:
    both, delta = Raceways(short_law, springs(4e7)), 2.5e-6
    step = 1e-3 * delta
    found = both.at([delta - step, delta, delta + step], 3e-4)
    slope = float(found.normal_load[2] - found.normal_load[0]) / (2 * step)
    assert float(found.normal_stiffness[1]) == pytest.approx(slope, rel=1e-3)


def test_what_leaves_either_table_is_named(short_law: ContactLaw) -> None:
    both = Raceways(short_law, short_law)
    with pytest.raises(InvalidInputError, match="approach = 2e-05: must be in the tables of both"):
        both.at(2e-5)
    with pytest.raises(InvalidInputError, match="approach, tilt = "):
        Raceways(short_law, springs(1e12)).at(8e-6)
    with pytest.raises(InvalidInputError, match="outer"):
        Raceways(short_law, short_law.table)  # type: ignore[arg-type]
