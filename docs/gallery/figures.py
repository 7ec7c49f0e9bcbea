"""Figures of the documentation: ``python docs/gallery/figures.py [NAME ...]`` draws them into this folder.

The code of a figure is the script of its name in this folder, the page of its name in the tutorial, or a program of
`studies`. `figures.json` contains a hash of the code; without names the program draws the figures with another hash.
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

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
RECORD = HERE / "figures.json"
BLOCKS = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)

PROGRAMS = {
    "study_best_profile": ("studies/best_profile.py", "results/best_profile/best_profile.png"),
    "study_quarter_space": ("studies/quarter_space.py", "results/quarter_space/quarter_space.png"),
    "study_regime_map": ("studies/regime_map.py", "results/regime_map/full_crown.png"),
    "study_regime_map_slight": ("studies/regime_map.py", "results/regime_map/0.3_crown.png"),
    "study_regime_map_worn": ("studies/regime_map.py", "results/regime_map/worn_crown.png"),
    "study_residual_stress": ("studies/residual_stress.py", "results/residual_stress/residual_stress.png"),
    "study_rolling": ("studies/rolling.py", "results/rolling.png"),
    "study_shakedown": ("studies/shakedown.py", "results/shakedown/shakedown.png"),
    "study_worn_profile": ("studies/worn_profile.py", "results/worn_profile/worn_profile.png"),
}
"""Program of `studies` that draws a figure, and its file."""


def code_of(name: str) -> str:
    """Python code of a figure."""
    if name in PROGRAMS:
        return (ROOT / PROGRAMS[name][0]).read_text()
    page = ROOT / "docs" / "tutorial" / f"{name}.md"
    return "\n".join(BLOCKS.findall(page.read_text())) if page.exists() else (HERE / f"{name}.py").read_text()


def names() -> list[str]:
    """Names of all figures with code."""
    scripts = {path.stem for path in HERE.glob("*.py")} - {"figures", "screens"}
    pages = {path.stem for path in (ROOT / "docs" / "tutorial").glob("*.md")} - {"index"}
    return sorted(scripts | pages | PROGRAMS.keys())


def studies_of(code: str) -> list[Path]:
    """Study files that code names."""
    return [ROOT / "studies" / file for file in sorted(set(re.findall(r"\w+\.toml", code)))]


def statements(code: str) -> str:
    """Syntax tree without comments and docstrings."""
    tree = ast.parse(code)
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            node.body = [entry for entry in node.body if not is_text(entry)]
    return ast.dump(tree)


def is_text(node: ast.stmt) -> bool:
    """Whether a statement is a docstring."""
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def digests() -> dict[str, str]:
    """Hash of each figure's code, of the study files that it names, and of the modules of `plots` that it calls."""
    modules = [path.read_text() for path in sorted((ROOT / "contactstudy" / "plots").glob("[!_]*.py"))]
    hashes = {}
    for name in names():
        code = code_of(name)
        studies = [study.read_text() for study in studies_of(code)]
        called = set(re.findall(r"\bplot_\w+|\bstudy_figures", code))
        used = [text for text in modules if called & set(re.findall(r"^def (\w+)", text, re.MULTILINE))]
        text = "".join([*map(statements, [code, *used]), *studies])
        hashes[name] = hashlib.sha256(text.encode()).hexdigest()[:16]
    return hashes


def draw(name: str) -> None:
    """Draw a figure, and record the hash of its code."""
    (ROOT / "results").mkdir(exist_ok=True)
    environment = os.environ | {"MPLBACKEND": "Agg"}
    if name in PROGRAMS:
        program, figure = PROGRAMS[name]
        for study in studies_of(code_of(name)):
            subprocess.run([sys.executable, "-m", "contactstudy.cli", "run", study], cwd=ROOT, check=True)
        subprocess.run([sys.executable, program], cwd=ROOT, env=environment, check=True)
        shutil.copy(ROOT / figure, HERE / f"{name}.png")
    else:
        with tempfile.TemporaryDirectory() as folder:
            for shared in ("studies", "results"):
                Path(folder, shared).symlink_to(ROOT / shared)
            script = Path(folder, f"{name}_figure.py")
            script.write_text(code_of(name))
            subprocess.run([sys.executable, script], cwd=folder, env=environment, check=True)
            shutil.copy(Path(folder, f"{name}.png"), HERE)
    stored = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    RECORD.write_text(json.dumps(dict(sorted((stored | {name: digests()[name]}).items())), indent=1) + "\n")


if __name__ == "__main__":
    stored = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    for figure in sys.argv[1:] or [name for name, value in digests().items() if stored.get(name) != value]:
        draw(figure)
