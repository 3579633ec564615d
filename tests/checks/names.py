"""Names and docstrings of the Python packages: unique classes, plain first sentences, terms of the field."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

PACKAGES = ("robot_runtime", "server", "migrations")
DOCUMENTED = (*PACKAGES, "bench", "tests")
"""Packages whose docstrings are checked; class and variable names only in the product's."""
RIDDLES = frozenset(
    {"What", "Whatever", "When", "Where", "Whether", "Which", "Who", "Whoever", "Whom", "Whose", "Why"}
    | {"How", "Let", "That"}
)
"""Words that begin a clause without a subject."""
DIALECT = frozenset({"befall", "felt", "kept", "lent", "told", "wanted"})
"""Participles of the project's old private English: say set point, requested, reported, override, backlog."""
STORED_NAMES = frozenset(
    {
        ("robot_runtime/contract/packets/definitions.py", "wanted"),
        ("server/features/exports/schemas.py", "wanted"),
        ("server/features/sessions/catalogue.py", "kept"),
        ("server/features/sessions/schemas.py", "kept"),
        ("server/platform/models.py", "kept"),
    }
)
"""Fields of packets, columns and stored documents: they are in recordings and data folders, and stay."""

Modules = dict[str, list[ast.AST]]
"""All nodes of each file."""


def find_bad_names(root: Path) -> list[str]:
    """One line for each name or docstring against the rules: place, name and what to do."""
    documented = _parse(root, DOCUMENTED)
    modules = {place: nodes for place, nodes in documented.items() if place.partition("/")[0] in PACKAGES}
    return [*_repeated_classes(modules), *_riddles(documented), *_dialect(modules)]


def _parse(root: Path, packages: tuple[str, ...]) -> Modules:
    files = sorted(file for package in packages for file in (root / package).rglob("*.py"))
    return {
        file.relative_to(root).as_posix(): list(ast.walk(ast.parse(file.read_text(encoding="utf-8"))))
        for file in files
    }


def _repeated_classes(modules: Modules) -> Iterator[str]:
    places: defaultdict[str, list[str]] = defaultdict(list)
    for place, nodes in modules.items():
        for node in nodes:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places[node.name].append(place)
    for name, found in sorted(places.items()):
        if len(found) > 1:
            yield f"class {name} is defined {len(found)} times, in {', '.join(found)}; rename all but one"


def _riddles(modules: Modules) -> Iterator[str]:
    for place, nodes in modules.items():
        for node in nodes:
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
                words = (ast.get_docstring(node) or "").split()
                if words and words[0].strip(",.:;") in RIDDLES:
                    line = 1 if isinstance(node, ast.Module) else node.lineno
                    yield f"{place}:{line}: the docstring begins with {words[0]}; say what it is or does"


def _dialect(modules: Modules) -> Iterator[str]:
    for place, nodes in modules.items():
        for node in nodes:
            name = _bound_name(node)
            if not DIALECT.isdisjoint(name.lower().split("_")) and (place, name) not in STORED_NAMES:
                yield f"{place}:{getattr(node, 'lineno', 1)}: {name} is private dialect; see the glossary"


def _bound_name(node: ast.AST) -> str:
    """The name that a node binds; empty where it binds none."""
    if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
        return node.name
    if isinstance(node, ast.arg):
        return node.arg
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
        return node.id
    if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
        return node.attr
    return ""
