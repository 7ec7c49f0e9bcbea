"""Kernels of strips: integrals over columns, images, and operators of columns."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import fft, integrate

from contactstudy import FiniteLengthSpace, Grid, HalfSpace, Material, QuarterSpace, cache
from contactstudy.bodies.models import Body
from contactstudy.checks import FloatArray
from contactstudy.fields.surface import ColumnsOperator, SurfaceOperator, end_kernel_of
from contactstudy.kernels.load import NORMAL_RESPONSE, Load, Response
from contactstudy.kernels.strips import (
    FAR_COLUMNS,
    GRADIENT_X,
    GRADIENT_Y,
    INVERSE,
    MIXED,
    SQUARE_X,
    ColumnsRequest,
    Strip,
    row_level,
    strips_of,
    surface_kernel,
)
from contactstudy.overlapping.quadrature import Resolution

WHOLE_LINE, ONE_END, TWO_ENDS = (-np.inf, np.inf), (0.0, np.inf), (0.0, 3.0)
STRIPS = [INVERSE, SQUARE_X, GRADIENT_Y, GRADIENT_X, MIXED]
each_strip = pytest.mark.parametrize("strip", STRIPS, ids=["inverse", "square x", "gradient y", "gradient x", "mixed"])


def compute_influence(
    strip: Strip,
    edges: FloatArray,
    dy: float,
    cells_y: int,
    extent: tuple[float, float],
    reference: float = np.inf,
    image_sign: int = 1,
) -> FloatArray:
    """Influence of a strip (wavenumber, cell, cell)."""
    return ColumnsRequest(edges=edges, dy=dy, cells_y=cells_y, extent=extent, reference=reference).influence(
        ((1.0, strip),), image_sign
    )


def compute_strip_kernel(strip: Strip, x: float, low: float, high: float) -> float:
    """Integral over y from low to high of the strip's density, from the definition."""
    r_low, r_high = float(np.hypot(x, low)), float(np.hypot(x, high))
    inverse = np.arcsinh(high / abs(x)) - np.arcsinh(low / abs(x))
    return {
        INVERSE: float(inverse),
        SQUARE_X: float(high / r_high - low / r_low),
        GRADIENT_Y: float(np.log(r_high / r_low)),
        GRADIENT_X: float(np.arctan(high / x) - np.arctan(low / x)),
        MIXED: x * (1 / r_low - 1 / r_high),
    }[strip]


def compute_mean_influence(
    strip: Strip, observed: tuple[float, float], loaded_column: tuple[float, float], low: float, high: float
) -> float:
    """Mean influence over one column of a unit force per length of y on another, by quadrature over the distance."""
    (observed_start, observed_stop), (loaded_start, loaded_stop) = observed, loaded_column

    def weighted(distance: float) -> float:
        overlap = max(0.0, min(observed_stop, loaded_stop + distance) - max(observed_start, loaded_start + distance))
        return overlap * compute_strip_kernel(strip, distance if abs(distance) > 1e-300 else 1e-300, low, high)

    corners = sorted(
        {
            observed_start - loaded_stop,
            observed_start - loaded_start,
            observed_stop - loaded_stop,
            observed_stop - loaded_start,
            *((0.0,) if observed_start - loaded_stop < 0 < observed_stop - loaded_start else ()),
        }
    )
    influences = [
        integrate.quad(weighted, start, stop, epsabs=1e-13, epsrel=1e-10, limit=200)[0]
        for start, stop in pairwise(corners)
    ]
    return sum(influences) / ((observed_stop - observed_start) * (loaded_stop - loaded_start))


def transform_to_offsets(kernel: FloatArray, strip: Strip) -> FloatArray:
    """Influence (offset along y, cell, cell) from its transform, with offsets from 0."""
    if strip.sign_y > 0:
        return np.asarray(fft.idct(kernel, type=1, axis=0))
    inner_kernel = -fft.idst(kernel[1:-1], type=1, axis=0)
    return np.pad(np.asarray(inner_kernel), ((1, 1), (0, 0), (0, 0)))


