import numpy as np
import pytest
from matplotlib import pyplot

from contactstudy import analysis, plots
from contactstudy.errors import InvalidInputError


@pytest.mark.parametrize(("axis", "labels"), [("x", ("y/a", "z/a")), ("y", ("x/a", "z/a")), ("z", ("x/a", "y/a"))])
def test_stress_planes_have_axis_labels(case_result, assert_nothing_clipped, axis, labels):
    position = {"x": 0.2e-3, "y": 1e-5, "z": 2e-5}[axis]
    ax = plots.plot_stress_plane(case_result, "tresca", **{axis: position})
    assert labels[0] in ax.get_xlabel()
    assert labels[1] in ax.get_ylabel()
    assert ax.get_title().startswith(f"plane ${axis}/a$ = ")
    low, high = ax.get_ylim()
    assert (low > high) == (axis != "z")
    assert_nothing_clipped(ax.figure)


def test_levels_cover_the_stress_of_the_plane(case_result):
    ax = plots.plot_stress_plane(case_result)
    plane = analysis.in_plane(case_result, y=0.0)["von_mises"] / 1.5e9
    levels = ax.collections[0].levels
    assert levels[0] <= float(plane.min())
    assert levels[-1] >= float(plane.max())


@pytest.mark.parametrize(("y", "off_plane"), [(0.0, ""), (0.4, " at $y/a$ = 0.4")])
@pytest.mark.parametrize("x", [1e-4, 4e-4])
def test_largest_stress_is_marked_with_its_value(case_result, assert_nothing_clipped, x, y, off_plane):
    a = float(case_result["hertz_half_width"])
    peak_position = {"peak_von_mises_x": x, "peak_von_mises_y": y * a, "peak_von_mises_z": 2e-5}
    case = case_result.assign(peak_position | {"peak_von_mises": 0.9 * 1.5e9})
    ax = plots.plot_stress_plane(case)
    (label,) = ax.texts
    assert label.get_text() == f"0.9{off_plane}"
    np.testing.assert_allclose(label.xy, (x / a, 2e-5 / a))
    (label_si,) = plots.plot_stress_plane(case, si=True).texts
    assert label_si.get_text().startswith("1350")
    assert_nothing_clipped(ax.figure)
    label_span = label.get_window_extent().intervalx
    assert (label_span >= ax.bbox.x0).all()
    assert (label_span <= ax.bbox.x1).all()


def test_single_plane_result_has_plot_in_its_plane_only(study_case):
    ax = plots.plot_stress_plane(study_case, "sigma_xx")
    low, high = ax.get_ylim()
    assert low > high
    with pytest.raises(InvalidInputError, match="this plane only"):
        plots.plot_stress_plane(study_case, y=1e-5)


def test_end_face_contours_are_continuous(case_result, assert_nothing_clipped):
    ax = plots.plot_end_face(case_result)
    contour_levels = [collection.levels for collection in ax.collections if getattr(collection, "filled", False)]
    assert len(contour_levels) == 2
    assert np.array_equal(*contour_levels)
    low, high = ax.get_xlim()
    # The field contains four half-widths along y: two on either side of the fold.
    assert low == pytest.approx(-2.0)
    assert high == pytest.approx(4.0)
    assert [tick.get_text() for tick in ax.get_xticklabels()] == [
        f"{abs(tick_position):g}" for tick_position in ax.get_xticks()
    ]
    assert_nothing_clipped(ax.figure)


def test_symmetric_case_has_equal_end_faces(case_result, draw_pixels):
    images = [draw_pixels(plots.plot_end_face(case_result, end=end).figure) for end in ("first", "last")]
    assert (np.abs(images[0].astype(int) - images[1]).max(axis=-1) > 40).mean() < 0.01


def test_end_face_of_sliding_contact_depends_on_side(case_result, draw_pixels):
    images = [draw_pixels(plots.plot_end_face(case_result, "tau_yz", side=side).figure) for side in (1, -1)]
    assert not np.array_equal(*images)


def test_end_face_is_limited_to_distance(case_result):
    ax = plots.plot_end_face(case_result, distance=1.5)
    assert ax.get_xlim()[1] <= 1.5 * (1 + 1e-9)


def test_stress_figures_use_given_axes(case_result):
    for draw in (plots.plot_stress_plane, plots.plot_end_face):
        ax = pyplot.figure().add_subplot()
        assert draw(case_result, ax=ax) is ax


def test_invalid_argument_raises(case_result, study_dataset, study_case):
    for call, message in (
        (lambda: plots.plot_stress_plane(study_dataset), "single case"),
        (lambda: plots.plot_stress_plane(study_case.drop_vars(["von_mises", "sigma_xx"])), "level"),
        (lambda: plots.plot_stress_plane(case_result, x=0.0, z=0.0), "exactly one"),
        (lambda: plots.plot_stress_plane(case_result.isel(z=[0])), "two or more positions"),
        (lambda: plots.plot_stress_plane(case_result, "normal_load"), "same points"),
        (lambda: plots.plot_end_face(case_result, end="left"), "one of first, last"),
        (lambda: plots.plot_end_face(case_result, side=0), "side"),
        (lambda: plots.plot_end_face(case_result.isel(x_field=slice(1, None))), "end face"),
        (lambda: plots.plot_end_face(case_result, distance=-1.0), "distance"),
        (lambda: plots.plot_end_face(study_case), "two or more positions"),
    ):
        with pytest.raises(InvalidInputError, match=message):
            call()
