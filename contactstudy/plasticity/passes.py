"""Passes of a contact over an elastic-plastic body, until the residual state is stationary.

docs/explanation/passes.md; radial return: J. C. Simo, T. J. R. Hughes, Computational Inelasticity (1998), chapter 3.
Each column along x acts separately while the strain changes along y, in plane strain as in a line contact.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.fft import next_fast_len
from scipy.interpolate import make_interp_spline

from contactstudy import checks
from contactstudy.analysis import dimension_along, positions, single_case
from contactstudy.analysis.provenance import check_solved_for
from contactstudy.arrays.variables import STRESSES, describe, require_in_si
from contactstudy.bodies.models import Body
from contactstudy.checks import FloatArray, IntArray
from contactstudy.eigenstrain.body import EigenstrainBody, Influence
from contactstudy.eigenstrain.layers import LayerInfluence, PeriodicLayers
from contactstudy.errors import ConvergenceWarning, InvalidInputError
from contactstudy.plasticity.eigenstrains import STRAINS, cross_section, edges_around
from contactstudy.plasticity.material import ElasticPlastic

DOUBLED = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # How often each component stands in a tensor


def deviator(tensor: FloatArray) -> FloatArray:
    """Deviator of tensors."""
    deviatoric = tensor.copy()
    deviatoric[:3] -= tensor[:3].mean(axis=0)
    return deviatoric


def length(tensor: FloatArray) -> FloatArray:
    """Euclidean length of tensors."""
    return np.asarray(np.sqrt(np.tensordot(DOUBLED, tensor**2, axes=1)))


MOST_REPETITIONS = 300  # Bound on the repetitions of a pass
MIXED = 6  # Latest iterates that are mixed


class State(NamedTuple):
    """State of some cells after passes."""

    strain: FloatArray  # (6, cell), plastic
    accumulated: FloatArray  # (cell), equivalent plastic strain
    converged: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class Passage:
    """A pass over some cells of the cross-section."""

    elastic: FloatArray  # (6, place, cell), stress of the contact, Pa
    residual: Influence | LayerInfluence  # of the body, strains uniform along y
    layers: LayerInfluence  # without an end
    along: PeriodicLayers  # strains that change along y on a closed way
    places: int  # on the closed way
    box: tuple[IntArray, IntArray]  # column and layer (cell) in `along`
    yield_stress: FloatArray  # (cell), in tension, Pa
    shear_modulus: float  # Pa
    isotropic: float  # Pa
    kinematic: float  # Pa
    tolerance: float  # change of the deviator over the yield stress

    def after(self, before: State) -> State:
        """State that the pass leaves."""
        stiffness = 2 * self.shear_modulus
        start = self.elastic + self.residual.stresses(before.strain)[:, None]
        flowed = np.zeros_like(start)
        mixing = _Mixing()
        for _ in range(MOST_REPETITIONS):
            trial = deviator(start + self._evaluate(flowed)) + stiffness * (before.strain[:, None] + flowed)
            plastic, accumulated = self._return_mapping(trial, before)
            change = plastic - flowed
            converged = bool((stiffness * length(change).max(axis=0) <= self.tolerance * self.yield_stress).all())
            if converged:
                break
            flowed = mixing.next(flowed, change)
        return State(before.strain + plastic[:, -1], accumulated, before.converged and converged)

    def _evaluate(self, flowed: FloatArray) -> FloatArray:
        """Residual stress (6, place, cell) of this pass's plastic strain (6, place, cell), columns in plane strain."""
        last = flowed[:, -1]
        column, layer = self.box
        inside = np.zeros((6, self.places, column.max() + 1, layer.max() + 1))
        behind = flowed.shape[1]
        inside[:, :behind, column, layer] = flowed
        places = self.places - behind
        ramp = np.clip(2 - 2 * (np.arange(places) + 0.5) / places, 0.0, 1.0)
        inside[:, behind:, column, layer] = (ramp**2 * (3 - 2 * ramp))[:, None] * last[:, None]
        stress = self.along.stresses(inside)[:, :behind, column, layer]
        # The correction to the whole body grows with the part of the final strain that the pass has made.
        size = float(DOUBLED @ (last**2).sum(axis=1))
        if size:
            share = np.einsum("i,ipc,ic->p", DOUBLED, flowed, last) / size
            difference = self.residual.stresses(last) - self.layers.stresses(last)
            stress += np.clip(share, 0.0, 1.0)[:, None] * difference[:, None]
        return np.asarray(stress)

    def _return_mapping(self, trial: FloatArray, before: State) -> tuple[FloatArray, FloatArray]:
        """Plastic strain of this pass and the accumulated one; `trial`: the deviator without plastic strain."""
        kinematic = 2 / 3 * self.kinematic
        modulus = 2 * self.shear_modulus + kinematic
        stiffness = modulus + 2 / 3 * self.isotropic
        strain, accumulated = before.strain, before.accumulated
        flow = np.empty_like(trial)
        for position in range(trial.shape[1]):
            relative = trial[:, position] - modulus * strain
            size = length(relative)
            radius = np.sqrt(2 / 3) * (self.yield_stress + self.isotropic * accumulated)
            if (size > radius).any():
                multiplier = np.maximum(size - radius, 0.0) / stiffness
                strain = strain + multiplier / np.maximum(size, radius) * relative
                accumulated = accumulated + np.sqrt(2 / 3) * multiplier
            flow[:, position] = strain - before.strain
        return flow, accumulated


