"""Passes of a contact over an elastic-plastic body, repeated until the residual state is stationary.

docs/explanation/passes.md; radial return: J. C. Simo, T. J. R. Hughes, Computational Inelasticity (1998), chapter 3.
Each column along x acts separately while the strain changes along y, in plane strain as in a line contact.
"""

from __future__ import annotations

import warnings
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.fft import next_fast_len
from scipy.interpolate import make_interp_spline

from contactstudy import checks
from contactstudy.analysis import dimension_along, positions, single_case
from contactstudy.analysis.provenance import check_solved_for
from contactstudy.arrays.variables import STRESSES, describe, in_si, require_in_si
from contactstudy.bodies.models import Body
from contactstudy.case.magnitudes import warn_of_values
from contactstudy.checks import FloatArray, IntArray
from contactstudy.eigenstrain.body import EigenstrainBody, PeriodicLayers, cell_influence, layer_stresses
from contactstudy.errors import ConvergenceWarning, InvalidInputError
from contactstudy.plasticity.eigenstrains import STRAINS, edges_between


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
    isotropic_hardening: float = field(default=0.0, metadata=checks.number(checks.not_negative, "Pa"))
    kinematic_hardening: float = field(default=0.0, metadata=checks.number(checks.not_negative, "Pa"))

    def __post_init__(self) -> None:
        if isinstance(self.yield_stress, xr.DataArray):
            values = in_si("yield_stress", self.yield_stress, "Pa")
            if values.dims != ("z",) or "z" not in values.coords:
                raise InvalidInputError("yield_stress.dims", values.dims, "('z',) with depths z in metres")
            checks.increasing("yield_stress.z", values["z"].values, "metres")
            checks.positive("yield_stress", float(checks.coordinates("yield_stress", values.values, "Pa").min()), "Pa")
            checks.store(self, yield_stress=values)
        else:
            checks.store(self, yield_stress=checks.positive("yield_stress", self.yield_stress, "Pa"))
        checks.store_numbers(self)
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


COMPONENT_COUNTS = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # Occurrences of each component in a tensor


def compute_deviator(tensor: FloatArray) -> FloatArray:
    """Deviator of tensors."""
    deviator = tensor.copy()
    deviator[:3] -= tensor[:3].mean(axis=0)
    return deviator


def tensor_norm(tensor: FloatArray) -> FloatArray:
    """Euclidean length of tensors."""
    return np.asarray(np.sqrt(np.tensordot(COMPONENT_COUNTS, tensor**2, axes=1)))


MAX_REPETITIONS = 300  # Bound on the repetitions of a pass
MIXING_HISTORY = 6  # Number of earlier iterates in Anderson's mixing


