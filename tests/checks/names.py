"""Names and docstrings of the Python packages: unique classes, plain first sentences, terms of the field."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

PACKAGES = ("robot_runtime", "server", "migrations")
NAMED = (*PACKAGES, "mucat", "packages", "bench")
"""Packages whose functions are described in the imperative."""
DOCUMENTED = (*NAMED, "tests")
"""Packages of unique classes, names that are nouns of the field, and docstrings with subject and verb."""
RIDDLES = frozenset(
    {"What", "Whatever", "When", "Where", "Whether", "Which", "Who", "Whoever", "Whom", "Whose", "Why"}
    | {"By", "How", "Let", "Nothing", "That", "Those"}
)
"""Words that begin a clause without a subject."""
NOUN_DECORATORS = frozenset({"property", "cached_property", "fixture"})
"""Decorators of functions that are described by a noun."""
VAGUE = frozenset({"found", "one", "ones", "place", "said", "words"})
"""Names that fit every variable: say session, match, path, message. A class's fields may be stored names."""
DIALECT = frozenset({"befall", "felt", "kept", "lent", "told", "wanted"})
"""Participles of the project's old private English: say set point, requested, reported, override, backlog."""
STORED_NAMES = frozenset(
    {
        ("robot_runtime/contract/packets/definitions.py", "wanted"),
        ("server/features/exports/schemas.py", "wanted"),
        ("server/library/catalogue.py", "kept"),
        ("server/library/listing.py", "kept"),
        ("server/library/schemas.py", "kept"),
        ("server/recording/schemas.py", "kept"),
        ("server/platform/models.py", "kept"),
    }
)
"""Fields of packets, columns and stored documents: they are in recordings and data folders, and stay."""

DEFINITIONS = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef, ast.arg)
Modules = dict[str, list[ast.AST]]
"""Each file's nodes that define a name."""


def find_bad_names(root: Path) -> list[str]:
    """Return one line for each name or docstring against the rules: position, name and what to do."""
    documented = _parse(root, DOCUMENTED)
    named = {path: nodes for path, nodes in documented.items() if path.partition("/")[0] in NAMED}
    return [
        *_repeated_classes(documented),
        *_riddles(documented),
        *_moods(named),
        *_dialect(documented),
        *_vague_names(documented),
    ]


def _parse(root: Path, packages: tuple[str, ...]) -> Modules:
    files = sorted(file for package in packages for file in (root / package).rglob("*.py"))
    return {
        file.relative_to(root).as_posix(): [
            node for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))) if _defines(node)
        ]
        for file in files
    }


def _defines(node: ast.AST) -> bool:
    if isinstance(node, ast.Name | ast.Attribute):
        return isinstance(node.ctx, ast.Store)
    return isinstance(node, DEFINITIONS)


def _repeated_classes(modules: Modules) -> Iterator[str]:
    paths: defaultdict[str, list[str]] = defaultdict(list)
    for path, nodes in modules.items():
        for node in nodes:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                paths[node.name].append(path)
    for name, files in sorted(paths.items()):
        if len(files) > 1:
            yield f"class {name} is defined {len(files)} times, in {', '.join(files)}; rename all but one"


def _riddles(modules: Modules) -> Iterator[str]:
    for path, nodes in modules.items():
        for node in nodes:
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
                first = _first_word(node)
                if first in RIDDLES:
                    line = 1 if isinstance(node, ast.Module) else node.lineno
                    yield f"{path}:{line}: the docstring begins with {first}; say what it is or does"


def _moods(modules: Modules) -> Iterator[str]:
    """Yield the docstrings of functions that begin with no verb or the third person; ruff finds articles."""
    for path, nodes in modules.items():
        for node in nodes:
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and not _is_noun(node):
                first = _first_word(node)
                if first and (not first.istitle() or (first.endswith("s") and not first.endswith("ss"))):
                    yield f"{path}:{node.lineno}: the docstring begins with {first}; use an imperative"


def _is_noun(function: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    names = (ast.unparse(decorator).partition("(")[0] for decorator in function.decorator_list)
    return any(name.rpartition(".")[2] in NOUN_DECORATORS for name in names)


def _first_word(node: ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) -> str:
    return (ast.get_docstring(node) or "").partition(" ")[0].strip().strip(",.:;")


def _dialect(modules: Modules) -> Iterator[str]:
    for path, nodes in modules.items():
        for node in nodes:
            name = _bound_name(node)
            if name.startswith("test_"):
                continue  # a sentence
            if not DIALECT.isdisjoint(name.lower().split("_")) and (path, name) not in STORED_NAMES:
                yield f"{path}:{getattr(node, 'lineno', 1)}: {name} is private dialect; see the glossary"


def _vague_names(modules: Modules) -> Iterator[str]:
    for path, nodes in modules.items():
        bodies = (node.body for node in nodes if isinstance(node, ast.ClassDef))
        fields = {id(entry.target) for body in bodies for entry in body if isinstance(entry, ast.AnnAssign)}
        for node in nodes:
            name = _bound_name(node)
            if name.strip("_") in VAGUE and id(node) not in fields:
                yield f"{path}:{getattr(node, 'lineno', 1)}: {name} fits everything; use a noun of the field"


def _bound_name(node: ast.AST) -> str:
    """Return the name that a node binds; empty where it binds none."""
    if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
        return node.name
    if isinstance(node, ast.arg):
        return node.arg
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
        return node.id
    if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
        return node.attr
    return ""
