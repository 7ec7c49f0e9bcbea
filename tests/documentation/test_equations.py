"""Equations of the documentation are cited in the code, and the names of its symbols exist."""

from __future__ import annotations

import ast
import re
from functools import cache
from itertools import chain

import numpy as np

from tests.documentation.pages import ROOT

PAGES = sorted((ROOT / "docs" / "explanation").glob("*.md"))
CODE = sorted((ROOT / "contactstudy").rglob("*.py"))


def tags() -> list[str]:
    """Numbers of all equations."""
    return list(chain.from_iterable(re.findall(r"\\tag\{(\w+)\}", page.read_text()) for page in PAGES))


def docs_only() -> set[str]:
    """Equations of derivations, which no line of code evaluates."""
    comments = chain.from_iterable(re.findall(r"<!-- docs only: ([\w, ]+) -->", page.read_text()) for page in PAGES)
    return set(chain.from_iterable(comment.split(", ") for comment in comments))


def cited_equations() -> set[str]:
    """Equations that comments and docstrings of the package cite."""
    values: set[str] = set()
    for path in CODE:
        for citation in re.findall(r"\beqs?\.\s+(\(\w+\)(?:(?:,| and| to|, and)\s+\(\w+\))*)", path.read_text()):
            values |= set(re.findall(r"\((\w+)\)", citation))
            for first, last in re.findall(r"\((\d+)\) to \((\d+)\)", citation):
                values |= {str(index) for index in np.arange(int(first), int(last) + 1)}
    return values


def test_numbers_are_unique() -> None:
    assert len(tags()) == len(set(tags()))


def test_equations_are_cited() -> None:
    assert set(tags()) - cited_equations() == docs_only()
    assert cited_equations() <= set(tags())


@cache
def identifiers() -> set[str]:
    """Names, attributes, arguments and variables of Datasets in the package."""
    names: set[str] = set()
    for path in CODE:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Name):
                names.add(node.id)
            elif isinstance(node, ast.Attribute):
                names.add(node.attr)
            elif isinstance(node, ast.arg):
                names.add(node.arg)
            elif isinstance(node, ast.FunctionDef | ast.ClassDef):
                names.add(node.name)
            elif isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.isidentifier():
                names.add(node.value)
    return names


def test_names_of_symbols_exist() -> None:
    rows = re.findall(
        r"^\| [^|]*\$[^|]*\| ([^|]*) \|", (ROOT / "docs" / "explanation" / "symbols.md").read_text(), re.M
    )
    quoted = chain.from_iterable(re.findall(r"`([^`]+)`", row) for row in rows)
    words = set(chain.from_iterable(re.findall(r"[A-Za-z_]\w*", name) for name in quoted))
    assert len(words) > 50
    assert words - identifiers() == set()