EDGES = np.array([0.0, 0.02, 0.05, 0.12, 0.3, 0.62, 0.9, 1.4, 1.9])


@each_strip
@pytest.mark.parametrize("image_sign", [1, -1])
@pytest.mark.parametrize("extent", [WHOLE_LINE, ONE_END, (-np.inf, 3.0), TWO_ENDS], ids=str)
def test_shifted_body_has_equal_influence(strip: Strip, image_sign: int, extent: tuple[float, float]) -> None:
    edges = np.array([0.0, 0.2, 0.7, 1.9, 2.5, 3.0])
    influence_at_origin = compute_influence(strip, edges, 0.3, 5, extent, 20.0, image_sign)
    shifted_influence = compute_influence(
        strip, edges + 8.0, 0.3, 5, (extent[0] + 8.0, extent[1] + 8.0), 20.0, image_sign
    )
    assert np.abs(shifted_influence - influence_at_origin).max() < 1e-9 * np.abs(influence_at_origin).max()


@each_strip
@pytest.mark.parametrize(("observed", "loaded_column"), [(0, 0), (0, 1), (3, 1), (7, 2), (6, 7)])
@pytest.mark.parametrize("offset", [0, 1, 4])
def test_influence_between_columns_is_the_double_integral(
    strip: Strip, observed: int, loaded_column: int, offset: int
) -> None:
    dy, cells_y = 0.2, 6
    kernel = transform_to_offsets(compute_influence(strip, EDGES, dy, cells_y, WHOLE_LINE), strip)
    columns = (EDGES[observed], EDGES[observed + 1]), (EDGES[loaded_column], EDGES[loaded_column + 1])
    double_integral = compute_mean_influence(strip, *columns, (offset - 0.5) * dy, (offset + 0.5) * dy)
    assert kernel[offset, observed, loaded_column] == pytest.approx(double_integral, rel=2e-9, abs=1e-12)


@pytest.mark.parametrize("image_sign", [1, -1])
@each_strip
def test_image_equals_mirrored_column(strip: Strip, image_sign: int) -> None:
    dy, cells_y, end_x = 0.2, 6, -0.1
    baseline = transform_to_offsets(compute_influence(strip, EDGES, dy, cells_y, WHOLE_LINE), strip)
    reflected_influence = (
        transform_to_offsets(
            compute_influence(strip, EDGES, dy, cells_y, (end_x, np.inf), image_sign=image_sign), strip
        )
        - baseline
    )
    for observed, loaded_column, offset in ((0, 0, 0), (2, 5, 1), (7, 7, 3)):
        mirrored_column = (2 * end_x - EDGES[loaded_column + 1], 2 * end_x - EDGES[loaded_column])
        observed_column = (EDGES[observed], EDGES[observed + 1])
        mirrored_influence = image_sign * compute_mean_influence(
            strip, observed_column, mirrored_column, (offset - 0.5) * dy, (offset + 0.5) * dy
        )
        assert reflected_influence[offset, observed, loaded_column] == pytest.approx(
            mirrored_influence, rel=2e-9, abs=1e-12
        )


@each_strip
def test_strip_derivatives_and_primitives_match_kernel(strip: Strip) -> None:
    step = 1e-4
    x, y = np.meshgrid(np.linspace(0.3, 4.0, 7), np.array([0.05, 0.4, 2.0]))
    kernel_before, centre_kernel, kernel_after = (strip.kernel(x + shift, y) for shift in (-step, 0.0, step))
    assert np.allclose(
        (kernel_after - 2 * centre_kernel + kernel_before) / step**2, strip.curvature(x, y), rtol=1e-5, atol=2e-7
    )
    primitive_difference = (strip.primitive(x + step, y) - strip.primitive(x - step, y)) / (2 * step)
    # The difference is a neglected term independent of y.
    neglected_term = primitive_difference - centre_kernel
    assert np.allclose(neglected_term, neglected_term[:1], atol=1e-7)


