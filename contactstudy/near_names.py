"""The nearest known name, for messages on a name that is not known."""

from __future__ import annotations

import sys
from collections.abc import Iterable


def nearest(name: str, known: Iterable[str], likeness: float = 0.6) -> str:
    """Return the one of `known` that is most like `name`; empty if none is as like as `likeness`, of 0 to 1.

    Examples
    --------
    >>> nearest("presure", ["gap", "pressure"]), nearest("gaps", ["pressure"])
    ('pressure', '')
    """
    from difflib import get_close_matches

    return next(iter(get_close_matches(name, known, n=1, cutoff=likeness)), "")


def missing(name: str, owner: str, known: Iterable[str]) -> AttributeError:
    """Return the error of an attribute that `owner` does not have, with the nearest that it has."""
    near = "" if name.startswith("_") else nearest(name, known)
    hint = f"; did you mean {near}?" if near else ""
    return AttributeError(f"{owner} has no attribute {name!r}{hint}", name=name)


def suggest(module: str, known: Iterable[str]) -> None:
    """Make a module that has the names `known` refuse others with the nearest of them.

    The module's ``__getattr__`` is set from here: to a type checker, a module that defines one has every name.

    Examples
    --------
    >>> import contactstudy.profiles
    >>> contactstudy.profiles.Lundburg
    Traceback (most recent call last):
    AttributeError: module 'contactstudy.profiles' has no attribute 'Lundburg'; did you mean Lundberg?
    """

    def refuse(name: str) -> object:
        raise missing(name, f"module {module!r}", known)

    vars(sys.modules[module])["__getattr__"] = refuse