class PlasticState(NamedTuple):
    """Plastic strain of a selection of cells after passes."""

    strain: FloatArray  # (6, cell), plastic
    accumulated: FloatArray  # (cell), equivalent plastic strain
    converged: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class Passage:
    """A pass over some cells of the cross-section."""

    elastic_stress: FloatArray  # (6, position, cell), stress of the contact, Pa
    compute_residual: Callable[[FloatArray], FloatArray]  # residual stress in the body by strains uniform along y
    layers: PeriodicLayers  # residual stress in a body without ends by strains periodic along y

    cell_indices: tuple[IntArray, IntArray]  # column and layer (cell) in `layers`
    yield_stress: FloatArray  # (cell), in tension, Pa

    material: ElasticPlastic  # for its hardening
    tolerance: float  # change of the deviator over the yield stress

    def solve(self, start: PlasticState) -> PlasticState:
        """Return the state after the pass."""
        stiffness = 2 * self.layers.material.shear_modulus
        elastic = self.elastic_stress + self.compute_residual(start.strain)[:, None]
        flow = np.zeros_like(elastic)
        iterates, changes = (deque[FloatArray](maxlen=MIXING_HISTORY + 1) for _ in range(2))
        for _ in range(MAX_REPETITIONS):
            trial = compute_deviator(elastic + self._residual_stress(flow)) + stiffness * (start.strain[:, None] + flow)
            next_strain, accumulated = self._return_mapping(trial, start)
            change = next_strain - flow
            converged = bool((stiffness * tensor_norm(change).max(axis=0) <= self.tolerance * self.yield_stress).all())
            if converged:
                break
            iterates.append(flow)
            changes.append(change)
            flow = _mix(iterates, changes)
        return PlasticState(start.strain + next_strain[:, -1], accumulated, start.converged and converged)

    def _residual_stress(self, plastic_strain: FloatArray) -> FloatArray:
        """Residual stress (6, position, cell) by this pass's plastic strain, with every column in plane strain."""
        final_strain = plastic_strain[:, -1]
        column, layer = self.cell_indices
        periodic_strain = np.zeros((6, self.layers.positions, column.max() + 1, layer.max() + 1))
        count = plastic_strain.shape[1]
        periodic_strain[:, :count, column, layer] = plastic_strain
        decay_count = self.layers.positions - count
        decay = np.clip(2 - 2 * (np.arange(decay_count) + 0.5) / decay_count, 0.0, 1.0)
        periodic_strain[:, count:, column, layer] = (decay**2 * (3 - 2 * decay))[:, None] * final_strain[:, None]
        stress = self.layers.stresses(periodic_strain)[:, :count, column, layer]
        # The correction for the body's ends grows with the fraction of the final strain reached at each position.
        norm = float(COMPONENT_COUNTS @ (final_strain**2).sum(axis=1))
        if norm:
            fraction = np.einsum("i,ipc,ic->p", COMPONENT_COUNTS, plastic_strain, final_strain) / norm
            difference = self.compute_residual(final_strain) - layer_stresses(self.layers.material, final_strain)
            stress += np.clip(fraction, 0.0, 1.0)[:, None] * difference[:, None]
        return np.asarray(stress)

    def _return_mapping(self, trial: FloatArray, initial: PlasticState) -> tuple[FloatArray, FloatArray]:
        """Plastic strain of this pass, and accumulated strain; `trial` is the deviator before plastic flow."""
        kinematic = 2 / 3 * self.material.kinematic_hardening
        modulus = 2 * self.layers.material.shear_modulus + kinematic
        stiffness = modulus + 2 / 3 * self.material.isotropic_hardening
        strain, accumulated = initial.strain, initial.accumulated
        flow = np.empty_like(trial)
        for position in range(trial.shape[1]):
            relative_stress = trial[:, position] - modulus * strain
            norm = tensor_norm(relative_stress)
            radius = np.sqrt(2 / 3) * (self.yield_stress + self.material.isotropic_hardening * accumulated)
            if (norm > radius).any():
                multiplier = np.maximum(norm - radius, 0.0) / stiffness
                strain = strain + multiplier / np.maximum(norm, radius) * relative_stress
                accumulated = accumulated + np.sqrt(2 / 3) * multiplier
            flow[:, position] = strain - initial.strain
        return flow, accumulated


def _mix(iterates: Sequence[FloatArray], changes: Sequence[FloatArray]) -> FloatArray:
    """Next iterate from the last iterates and their changes, by Anderson's mixing."""
    steps, differences = (np.diff(np.stack(history), axis=0) for history in (iterates, changes))
    flattened = differences.reshape(len(differences), changes[-1].size)
    # rcond: differences between iterates with smaller singular values are dependent
    weights = np.linalg.lstsq(flattened @ flattened.T, flattened @ changes[-1].ravel(), rcond=1e-10)[0]
    return np.asarray(iterates[-1] + changes[-1] - np.tensordot(weights, steps + differences, axes=1))


NEAR_YIELD_RATIO = 0.9  # Minimum von Mises stress over yield stress of the cells of a pass
MAX_STRAIN = 0.05  # Largest plastic strain for which small-strain theory and the contact stresses hold