@st.composite
def draw_increasing_edges(draw: st.DrawFn) -> FloatArray:
    """Edges whose widths differ by a factor of 2.5 from cell to cell at most."""
    ratios = draw(st.lists(st.floats(0.4, 2.5), min_size=1, max_size=14))
    widths = np.cumprod([1.0, *ratios])
    edges = np.append(0.0, np.cumsum(widths))
    return np.asarray(3.0 * edges / edges[-1])


sampled_strips = st.sampled_from(STRIPS)


@settings(max_examples=30)
@given(edges=draw_increasing_edges(), strip=sampled_strips)
def test_influence_is_reciprocal_to_the_last_bit(edges: FloatArray, strip: Strip) -> None:
    """The influence of an odd strip with images of one sign is reciprocal to that with images of the other sign."""
    for extent in (WHOLE_LINE, ONE_END):
        kernel, scaled_kernel = (
            compute_influence(strip, edges, 0.1, 6, extent, image_sign=image_sign) for image_sign in (1, strip.sign_x)
        )
        assert np.array_equal(kernel, strip.sign_x * scaled_kernel.transpose(0, 2, 1))
    kernel, scaled_kernel = (
        compute_influence(strip, edges, 0.1, 6, TWO_ENDS, 30.0, image_sign=image_sign)
        for image_sign in (1, strip.sign_x)
    )
    # Far images of a traction are differences of large numbers.
    tolerance = 1e-12 if strip is INVERSE else 1e-7
    assert np.abs(kernel - strip.sign_x * scaled_kernel.transpose(0, 2, 1)).max() < tolerance * np.abs(kernel).max()


@settings(max_examples=30)
@given(edges=draw_increasing_edges(), strip=sampled_strips, has_two_ends=st.booleans())
def test_reversed_columns_have_reversed_influence(edges: FloatArray, strip: Strip, has_two_ends: bool) -> None:
    extent = TWO_ENDS if has_two_ends else WHOLE_LINE
    kernel = compute_influence(strip, edges, 0.1, 6, extent, 30.0)
    reversed_influence = compute_influence(strip, 3.0 - edges[::-1], 0.1, 6, extent, 30.0)
    assert np.abs(kernel - strip.sign_x * reversed_influence[:, ::-1, ::-1]).max() < 1e-7 * np.abs(kernel).max()


@settings(max_examples=30)
@given(edges=draw_increasing_edges())
def test_influence_is_positive_definite(edges: FloatArray) -> None:
    for matrix in compute_influence(INVERSE, edges, 0.1, 6, WHOLE_LINE):
        assert np.linalg.eigvalsh(matrix).min() > 0


@settings(max_examples=30)
@given(edges=draw_increasing_edges(), strip=sampled_strips, has_two_ends=st.booleans(), split_column=st.integers(0, 20))
def test_split_columns_sum_to_original_column(
    edges: FloatArray, strip: Strip, has_two_ends: bool, split_column: int
) -> None:
    """The force on a column is distributed in proportion to the widths of its parts; their displacements are
    averaged."""
    split_column %= edges.size - 1
    extent = TWO_ENDS if has_two_ends else WHOLE_LINE
    split_edges = np.insert(
        edges, split_column + 1, edges[split_column] + 0.3 * (edges[split_column + 1] - edges[split_column])
    )
    widths, original_column = (
        np.diff(split_edges),
        np.searchsorted(edges, 0.5 * (split_edges[1:] + split_edges[:-1])) - 1,
    )
    fractions = np.zeros((edges.size - 1, widths.size))
    fractions[original_column, np.arange(widths.size)] = widths / np.diff(edges)[original_column]
    coarse_influence = compute_influence(strip, edges, 0.1, 6, extent, 30.0)
    fine_influence = fractions @ compute_influence(strip, split_edges, 0.1, 6, extent, 30.0) @ fractions.T
    assert np.abs(fine_influence - coarse_influence).max() < 1e-7 * np.abs(coarse_influence).max()


