"""Functions of arrays applied to labelled arrays, of one case or of every case of a study at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr

from contactstudy.checks import Array


def reduced(
    function: Callable[..., tuple[Array, ...]], arguments: Sequence[tuple[xr.DataArray, Sequence[str]]], outputs: int
) -> tuple[xr.DataArray, ...]:
    """Apply a function that reduces some dimensions of its arguments to several numbers.

    Parameters
    ----------
    function : callable
        Takes arrays whose last axes are the dimensions to reduce, and returns `outputs` arrays without these.
    arguments : sequence of pairs
        DataArray and the dimensions to reduce, in order. Dask arrays stay lazy.
    outputs : int
        Number of arrays returned, at least two.

    Returns
    -------
    tuple of DataArray
        Of floats, along the dimensions that are left.

    Examples
    --------
    >>> numbers = xr.DataArray([[1.0, 4.0], [3.0, 2.0]], dims=("x", "y"))
    >>> least, most = reduced(lambda values: (values.min(-1), values.max(-1)), [(numbers, ["y"])], 2)
    >>> least.values.tolist(), most.values.tolist()
    ([1.0, 2.0], [4.0, 3.0])
    """
    results: tuple[xr.DataArray, ...] = xr.apply_ufunc(
        function,
        *(array for array, _ in arguments),
        input_core_dims=[list(dims) for _, dims in arguments],
        output_core_dims=[[]] * outputs,
        dask="parallelized",
        dask_gufunc_kwargs={"allow_rechunk": True},
        output_dtypes=[np.float64] * outputs,
    )
    return results
