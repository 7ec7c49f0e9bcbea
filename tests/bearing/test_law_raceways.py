"""Contact laws of two raceways in series."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError
from contactstudy.bearing import ContactLaw, Raceways

ARM = 1e-3


def make_spring_law(stiffness: float, arm: float = ARM) -> ContactLaw:
    """Contact law of linear springs on both sides of mid-length."""
    approach, tilt = np.geomspace(5e-7, 2e-5, 9), np.linspace(-5e-4, 5e-4, 9)
    delta, theta = np.meshgrid(approach, tilt, indexing="ij")
    dims = ("approach", "tilt")
    tilting_stiffness = stiffness * arm**2
    table = xr.Dataset(
        {
            "normal_load": (dims, stiffness * delta),
            "moment": (dims, tilting_stiffness * theta),
            "strain_energy": (dims, 0.5 * stiffness * delta**2 + 0.5 * tilting_stiffness * theta**2),
            "relative_load_error": 0.01,
            "relative_moment_error": 0.02,
            "contact_length": 2 * ARM,
        },
        {"approach": approach, "tilt": tilt},
    )
    return ContactLaw(table)


def test_compliances_of_raceways_add_up(short_law: ContactLaw) -> None:
    raceways = Raceways(short_law, short_law)
    motion, single_motion = raceways.at(3.2e-6, 8e-4), short_law.at(1.6e-6, 4e-4)
    assert float(motion.inner_approach) == pytest.approx(1.6e-6, rel=1e-5)
    assert float(motion.outer_tilt) == pytest.approx(4e-4, rel=1e-4)
    assert float(motion.normal_load) == pytest.approx(float(single_motion.normal_load), rel=1e-5)
    assert float(motion.coupling_stiffness) == pytest.approx(0.5 * float(single_motion.coupling_stiffness), rel=1e-3)
    assert float(single_motion.reference_depth) == np.inf
    assert float(motion.inner_reference_depth) == float(motion.outer_reference_depth) == np.inf
    loaded_motion = raceways.under(float(single_motion.normal_load), float(single_motion.moment))
    assert float(loaded_motion.approach) == pytest.approx(3.2e-6, rel=1e-5)
    assert float(loaded_motion.tilt) == pytest.approx(8e-4, rel=1e-4)


def test_raceways_of_springs_equal_springs_in_series() -> None:
    raceways = Raceways(make_spring_law(2e7), make_spring_law(6e7))
    motion = raceways.at(8e-6, 4e-4)
    assert float(motion.inner_approach) == pytest.approx(6e-6, rel=2e-2)
    assert float(motion.normal_load) == pytest.approx(1.5e7 * 8e-6, rel=2e-2)
    assert float(motion.normal_stiffness) == pytest.approx(1.5e7, rel=5e-2)
    assert float(motion.tilting_stiffness) == pytest.approx(1.5e7 * ARM**2, rel=0.1)
    assert float(motion.normal_load_error) == pytest.approx(0.01 * float(motion.normal_load))


def test_raceways_broadcast_arguments(short_law: ContactLaw) -> None:
    motion = Raceways(short_law, short_law).at([2.5e-6, 4e-6], [0.0, 1e-4, 2e-4])
    assert dict(motion.sizes) == {"approach": 2, "tilt": 3}
    assert bool((motion.normal_load.diff("approach") > 0).all())
    loaded_motion = Raceways(short_law, short_law).under([80.0, 100.0], [0.0, 4e-4, 8e-4])
    assert dict(loaded_motion.approach.sizes) == {"normal_load": 2, "moment": 3}
    assert dict(loaded_motion.normal_load_error.sizes) == {"normal_load": 2, "moment": 3}
    assert bool((loaded_motion.tilt.diff("moment") > 0).all())


def test_stiffness_of_raceways_equals_difference_quotient(short_law: ContactLaw) -> None:
    raceways, delta = Raceways(short_law, make_spring_law(4e7)), 2.5e-6
    step = 1e-3 * delta
    motion = raceways.at([delta - step, delta, delta + step], 3e-4)
    slope = float(motion.normal_load[2] - motion.normal_load[0]) / (2 * step)
    assert float(motion.normal_stiffness[1]) == pytest.approx(slope, rel=1e-3)


def test_argument_outside_table_raises(short_law: ContactLaw) -> None:
    raceways = Raceways(short_law, short_law)
    with pytest.raises(InvalidInputError, match="approach = 2e-05: must be in the tables of both"):
        raceways.at(2e-5)
    with pytest.raises(InvalidInputError, match="approach, tilt = "):
        Raceways(short_law, make_spring_law(1e12)).at(8e-6)
    with pytest.raises(InvalidInputError, match="outer"):
        Raceways(short_law, short_law.table)  # type: ignore[arg-type]