class _Mixing:
    """Anderson's mixing."""

    def __init__(self) -> None:
        self._iterates: list[FloatArray] = []
        self._changes: list[FloatArray] = []

    def next(self, iterate: FloatArray, change: FloatArray) -> FloatArray:
        """Next iterate from an iterate and its change."""
        self._iterates = [*self._iterates[-MIXED:], iterate]
        self._changes = [*self._changes[-MIXED:], change]
        if len(self._changes) == 1:
            return np.asarray(iterate + change)
        steps, bends = (np.diff(np.stack(history), axis=0) for history in (self._iterates, self._changes))
        flat = bends.reshape(len(bends), -1)
        # Singular value over the largest below which differences between iterates count as dependent
        weights = np.linalg.lstsq(flat @ flat.T, flat @ change.ravel(), rcond=1e-10)[0]
        return np.asarray(iterate + change - np.tensordot(weights, steps + bends, axes=1))


NEAR_YIELD = 0.9  # Least von Mises stress over the yield stress of the cells that flow
SMALL_STRAIN = 0.05  # Largest plastic strain of small-strain theory, with the contact stresses of a flat body


@dataclass(frozen=True, kw_only=True, eq=False)
class _Section:
    """The cross-section: elastic stresses (6, position, cell) at falling y, residual stress of plastic strain."""

    body: Body
    material: ElasticPlastic
    x: FloatArray
    y: FloatArray
    z: FloatArray
    elastic: FloatArray

    @property
    def layered(self) -> bool:
        """Whether one position along x stands for all."""
        return self.x.size == 1

    @cached_property
    def cells(self) -> EigenstrainBody:
        """Cells around the positions."""
        return cross_section(self.body, self.x, self.z)

    @cached_property
    def yield_stress(self) -> FloatArray:
        """Yield stress in every cell, Pa."""
        return np.tile(self.material.yield_stress_at(self.z), self.x.size)

    @property
    def layers(self) -> LayerInfluence:
        """Residual stress of layers without an end."""
        return LayerInfluence(self.body.material.poisson, self.body.material.young)

    def passage(self, cells: IntArray, substeps: int, tolerance: float) -> Passage:
        """Pass over some of the cells."""
        steps = substeps * max(1, round(float(np.ptp(self.y) / np.abs(np.diff(self.y)).min())))
        y = np.linspace(self.y[0], self.y[-1], steps + 1)
        # Between positions the stress is linear; behind the last one there is none any more.
        spline = make_interp_spline(self.y[::-1], self.elastic[:, ::-1, cells], k=1, axis=1)
        elastic = np.concatenate([spline(y), np.zeros((6, 1, cells.size))], axis=1)
        columns, layers = np.unravel_index(cells, (self.x.size, self.z.size))
        first, last = layers.min(), layers.max()
        edges = edges_around(self.z, 0.0, np.inf)[first : last + 2]
        # Length of the closed way over the length of the positions along y. Accuracy: the influence along y reaches so
        # far
        places = int(next_fast_len(int(3.0 * y.size), real=True))
        periodic = PeriodicLayers(self.body.material, edges, places, float(y[1] - y[0]))
        box = np.unique(columns, return_inverse=True)[1], layers - first
        return Passage(
            elastic=elastic,
            residual=self.layers if self.layered else Influence.of(self.cells, columns, layers),
            layers=self.layers,
            along=periodic,
            places=places,
            box=box,
            yield_stress=self.yield_stress[cells],
            shear_modulus=self.body.material.shear_modulus,
            isotropic=self.material.isotropic_hardening,
            kinematic=self.material.kinematic_hardening,
            tolerance=tolerance,
        )

    def residual_state(self, strain: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Residual stresses (6, x, z) everywhere, and displacements z and y of the top."""
        shaped = strain.reshape(6, self.x.size, self.z.size)
        if not self.layered:
            solution = self.cells.solve(shaped)
            return solution.cell_averages(), *solution.top_displacement(self.x)
        stress = self.layers.stresses(strain).reshape(shaped.shape)
        heights = np.diff(np.concatenate([[0.0], 0.5 * (self.z[1:] + self.z[:-1]), self.z[-1:]]))
        constants = self.body.material
        strain_zz = -constants.poisson / constants.young * (stress[0] + stress[1]) + shaped[2]
        return stress, -strain_zz @ heights, -2 * shaped[5] @ heights

    def may_flow(self, residual: FloatArray, part: float) -> IntArray:
        """Cells whose von Mises stress passes a part of their yield stress at some instant."""
        sizes = [length(deviator(self.elastic[:, position] + residual)) for position in range(self.y.size)]
        return np.flatnonzero(np.max(sizes, axis=0) * np.sqrt(1.5) > part * self.yield_stress)


def residual_stress(
    stress: xr.Dataset,
    body: Body,
    material: ElasticPlastic,
    passes: int = 10,
    *,
    substeps: int = 2,
    tolerance: float = 1e-4,
) -> xr.Dataset:
    """Residual stress, plastic strain and profile that passes of a contact roll into a body.

    Parameters
    ----------
    stress : Dataset
        A single case with the six elastic stresses along x, y and z, as for :func:`contactstudy.fatigue.dang_van`. The
        positions along x and z are the cells' middles, beyond the yielding region too. One position along x: a line
        contact.
    body : Body
        The body, for its elastic constants and free ends.
    material : ElasticPlastic
        Yield stress and hardening. Without hardening, flow above the shakedown limit continues with every pass.
    passes : int
        Number of passes; fewer if one leaves everything as it was.
    substeps : int
        Steps from one position along y to the next, between which the elastic stress is linear. The error falls with
        their number.
    tolerance : float
        Accuracy of the stress at each place, over the yield stress.

    Returns
    -------
    Dataset
        Along `pass_number` (from 1): the six residual stresses ``sigma_xx`` ... ``tau_yz`` (Pa), which may be
        added to those of the contact; the plastic strains ``plastic_strain_xx`` ... (components of the tensor);
        `equivalent_plastic_strain`, accumulated; `plastic_flow`, the largest equivalent plastic strain of the pass;
        `residual_displacement_z` and `residual_displacement_y` of the top (m, relative to the depth; of a line contact
        relative to the last depth); `converged`, whether every pass reached the tolerance. The contact itself is that
        of the elastic body.

    Raises
    ------
    InvalidInputError
        If an argument is of the wrong kind, there is more than one case, the stresses are of another body or reach
        beyond its ends, or strains are not small any more.

    Warns
    -----
    ConvergenceWarning
        If the flow of a pass did not reach the tolerance.

    Examples
    --------
    >>> from contactstudy import HalfSpace, Material
    >>> y, z = np.linspace(-3, 3, 61), np.linspace(0.05, 1.0, 11)
    >>> push = -2.0 * np.exp(-(y[:, None] ** 2)) * np.exp(-z) * np.ones((1, 1, 1))
    >>> contact = xr.Dataset({name: (("x", "y", "z"), push * (name == "sigma_zz")) for name in STRESSES},
    ...                      {"x": [0.0], "y": y, "z": z})
    >>> body, plastic = HalfSpace(material=Material(1000.0, 0.3)), ElasticPlastic(yield_stress=1.0)
    >>> found = residual_stress(contact, body, plastic, passes=3)
    >>> bool(found.plastic_flow[0] > 0), bool(found.plastic_flow[-1] < 1e-3 * found.plastic_flow[0])
    (True, True)
    """
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    checks.instance("material", material, ElasticPlastic, "a contactstudy.plasticity.ElasticPlastic")
    passes, substeps = checks.count("passes", passes), checks.count("substeps", substeps)
    tolerance = checks.positive("tolerance", tolerance)
    section, dims = _section(stress, body, material)
    cells = section.may_flow(np.zeros((6, 1)), NEAR_YIELD)
    count = section.yield_stress.size
    state = State(np.zeros((6, count)), np.zeros(count), True)
    states: list[xr.Dataset] = []
    passage = section.passage(cells, substeps, tolerance) if cells.size else None
    for number in range(1, passes + 1):
        while True:
            after = state
            if passage is not None:
                flowed = passage.after(State(state.strain[:, cells], state.accumulated[cells], state.converged))
                after = State(state.strain.copy(), state.accumulated.copy(), flowed.converged)
                after.strain[:, cells], after.accumulated[cells] = flowed.strain, flowed.accumulated
            residual, sunk, dragged = section.residual_state(after.strain)
            further = np.setdiff1d(section.may_flow(residual.reshape(6, -1), 1 + tolerance), cells)
            if not further.size:
                break
            # Residual stress makes cells flow that were not counted: once more with them.
            cells = np.union1d(np.union1d(cells, further), section.may_flow(residual.reshape(6, -1), NEAR_YIELD))
            passage = section.passage(cells, substeps, tolerance)
        grown = float((after.accumulated - state.accumulated).max())
        size = length(after.strain)
        if size.max(initial=0.0) > SMALL_STRAIN:
            index = np.unravel_index(int(size.argmax()), (section.x.size, section.z.size))
            position = f"x = {section.x[index[0]]:.4g} m, z = {section.z[index[1]]:.4g} m"
            raise InvalidInputError(
                "stress",
                f"a plastic strain of {size.max():.2g} at {position}",
                f"such that plastic strains stay below {SMALL_STRAIN:g}",
                "lower the load, or give the material hardening: flow above the shakedown limit has no end without",
            )
        state = after
        strains = state.strain.reshape(6, section.x.size, section.z.size)
        fields = dict(zip((*STRESSES, *STRAINS), (*residual, *strains), strict=True))
        fields["equivalent_plastic_strain"] = state.accumulated.reshape(strains.shape[1:])
        tops = {"residual_displacement_z": sunk, "residual_displacement_y": dragged}
        left = xr.Dataset(
            {name: (dims, field) for name, field in fields.items()}
            | {name: (dims[:1], values) for name, values in tops.items()}
            | {"plastic_flow": ((), grown), "converged": ((), state.converged)},
            coords={dims[0]: section.x, dims[1]: section.z},
        )
        states.append(left.expand_dims(pass_number=[number]))
        # Stress of a pass' flow, over the tolerance times the yield stress, below which the state is stationary
        if 3 * body.material.shear_modulus * grown <= 2.0 * tolerance * section.yield_stress.min():
            break
    if not state.converged:
        warnings.warn(
            f"the flow of a pass did not reach tolerance = {tolerance:g}; take more substeps, or lower the load",
            ConvergenceWarning,
            stacklevel=2,
        )
    return describe(xr.concat(states, "pass_number"), "what passes of a contact leave")


def _section(stress: xr.Dataset, body: Body, material: ElasticPlastic) -> tuple[_Section, tuple[str, str]]:
    """Check a case and return its cross-section, and its dimensions along x and z."""
    case = single_case(require_in_si(stress, *STRESSES, argument="stress"))
    first = case[STRESSES[0]]
    dims = {axis: dimension_along(case["tau_yz"], axis) for axis in ("y", "x", "z")}
    x, y, z = (np.asarray(positions(first, axis).values, dtype=np.float64) for axis in ("x", "y", "z"))
    # The contact moves along +y: a point meets its leading edge, at the largest y, first.
    order = np.argsort(y)[::-1]
    values = np.stack([case[name].transpose(*dims.values()).values[order] for name in STRESSES])
    if y.size < 2:
        raise InvalidInputError("stress", f"{y.size} position along y", "the whole passage along y")
    if not np.isfinite(values).all():
        raise InvalidInputError("stress", "values that are not finite", "finite stresses")
    elastic = values.reshape(*values.shape[:2], -1)
    section = _Section(body=body, material=material, x=x, y=y[order], z=z, elastic=elastic)
    # A line contact has one column along x, without ends.
    check_solved_for(stress, body, "stress", only=("body.material",) if section.layered else ())
    if not section.layered:
        section.cells  # noqa: B018, refuses positions that make no cells
    return section, (dims["x"], dims["z"])
