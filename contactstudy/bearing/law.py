"""Contact laws: load, moment and stiffness at an approach and a tilt, the inverse law, and two laws in series."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.engineering import format_quantity, html_table
from contactstudy.arrays.variables import describe, in_si, name_array, require, without_error
from contactstudy.bearing.energy_spline import STIFFNESSES, ContactResponse, EnergySpline, Nodes
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

Values = float | list[float] | tuple[float, ...] | FloatArray | xr.DataArray  # A number, several, or labelled numbers
Position = tuple[xr.DataArray, xr.DataArray]  # Approach and tilt
UNITS = {"approach": "m", "tilt": "rad", "normal_load": "N", "moment": "N m"}  # Units of the arguments


def broadcast_arguments(**values: Values) -> tuple[xr.DataArray, ...]:
    """Broadcast arguments; the dimension of a sequence has the argument's name."""
    labelled = [_label_argument(*argument) for argument in values.items()]
    for dim in {str(dim) for argument in labelled for dim in argument.dims}:
        indexes = [argument.indexes[dim] for argument in labelled if dim in argument.indexes]
        if any(set(labels) != set(indexes[0]) for labels in indexes):
            labels_text = " and ".join(str(labels.tolist()[:5]) for labels in indexes)
            allowed = f"with the same labels along {dim}, or without"
            raise InvalidInputError(", ".join(values), f"{dim} = {labels_text}", allowed)
    try:
        aligned = xr.align(*labelled, join="left")
    except ValueError as error:
        sizes = {name: dict(argument.sizes) for name, argument in zip(values, labelled, strict=True)}
        allowed = "as many values along each common dimension"
        raise InvalidInputError(", ".join(values), sizes, allowed, str(error)) from None
    return tuple(argument.astype(np.float64) for argument in xr.broadcast(*aligned))


def _label_argument(name: str, value: Values) -> xr.DataArray:
    """Return an argument as a DataArray of finite numbers."""
    if isinstance(value, xr.DataArray):
        labelled: xr.DataArray = in_si(name, value, UNITS[name])
        checks.coordinates(name, labelled.values.ravel(), UNITS[name])
        return labelled.drop_vars(name, errors="ignore") if name not in labelled.dims else labelled
    if np.ndim(value) == 0:
        return xr.DataArray(checks.finite(name, value, UNITS[name]))
    numbers = checks.coordinates(name, value, UNITS[name])
    return xr.DataArray(numbers, dims=name, coords={name: numbers})


# Arguments of `apply_ufunc` for a function that returns two numbers
TWO_OUTPUTS: dict[str, Any] = {"output_core_dims": [[], []], "vectorize": True, "output_dtypes": [float, float]}


def add_position_errors(motion: xr.Dataset) -> xr.Dataset:
    """Add the errors of approach and tilt, from the errors of load and moment, to a motion under a load."""
    normal, coupling, tilting = (np.abs(motion[name]) for name in STIFFNESSES)
    determinant = np.abs(motion["normal_stiffness"] * motion["tilting_stiffness"] - motion["coupling_stiffness"] ** 2)
    load, moment = motion["normal_load_error"], motion["moment_error"]
    errors = {
        "approach_error": (tilting * load + coupling * moment) / determinant,
        "tilt_error": (coupling * load + normal * moment) / determinant,
    }
    return motion.assign({name: name_array(name, error.drop_attrs()) for name, error in errors.items()})


def label_motion(approach: xr.DataArray, tilt: xr.DataArray, motion: ContactResponse, errors: FloatArray) -> xr.Dataset:
    """Label loads and stiffness at pairs of approach and tilt; `errors` of load and moment are over the load."""
    values = {
        "approach": approach.values,
        "tilt": tilt.values,
        **motion._asdict(),
        "normal_load_error": errors[0] * motion.normal_load,
        "moment_error": errors[1] * motion.normal_load,
    }
    coords = {str(name): coordinate for name, coordinate in approach.coords.items()}
    variables = {name: (approach.dims, array) for name, array in values.items() if name not in coords}
    labelled = describe(xr.Dataset(variables, coords=coords))
    return without_error(labelled, *STIFFNESSES)


