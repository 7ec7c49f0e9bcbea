"""Sources with one sign, factor or comparison changed."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

OTHER = {ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*")}
"""Arithmetic signs, and what each becomes."""

REVERSED = {ast.Lt: ("<", ">"), ast.Gt: (">", "<"), ast.LtE: ("<=", ">="), ast.GtE: (">=", "<=")}
"""Comparisons, likewise."""

FACTOR = 1.1
"""By which a number with a decimal point grows inside a function."""


@dataclass(frozen=True, order=True)
class Mutant:
    """A change of a source.

    Attributes
    ----------
    file : str
        The source, relative to the repository.
    line : int
        Its line.
    start, stop : int
        Characters that are replaced.
    text : str
        What they become.
    shown : str
        The line before and after.
    """

    file: str
    line: int
    start: int
    stop: int
    text: str
    shown: str

    def applied(self, source: str) -> str:
        """The source with the change."""
        return source[: self.start] + self.text + source[self.stop :]


def mutants_of(file: str, source: str) -> Iterator[Mutant]:
    """All changes of the bodies of a source's functions."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def at(line: int, column: int) -> int:
        # ast counts bytes; sources hold other letters in comments and docstrings only.
        return starts[line - 1] + column

    def mutant(start: int, stop: int, text: str) -> Mutant:
        number = source.count("\n", 0, start) + 1
        changed = source[:start] + text + source[stop:]
        before, after = (each.splitlines()[number - 1].strip() for each in (source, changed))
        return Mutant(file, number, start, stop, text, f"{before}  ->  {after}")

    for node in _in_functions(ast.parse(source)):
        match node:
            case ast.BinOp(left=left, op=op) if type(op) in OTHER:
                own, other = OTHER[type(op)]
                place = _between(source, at(left.end_lineno or 0, left.end_col_offset or 0), own)
                if not (isinstance(left, ast.Constant) and isinstance(left.value, str)):
                    yield mutant(place, place + len(own), other)
            case ast.Compare(left=left, ops=[op]) if type(op) in REVERSED:
                own, other = REVERSED[type(op)]
                place = _between(source, at(left.end_lineno or 0, left.end_col_offset or 0), own)
                yield mutant(place, place + len(own), other)
            case ast.UnaryOp(op=ast.USub(), operand=operand) if not isinstance(operand, ast.Constant):
                place = at(node.lineno, node.col_offset)
                yield mutant(place, place + 1, "+")
            case ast.Constant(value=float(value)) if value:
                start, stop = at(node.lineno, node.col_offset), at(node.end_lineno or 0, node.end_col_offset or 0)
                yield mutant(start, stop, repr(FACTOR * value))


def _in_functions(tree: ast.AST) -> Iterator[ast.AST]:
    """Nodes of the bodies of functions that compute; not of annotations, defaults, messages or checks."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            for statement in node.body:
                yield from _computing(statement)


def _computing(node: ast.AST) -> Iterator[ast.AST]:
    """Nodes below one, without errors that are raised, texts, types and functions within, which come by themselves."""
    if isinstance(node, (ast.Raise, ast.JoinedStr, ast.FunctionDef, ast.Assert)):
        return
    yield node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _computing(child)


def _between(source: str, start: int, sign: str) -> int:
    """Place of a sign after an operand, beyond closing brackets and comments."""
    place = start
    while not source.startswith(sign, place):
        place = source.index("\n", place) if source[place] == "#" else place + 1
    return place


def all_mutants(root: Path, packages: tuple[str, ...]) -> list[Mutant]:
    """All changes of the sources of some packages, in order."""
    files = sorted(path for package in packages for path in (root / "contactstudy" / package).glob("*.py"))
    return [
        mutant
        for path in files
        for mutant in sorted(mutants_of(path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")))
    ]