@dataclass(frozen=True, kw_only=True, eq=False)
class _CrossSection:
    """Cross-section of the body: elastic stresses (6, position, cell) at falling y, and influence of plastic strain."""

    body: Body
    material: ElasticPlastic
    x: FloatArray
    y: FloatArray
    z: FloatArray
    elastic: FloatArray

    @property
    def is_line_contact(self) -> bool:
        """Whether the section has one position along x."""
        return self.x.size == 1

    @cached_property
    def cells(self) -> EigenstrainBody:
        """Cells around the positions, up to the body's top and its free ends."""
        body, x, z = self.body, self.x, self.z
        for name, points in (("x", x), ("z", z)):
            checks.increasing(name, points, "metres", minimum=2)
        low, high = body.extent
        tolerance = 1e-9 * (x[-1] - x[0])  # Rounding over the positions' range
        if x[0] < low - tolerance or x[-1] > high + tolerance:
            allowed = f"positions in the body, from {low:g} to {high:g} m"
            raise InvalidInputError("x", f"{x[0]:g} to {x[-1]:g} m", allowed)
        x_edges, z_edges = edges_between(x, low, high), edges_between(z, 0.0, np.inf)
        for name, face, edge in (("x", low, x_edges[0]), ("x", high, x_edges[-1]), ("z", 0.0, z_edges[0])):
            if np.isfinite(face) and edge != face:
                border = "the top" if name == "z" else f"the free end at {face:g} m"
                allowed = f"positions that reach to {border}"
                raise InvalidInputError(name, f"{edge:g} m, where the outer cell ends", allowed)
        return EigenstrainBody(material=body.material, extent=body.extent, x_edges=x_edges, z_edges=z_edges)

    @cached_property
    def yield_stress(self) -> FloatArray:
        """Yield stress in every cell, Pa."""
        return np.tile(self.material.yield_stress_at(self.z), self.x.size)

    def create_passage(self, cells: IntArray, substeps: int, tolerance: float) -> Passage:
        """Create the pass over a selection of the cells."""
        steps = substeps * max(1, round(float(np.ptp(self.y) / np.abs(np.diff(self.y)).min())))
        y = np.linspace(self.y[0], self.y[-1], steps + 1)
        # The stress is linear between positions and vanishes behind the last position.
        spline = make_interp_spline(self.y[::-1], self.elastic[:, ::-1, cells], k=1, axis=1)
        elastic = np.concatenate([spline(y), np.zeros((6, 1, cells.size))], axis=1)
        columns, layers = np.unravel_index(cells, (self.x.size, self.z.size))
        top_layer, bottom_layer = layers.min(), layers.max()
        edges = edges_between(self.z, 0.0, np.inf)[top_layer : bottom_layer + 2]
        # Period over the length of the positions along y. Accuracy: strains one period away have no influence.
        period = int(next_fast_len(3 * y.size, real=True))
        compute_residual: Callable[[FloatArray], FloatArray] = partial(layer_stresses, self.body.material)
        if not self.is_line_contact:
            compute_residual = cell_influence(self.cells, columns, layers)
        return Passage(
            elastic_stress=elastic,
            compute_residual=compute_residual,
            layers=PeriodicLayers(self.body.material, edges, period, float(y[1] - y[0])),
            cell_indices=(np.unique(columns, return_inverse=True)[1], layers - top_layer),
            yield_stress=self.yield_stress[cells],
            material=self.material,
            tolerance=tolerance,
        )

    def residual_state(self, strain: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Residual stresses (6, x, z) and displacements z and y of the top."""
        strain_field = strain.reshape(6, self.x.size, self.z.size)
        if not self.is_line_contact:
            solution = self.cells.solve(strain_field)
            return solution.cell_averages(), *solution.top_displacement(self.x)
        material = self.body.material
        stress = layer_stresses(material, strain).reshape(strain_field.shape)
        layer_heights = np.diff(np.concatenate([[0.0], 0.5 * (self.z[1:] + self.z[:-1]), self.z[-1:]]))
        strain_zz = -material.poisson / material.young * (stress[0] + stress[1]) + strain_field[2]
        return stress, -strain_zz @ layer_heights, -2 * strain_field[5] @ layer_heights

    def yielding_cells(self, residual: FloatArray, ratio: float) -> IntArray:
        """Cells whose largest von Mises stress exceeds a ratio of their yield stress."""
        norms = [tensor_norm(compute_deviator(self.elastic[:, position] + residual)) for position in range(self.y.size)]
        return np.flatnonzero(np.max(norms, axis=0) * np.sqrt(1.5) > ratio * self.yield_stress)


def residual_stress(
    stress: xr.Dataset,
    body: Body,
    material: ElasticPlastic,
    passes: int = 10,
    *,
    substeps: int = 2,
    tolerance: float = 1e-4,
) -> xr.Dataset:
    """Residual stress, plastic strain and profile of a body by passes of a contact.

    Parameters
    ----------
    stress : Dataset
        A single case with the six elastic stresses along x, y and z, as for :func:`contactstudy.fatigue.dang_van`. The
        positions along x and z are cell midpoints, also beyond the yielding region; one along x is a line contact.
    body : Body
        The body, for its elastic constants and free ends.
    material : ElasticPlastic
        Yield stress and hardening. Without hardening, flow above the shakedown limit continues with every pass.
    passes : int
        Number of passes; fewer if a pass leaves the state unchanged.
    substeps : int
        Steps between neighbouring positions along y, with linear elastic stress. The error falls with their number.
    tolerance : float
        Accuracy of the stress at each position, over the yield stress.

    Returns
    -------
    Dataset
        Along `pass_number` (from 1): the six residual stresses ``sigma_xx`` ... ``tau_yz`` (Pa), which may be
        added to the contact's stresses; the plastic strains ``plastic_strain_xx`` ... (components of the tensor);
        `equivalent_plastic_strain`, accumulated; `plastic_flow`, the largest equivalent plastic strain of the pass;
        `residual_displacement_z` and `residual_displacement_y` of the top (m, relative to the depth; of a line contact
        relative to the last depth); `converged`, whether every pass reached the tolerance. The contact remains elastic.

    Raises
    ------
    InvalidInputError
        If an argument is of the wrong kind, the Dataset has several cases, the stresses are of another body or reach
        beyond its ends, or strains are not small.

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
    >>> result = residual_stress(contact, body, plastic, passes=3)
    >>> bool(result.plastic_flow[0] > 0), bool(result.plastic_flow[-1] < 1e-3 * result.plastic_flow[0])
    (True, True)
    """
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    checks.instance("material", material, ElasticPlastic, "a contactstudy.plasticity.ElasticPlastic")
    passes, substeps = checks.count("passes", passes), checks.count("substeps", substeps)
    tolerance = checks.positive("tolerance", tolerance)
    section, dims = _create_section(stress, body, material)
    cells = section.yielding_cells(np.zeros((6, 1)), NEAR_YIELD_RATIO)
    cell_count = section.yield_stress.size
    state = PlasticState(np.zeros((6, cell_count)), np.zeros(cell_count), True)
    states: list[xr.Dataset] = []
    passage = section.create_passage(cells, substeps, tolerance) if cells.size else None
    for pass_number in range(1, passes + 1):
        while True:
            strain, accumulated, converged = state.strain.copy(), state.accumulated.copy(), state.converged
            if passage is not None:
                start = PlasticState(strain[:, cells], accumulated[cells], converged)
                strain[:, cells], accumulated[cells], converged = passage.solve(start)
            residual, displacement_z, displacement_y = section.residual_state(strain)
            if np.isin(section.yielding_cells(residual.reshape(6, -1), 1 + tolerance), cells).all():
                break
            # Residual stress makes further cells yield: repeat the pass with these cells.
            cells = np.union1d(cells, section.yielding_cells(residual.reshape(6, -1), NEAR_YIELD_RATIO))
            passage = section.create_passage(cells, substeps, tolerance)
        plastic_flow = float((accumulated - state.accumulated).max())
        strain_norm = tensor_norm(strain)
        if strain_norm.max(initial=0.0) > MAX_STRAIN:
            index = np.unravel_index(int(strain_norm.argmax()), (section.x.size, section.z.size))
            position = f"x = {section.x[index[0]]:.4g} m, z = {section.z[index[1]]:.4g} m"
            value = f"a plastic strain of {strain_norm.max():.2g} at {position}"
            hint = "lower the load, or give the material hardening: flow above the shakedown limit does not end"
            raise InvalidInputError("stress", value, f"such that plastic strains stay below {MAX_STRAIN:g}", hint)
        state = PlasticState(strain, accumulated, converged)
        strains = state.strain.reshape(6, section.x.size, section.z.size)
        fields = dict(zip((*STRESSES, *STRAINS), (*residual, *strains), strict=True))
        fields["equivalent_plastic_strain"] = state.accumulated.reshape(strains.shape[1:])
        variables = {name: (dims, field) for name, field in fields.items()} | {
            "residual_displacement_z": (dims[:1], displacement_z),
            "residual_displacement_y": (dims[:1], displacement_y),
            "plastic_flow": ((), plastic_flow),
            "converged": ((), state.converged),
        }
        pass_result = xr.Dataset(variables, coords={dims[0]: section.x, dims[1]: section.z})
        states.append(pass_result.expand_dims(pass_number=[pass_number]))
        # The state is stationary once the flow of a pass changes the stress by less than twice the tolerance.
        if 3 * body.material.shear_modulus * plastic_flow <= 2.0 * tolerance * section.yield_stress.min():
            break
    if not state.converged:
        message = f"the flow of a pass did not reach tolerance = {tolerance:g}; take more substeps, or lower the load"
        warnings.warn(message, ConvergenceWarning, stacklevel=2)
    return describe(xr.concat(states, "pass_number"), "residual state after passes of a contact")


def _create_section(stress: xr.Dataset, body: Body, material: ElasticPlastic) -> tuple[_CrossSection, tuple[str, str]]:
    """Check a case and return its cross-section, and its dimensions along x and z."""
    case = single_case(require_in_si(stress, *STRESSES, argument="stress"))
    component = case[STRESSES[0]]
    dims = {axis: dimension_along(case["tau_yz"], axis) for axis in ("y", "x", "z")}
    x, y, z = (np.asarray(positions(component, axis).values, dtype=np.float64) for axis in ("x", "y", "z"))
    # The contact moves along +y: its leading edge, at the largest y, passes a point first.
    descending = np.argsort(y)[::-1]
    stresses = np.stack([case[name].transpose(*dims.values()).values[descending] for name in STRESSES])
    if y.size < 2:
        raise InvalidInputError("stress", f"{y.size} position along y", "the whole passage along y")
    if not np.isfinite(stresses).all():
        raise InvalidInputError("stress", "values that are not finite", "finite stresses")
    elastic = stresses.reshape(*stresses.shape[:2], -1)
    section = _CrossSection(body=body, material=material, x=x, y=y[descending], z=z, elastic=elastic)
    # A line contact has one column along x, without ends.
    check_solved_for(stress, body, "stress", compared_names=("body.material",) if section.is_line_contact else ())
    if not section.is_line_contact:
        section.cells  # noqa: B018, rejects positions without cells
    return section, (dims["x"], dims["z"])
