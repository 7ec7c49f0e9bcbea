"""Peaks of sampled pressures and fields: values between samples, and the width of a peak."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contactstudy.checks import FloatArray

FLANK = 0.8  # Height over a peak's where its width is measured: 0.6 of the base of a half-ellipse. Accuracy.
SAMPLE_COUNT = 17  # Points of the interpolating polynomial between the two neighbours of a sample. Accuracy.


def section_maxima(pressure: FloatArray) -> FloatArray:
    """Largest pressure of each cross-section, interpolated between the cells along y of `pressure` (x, y)."""
    # The squared pressure is nearly a parabola across the contact, through the largest cell and its neighbours.
    squared = pressure**2
    central_cell = np.clip(squared.argmax(axis=1), 1, squared.shape[1] - 2)
    lower, central, upper = (squared[np.arange(central_cell.size), central_cell + step] for step in (-1, 0, 1))
    second_difference = np.minimum(lower - 2 * central + upper, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = np.where(second_difference < 0, -((upper - lower) ** 2) / (8 * second_difference), 0.0)
    maxima = squared.max(axis=1)
    # Three cells determine a parabola; one or two cells do not.
    return np.sqrt(np.where(maxima > 0, np.maximum(central + np.minimum(rise, 0.25 * central), maxima), 0.0))


def lagrange_weights(nodes: FloatArray, points: FloatArray) -> FloatArray:
    """Matrix (point, node) that interpolates from `nodes` to `points` by one polynomial."""
    matrix = np.empty((points.size, nodes.size))
    for i, node in enumerate(nodes):
        other_nodes = np.delete(nodes, i)
        matrix[:, i] = np.prod((points[:, None] - other_nodes) / (node - other_nodes), axis=1)
    return matrix


def interpolate_about(
    axes: Sequence[FloatArray], index: Sequence[int], values: FloatArray, neighbours: int
) -> tuple[list[FloatArray], FloatArray]:
    """Points about a sample along each axis, and their values (component, *axes, ...), by `neighbours` on each side."""
    points, matrices = [], []
    for dimension, (axis, centre) in enumerate(zip(axes, index, strict=True), start=1):
        # At an edge the polynomial uses samples on one side only.
        count = min(2 * neighbours + 1, axis.size)
        start = min(max(centre - neighbours, 0), axis.size - count)
        nodes = axis[start : start + count]
        low, high = axis[max(centre - 1, 0)], axis[min(centre + 1, axis.size - 1)]
        samples = np.unique(np.append(np.linspace(low, high, SAMPLE_COUNT), axis[centre])) if count > 1 else nodes
        values = values[(slice(None),) * dimension + (slice(start, start + count),)]
        points.append(samples)
        matrices.append(lagrange_weights(nodes, samples))
    for dimension, matrix in enumerate(matrices, start=1):
        values = np.moveaxis(np.tensordot(matrix, values, axes=(1, dimension)), 0, dimension)
    return points, values


def variation_lengths(
    pressure: FloatArray, x: FloatArray, dy: float, column: int, *, rising: bool = True
) -> tuple[float, float]:
    """Lengths along x and y over which a pressure varies about one column, metres."""
    # The length along x is the half-width of a half-ellipse that falls (or with `rising` rises) as fast as the
    # pressure; infinite for a nearly uniform pressure; for a column without pressure, the distance to the contact.
    axial = pressure.max(axis=1)
    is_different = axial < FLANK * axial[column]
    if rising:
        is_different |= FLANK * axial > axial[column]
    loaded_column = column if axial[column] > 0 else int(axial.argmax())
    length_y = 0.5 * dy * np.count_nonzero(pressure[loaded_column] > 0)
    length_x = np.abs(x[is_different] - x[column]).min() if is_different.any() else np.inf
    if axial[column] > 0:
        length_x /= np.sqrt(1 - FLANK**2)
    return float(length_x), float(length_y)
