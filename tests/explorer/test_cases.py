"""Texts and numbers of the cases on the page."""

import xarray as xr

from contactstudy.explorer.cases import Cases, numbers_by_subject, status_sentence


def test_status_sentence_contains_reason_of_unsolved_case():
    sentence = status_sentence("skipped", "profile: must fit the length")
    assert sentence == "This case cannot be solved. profile: must fit the length"
    assert status_sentence("missing", "") == "This case is not solved yet."


def test_choices_have_engineering_units():
    swept_coordinates = {
        "max_pressure": ("max_pressure", [1.5e9], {"units": "Pa"}),
        "profile": ["cylinder"],
        "friction": [0.1],
    }
    scalars = xr.Dataset({"status": (tuple(swept_coordinates), [[["ok"]]])}, coords=swept_coordinates)
    cases = Cases(scalars, lambda index: None, "title")
    assert [cases.choices(name) for name in swept_coordinates] == [["1.5 GPa"], ["cylinder"], ["0.1"]]


def test_numbers_are_grouped_by_subject():
    names = ("seconds", "peak_von_mises", "peak_pressure")
    groups = numbers_by_subject(xr.Dataset({name: ("friction", [1.0, 2.0]) for name in names}))
    assert [list(group.values()) for group in groups.values()] == [["peak_pressure"], ["peak_von_mises"], ["seconds"]]
