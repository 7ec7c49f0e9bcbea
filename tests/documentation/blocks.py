"""Python and TOML blocks of README.md and of every page in docs as tests.

The blocks of a page run in order and share names. Their environment contains

* an empty working folder, with the study files of `studies` and a measured profile, `roller_7.csv`;
* `result`, a small solved case;
* after a TOML block of a whole study: the file of the study, results of the stand-in solver in `results/NAME`, and the
  `path` of one batch. Other TOML blocks are parsed.

A text block that directly follows a Python block is its output: the same words, and the same numbers to a percent.

A comment on the line before a block skips the block, with a reason::

    <!-- skip: next "needs a SLURM cluster" -->
"""

from __future__ import annotations

import contextlib
import functools
import io
import os
import re
import shutil
import tempfile
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sybil import Document, Example, Region, Sybil
from sybil.evaluators.python import PythonEvaluator
from sybil.integration.pytest import SybilItem
from sybil.parsers.markdown import SkipParser
from sybil.parsers.markdown.lexers import DirectiveInHTMLCommentLexer, RawFencedCodeBlockLexer

from contactstudy.study import Study, run_study
from tests.documentation.pages import ROOT
from tests.solved_case import solved_case
from tests.stand_in_solver import solve_fake

PUNCTUATION = ",:;"  # signs that follow a number
WHOLE_STUDY = {"name", "base", "sweep"}
"""Keys that a TOML block of a whole study contains."""


class FencedBlocks:
    """Parser of fenced blocks of one language, with any further words in their first line."""

    def __init__(self, language: str, evaluator: Any) -> None:
        opening = rf"[ \t]*\{{?[ \t]*\.?{language}\b[^\n]*$\n"
        self._lexer = RawFencedCodeBlockLexer(re.compile(opening, re.MULTILINE))
        self._evaluator = evaluator

    def __call__(self, document: Document) -> Iterable[Region]:
        for region in self._lexer(document):
            region.parsed = region.lexemes["source"]
            region.evaluator = self._evaluator
            yield region


class PrintingEvaluator(PythonEvaluator):
    """Evaluator that records the output of a block."""

    def __call__(self, example: Example) -> None:
        with contextlib.redirect_stdout(io.StringIO()) as output:
            try:
                super().__call__(example)
            except Exception as error:
                # Sybil cuts the traceback of every cause and raises IndexError for a short traceback.
                raise error from None
        example.namespace["_printed"] = output.getvalue()


OUTPUT = re.compile(r"^```python\n(?:(?!^```).*\n)*```\n\n(```text\n((?:(?!^```).*\n)*)```)", re.MULTILINE)
"""A text block that directly follows a Python block."""


class Outputs:
    """Parser of text blocks that directly follow Python blocks."""

    def __call__(self, document: Document) -> Iterable[Region]:
        for match in OUTPUT.finditer(document.text):
            yield Region(match.start(1), match.end(1), match[2], compare_output)


def compare_output(example: Example) -> None:
    """Compare the shown with the printed text: words exactly, numbers to a percent."""
    expected_words, output = example.parsed.split(), example.namespace["_printed"].split()
    assert len(expected_words) == len(output), example.namespace["_printed"]
    for shown_word, printed_word in zip(expected_words, output, strict=True):
        if shown_word != printed_word:
            shown_number, printed_number = (float(word.strip(PUNCTUATION)) for word in (shown_word, printed_word))
            assert shown_number == pytest.approx(printed_number, rel=0.01, abs=2e-3), (shown_word, printed_word)


class ReasonedSkips(SkipParser):
    """Parser of skips that requires a reason."""

    def __call__(self, document: Document) -> Iterable[Region]:
        for comment in DirectiveInHTMLCommentLexer(self.directive)(document):
            if not re.fullmatch(r'next ".+"\s*', comment.lexemes["arguments"] or ""):
                line, _ = document.line_column(comment.start).removeprefix("line ").split(",", 1)
                raise ValueError(f'{document.path}:{line}: write <!-- skip: next "reason" -->')
        yield from super().__call__(document)


def run_toml(example: Example) -> None:
    """Parse a block, and run it if it is a whole study."""
    content = tomllib.loads(example.parsed)
    if not content.keys() >= WHOLE_STUDY:
        return
    study = Study.from_mapping(content)
    Path("studies", f"{study.name}.toml").write_text(example.parsed)
    report = run_study(study, Path("results", study.name), workers=0, solver=solve_fake, progress=False)
    assert set(report.counts) == {"ok"}, report
    example.namespace["path"] = report.files[0]


@functools.cache
def make_working_folder() -> Path:
    """Folder with the files for all pages."""
    folder = Path(tempfile.mkdtemp(prefix="contactstudy-page-"))
    (folder / "studies").mkdir()
    for study in (ROOT / "studies").glob("*.toml"):
        shutil.copy(study, folder / "studies")
    x = np.linspace(0, 10, 201)
    rows = (f"{position:.3f}, {0.2 * (position - 4.9) ** 2:.5f}" for position in x)
    (folder / "roller_7.csv").write_text("\n".join(["x [mm], drop [um]", *rows]))
    return folder


def begin_page(namespace: dict[str, Any]) -> None:
    """Change to a copy of the prepared folder."""
    folder = tempfile.mkdtemp(prefix="contactstudy-page-")
    shutil.copytree(make_working_folder(), folder, dirs_exist_ok=True)
    namespace |= {"result": solved_case(), "_before": os.getcwd(), "_folder": folder}
    os.chdir(folder)


def end_page(namespace: dict[str, Any]) -> None:
    """Leave and remove the copy."""
    from matplotlib import pyplot

    pyplot.close("all")
    os.chdir(namespace["_before"])
    shutil.rmtree(namespace["_folder"])


pytest_collect_file = Sybil(
    parsers=[FencedBlocks("python", PrintingEvaluator()), Outputs(), FencedBlocks("toml", run_toml), ReasonedSkips()],
    path=str(ROOT),
    patterns=["docs/*.md", "docs/**/*.md"],
    filenames=["README.md"],
    setup=begin_page,
    teardown=end_page,
).pytest()


def pytest_itemcollected(item: pytest.Item) -> None:
    """Put pages into the system tier."""
    if isinstance(item, SybilItem):
        item.add_marker(pytest.mark.system)
