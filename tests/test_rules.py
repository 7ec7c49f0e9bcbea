"""Rules of CONTRIBUTING.md: few positional arguments, constants bound once, no circular imports, one module per
test."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import contactstudy

MOST_FIELDS = 4  # fields of a dataclass with positional arguments
MOST_ARGUMENTS = 5  # positional arguments of a call
MOST_PARAMETERS = 7  # parameters of a function
MOST_POSITIONAL = 2  # positional parameters of a function with more parameters
MOST_VALUES = 3  # values of a tuple that a function returns
TUPLE_FUNCTIONS = ("__reduce__", "_difference_matrices")  # pickle prescribes the tuple; four matrices of one form
SOLVER_ROOMS = ("arrays", "case", "contact", "eigenstrain", "fields", "film", "kernels", "overlapping", "profiles")
CONSTANT_MARK = re.compile(r"\b(Physics|Accuracy|Speed|Rounding|Limit)[.:]")

ROOT = Path(contactstudy.__file__).parent
MODULES = {str(path.relative_to(ROOT)): path.read_text() for path in sorted(ROOT.rglob("*.py"))}
STUBS = {str(path.relative_to(ROOT)): path.read_text() for path in sorted(ROOT.rglob("*.pyi"))}


def find_violations(modules: dict[str, str]) -> list[str]:
    """Violations in the source text of modules: module, line and rule."""
    trees = {name: list(ast.walk(ast.parse(text))) for name, text in modules.items()}
    nodes = [node for tree in trees.values() for node in tree]
    classes = {node.name: node for node in nodes if isinstance(node, ast.ClassDef)}
    variadic = {node.name for node in nodes if isinstance(node, ast.FunctionDef) and node.args.vararg} | {"chain"}
    return [
        f"{name}:{getattr(node, 'lineno', 1)}: {rule}"
        for name, tree in trees.items()
        for node in tree
        for rule in list_broken_rules(node, classes, variadic)
    ]


def list_broken_rules(node: ast.AST, classes: dict[str, ast.ClassDef], variadic: set[str]) -> Iterator[str]:
    """Rules that a module, a class, a call or a function breaks."""
    if isinstance(node, ast.Module | ast.ClassDef):
        names = Counter(list_bound_names(node))
        yield from (f"{name} is bound {count} times" for name, count in names.items() if count > 1)
    if isinstance(node, ast.ClassDef):
        decorators = [ast.unparse(decorator) for decorator in node.decorator_list]
        positional = any("dataclass" in text and "kw_only=True" not in text for text in decorators)
        if positional and len(list_fields(node, classes)) > MOST_FIELDS:
            yield f"{node.name} has more than {MOST_FIELDS} fields and is not keyword-only"
    elif isinstance(node, ast.Call) and len(node.args) > MOST_ARGUMENTS:
        callee = ast.unparse(node.func).rpartition(".")[2]
        if callee not in variadic:
            yield f"call of {callee} with more than {MOST_ARGUMENTS} positional arguments"
    elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        positional = [entry.arg for entry in (*node.args.posonlyargs, *node.args.args)]
        positional = positional[positional[:1] in (["self"], ["cls"]) :]
        if len(positional) + len(node.args.kwonlyargs) > MOST_PARAMETERS:
            if "Parameters\n----" not in (ast.get_docstring(node) or ""):
                yield f"{node.name} has more than {MOST_PARAMETERS} parameters and does not document them"
            if len(positional) > MOST_POSITIONAL:
                yield f"{node.name} takes more than {MOST_POSITIONAL} of its many parameters by position"
        if count_returned_values(node) > MOST_VALUES and node.name not in TUPLE_FUNCTIONS:
            yield f"{node.name} returns a tuple of more than {MOST_VALUES} values"


def count_returned_values(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Largest number of values of the tuples that a function returns by its annotation or its statements."""
    returns = [entry.value for entry in ast.walk(node) if isinstance(entry, ast.Return)]
    if isinstance(node.returns, ast.Subscript) and ast.unparse(node.returns.value) == "tuple":
        returns.append(node.returns.slice)
    return max((len(entry.elts) for entry in returns if isinstance(entry, ast.Tuple)), default=0)


def list_bound_names(node: ast.Module | ast.ClassDef) -> list[str]:
    """Names that the assignments of a module or class bind."""
    targets = [
        target
        for statement in node.body
        if isinstance(statement, ast.Assign | ast.AnnAssign)
        for target in (statement.targets if isinstance(statement, ast.Assign) else [statement.target])
    ]
    return [
        name.id
        for target in targets
        for name in ast.walk(target)
        if isinstance(getattr(name, "ctx", None), ast.Store) and isinstance(name, ast.Name)
    ]


