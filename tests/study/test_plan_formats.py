"""Texts about a study on the command line."""

from contactstudy.cli import format_bytes
from contactstudy.study.plan import format_value
from contactstudy.study.profile_tables import format_profile
from contactstudy.study.run import format_duration


def test_sizes_and_durations_have_units():
    assert [format_bytes(size) for size in (20, 123456, 5e12)] == ["20 bytes", "123 kB", "5e+03 GB"]
    assert [format_duration(seconds) for seconds in (7.4, 200, 9000)] == ["7 s", "3.3 min", "2.5 h"]


def test_values_of_parameters_in_engineering_units():
    assert (format_value("radius", 5e-3), format_value("field_y_over_a", [0.0])) == ("5 mm", "1 value, 0")
    assert format_value("coupled", True) == "yes"
    assert (
        format_profile({"kind": "cylinder", "fillet_radius": 2e-4}, in_units=True) == "cylinder, fillet radius 0.2 mm"
    )
    assert (
        format_profile({"kind": "lundberg", "design_pressure": 2e9}, in_units=True) == "lundberg, design pressure 2 GPa"
    )
