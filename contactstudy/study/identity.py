"""Who a case is: the hash of its parameters, however they were written."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from contactstudy.study.parameters import checked, counted

SCHEMA = 1
"""Number of the meaning of the parameters; raised only if an old parameter changes its meaning."""


def canonical_json(values: object) -> str:
    """JSON with sorted keys and no spaces, so that equal values give equal text."""
    return json.dumps(values, sort_keys=True, separators=(",", ":"), allow_nan=False)


def case_id(parameters: Mapping[str, Any]) -> str:
    """Identity of a case: SHA-256 of its canonical JSON, as 64 hexadecimal digits.

    Numbers count to 12 significant digits and parameters at their default do not count, so that a parameter
    added later with a default keeps the identity of old cases. The version of the solver is not part of it.

    Parameters
    ----------
    parameters : mapping
        Parameters of the case.

    Raises
    ------
    InvalidInputError
        If a name is unknown or a value is of a wrong type.

    Examples
    --------
    >>> case_id({"friction": 1}) == case_id({"friction": 1.0, "coupled": False})
    True
    """
    values = checked(parameters)
    return identity_of({name: fragment(name, value) for name, value in values.items()})


def fragment(name: str, value: Any) -> str:
    """Return a checked parameter's part of the canonical JSON; empty if the value is the default."""
    value = counted(name, value)
    return "" if value is None else f'"{name}":{canonical_json(value)}'


def identity_of(fragments: Mapping[str, str]) -> str:
    """Identity of a case from the fragments of its parameters, by name."""
    content = ",".join(fragments[name] for name in sorted(fragments) if fragments[name])
    return hashlib.sha256(f'{{"case":{{{content}}},"schema":{SCHEMA}}}'.encode()).hexdigest()
