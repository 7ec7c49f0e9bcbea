"""Tables and pages of the documentation, generated from the code.

A line ``<!-- made: NAME -->`` in a page is replaced by the table `NAME` of :data:`TABLES`; the pages of the Python
reference are generated completely, one for each folder of the package with public names.
"""

from __future__ import annotations

import argparse
import ast
import html
import importlib
import inspect
import pkgutil
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import MISSING, fields, is_dataclass
from pathlib import Path
from types import ModuleType

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

import contactstudy
from contactstudy import materials
from contactstudy.analysis.peaks import MEASURES
from contactstudy.arrays import vocabulary
from contactstudy.cli import command_parser
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.study.parameters import parameter_table
from contactstudy.study.profile_tables import DESIGN_KEYS, PROFILES

ROOT = Path(__file__).parents[2]
MARKER = re.compile(r"^<!-- made: ([\w-]+) -->$", re.MULTILINE)
SCRIPT_LINK = re.compile(r"^\[(\w+\.py)\]\(\1\)$", re.MULTILINE)
COMPLETE_PACKAGES = (
    "analysis",
    "bearing",
    "design",
    "export",
    "fatigue",
    "heat",
    "operators",
    "plasticity",
    "plots",
    "profiles",
    "report",
    "study",
    "verification",
    "wear",
)
"""Packages whose pages contain all names of ``__all__``, also names that ``contactstudy`` does not export."""

READING_ORDER = (
    "solution",
    "case",
    "bodies",
    "profiles",
    "contact",
    "fields",
    "operators",
    "analysis",
    "fatigue",
    "heat",
    "plasticity",
    "wear",
    "bearing",
    "design",
    "plots",
    "export",
    "report",
    "study",
)
"""The order in which a reader needs the folders; any other follows."""