@each_strip
def test_far_expansion_matches_integral(strip: Strip) -> None:
    dy, cells_y = 0.01, 4
    edges = np.array([0.0, 1e-3, 2e-3, 4e-3, 1.0, 1.03])
    kernel = transform_to_offsets(compute_influence(strip, edges, dy, cells_y, WHOLE_LINE), strip)
    assert edges[4] - edges[3] > FAR_COLUMNS * (edges[5] - edges[4])
    for offset in (0, 2):
        integral = compute_mean_influence(strip, (0.0, 1e-3), (1.0, 1.03), (offset - 0.5) * dy, (offset + 0.5) * dy)
        scale = max(np.abs(kernel[:, 4, 4]).max(), np.abs(kernel[:, 0, 4]).max())
        assert abs(kernel[offset, 0, 4] - integral) < 1e-7 * scale
        assert kernel[offset, 0, 4] == pytest.approx(integral, rel=1e-6, abs=1e-15)
        assert kernel[offset, 4, 0] == strip.sign_x * kernel[offset, 0, 4]


def test_very_narrow_columns_keep_their_digits() -> None:
    """A column of 1e-5 a lies between wide columns, at 150 a from them."""
    edges = np.concatenate([1e-5 * 2.0 ** np.arange(24), [150.0, 150.0 + 1e-5]])
    edges = np.insert(edges, 0, 0.0)
    kernel = transform_to_offsets(compute_influence(INVERSE, edges, 0.1, 4, WHOLE_LINE), INVERSE)
    last_column, y = edges.size - 2, (-0.05, 0.05)
    for observed, loaded_column in ((0, 0), (5, 0), (0, last_column), (last_column, last_column)):
        column_pair = (edges[observed], edges[observed + 1]), (edges[loaded_column], edges[loaded_column + 1])
        distance = 0.5 * (sum(column_pair[0]) - sum(column_pair[1]))
        # At a large distance both columns are points.
        is_far = abs(distance) > 1
        exact_influence = (
            compute_strip_kernel(INVERSE, abs(distance), *y)
            if is_far
            else compute_mean_influence(INVERSE, *column_pair, *y)
        )
        assert kernel[0, observed, loaded_column] == pytest.approx(exact_influence, rel=1e-6)


STEEL = Material(210e9, 0.3)
LENGTH = 1e-3
BODIES: list[Body] = [
    HalfSpace(material=STEEL),
    QuarterSpace(material=STEEL),
    QuarterSpace(material=STEEL, model="mirror-factor"),
    FiniteLengthSpace(length=LENGTH, material=STEEL),
    FiniteLengthSpace(length=LENGTH, material=STEEL, model="mirror"),
    FiniteLengthSpace(length=LENGTH, material=STEEL, model="single-mirror"),
]


LOADS = (Load.NORMAL, Load.ALONG_X, Load.ALONG_Y)


@pytest.mark.parametrize("body", BODIES, ids=lambda body: f"{type(body).__name__}-{getattr(body, 'model', '')}")
def test_operator_averages_displacement_of_finer_cells(body: Body) -> None:
    refinement, cells_x, cells_y = 8, 24, 12
    y_range = (-1.2e-4, 1.2e-4)
    fine_influence, coarse_influence = (
        Grid(x_range=(0.0, LENGTH), y_range=y_range, cells_x=cells_x * factor, cells_y=cells_y)
        for factor in (refinement, 1)
    )
    pressure = np.random.default_rng(0).random(coarse_influence.shape)
    is_single_mirror = getattr(body, "model", "") == "single-mirror"
    loads, directions = (LOADS[::2], LOADS[:1]) if is_single_mirror else (LOADS, LOADS)
    responses = tuple(Response(direction, load) for direction in directions for load in loads)
    fine_operator = SurfaceOperator.of(body, fine_influence, loads, directions)
    material, operators = body.material, []
    for term in body.terms:
        end_kernels = end_kernel_of(term, material, coarse_influence, responses, Resolution())
        operators.append(
            (term.weight, ColumnsOperator.of(material, term.extent, coarse_influence, responses, end_kernels))
        )
    columns = SurfaceOperator(body, operators)
    for load in loads:
        displacements = fine_operator.compute_displacements({load: np.repeat(pressure, refinement, axis=0)}, directions)
        means = {
            mean_direction: displacement.reshape(cells_x, refinement, cells_y).mean(axis=1)
            for mean_direction, displacement in displacements.items()
        }
        computed = columns.compute_displacements({load: pressure}, directions)
        max_variation = max(float(np.ptp(mean_direction)) for mean_direction in means.values())
        for direction, mean in means.items():
            assert np.abs(computed[direction] - mean).max() < 1.5e-3 * max_variation, (load, direction)


