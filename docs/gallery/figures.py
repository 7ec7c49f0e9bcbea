"""Figures of the documentation: ``python docs/gallery/figures.py [NAME ...]`` draws them into this folder.

The code of a figure is the script of its name in this folder, the page of its name in the tutorial, or a program in
`PROGRAMS`. `figures.json` contains a hash of the code; without names the program draws the figures with another hash.
"""

from __future__ import annotations

import ast
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

GALLERY = Path(__file__).resolve().parent
ROOT = GALLERY.parents[1]
RECORD = GALLERY / "figures.json"
BLOCKS = re.compile(r"^```(python|toml)\n(.*?)^```", re.DOTALL | re.MULTILINE)


class Program(NamedTuple):
    """Command that draws a figure, the file that it writes, and the files and folders that contain its code."""

    command: str
    file: str
    sources: tuple[str, ...]


def study_program(name: str, figure: str) -> Program:
    """Return the program of `studies` that draws a figure."""
    return Program(f"studies/{name}.py", f"results/{figure}.png", (f"studies/{name}.py",))


PROGRAMS = {
    "study_best_profile": study_program("best_profile", "best_profile/best_profile"),
    "study_quarter_space": study_program("quarter_space", "quarter_space/quarter_space"),
    "study_regime_map": study_program("regime_map", "regime_map/full_crown"),
    "study_regime_map_slight": study_program("regime_map", "regime_map/0.3_crown"),
    "study_regime_map_worn": study_program("regime_map", "regime_map/worn_crown"),
    "study_residual_stress": study_program("residual_stress", "residual_stress/residual_stress"),
    "study_rolling": study_program("rolling", "rolling"),
    "study_shakedown": study_program("shakedown", "shakedown/shakedown"),
    "study_worn_profile": study_program("worn_profile", "worn_profile/worn_profile"),
    "explore": Program(
        "-m docs.gallery.screens explore",
        "results/explore.png",
        ("docs/gallery/screens.py", "docs/how-to/explore.md", "contactstudy/explorer"),
    ),
    "report": Program(
        "-m docs.gallery.screens report",
        "results/report.png",
        ("docs/gallery/screens.py", "docs/how-to/report.md", "contactstudy/report"),
    ),
    "verification_convergence": Program(
        "-m benchmarks.convergence --out results/convergence",
        "results/convergence/convergence.png",
        ("benchmarks/convergence.py",),
    ),
    "verification_finite_elements": Program(
        "-m contactstudy.cli verify --level full --out results/verification",
        "results/verification/finite_elements.png",
        ("contactstudy/verification/suite.py", "contactstudy/verification/free_ends.py"),
    ),
}
"""Programs of figures that have no script of their name."""


def find_sources(name: str) -> list[Path]:
    """Files that contain the code of a figure."""
    if name in PROGRAMS:
        sources = [ROOT / source for source in PROGRAMS[name].sources]
        return [file for source in sources for file in (sorted(source.glob("*.py")) if source.is_dir() else [source])]
    page = ROOT / "docs" / "tutorial" / f"{name}.md"
    return [page if page.exists() else GALLERY / f"{name}.py"]


def find_blocks(page: Path, language: str) -> str:
    """Blocks of a page in a language, one after the other."""
    return "\n".join(text for name, text in BLOCKS.findall(page.read_text()) if name == language)


def read_code(source: Path) -> str:
    """Python code of a module, or of a page's blocks."""
    return find_blocks(source, "python") if source.suffix == ".md" else source.read_text()


def figure_names() -> list[str]:
    """Names of all figures with code."""
    scripts = {path.stem for path in GALLERY.glob("*.py")} - {"figures", "screens"}
    pages = {path.stem for path in (ROOT / "docs" / "tutorial").glob("*.md")} - {"index"}
    return sorted(scripts | pages | PROGRAMS.keys())


def find_studies(code: str) -> list[Path]:
    """Study files that code names."""
    return [ROOT / "studies" / file for file in sorted(set(re.findall(r"\w+\.toml", code)))]


def parse_syntax(source: Path) -> str:
    """Syntax tree of a module or page without comments and docstrings."""
    tree = ast.parse(read_code(source))
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            node.body = [entry for entry in node.body if not is_docstring(entry)]
    return repr(describe_structure(tree))


def describe_structure(node: object) -> object:
    """Types and filled fields of a syntax tree, which are the same in each version of Python."""
    if isinstance(node, list):
        return [describe_structure(entry) for entry in node]
    if isinstance(node, ast.AST):
        return type(node).__name__, [
            (name, describe_structure(value)) for name, value in ast.iter_fields(node) if value not in (None, [])
        ]
    return node


def is_docstring(node: ast.stmt) -> bool:
    """Whether a statement is a docstring."""
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def compute_hashes() -> dict[str, str]:
    """Hash of each figure's code, of the study files that it names, and of the modules of `plots` that it calls."""
    modules = sorted((ROOT / "contactstudy" / "plots").glob("[!_]*.py"))
    hashes = {}
    for name in figure_names():
        sources = find_sources(name)
        code = "\n".join(map(read_code, sources))
        functions = set(re.findall(r"\bplot_\w+|\bstudy_figures", code))
        modules_used = [
            module for module in modules if functions & set(re.findall(r"^def (\w+)", read_code(module), re.MULTILINE))
        ]
        settings = [find_blocks(source, "toml") for source in sources if source.suffix == ".md"]
        text = "".join(
            [*map(parse_syntax, sources + modules_used), *settings, *map(Path.read_text, find_studies(code))]
        )
        hashes[name] = hashlib.sha256(text.encode()).hexdigest()[:16]
    return hashes


def draw(name: str) -> None:
    """Draw a figure, and record the hash of its code."""
    (ROOT / "results").mkdir(exist_ok=True)
    environment = os.environ | {"MPLBACKEND": "Agg"}
    code = "\n".join(map(read_code, find_sources(name)))
    if name in PROGRAMS:
        program = PROGRAMS[name]
        if program.command.startswith("studies/"):
            for study in find_studies(code):
                subprocess.run([sys.executable, "-m", "contactstudy.cli", "run", study], cwd=ROOT, check=True)
        subprocess.run([sys.executable, *program.command.split()], cwd=ROOT, env=environment, check=True)
        shutil.copy(ROOT / program.file, GALLERY / f"{name}.png")
    else:
        with tempfile.TemporaryDirectory() as folder:
            for shared in ("studies", "results"):
                Path(folder, shared).symlink_to(ROOT / shared)
            script = Path(folder, f"{name}_figure.py")
            script.write_text(code)
            subprocess.run([sys.executable, script], cwd=folder, env=environment, check=True)
            shutil.copy(Path(folder, f"{name}.png"), GALLERY)
    stored = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    RECORD.write_text(json.dumps(dict(sorted((stored | {name: compute_hashes()[name]}).items())), indent=1) + "\n")


if __name__ == "__main__":
    stored = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    for figure in sys.argv[1:] or [name for name, value in compute_hashes().items() if stored.get(name) != value]:
        draw(figure)
