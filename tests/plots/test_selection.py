"""Values of parameters in titles."""

import xarray as xr

from contactstudy.plots.selection import describe_value, select_values


def test_selected_value_keeps_dimension():
    study = xr.Dataset({"status": ("friction", ["ok", "ok"])}, {"friction": [0.0, 0.1]})
    assert select_values(study, {"friction": 0.1}).friction.values.tolist() == [0.1]


def test_values_are_described():
    assert describe_value("max_pressure", 1e9, "Pa", 2) == "$p_0$ = 1 GPa, one of 2 values"
    assert describe_value("profile", "crowned", "") == "profile = crowned"
