"""Numbers in engineering units, and HTML tables."""

from __future__ import annotations

import math

from contactstudy.arrays.engineering import (
    TEXT_STYLE,
    format_quantity,
    format_value,
    format_with_error,
    html_table,
    unit_for,
)


def test_unit_follows_from_magnitude() -> None:
    assert [unit_for(*value_and_unit) for value_and_unit in ((1.5e9, "Pa"), (2e-6, "m"), (0.1, "1"))] == [
        (1e9, "GPa"),
        (1e-6, "\N{MICRO SIGN}m"),
        (1.0, ""),
    ]


def test_formatted_numbers_have_four_digits() -> None:
    values = (0.000211234, 1531.52, 1e-9, math.inf)
    assert [format_value(value) for value in values] == ["0.0002112", "1532", "1e-09", "\N{INFINITY}"]
    assert [format_quantity(1.5e9, "Pa"), format_quantity(0.1, "1")] == ["1.5 GPa", "0.1"]
    assert format_with_error(2.2531e9, 0.012e9, "Pa") == "2.253 ± 0.012 GPa"
    assert format_with_error(65e-6, math.nan, "m") == "65 \N{MICRO SIGN}m"
    assert format_with_error(0.0, 0.0, "Pa") == "0 MPa"


def test_table_escapes_texts() -> None:
    table = html_table([("", [("radius", "<5 mm")])], styles=(TEXT_STYLE,) * 2)
    assert table.startswith("<table><tr><td style='text-align:left'>radius</td>")
    assert "&lt;5 mm" in table