MIN_NODES = 5  # Minimum number of approaches and of tilts
ROUNDING = 1e-9  # Rounding of an argument over the range of the table


def find_root(
    residual: Callable[[FloatArray], FloatArray],
    start: FloatArray,
    bounds: FloatArray,
    scales: FloatArray,
    jacobian: Callable[[FloatArray], FloatArray] | str = "2-point",
) -> tuple[float, float] | None:
    """Return the approach and tilt within `bounds` (bound, 2) whose scaled `residual` vanishes; None without a root."""
    from scipy.optimize import least_squares

    low, high = bounds / scales
    start = np.clip(start / scales, low + ROUNDING, high - ROUNDING)
    root = least_squares(residual, start, jacobian, bounds=(low, high), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    delta, theta = root.x * scales
    # Maximum residual of load and moment, over load and load times length
    return (float(delta), float(theta)) if np.abs(root.fun).max() <= 1e-7 else None


# Required variables of a table
REQUIRED = ("normal_load", "moment", "strain_energy", "relative_load_error", "relative_moment_error", "contact_length")


@dataclass(frozen=True, eq=False)
class ContactLaw:
    """Load and moment of one contact as smooth functions of approach and tilt, and the inverse.

    Parameters
    ----------
    table : Dataset
        Table of :func:`contactstudy.bearing.contact_law`, or its file:
        ``ContactLaw(xarray.open_dataset(path))``.

    Raises
    ------
    InvalidInputError
        If the Dataset lacks a variable of the table.

    Notes
    -----
    The law interpolates the strain energy U. Load ``Q = dU/d delta`` and moment ``M = dU/d theta`` derive from it, so
    the stiffness matrix is symmetric and their exact derivative, as Newton's method for a bearing's equilibrium needs.

    Examples
    --------
    >>> approach, tilt = np.geomspace(1e-6, 4e-6, 5), np.linspace(-1e-3, 1e-3, 5)
    >>> delta, theta = np.meshgrid(approach, tilt, indexing="ij")
    >>> dims = ("approach", "tilt")  # two springs of 10 N/um, 1 mm to either side of mid-length
    >>> springs = xr.Dataset(
    ...     {
    ...         "normal_load": (dims, 2e7 * delta),
    ...         "moment": (dims, 20.0 * theta),
    ...         "strain_energy": (dims, 1e7 * delta**2 + 10.0 * theta**2),
    ...         "relative_load_error": 0.0,
    ...         "relative_moment_error": 0.0,
    ...         "contact_length": 2e-3,
    ...     },
    ...     {"approach": approach, "tilt": tilt},
    ... )
    >>> law = ContactLaw(springs)
    >>> round(float(law.at(2e-6, 5e-4).normal_load), 1)
    40.0
    >>> motion = law.under(normal_load=40.0, moment=0.01)
    >>> round(1e6 * float(motion.approach), 2), round(1e3 * float(motion.tilt), 2)
    (2.0, 0.5)
    """

    table: xr.Dataset

    def __post_init__(self) -> None:
        require(self.table, *REQUIRED, argument="table")
        for name in ("approach", "tilt"):
            if self.table.sizes.get(name, 0) < MIN_NODES:
                raise InvalidInputError("table", dict(self.table.sizes), f"one with {MIN_NODES} or more along {name}")

    def __repr__(self) -> str:
        return f"ContactLaw({', '.join(f'{name} {text}' for name, text in self._rows())})"

    def _repr_html_(self) -> str:
        return html_table([("Contact law", self._rows())])

    def _rows(self) -> Iterator[tuple[str, str]]:
        """Ranges and errors of the table, as rows of text."""
        low, high = (1e6 * end for end in self.range_of("approach"))
        min_tilt, max_tilt = (1e3 * end for end in self.range_of("tilt"))
        loads = self.table["normal_load"]
        errors = 100 * self.table["relative_load_error"].broadcast_like(loads)
        worst_node = errors[errors.argmax(...)]
        yield "approach", f"{low:.3g} to {high:.3g} um"
        yield "tilt", f"{min_tilt:.3g} to {max_tilt:.3g} mrad"
        for name, depth in self.references.items():
            yield str(name).replace("_", " "), format_quantity(float(depth), "m")
        yield "load", f"{float(loads.min()):.3g} to {float(loads.max()):.3g} N"
        yield (
            "error of the load",
            f"{float(errors.median()):.1g} % by the median, up to {float(errors.max()):.1g} % at "
            f"{1e6 * float(worst_node.approach):.3g} um and {1e3 * float(worst_node.tilt):.3g} mrad",
        )

    def at(self, approach: Values, tilt: Values = 0.0) -> xr.Dataset:
        """Load, moment and stiffness at an approach and a tilt.

        Parameters
        ----------
        approach : float, sequence or DataArray
            Approach at the roller's mid-length, metres, relative to the table's reference.
        tilt : float, sequence or DataArray
            Radians, positive if the end at larger x is deeper. Two sequences give a table; DataArrays are broadcast.

        Returns
        -------
        Dataset
            `normal_load` Q (N), `moment` M about the roller's mid-length (N m), `normal_stiffness` dQ/d approach,
            `coupling_stiffness` dQ/d tilt = dM/d approach, `tilting_stiffness` dM/d tilt; `normal_load_error` and
            `moment_error`, from interpolation and discretisation; and the reference depths.

        Raises
        ------
        InvalidInputError
            Outside the table.
        """
        delta, theta = broadcast_arguments(approach=approach, tilt=tilt)
        for name, values in (("approach", delta), ("tilt", theta)):
            low, high = self.range_of(name)
            tolerance = ROUNDING * (high - low)
            outside_values = values.values[(values.values < low - tolerance) | (values.values > high + tolerance)]
            if outside_values.size:
                allowed = f"in the table, from {low:g} to {high:g} {UNITS[name]}"
                raise InvalidInputError(name, float(outside_values[0]), allowed)
        position = delta.values, theta.values
        return label_motion(delta, theta, self.motion(*position), self.errors(*position)).assign(self.references)

    def under(self, normal_load: Values, moment: Values = 0.0) -> xr.Dataset:
        """Approach and tilt under a load and a moment, with the stiffness.

        Parameters
        ----------
        normal_load, moment : float, sequence or DataArray
            N, and N m about the roller's mid-length; broadcast as in :meth:`at`.

        Returns
        -------
        Dataset
            `approach` (m), `tilt` (rad), their errors, and the variables of :meth:`at`.

        Raises
        ------
        InvalidInputError
            If approach and tilt are outside the table.
        """
        loads, moments = broadcast_arguments(normal_load=normal_load, moment=moment)
        delta, theta = xr.apply_ufunc(self.solve_position, loads, moments, **TWO_OUTPUTS)
        position = delta.values, theta.values
        motion = label_motion(delta, theta, self.motion(*position), self.errors(*position)).assign(self.references)
        return add_position_errors(motion)

    def motion(self, approach: FloatArray, tilt: FloatArray) -> ContactResponse:
        """Load, moment and stiffness as arrays, at pairs inside the table; the law extrapolates outside."""
        return self._spline(np.asarray(approach, dtype=np.float64), np.asarray(tilt, dtype=np.float64))

    def solve_position(self, load: float, moment: float) -> tuple[float, float]:
        """Approach and tilt under one load (N) and one moment (N m)."""
        load = checks.positive("normal_load", load, "N")
        length, nodes = float(self.table["contact_length"]), self._nodes
        distance = np.hypot(nodes.normal_load / load - 1, (nodes.moment - moment) / (load * length))
        row, column = np.unravel_index(int(distance.argmin()), distance.shape)
        bounds = np.transpose([self.range_of("approach"), self.range_of("tilt")])
        min_tilt, max_tilt = bounds[:, 1]
        scales = np.array([bounds[1, 0], max_tilt - min_tilt])

        def residual(scaled: FloatArray) -> FloatArray:
            motion = self.motion(*(scaled * scales))
            return np.array([motion.normal_load / load - 1, (motion.moment - moment) / (load * length)])

        def jacobian(scaled: FloatArray) -> FloatArray:
            *_, normal, coupling, tilting = self.motion(*(scaled * scales))
            moment_row = np.array([coupling, tilting]) / length
            return np.asarray(np.array([[normal, coupling], moment_row]) / load * scales)

        start = np.array([nodes.approaches[row], nodes.tilts[column]])
        position = find_root(residual, start, bounds, scales, jacobian)
        if position is None:
            low, high = nodes.normal_load.min(), nodes.normal_load.max()
            allowed = (
                f"of a contact in the table, whose loads go from {low:.4g} to {high:.4g} N "
                f"and tilts from {min_tilt:g} to {max_tilt:g} rad"
            )
            hint = "make the table for larger approaches or tilts"
            raise InvalidInputError("normal_load, moment", (load, moment), allowed, hint)
        return position

    def range_of(self, name: str) -> tuple[float, float]:
        """First and last approach or tilt."""
        return float(self.table[name][0]), float(self.table[name][-1])

    @property
    def references(self) -> xr.Dataset:
        """Depths to which approach and tilt refer, as far as the table has them."""
        return self.table[[name for name in ("reference_depth", "roller_reference_depth") if name in self.table]]

    def _node_values(self, name: str) -> FloatArray:
        """Values (approach, tilt) of a variable of the table."""
        return self.table[name].broadcast_like(self.table["normal_load"]).transpose("approach", "tilt").values

    @cached_property
    def _nodes(self) -> Nodes:
        node_arrays = (self._node_values(name) for name in ("strain_energy", "normal_load", "moment"))
        return Nodes(self.table["approach"].values, self.table["tilt"].values, *node_arrays)

    @cached_property
    def _spline(self) -> EnergySpline:
        return EnergySpline.fit(self._nodes)

    def errors(self, approach: FloatArray, tilt: FloatArray) -> FloatArray:
        """Errors of load and moment over the load, at pairs inside the table: the largest of the four nearest nodes."""
        row, column = (
            np.clip(np.searchsorted(nodes, values), 1, nodes.size - 1)
            for nodes, values in ((self._nodes.approaches, approach), (self._nodes.tilts, tilt))
        )
        errors = np.stack([self._node_values(f"relative_{name}_error") for name in ("load", "moment")])
        load, moment = np.max([errors[:, row - i, column - j] for i in (0, 1) for j in (0, 1)], axis=0)
        return np.array([load, float(self.table["contact_length"]) * moment])


@dataclass(frozen=True, eq=False)
class Raceways:
    """A roller between an inner and an outer raceway, free to tilt between them.

    Parameters
    ----------
    inner, outer : ContactLaw
        Laws of the same roller on either raceway, with x in the same direction.

    Raises
    ------
    InvalidInputError
        If an argument is not a ContactLaw.

    Notes
    -----
    Load and moment about mid-length are equal in both contacts, without centrifugal force and flange. Approaches and
    tilts add up to the relative motion of the raceways. The contacts deform an elastic roller independently.

    Examples
    --------
    >>> import contactstudy as cs
    >>> steel = cs.Material(210e9, 0.3)
    >>> roller = cs.Roller(radius=5e-3, length=0.3e-3, profile=cs.profiles.FullCrown(crown_radius=0.1))
    >>> case = cs.Case(body=cs.HalfSpace(material=steel), roller=roller, load=30.0)
    >>> law = cs.bearing.contact_law(case, np.linspace(-2e-4, 2e-4, 5), 1e-6 * np.linspace(1.0, 1.8, 5), accuracy=0.1)
    >>> raceways = Raceways(law, law)  # two equal contacts have equal approaches
    >>> round(float(raceways.at(2.6e-6).normal_load / law.at(1.3e-6).normal_load), 6)
    1.0
    """

    inner: ContactLaw
    outer: ContactLaw

    def __post_init__(self) -> None:
        for name in ("inner", "outer"):
            checks.instance(name, getattr(self, name), ContactLaw, "a ContactLaw, as contact_law returns")

    def at(self, approach: Values, tilt: Values = 0.0) -> xr.Dataset:
        """Load, moment and stiffness at an approach and a tilt of one raceway against the other.

        As :meth:`ContactLaw.at`; the result contains the motions of the contacts: `inner_approach`, `inner_tilt`,
        `outer_approach` and `outer_tilt`, with their reference depths.

        Raises
        ------
        InvalidInputError
            If either contact is outside its table.
        """
        delta, theta = broadcast_arguments(approach=approach, tilt=tilt)
        inner = xr.apply_ufunc(self._solve_inner_position, delta, theta, **TWO_OUTPUTS)
        return self._label_series(inner, (delta - inner[0], theta - inner[1]))

    def under(self, normal_load: Values, moment: Values = 0.0) -> xr.Dataset:
        """Approach and tilt of the raceways under a load and a moment, as :meth:`ContactLaw.under`.

        Raises
        ------
        InvalidInputError
            If either contact is outside its table.
        """
        loads, moments = broadcast_arguments(normal_load=normal_load, moment=moment)
        laws = (self.inner, self.outer)
        contacts = (xr.apply_ufunc(law.solve_position, loads, moments, **TWO_OUTPUTS) for law in laws)
        return add_position_errors(self._label_series(*contacts))

    def _label_series(self, inner: Position, outer: Position) -> xr.Dataset:
        """Label the series of two contacts at given approaches and tilts."""
        law_positions = [(self.inner, *inner), (self.outer, *outer)]
        contacts = [law.motion(delta.values, theta.values) for law, delta, theta in law_positions]
        # Compliances add up.
        matrices = [np.array([[normal, coupling], [coupling, tilting]]).T for *_, normal, coupling, tilting in contacts]
        (normal, _), (coupling, tilting) = np.linalg.inv(sum(map(np.linalg.inv, matrices))).T
        motion = contacts[0]._replace(normal_stiffness=normal, coupling_stiffness=coupling, tilting_stiffness=tilting)
        # The larger of the two errors bounds the error of either contact.
        errors = np.maximum(*(law.errors(delta.values, theta.values) for law, delta, theta in law_positions))
        labelled = label_motion(inner[0] + outer[0], inner[1] + outer[1], motion, errors)
        for raceway, (law, delta, theta) in zip(("inner", "outer"), law_positions, strict=True):
            for name, values in {"approach": delta, "tilt": theta, **law.references}.items():
                labelled[f"{raceway}_{name}"] = (values.dims, values.values)
        return describe(labelled)

    def _solve_inner_position(self, approach: float, tilt: float) -> tuple[float, float]:
        """Solve for the approach and tilt of the inner contact with equal loads and moments in both."""
        bounds = np.empty((2, 2))
        for index, (name, total) in enumerate((("approach", approach), ("tilt", tilt))):
            (first, last), (outer_first, outer_last) = self.inner.range_of(name), self.outer.range_of(name)
            bounds[:, index] = max(first, total - outer_last), min(last, total - outer_first)
            if not bounds[0, index] < bounds[1, index]:
                limits = f"from {first + outer_first:g} to {last + outer_last:g}"
                raise InvalidInputError(name, total, f"in the tables of both contacts together, {limits}")
        scales = np.array([approach, np.ptp(self.inner.range_of("tilt"))])
        length = float(self.inner.table["contact_length"])

        def residual(scaled: FloatArray) -> FloatArray:
            delta, theta = scaled * scales
            inner, outer = self.inner.motion(delta, theta), self.outer.motion(approach - delta, tilt - theta)
            scale = float(np.sqrt(inner.normal_load * outer.normal_load))
            return np.array([inner.normal_load - outer.normal_load, (inner.moment - outer.moment) / length]) / scale

        position = find_root(residual, 0.5 * np.array([approach, tilt]), bounds, scales)
        if position is None:
            allowed, hint = "such that either contact is in its table", "make the tables for more approaches or tilts"
            raise InvalidInputError("approach, tilt", (approach, tilt), allowed, hint)
        return position
