import matplotlib
import numpy as np
import pytest
from matplotlib import pyplot

from contactstudy import plots
from contactstudy.errors import InvalidInputError


def test_colours_are_ordered_in_grey():
    colours = matplotlib.colormaps[plots.COLORS](np.linspace(0, 1, 20))[:, :3]
    assert np.all(np.diff(colours @ [0.299, 0.587, 0.114]) > 0)


def test_saved_figure_is_png_and_pdf_with_text(tmp_path):
    figure = pyplot.figure()
    figure.add_subplot().set_ylabel("von Mises stress")
    png, pdf = plots.save(figure, tmp_path / "figure_1.5GPa")
    assert (png.name, pdf.name) == ("figure_1.5GPa.png", "figure_1.5GPa.pdf")
    assert png.read_bytes().startswith(b"\x89PNG")
    content = pdf.read_bytes()
    assert content.startswith(b"%PDF")
    # The PDF contains fonts, not outlines.
    assert b"TrueType" in content or b"CIDFontType2" in content


def test_suffix_is_not_doubled(tmp_path):
    assert [file.name for file in plots.save(pyplot.figure(), tmp_path / "a.png", ["png"])] == ["a.png"]


def test_unknown_format_raises(tmp_path):
    with pytest.raises(InvalidInputError, match="formats = 'docx'"):
        plots.save(pyplot.figure(), tmp_path / "a", ["docx"])
    assert not list(tmp_path.iterdir())