def list_fields(node: ast.ClassDef, classes: dict[str, ast.ClassDef]) -> set[str]:
    """Names of the fields of a dataclass, inherited ones included."""
    annotated_entries = [entry for entry in node.body if isinstance(entry, ast.AnnAssign)]
    names = {
        ast.unparse(entry.target) for entry in annotated_entries if "ClassVar" not in ast.unparse(entry.annotation)
    }
    return names.union(
        *(list_fields(classes[name], classes) for base in node.bases if (name := ast.unparse(base)) in classes)
    )


def find_import_circle(modules: dict[str, str], stubs: dict[str, str]) -> list[str]:
    """Modules of a circle of imports, lazy imports and imports for types included; empty without a circle."""
    texts = {format_module_name(path): text for path, text in modules.items()}
    source_modules = {  # module of each lazily imported name of a package
        f"{format_module_name(path)}.{entry.name}": f"{format_module_name(path)}.{node.module or entry.name}"
        for path, text in stubs.items()
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.ImportFrom)
        for entry in node.names
    }
    graph: dict[str, set[str]] = {}
    for module, text in texts.items():
        nodes = list(ast.walk(ast.parse(text)))
        imports = {entry.name: entry.name for node in nodes if isinstance(node, ast.Import) for entry in node.names}
        for node in nodes:
            if isinstance(node, ast.ImportFrom):
                imports |= {f"{node.module}.{entry.name}": str(node.module) for entry in node.names}
        imported_modules = {
            source_modules.get(name, name if name in texts else package) for name, package in imports.items()
        }
        graph[module] = (imported_modules & set(texts)) - {module}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def format_module_name(path: str) -> str:
    """Dotted name of a module from its path within the package."""
    parts = ("contactstudy", *Path(path).with_suffix("").parts)
    return ".".join(part for part in parts if part != "__init__")


def find_misplaced_tests(tests: list[str], modules: list[str]) -> list[str]:
    """Files `room/test_MODULE.py`, `room/test_MODULE_TOPIC.py` or `MODULE/test_TOPIC.py` without such a module."""
    stems = {name.removesuffix(".py") for name in modules}
    rooms = {name.split("/")[0] for name in stems}
    misplaced_files = []
    for test in tests:
        room, _, name = test.removesuffix(".py").rpartition("/")
        words = name.split("_")[1:]
        candidates = {f"{room}/{'_'.join(words[:count])}" for count in range(1, len(words) + 1)} | {room}
        if room.split("/")[0] in rooms and not candidates & stems:
            misplaced_files.append(test)
    return misplaced_files


def unmarked_constants(text: str) -> list[str]:
    """Numeric constants of a module without a mark in their comment, a comment above or the docstring below."""
    lines, body = text.splitlines(), ast.parse(text).body
    numeric_names = {"np", "math"}
    unmarked = []
    for node, following in zip(body, [*body[1:], None], strict=True):
        if not isinstance(node, ast.Assign) or not is_numeric(node.value, numeric_names):
            continue
        names = [name.id for name in ast.walk(node.targets[0]) if isinstance(name, ast.Name)]
        if not all(map(str.isupper, names)):
            continue
        numeric_names |= set(names)
        first = node.lineno - 1
        while first and lines[first - 1].startswith("#"):
            first -= 1
        comments = [line.partition("#")[2] for line in lines[first : node.end_lineno]]
        if isinstance(following, ast.Expr):
            comments.append(str(getattr(following.value, "value", "")))
        if not CONSTANT_MARK.search(" ".join(comments)):
            unmarked += names
    return unmarked


def is_numeric(node: ast.expr, numeric_names: set[str]) -> bool:
    """Whether an expression consists of numbers, of names of numbers, and of functions of numpy and math."""
    values = [entry for entry in ast.walk(node) if isinstance(entry, ast.Constant | ast.Name)]
    has_other_nodes = any(isinstance(entry, ast.Dict | ast.Lambda | ast.comprehension) for entry in ast.walk(node))
    return not has_other_nodes and all(
        entry.id in numeric_names if isinstance(entry, ast.Name) else type(entry.value) in (int, float)
        for entry in values
    )


def test_package_follows_rules() -> None:
    assert not find_violations(MODULES)


