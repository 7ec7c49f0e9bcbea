"""Stress history of a material point that the contact rolls over.

The field along y at one (x, z) is the history of the point there during one passage. A point of the body is unloaded
before and after: the window of a result shows only part of that. So the unloaded state is added to every history, and
what the window leaves out between its border and the unloaded state is measured by :func:`window_remainder`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from contactstudy.analysis import dimension_along
from contactstudy.arrays.units import required_in_si
from contactstudy.arrays.variables import STRESSES, UNBOUNDED, Variable, named
from contactstudy.checks import Array
from contactstudy.errors import InvalidInputError

OF_POINTS = f"of the stresses at the given points, {UNBOUNDED}"
"""Comment of what is made of a history."""

FEWEST_POSITIONS = 3
"""Along y, for a history."""

COMPONENT = "stress_component"
"""Dimension of the six components while a history is worked on."""


def histories(stress: xr.Dataset) -> tuple[xr.DataArray, str]:
    """Six stress components with the rolling direction and the component last, and the name of the former.

    Raises
    ------
    InvalidInputError
        If a component is missing, the rolling direction is, or it has fewer than three positions.
    """
    stress = required_in_si(stress, *STRESSES, argument="stress")
    rolling = dimension_along(stress["tau_yz"], "y")
    if stress.sizes[rolling] < FEWEST_POSITIONS:
        raise InvalidInputError(
            f"stress.sizes[{rolling!r}]",
            stress.sizes[rolling],
            f"at least {FEWEST_POSITIONS}: the positions along y are the history",
            "solve with y over the whole passage, for example from -3 to 3 half-widths",
        )
    tensor = xr.concat([stress[name] for name in STRESSES], dim=COMPONENT, coords="minimal", compat="override")
    lead = [dim for dim in tensor.dims if dim not in (rolling, COMPONENT)]
    return tensor.transpose(*lead, rolling, COMPONENT), rolling


def over_history(
    function: Callable[[Array], tuple[Array, ...]], stress: xr.Dataset, sizes: tuple[tuple[str, int] | None, ...]
) -> tuple[xr.DataArray, ...]:
    """Apply a function of histories to every material point of a result.

    Parameters
    ----------
    function : callable
        From an array (point, instant, 6), whose last instant is the unloaded state, to arrays (point,) or (point, n).
    stress : Dataset
        With the six components.
    sizes : tuple
        For each array that the function returns: None, or name and size of its last dimension.

    Returns
    -------
    tuple of DataArray
        Without the rolling direction; NaN where a study is padded.
    """
    tensor, rolling = histories(stress)

    def apply(values: Array) -> Array | tuple[Array, ...]:
        lead = values.shape[:-2]
        flat = values.reshape(-1, *values.shape[-2:]).astype(np.float64)
        absent = np.isnan(flat).any(axis=-1)
        known = ~absent.all(axis=-1)
        # Positions that pad a shorter window are as unloaded as those beyond it.
        flat[absent] = 0.0
        history = np.concatenate([flat, np.zeros_like(flat[:, :1])], axis=1)[known]
        results = []
        computed = function(history) if known.any() else None
        for number, extra in enumerate(sizes):
            full = np.full((known.size, *(() if extra is None else (extra[1],))), np.nan)
            if computed is not None:
                full[known] = computed[number]
            results.append(full.reshape((*lead, *full.shape[1:])))
        return tuple(results) if len(results) > 1 else results[0]

    found = xr.apply_ufunc(
        apply,
        tensor,
        input_core_dims=[[rolling, COMPONENT]],
        output_core_dims=[[] if extra is None else [extra[0]] for extra in sizes],
        dask="parallelized",
        dask_gufunc_kwargs={
            "allow_rechunk": True,
            "output_sizes": {extra[0]: extra[1] for extra in sizes if extra is not None},
        },
        output_dtypes=[np.float64] * len(sizes),
    )
    return tuple(found) if len(sizes) > 1 else (found,)


def of_points(name: str, array: xr.DataArray, base: Variable | None = None) -> xr.DataArray:
    """Return what is made of the histories at points with its name, its unit and the mark that it has no error.

    Parameters
    ----------
    name : str
        In the table of variables.
    array : DataArray
        Values.
    base : Variable, optional
        As for :func:`contactstudy.arrays.variables.named`.

    Examples
    --------
    >>> of_points("dang_van", xr.DataArray(1.0)).attrs["comment"]
    'of the stresses at the given points, no error known'
    """
    return named(name, array, base).assign_attrs(comment=OF_POINTS)


def window_remainder(stress: xr.Dataset) -> xr.DataArray:
    """Stress at the window's borders in y over the largest of the passage: how much of a history is left out.

    Every fatigue measure here takes the unloaded state as part of the history, so the remainder matters only where
    an extreme lies beyond the window. The extremes of the orthogonal shear lie at ``y = 0.87 a`` near the surface,
    and move out to ``y = z / sqrt(3)`` at depths of several half-widths.

    Parameters
    ----------
    stress : Dataset
        The six components `sigma_xx` ... `tau_yz`, with the rolling direction `y`, `y_field` or ``y_index``.

    Returns
    -------
    DataArray
        Largest magnitude of the stress tensor (root of the sum of its squared components) at the first and the last
        position along y, over that anywhere along y; 0 for a history that begins and ends unloaded, 1 at most.

    Raises
    ------
    InvalidInputError
        If a component or the rolling direction is missing, or there are fewer than three positions along it.

    Examples
    --------
    >>> passage = xr.DataArray([0.0, 1.0, 0.25], dims="y", coords={"y": [-1.0, 0.0, 1.0]})
    >>> float(window_remainder(xr.Dataset({name: passage for name in STRESSES})))
    0.25
    """

    def remainder(history: Array) -> tuple[Array, ...]:
        weights = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
        magnitude = np.sqrt((history[:, :-1] ** 2) @ weights)
        largest = magnitude.max(axis=1)
        border = np.maximum(magnitude[:, 0], magnitude[:, -1])
        return (np.divide(border, largest, out=np.zeros_like(border), where=largest > 0),)

    stress = required_in_si(stress, *STRESSES, argument="stress")
    rolling = dimension_along(stress["tau_yz"], "y")
    # Positions may be in any order.
    ordered = stress.sortby(rolling) if rolling in stress.indexes else stress
    (result,) = over_history(remainder, ordered, (None,))
    return named("window_remainder", result)
