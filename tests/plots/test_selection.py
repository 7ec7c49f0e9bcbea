"""Values of parameters in titles."""

from contactstudy.plots.selection import describe_value


def test_values_are_described():
    assert describe_value("max_pressure", 1e9, "Pa", 2) == "$p_0$ = 1 GPa, one of 2 values"
    assert describe_value("profile", "crowned", "") == "profile = crowned"