def test_constants_of_solver_state_their_purpose() -> None:
    solver = {name: text for name, text in MODULES.items() if Path(name).parts[0] in SOLVER_ROOMS}
    unmarked = {name: constants for name, text in solver.items() if (constants := unmarked_constants(text))}
    assert not unmarked


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("STEPS = 3  # number of steps. Speed.", []),
        ("# Number of steps. Speed.\nSTEPS = 3", []),
        ('STEPS = 3\n"""Number of steps. Speed: more are slower."""', []),
        ("STEPS = 3  # number of steps", ["STEPS"]),
        ("import numpy as np\nLOW, HIGH = -np.sqrt(2.0), 10**8", ["LOW", "HIGH"]),
        ("STEP = 0.5  # step. Accuracy.\nSTEPS = np.array([STEP, 2 * STEP])", ["STEPS"]),
        ('NAME = "steps"\nsteps = 3', []),
    ],
)
def test_constant_without_purpose_is_detected(text: str, names: list[str]) -> None:
    assert unmarked_constants(text) == names


@pytest.mark.parametrize("folder", ["benchmarks", "studies"])
def test_scripts_follow_rules(folder: str) -> None:
    folder_path = Path(__file__).parent.parent / folder
    assert not find_violations(
        {str(path.relative_to(folder_path)): path.read_text() for path in folder_path.rglob("*.py")}
    )


def test_modules_import_without_circles() -> None:
    assert not find_import_circle(MODULES, STUBS)


@pytest.mark.parametrize(
    "text",
    [
        "from contactstudy.room.first import size",
        "def solve() -> None:\n    import contactstudy.room.first",
        "if TYPE_CHECKING:\n    from contactstudy.room import first",
        "from contactstudy.room import size",
    ],
)
def test_circle_of_imports_is_detected(text: str) -> None:
    modules = {"room/__init__.py": "", "room/first.py": "from contactstudy.room.second import edge"}
    stubs = {"room/__init__.pyi": "from .first import size as size"}
    names = {"contactstudy.room.first", "contactstudy.room.second"}
    assert set(find_import_circle(modules | {"room/second.py": text}, stubs)) == names


def test_tests_mirror_modules() -> None:
    folder = Path(__file__).parent
    tests = [path.relative_to(folder).as_posix() for path in folder.rglob("test_*.py")]
    assert not find_misplaced_tests(tests, [Path(name).as_posix() for name in MODULES])


def test_misplaced_test_is_detected() -> None:
    tests = ["film/test_solve.py", "film/test_solve_speeds.py", "export/test_vtk.py", "film/test_speeds.py"]
    assert find_misplaced_tests(tests, ["film/solve.py", "export.py"]) == ["film/test_speeds.py"]


FIELDS = "\n    ".join(f"{name}: int" for name in "abcde")
NUMPYDOC = '\n    """Solve.\n\n    Parameters\n    ----------\n    a, b, c, d, e, f, g, h : int\n    """'


@pytest.mark.parametrize(
    ("text", "count"),
    [
        (f"@dataclass(frozen=True)\nclass Five:\n    {FIELDS}", 1),
        (f"@dataclass(frozen=True, kw_only=True)\nclass Five:\n    {FIELDS}", 0),
        (
            "@dataclass\nclass A:\n    a: int\n    b: int\n    c: int\n@dataclass\nclass B(A):\n    d: int\n    e: int",
            1,
        ),
        ("module.solve(1, 2, 3, 4, 5, 6)", 1),
        ("solve(1, 2, 3, 4, 5, f=6)", 0),
        ("def joined(*parts): ...\njoined(1, 2, 3, 4, 5, 6)", 0),
        (f"def solve(a, b, *, c, d, e, f, g, h):{NUMPYDOC}", 0),
        (f"def solve(a, b, c, *, d, e, f, g, h):{NUMPYDOC}", 1),
        ("def solve(a, b, *, c, d, e, f, g, h): ...", 1),
        ("def solve(a, b, c, d, e, f, g): ...", 0),
        ("class A:\n    def solve(self, a, b, c, d, e, f, g): ...", 0),
        ("TOLERANCE = 1e-2\nSTEPS, TOLERANCE = 3, 1e-3", 1),
        ("class A:\n    size: int = 1\n    size = 2", 1),
        ("class A:\n    def solve(self, a, b, c, d, e, f, g, h): ...", 2),
        ("def solve() -> tuple[int, int, int, int]: ...", 1),
        ("def solve() -> tuple[int, ...]:\n    return 1, 2, 3, 4", 1),
        ("def solve() -> tuple[int, int, int]: ...", 0),
    ],
)
def test_rule_detects_violation(text: str, count: int) -> None:
    assert len(find_violations({"module.py": text})) == count
