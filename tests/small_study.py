"""A shared study of four small cases."""

from __future__ import annotations

import json

from contactstudy.study import Study
from contactstudy.study.parameters import check_parameters, hash_fragments, identity_fragment

BASE = {
    "young": 210e9,
    "poisson": 0.3,
    "radius": 5e-3,
    "roller_length": 0.5e-3,
    "max_pressure": 1.5e9,
    "cells_x": 4,
    "cells_y": 8,
    "field_y_over_a": [0.0],
    "field_x_over_a": [0.0, 1.0, 2.0],
    "field_z_over_a": [0.0, 0.5, 1.0],
}


def small_study(name: str = "small", **changes) -> Study:
    """A study of four cases, changed by `changes`."""
    content = {"base": BASE, "sweep": {"e_over_a": [0.0, 1.0], "friction": [0.0, 0.1]}} | changes
    return Study(name=name, **content)


def case_id(parameters: dict) -> str:
    """Identity of a case of these parameters, without the default accuracy."""
    values = check_parameters(parameters)
    return hash_fragments(identity_fragment(name, values[name]) for name in sorted(values)).decode()


def identity(**changes) -> str:
    """Identity of a case of the small study."""
    return case_id(BASE | changes)


def format_toml(study: Study) -> str:
    """A study as a TOML file; JSON's numbers, texts and lists are TOML as well."""
    lines = [f"name = {json.dumps(study.name)}", f"level = {json.dumps(study.level)}"]
    for table in ("base", "sweep"):
        lines.append(f"[{table}]")
        lines += [f"{key} = {json.dumps(value)}" for key, value in getattr(study, table).items()]
    return "\n".join(lines) + "\n"
