"""Citations of the documentation's equations in the code, and names of its symbols."""

from __future__ import annotations

import ast
import re
from functools import cache
from itertools import chain

import numpy as np

from tests.documentation.pages import ROOT

PAGES = sorted((ROOT / "docs" / "explanation").glob("*.md"))
CODE = sorted((ROOT / "contactstudy").rglob("*.py"))


def list_equation_numbers() -> list[str]:
    """Numbers of all equations."""
    return list(chain.from_iterable(re.findall(r"\\tag\{(\w+)\}", page.read_text()) for page in PAGES))


def list_uncited_equations() -> set[str]:
    """Equations of derivations, marked as not evaluated in the code."""
    comments = chain.from_iterable(re.findall(r"<!-- docs only: ([\w, ]+) -->", page.read_text()) for page in PAGES)
    return set(chain.from_iterable(comment.split(", ") for comment in comments))


def list_cited_equations() -> set[str]:
    """Equations that comments and docstrings of the package cite."""
    cited_numbers: set[str] = set()
    for path in CODE:
        for citation in re.findall(r"\beqs?\.\s+(\(\w+\)(?:(?:,| and| to|, and)\s+\(\w+\))*)", path.read_text()):
            cited_numbers |= set(re.findall(r"\((\w+)\)", citation))
            for first_number, last_number in re.findall(r"\((\d+)\) to \((\d+)\)", citation):
                cited_numbers |= {str(index) for index in np.arange(int(first_number), int(last_number) + 1)}
    return cited_numbers


def test_equation_numbers_are_unique() -> None:
    assert len(list_equation_numbers()) == len(set(list_equation_numbers()))


def test_code_cites_all_evaluated_equations() -> None:
    assert set(list_equation_numbers()) - list_cited_equations() == list_uncited_equations()
    assert list_cited_equations() <= set(list_equation_numbers())


@cache
def list_identifiers() -> set[str]:
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


def test_names_in_symbol_table_exist_in_code() -> None:
    rows = re.findall(
        r"^\| [^|]*\$[^|]*\| ([^|]*) \|", (ROOT / "docs" / "explanation" / "symbols.md").read_text(), re.M
    )
    quoted_texts = chain.from_iterable(re.findall(r"`([^`]+)`", row) for row in rows)
    words = set(chain.from_iterable(re.findall(r"[A-Za-z_]\w*", name) for name in quoted_texts))
    assert len(words) > 50
    assert words - list_identifiers() == set()
