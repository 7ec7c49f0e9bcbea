"""Sources with one sign, factor or comparison changed."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[2]

PACKAGES = ("kernels", "overlapping", "contact")
"""The solver's core."""

OTHER_OPERATORS = {ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*")}
"""Arithmetic signs and their changes."""

REVERSED_COMPARISONS = {ast.Lt: ("<", ">"), ast.Gt: (">", "<"), ast.LtE: ("<=", ">="), ast.GtE: (">=", "<=")}
"""Comparisons and their changes."""

FACTOR = 1.1
"""Factor on a number with a decimal point inside a function."""


@dataclass(frozen=True, kw_only=True)
class Mutant:
    """A change of a source.

    Attributes
    ----------
    file, source : str
        The source, relative to the repository, and its text.
    start, stop : int
        Characters that are replaced.
    text : str
        Replacement of the text.
    lines : tuple of str
        Lines of the changed statement, without the lines of nested statements.
    where : str
        Name of the function.
    description : str
        The line before and after.
    """

    file: str
    source: str = field(repr=False)
    start: int
    stop: int
    text: str
    lines: tuple[str, ...]
    where: str
    description: str

    @property
    def key(self) -> str:
        """Identity of a change, independent of line numbers."""
        return f"{self.file}: {self.where}: {self.description}"

    @property
    def changed(self) -> str:
        """The source with the change."""
        return self.source[: self.start] + self.text + self.source[self.stop :]


def list_mutants_of_function(file: str, source: str) -> Iterator[Mutant]:
    """All changes of the bodies of a source's functions."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def compute_offset(line: int, column: int) -> int:
        # ast counts bytes; code without comments and docstrings is ASCII.
        return starts[line - 1] + column

    texts, occurrences = source.splitlines(), Counter[str]()

    def mutant(lines: range, where: str, start: int, stop: int, text: str) -> Mutant:
        line_number = source.count("\n", 0, start) + 1
        changed_source = source[:start] + text + source[stop:]
        before, after = (version.splitlines()[line_number - 1].strip() for version in (source, changed_source))
        description = f"{before}  ->  {after}"
        occurrences[where + description] += 1
        if occurrences[where + description] > 1:
            description += f"  (no. {occurrences[where + description]})"
        statement = tuple(texts[line_number - 1].strip() for line_number in lines)
        return Mutant(
            file=file,
            source=source,
            start=start,
            stop=stop,
            text=text,
            lines=statement,
            where=where,
            description=description,
        )

    for node, lines, where in _list_function_nodes(ast.parse(source)):
        match node:
            case ast.BinOp(left=left, op=op) if type(op) in OTHER_OPERATORS:
                symbol, replacement = OTHER_OPERATORS[type(op)]
                offset = find_sign(source, compute_offset(left.end_lineno or 0, left.end_col_offset or 0), symbol)
                if not (isinstance(left, ast.Constant) and isinstance(left.value, str)):
                    yield mutant(lines, where, offset, offset + len(symbol), replacement)
            case ast.Compare(left=left, ops=[op]) if type(op) in REVERSED_COMPARISONS:
                symbol, replacement = REVERSED_COMPARISONS[type(op)]
                offset = find_sign(source, compute_offset(left.end_lineno or 0, left.end_col_offset or 0), symbol)
                yield mutant(lines, where, offset, offset + len(symbol), replacement)
            case ast.UnaryOp(op=ast.USub(), operand=operand) if not isinstance(operand, ast.Constant):
                offset = compute_offset(node.lineno, node.col_offset)
                yield mutant(lines, where, offset, offset + 1, "+")
            case ast.Constant(value=float(value)) if value:
                start, stop = (
                    compute_offset(node.lineno, node.col_offset),
                    compute_offset(node.end_lineno or 0, node.end_col_offset or 0),
                )
                yield mutant(lines, where, start, stop, repr(FACTOR * value))


def _list_function_nodes(tree: ast.AST, where: str = "") -> Iterator[tuple[ast.AST, range, str]]:
    """Arithmetic nodes of functions, with the lines of their statement and the function's name."""
    for node in ast.iter_child_nodes(tree):
        name = f"{where}.{node.name}".lstrip(".") if isinstance(node, (ast.FunctionDef, ast.ClassDef)) else where
        yield from _list_function_nodes(node, name)
        if isinstance(node, ast.FunctionDef):
            for statement in node.body:
                yield from ((subnode, lines, name) for subnode, lines in _list_computing_nodes(statement, range(0)))


def _list_computing_nodes(node: ast.AST, lines: range) -> Iterator[tuple[ast.AST, range]]:
    """Nodes of a statement without raised errors, f-strings, assertions, types and nested functions."""
    if isinstance(node, (ast.Raise, ast.JoinedStr, ast.FunctionDef, ast.Assert)):
        return
    if isinstance(node, ast.stmt):
        nested_lines = [statement.lineno for statement in getattr(node, "body", [])]
        lines = range(node.lineno, min([*nested_lines, (node.end_lineno or 0) + 1]))
    yield node, lines
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _list_computing_nodes(child, lines)


def find_sign(source: str, start: int, operator_text: str) -> int:
    """Offset of the operator after an operand, behind closing brackets and comments."""
    offset = start
    while not source.startswith(operator_text, offset):
        offset = source.index("\n", offset) if source[offset] == "#" else offset + 1
    return offset


def list_mutants(packages: tuple[str, ...] = PACKAGES, root: Path = ROOT) -> list[Mutant]:
    """All changes of the sources of `packages`, ordered by file."""
    files = sorted(path for package in packages for path in (root / "contactstudy" / package).rglob("*.py"))
    return [
        mutant
        for path in files
        for mutant in list_mutants_of_function(path.relative_to(root).as_posix(), path.read_text(encoding="utf-8"))
    ]
