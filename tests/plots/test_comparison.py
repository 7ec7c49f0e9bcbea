import numpy as np
import pytest
from matplotlib import pyplot

from contactstudy import analysis, plots
from contactstudy.errors import InvalidInputError


def test_one_line_and_name_per_result(solved, strip_result, assert_nothing_clipped):
    ax = plots.plot_comparison({"ends": solved, "Hertz": strip_result(1e-4, 1e9)})
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["ends", "Hertz"]
    assert ax.lines[1].get_ydata().max() == pytest.approx(1.0, abs=1e-3)
    assert_nothing_clipped(ax.figure)


def test_lines_differ_by_colour_and_dashes(strip_result):
    ax = plots.plot_comparison({str(number): strip_result() for number in range(6)})
    styles = {(line.get_color() if isinstance(line.get_color(), str) else tuple(line.get_color())) for line in ax.lines}
    assert len(styles) == 6
    assert len({str(line._dash_pattern) for line in ax.lines}) == 6
    grey = [np.dot(line.get_color()[:3], [0.299, 0.587, 0.114]) for line in ax.lines]
    assert np.all(np.diff(grey) > 0)


def test_stress_and_middle(solved):
    ax = plots.plot_comparison({"case": solved}, "tresca", centred=True, si=True)
    assert ax.lines[0].get_xdata().mean() == pytest.approx(0, abs=1e-6)
    largest = analysis.peak(solved, "tresca")["peak_tresca"]
    assert ax.lines[0].get_ydata().max() == pytest.approx(1e-6 * float(largest))
    assert "mid-length" in ax.get_xlabel()


def test_depth(strip_result, assert_nothing_clipped):
    ax = plots.plot_depth(strip_result(2e-4, 1e9), ["von_mises", "maximum_shear"])
    assert [line.get_xdata().max() for line in ax.lines] == pytest.approx([0.5575, 0.3], abs=2e-3)
    low, high = ax.get_ylim()
    assert low > high
    assert ax.get_title() == "below $x/a$ = 3, $y/a$ = 0"
    assert_nothing_clipped(ax.figure)


def test_given_axes_are_used(solved):
    ax = pyplot.figure().add_subplot()
    assert plots.plot_comparison({"case": solved}, ax=ax) is ax
    assert plots.plot_depth(solved, ax=ax, x=0.2e-3, si=True) is ax
    assert ax.get_title() == "below $x$ = 0.2 mm, $y$ = 0 mm"


def test_bad_input(solved, opened):
    for call, message in (
        (lambda: plots.plot_comparison({}), "at least one"),
        (lambda: plots.plot_comparison([solved]), "mapping"),
        (lambda: plots.plot_comparison({"study": opened}), "single case"),
        (lambda: plots.plot_comparison({"case": solved}, "trescas"), "did you mean"),
        (lambda: plots.plot_depth(solved, []), "at least one"),
        (lambda: plots.plot_depth(solved, x=1.0), "within the result"),
        (lambda: plots.plot_depth(opened), "single case"),
    ):
        with pytest.raises(InvalidInputError, match=message):
            call()
