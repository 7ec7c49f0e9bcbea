"""Contacts in plain arrays: values, number of operator applications, independence of units."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

from contactstudy import ConvergenceWarning, FiniteLengthSpace, Grid, HalfSpace, Material, QuarterSpace
from contactstudy.bodies import Body, Counterbody
from contactstudy.cache import ArrayKey
from contactstudy.contact.normal.contact import Contact, Settings, Shape, contact_of
from contactstudy.contact.normal.prescribed_loads import PrescribedLoad

LENGTH, PRESSURE = 2.0**-17, 2.0**37
"""Units of length and pressure: powers of two have no rounding errors."""

COARSE_EDGES, FINE_EDGES = np.linspace(-1.5, 1.5, 21), np.linspace(-1.5, 1.5, 65)
GRADED_EDGES = np.concatenate([np.linspace(-1.5, 0.3, 11), np.linspace(0.4, 1.5, 12)])
FREE_END_EDGES = np.linspace(0.0, 3.0, 21)


class ContactSpec(NamedTuple):
    """A ball off the origin, or a roller across a body with two ends; lengths and pressures are about 1."""

    edges: Any = COARSE_EDGES
    load: float | None = 0.05
    position: float | None = None
    approach: float | None = None
    has_free_ends: bool = False
    has_counterbody: bool = False
    coupled: float = 0.0
    cells_y: int = 20

    def make_shape(self, length: float = 1.0, pressure: float = 1.0) -> Shape:
        """Return the contact with lengths and pressures in given units."""
        grid = Grid.between(length * self.edges, (-1.5 * length, 1.5 * length), self.cells_y)
        x, y = grid.x[:, None] / length, grid.y / length
        gap = 0.02 * (x - 1.6) ** 2 + 0.1 * y**2 if self.has_free_ends else 0.05 * ((x - 0.1) ** 2 + y**2)
        gap = np.where(x > 2.7, np.inf, gap)
        material = Material(0.91 * pressure, 0.3)
        body: Body = HalfSpace(material=material)
        if self.has_free_ends:
            body = FiniteLengthSpace(material=material, length=3.0 * length)
        load = None if self.load is None else self.load * pressure * length**2
        position, approach = (None if ratio is None else ratio * length for ratio in (self.position, self.approach))
        prescribed = PrescribedLoad(load, position, approach)
        counterbody = Counterbody(HalfSpace(material=Material(0.5 * pressure, 0.2))) if self.has_counterbody else None
        return Shape(body, grid, ArrayKey(length * gap), prescribed, counterbody, self.coupled)


CONTACT_SPECS = {
    "load": ContactSpec(),
    "graded": ContactSpec(GRADED_EDGES, has_counterbody=True),
    "approach": ContactSpec(load=None, approach=0.04),
    "nested": ContactSpec(FINE_EDGES, has_counterbody=True, cells_y=64),
    "nested approach": ContactSpec(FINE_EDGES, load=None, approach=0.04, cells_y=64),
    "coupled": ContactSpec(coupled=0.4),
    "coupled approach": ContactSpec(GRADED_EDGES, load=None, approach=0.04, coupled=0.4),
    "ends": ContactSpec(FREE_END_EDGES, has_free_ends=True),
    "position": ContactSpec(FREE_END_EDGES, position=1.75, has_free_ends=True),
    "nested position": ContactSpec(np.linspace(0.0, 3.0, 65), position=1.7, has_free_ends=True, cells_y=64),
    "coupled position": ContactSpec(FREE_END_EDGES, position=1.7, has_free_ends=True, coupled=0.3),
}


@pytest.mark.parametrize("spec", CONTACT_SPECS.values(), ids=CONTACT_SPECS)
def test_results_scale_with_units(spec: ContactSpec) -> None:
    baseline, variant = (
        contact_of(spec.make_shape(), Settings()),
        contact_of(spec.make_shape(LENGTH, PRESSURE), Settings()),
    )
    assert baseline.converged
    assert (baseline.converged, baseline.iterations) == (variant.converged, variant.iterations)
    units = {"pressure": PRESSURE, "gap": LENGTH, "displacement": LENGTH, "approach": LENGTH, "tilt": 1.0}
    units |= {"carried_load": PRESSURE * LENGTH**2, "load_position": LENGTH}
    for name, unit in units.items():
        value = getattr(baseline, name)
        minimum = 1e-9 * np.abs(np.where(np.isfinite(value), value, 0.0)).max()
        assert getattr(variant, name) / unit == pytest.approx(value, rel=1e-6, abs=minimum), name
    for name, value in vars(baseline.certificate).items():
        assert getattr(variant.certificate, name) == pytest.approx(value, rel=0.1, abs=1e-10), name


@pytest.mark.parametrize("has_free_ends", [False, True])
def test_symmetric_contacts_have_symmetric_pressures(has_free_ends: bool) -> None:
    edges = FREE_END_EDGES if has_free_ends else COARSE_EDGES
    grid = Grid.between(edges, (-1.5, 1.5), 20)
    mid_x = 0.5 * (edges[0] + edges[-1])
    gap = 0.05 * ((grid.x[:, None] - mid_x) ** 2 + grid.y**2)
    material = Material(0.91, 0.3)
    body: Body = FiniteLengthSpace(material=material, length=3.0) if has_free_ends else HalfSpace(material=material)
    shape = Shape(body, grid, ArrayKey(gap), PrescribedLoad(0.05))
    pressure = contact_of(shape, Settings()).pressure
    assert (pressure == pressure[::-1]).all()
    assert (pressure == pressure[:, ::-1]).all()
    assert shape.reflections() == [0, 1]
    unsymmetric_shapes = (
        (shape._replace(coupled_friction=0.3), [0]),
        (shape._replace(gap=ArrayKey(gap + 1e-6 * grid.x[:, None])), [1]),
        (shape._replace(prescribed=PrescribedLoad(0.05, mid_x + 1e-6)), [1]),
        (shape._replace(body=QuarterSpace(material=material)), [1]),
        (shape._replace(counterbody=Counterbody(FiniteLengthSpace(length=1.0, material=material), 0.1)), [1]),
    )
    for unsymmetric_shape, axes in unsymmetric_shapes:
        assert unsymmetric_shape.reflections() == axes


def compute_rigid_approach(contact: Contact) -> Any:
    """Approach of the surfaces by the rigid motion, from the approach and tilt of a contact."""
    load_position = contact.shape.prescribed.load_position
    tilt_height = 0.0 if load_position is None else contact.tilt * (contact.shape.grid.x[:, None] - load_position)
    return contact.approach + tilt_height


@pytest.mark.parametrize("name", ["load", "approach", "ends", "position"])
def test_gap_follows_from_displacement_and_shape(name: str) -> None:
    computed = contact_of(CONTACT_SPECS[name].make_shape(), Settings())
    is_under_shape = np.isfinite(computed.gap)
    expected = computed.shape.gap.values + computed.displacement - compute_rigid_approach(computed)
    assert computed.gap[is_under_shape] == pytest.approx(expected[is_under_shape], abs=1e-9)
    assert (np.abs(computed.tilt) > 1e-4) == (name == "position")
    if name == "position":
        assert computed.load_position == pytest.approx(1.75, abs=1e-5)


MAX_APPLICATIONS = {
    "load": 14,
    "graded": 13,
    "approach": 13,
    "nested": 9,
    "nested approach": 17,
    "coupled": 42,
    "coupled approach": 46,
    "ends": 44,
    "position": 16,
    "nested position": 12,
    "coupled position": 48,
}
"""Bounds on the operator applications: ten percent above the measured number."""


@pytest.mark.parametrize("name", MAX_APPLICATIONS)
def test_operator_applications_are_few(name: str) -> None:
    assert contact_of(CONTACT_SPECS[name].make_shape(), Settings()).iterations <= MAX_APPLICATIONS[name]


def test_warning_refers_to_caller() -> None:
    computed = contact_of(CONTACT_SPECS["load"].make_shape(), Settings(1e-6, 3))
    with pytest.warns(ConvergenceWarning, match="after 3 operator applications|max_iterations .now 3") as message:
        computed.warn_unless_converged()
    assert message[0].filename == __file__