def format_table(header: Sequence[str], rows: Iterator[Sequence[str]] | Sequence[Sequence[str]]) -> str:
    """Markdown of a table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", r"\|") for cell in row) + " |" for row in lines)


def format_code(*values: object) -> str:
    """Values as code, with commas."""
    return ", ".join(f"`{value}`" for value in values)


def first_sentence(text: str | None) -> str:
    """Return the first paragraph of a docstring as one line, without roles."""
    paragraph = " ".join((text or "").strip().split("\n\n")[0].split())
    return re.sub(r":\w+:`~?(?:[\w.]*\.)?(\w+)`", r"`\1`", paragraph)


# ------------------------------------------------------------------------------------------------ studies


def profile_kinds() -> str:
    """Return the kinds of profile and the keys of their tables."""
    rows = []
    for name, kind in PROFILES.items():
        keys = [
            format_code(entry.name) + ("" if entry.default in (MISSING, None) else f" ({entry.default:g})")
            for entry in fields(kind.profile_class)
        ]
        if kind.design_fields:
            keys.append(format_code(*DESIGN_KEYS))
        if name == "measured":
            keys.append(format_code("file"))
        rows.append(
            (
                format_code(name),
                f"[`{kind.profile_class.__name__}`][contactstudy.profiles.{kind.profile_class.__name__}]",
                ", ".join(keys),
            )
        )
    return format_table(("kind", "class", "keys, with a default in brackets"), rows)


def measures() -> str:
    """Return the names of the stress measures."""
    return format_code(*MEASURES)


# ------------------------------------------------------------------------------------------------ variables


def _variable_table(entries: Mapping[str, vocabulary.Variable]) -> str:
    """Every field of a specification: dims as code, the other fields as text."""
    kind = vocabulary.Variable
    names = [entry.name for entry in fields(kind)] if is_dataclass(kind) else list(kind._fields)
    columns = [name for name in names if name not in ("dims", "comment")]
    headings = {"long_name": "meaning", "units": "unit"}

    def format_field(name: str, entry: vocabulary.Variable) -> str:
        text = str(getattr(entry, name) or "")
        if name == "long_name" and entry.comment:
            return f"{text}, {entry.comment}"
        return f"${text.strip('$')}$" if name == "symbol" and text else text

    return format_table(
        ("variable", "dimensions", *(headings.get(name, name) for name in columns)),
        [
            (
                format_code(name),
                ", ".join(entry.dims) or "scalar",
                *(format_field(column, entry) for column in columns),
            )
            for name, entry in entries.items()
        ],
    )


def coordinates() -> str:
    """Return the coordinates of every Dataset."""
    return _variable_table(vocabulary.COORDINATES)


def dataset_variables() -> str:
    """Return the variables of every Dataset, one table for each subject, in the order and the words of the code."""
    sections, subjects = [], list(_subjects())
    missing = vocabulary.VARIABLES.keys() - {name for _, entries, _ in subjects for name in entries}
    if missing:
        raise ValueError(f"variables of a subject without a meaning on its first line: {sorted(missing)}")
    for name, entries, meaning in subjects:
        sections.append(f"### {name.replace('_', ' ').capitalize()}\n\n{meaning}\n\n{_variable_table(entries)}")
    return "\n\n".join(sections)


def _subjects() -> Iterator[tuple[str, dict[str, vocabulary.Variable], str]]:
    """Name, variables and meaning of each dictionary that ``VARIABLES`` is made of."""
    for name, meaning in re.findall(r"^([A-Z_]+) = \{  # (.*)$", inspect.getsource(vocabulary), re.MULTILINE):
        if name not in ("COORDINATES", "RULES"):
            yield name, getattr(vocabulary, name), first_sentence(f"{meaning[0].upper()}{meaning[1:]}.")


def naming_rules() -> str:
    """Return the names that are made of other names."""
    return _variable_table(vocabulary.RULES)


# ------------------------------------------------------------------------------------------------ command line


def command_line() -> str:
    """Return every command with its arguments, from the parser."""
    parser = command_parser()
    commands = next(action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    texts = [_arguments(parser)]
    for name, command in commands.choices.items():
        usage = " ".join(command.format_usage().removeprefix("usage: ").split())
        texts.append(f"## {name}\n\n{command.description}\n\n```sh\n{usage}\n```\n\n{_arguments(command)}")
    return "\n\n".join([*texts, f"## Exit codes\n\n{(parser.epilog or '').removeprefix('Exit codes: ').capitalize()}"])


def _arguments(parser: argparse.ArgumentParser) -> str:
    rows = []
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            continue
        names = [f"{name} {action.metavar}" if action.metavar else name for name in action.option_strings]
        choices_text = f": {format_code(*action.choices)}" if action.choices else ""
        meaning = html.escape(action.help or "", quote=False)
        rows.append((format_code(*(names or [str(action.metavar)])), meaning + choices_text))
    return format_table(("argument", "meaning"), rows)


# ------------------------------------------------------------------------------------------------ the package


def layers() -> str:
    """Return the layers of the package from the top down, from their contract in pyproject.toml."""
    return format_table(
        ("layer", "what it does"),
        [
            (
                " ".join(f"`{name}`" for name in layer),
                " ".join(first_sentence(importlib.import_module(f"contactstudy.{name}").__doc__) for name in layer),
            )
            for layer in _layers()
        ],
    )


def _layers() -> list[list[str]]:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    return [
        layer.replace(" ", "").split("|") for layer in next(c for c in contracts if c["type"] == "layers")["layers"]
    ]


def quadrature() -> str:
    """Return the settings of the quadratures."""
    meanings = _parameters(Resolution)
    return format_table(
        ("setting", "value", "meaning"),
        [(format_code(entry.name), f"{entry.default:.4g}", meanings[entry.name]) for entry in fields(Resolution)],
    )


def _parameters(documented: type) -> dict[str, str]:
    """Return the meaning of each parameter in a numpy docstring."""
    section = inspect.cleandoc(documented.__doc__ or "").split("Parameters\n----------\n")[1].split("\n\n")[0]
    entries = re.findall(r"^(\w+) : .*\n((?:    .*\n?)+)", section, re.MULTILINE)
    return {name: " ".join(text.split()) for name, text in entries}


def modules() -> str:
    """Return every module of the package with its first sentence."""
    rows = []
    for folder in sorted((ROOT / "contactstudy").iterdir()):
        if folder.is_dir() and (folder / "__init__.py").exists():
            names = [module.name for module in pkgutil.iter_modules([str(folder)])]
            rows.append((format_code(folder.name + "/"), format_code(*names)))
    return format_table(("folder", "modules"), rows)


def material_table() -> str:
    """Return the elastic constants of the materials with their sources."""
    rows = []
    for name, source in materials.SOURCES.items():
        material = getattr(materials, name)
        rows.append(
            (format_code(f"cs.materials.{name}"), f"{1e-9 * material.young:g}", f"{material.poisson:g}", source)
        )
    return format_table(("name", "E, GPa", "nu", "description and source"), rows)


TABLES: dict[str, Callable[[], str]] = {
    "materials": material_table,
    "study-keys": parameter_table,
    "profile-kinds": profile_kinds,
    "measures": measures,
    "coordinates": coordinates,
    "variables": dataset_variables,
    "naming-rules": naming_rules,
    "command-line": command_line,
    "layers": layers,
    "quadrature": quadrature,
    "modules": modules,
}


# ------------------------------------------------------------------------------------------------ Python reference


def python_pages() -> dict[str, str]:
    """Return the Python reference: Markdown of one page for each folder with public names, as a reader needs them."""
    entries: dict[str, list[str]] = {}
    for name in sorted(contactstudy.__all__, key=lambda name: name != "solve"):
        value = getattr(contactstudy, name)
        module_name = value.__name__ if isinstance(value, ModuleType) else value.__module__
        folder = module_name.split(".")[1]
        if not (isinstance(value, ModuleType) and folder in COMPLETE_PACKAGES):
            entries.setdefault(folder, []).append(_reference_directive(f"contactstudy.{name}", value))
    for folder in COMPLETE_PACKAGES:
        package = importlib.import_module(f"contactstudy.{folder}")
        folder_entries = entries.setdefault(folder, [])
        names = [name for name in package.__all__ if name not in contactstudy.__all__]
        folder_entries += [
            _reference_directive(f"contactstudy.{folder}.{name}", getattr(package, name)) for name in names
        ]
    order = [
        *(name for name in READING_ORDER if name in entries),
        *(name for name in entries if name not in READING_ORDER),
    ]
    pages = {}
    for folder in order:
        text = _add_links((importlib.import_module(f"contactstudy.{folder}").__doc__ or "").strip(), folder)
        pages[f"reference/api/{folder}.md"] = "\n\n".join([f"# {folder}", text, *entries[folder]]) + "\n"
    return pages


def _add_links(text: str, folder: str) -> str:
    """Return a module's docstring without its table of files, with links and Markdown's literal blocks."""

    def link(match: re.Match[str]) -> str:
        name = match[1]
        target = name if name.startswith("contactstudy.") else f"contactstudy.{folder}.{name}"
        return f'<autoref optional identifier="{target}"><code>{name}</code></autoref>'

    # The page on architecture contains the table of files.
    text = re.sub(r"\n*^=+  =+$.*^=+  =+$", "", text, flags=re.MULTILINE | re.DOTALL)
    return re.sub(r":\w+:`~?([\w.]+)`", link, text).replace("::\n\n", ":\n\n")


def _reference_directive(path: str, value: object) -> str:
    """Return the directive that documents one public name."""
    if not isinstance(value, ModuleType):
        return f"::: {path}"
    tree = ast.parse(Path(str(value.__file__)).read_text())
    defined_names = [node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)]
    names = [name for name in getattr(value, "__all__", defined_names) if not name.startswith("_")]
    members = "".join(f"\n        - {name}" for name in names)
    return f"::: {value.__name__}\n    options:\n      heading: {path}\n      members:{members}\n"


# ------------------------------------------------------------------------------------------------ hooks of MkDocs


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Put the pages of the Python reference into the navigation."""
    for section in config.nav or []:
        for entry in next(iter(section.values())):
            if isinstance(entry, dict) and entry.get("Python") == "api":
                entry["Python"] = list(python_pages())
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add them to the site."""
    for path, text in python_pages().items():
        files.append(File.generated(config, path, content=text))
    return files


def script(name: str) -> str:
    """Return a folded block with a script of the gallery."""
    text = (ROOT / "docs" / "gallery" / name).read_text()
    return f'<details markdown="1"><summary>{name}</summary>\n\n```python\n{text}```\n\n</details>'


def on_page_markdown(markdown: str, **_: object) -> str:
    """Fill in the tables and the scripts of the gallery."""
    markdown = SCRIPT_LINK.sub(lambda match: script(match[1]), markdown)
    return MARKER.sub(lambda match: TABLES[match[1]](), markdown)