def test_operator_converges_to_uniform_cells() -> None:
    """The difference is the error of the finer cells and decreases with the square of their size."""
    body, cells_x, cells_y = HalfSpace(material=STEEL), 16, 8
    coarse_influence = Grid(x_range=(0.0, LENGTH), y_range=(-1.2e-4, 1.2e-4), cells_x=cells_x, cells_y=cells_y)
    pressure = np.random.default_rng(1).random(coarse_influence.shape)
    operator = ColumnsOperator.of(STEEL, body.extent, coarse_influence, (NORMAL_RESPONSE,), None)
    columns = operator({Load.NORMAL: pressure}, (Load.NORMAL,))[Load.NORMAL]
    differences = []
    for refinement in (4, 8, 16):
        fine_influence = Grid(
            x_range=(0.0, LENGTH), y_range=(-1.2e-4, 1.2e-4), cells_x=cells_x * refinement, cells_y=cells_y
        )
        fine_operator = SurfaceOperator.of(body, fine_influence)({Load.NORMAL: np.repeat(pressure, refinement, axis=0)})
        differences.append(
            np.abs(fine_operator.reshape(cells_x, refinement, cells_y).mean(axis=1) - columns).max() / np.ptp(columns)
        )
    assert differences[1] < 0.35 * differences[0]
    assert differences[2] < 0.35 * differences[1]


P, X, Y = Load.NORMAL, Load.ALONG_X, Load.ALONG_Y


@pytest.mark.parametrize("unit", [2.0**-17, 1.0, 2.0**10])
@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("response", [Response(P, P), Response(Y, Y)])
def test_image_row_vanishes_at_reference(response: Response, poisson: float, unit: float) -> None:
    """The displacement is proportional to ``2 (1 - nu) / L ln(r / y)`` per force, like under a line load."""
    length, reference, cell = 0.8 * unit, 8.0 * unit, 0.1 * unit
    x, y = cell * np.arange(4.0), cell * np.array([40.0, 80.0, 160.0])
    computed = np.stack(
        [
            surface_kernel(
                response, poisson, x, scaled_kernel * np.ones(1), (cell, cell), length=length, reference=reference
            )[:, 0]
            for scaled_kernel in y
        ]
    )
    row_factor = cell**2 * 2 * (1 - poisson) / length
    expected = row_factor * np.log(reference / y)[:, None] * np.ones(4)
    assert computed == pytest.approx(expected, abs=2e-3 * cell**2 / length)


def test_image_rows_without_net_load_have_zero_level() -> None:
    for displacement in (P, X, Y):
        for load in (P, X, Y):
            computed = row_level(strips_of(Response(displacement, load), 0.3), load.sign_x, 0.8, 8.0)
            assert (computed != 0) == ((displacement, load) in ((P, P), (Y, Y)))


@pytest.mark.parametrize("response", [Response(Load.NORMAL, Load.NORMAL), Response(Load.ALONG_X, Load.NORMAL)])
def test_influences_do_not_depend_on_cached_columns(response: Response) -> None:
    coarse_influence = np.array([0.0, 0.02, 0.05, 0.2, 0.4, 0.8, 1.0])
    fine_influence = np.sort(np.append(coarse_influence, [0.01, 0.3, 0.9]))

    def compute_kernel(edges: np.ndarray) -> np.ndarray:
        request = ColumnsRequest(edges=edges, dy=0.03, cells_y=8, extent=(0.0, 1.0), reference=10.0)
        return request.kernel(response, 0.3)

    cache.clear()
    uncached_kernel = compute_kernel(fine_influence)
    cache.clear()
    compute_kernel(coarse_influence)
    np.testing.assert_array_equal(compute_kernel(fine_influence), uncached_kernel)
