"""The contact algorithm of 1999 on SciPy's transforms: a plain script."""

from __future__ import annotations

import numpy as np
from scipy import fft

from benchmarks.performance.problems import FloatArray, Problem

MAX_ITERATIONS = 5000


def compute_corner_primitive(x: FloatArray, y: FloatArray) -> FloatArray:
    distance = np.hypot(x, y)
    return np.asarray(x * np.log(y + distance) + y * np.log(x + distance))


def compute_influence_spectrum(problem: Problem) -> FloatArray:
    """Spectrum of the displacement of every cell under unit pressure on one cell (A. E. H. Love's formula)."""
    axes = []
    for count, size in zip(problem.gap.shape, problem.size, strict=True):
        offset = np.arange(2 * count)
        offset[count:] -= 2 * count
        axes.append(np.abs(offset) * size / count)
    half_x, half_y = (size / count / 2 for count, size in zip(problem.gap.shape, problem.size, strict=True))
    x, y = axes[0][:, None], axes[1][None, :]
    kernel = (
        compute_corner_primitive(x + half_x, y + half_y)
        + compute_corner_primitive(x - half_x, y - half_y)
        - compute_corner_primitive(x + half_x, y - half_y)
        - compute_corner_primitive(x - half_x, y + half_y)
    )
    return np.asarray(fft.rfft2(kernel / (np.pi * problem.contact_modulus)))


def solve_classic(problem: Problem, tolerance: float) -> FloatArray:
    """Pressure by the conjugate gradients of I. A. Polonsky and L. M. Keer, Wear 231 (1999) 206."""
    gap = problem.finite_gap
    cells = gap.shape
    padded_shape = (2 * cells[0], 2 * cells[1])
    spectrum = compute_influence_spectrum(problem)

    def apply(pressure: FloatArray) -> FloatArray:
        convolution = fft.irfft2(fft.rfft2(pressure, s=padded_shape) * spectrum, s=padded_shape)
        return np.asarray(convolution[: cells[0], : cells[1]])

    pressure_sum = problem.load * cells[0] * cells[1] / (problem.size[0] * problem.size[1])
    pressure = np.full(cells, pressure_sum / gap.size)
    direction = np.zeros(cells)
    restart, previous_norm = 0.0, 1.0
    for _ in range(MAX_ITERATIONS):
        contact = pressure > 0
        height = gap + apply(pressure)
        height -= height[contact].mean()
        norm = float((height[contact] ** 2).sum())
        direction = np.where(contact, height + restart * norm / previous_norm * direction, 0.0)
        previous_norm = norm
        displacement = apply(direction)
        displacement -= displacement[contact].mean()
        step = float((height[contact] * direction[contact]).sum() / (displacement[contact] * direction[contact]).sum())
        previous_pressure = pressure
        pressure = np.where(contact, np.maximum(pressure - step * direction, 0.0), 0.0)
        overlapping = (pressure == 0) & (height < 0)
        restart = 0.0 if overlapping.any() else 1.0
        pressure = np.where(overlapping, pressure - step * height, pressure)
        pressure *= pressure_sum / pressure.sum()
        if float(np.abs(pressure - previous_pressure).sum()) / pressure_sum < tolerance:
            return pressure
    raise RuntimeError(f"no convergence to {tolerance:g} in {MAX_ITERATIONS} iterations")
