"""Topics are compared as the objects of the contract, never by their names in strings.

An expression counts as a topic or its name where its last word is `topic`, `topics`, `source` or `sources`,
alone or after an underscore (`block.topic`, `row["topic"]`, `own_topics`, `sample.source`), where it is
`.name` of such a one, and where it is a variable that the same function has set to such a one. It may not be
compared with a literal that is the name of a topic: by an operator, by `match`, as an index or with `get`, in
a set or dictionary of literals. Nor may `BY_NAME` be indexed by one. Words such as "depth" beside anything
else are fields, loops or words of a protocol.
"""

import ast
from collections.abc import Iterator, Sequence
from pathlib import Path

from robot_runtime.contract.topics import BY_NAME

PACKAGES = ("mucat", "robot_runtime", "server")
CONTRACT = "robot_runtime/contract"
WORDS = frozenset({"topic", "topics", "source", "sources"})


def find_compared_names(root: Path) -> list[str]:
    """Return one line for each comparison of a topic with a string: position, name and remedy."""
    files = sorted(file for package in PACKAGES for file in (root / package).rglob("*.py"))
    places = {file.relative_to(root).as_posix(): file for file in files}
    return [
        f'{position}:{line}: a topic is compared with "{name}"; use topics.{name.upper()} of the contract'
        for position, file in places.items()
        if not position.startswith(f"{CONTRACT}/")
        for line, name in sorted(_compared(ast.parse(file.read_text(encoding="utf-8"))))
    ]


def _compared(tree: ast.Module) -> set[tuple[int, str]]:
    """Line and name of each comparison in a file."""
    results = set(_Comparisons(frozenset()).of(tree))
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef):
            results.update(_Comparisons(_variables(function)).of(function))
    return results


def _variables(function: ast.AST) -> frozenset[str]:
    """Return the variables that a function sets to a topic or its name."""
    known = _Comparisons(frozenset())
    return frozenset(
        target.id
        for node in ast.walk(function)
        if isinstance(node, ast.Assign) and known.is_topic(node.value)
        for target in node.targets
        if isinstance(target, ast.Name)
    )


class _Comparisons:
    """Finds the comparisons of topics with literals, where these variables are topics, too."""

    def __init__(self, variables: frozenset[str]) -> None:
        self._variables = variables

    def is_topic(self, node: ast.AST) -> bool:
        """Return True for an expression that is a topic, several ones, or the name of one."""
        match node:
            case ast.Attribute(value=value, attr="name"):
                return self.is_topic(value)
            case ast.Attribute(attr=word) | ast.Subscript(slice=ast.Constant(value=str(word))):
                return word.rpartition("_")[2] in WORDS
            case ast.Name(id=word):
                return word in self._variables or word.rpartition("_")[2] in WORDS
        return False

    def of(self, tree: ast.AST) -> Iterator[tuple[int, str]]:
        """Line and name of each comparison."""
        for node in ast.walk(tree):
            for side in self._other_sides(node):
                yield from ((node.lineno, name) for name in _names(side))  # type: ignore[attr-defined]

    def _other_sides(self, node: ast.AST) -> Sequence[ast.AST]:
        """Return the expressions that a node compares with a topic."""
        match node:
            case ast.Compare(left=left, comparators=[right]) | ast.BinOp(left=left, right=right):
                return [right] * self.is_topic(left) + [left] * self.is_topic(right)
            case ast.Match(subject=subject, cases=cases) if self.is_topic(subject):
                return [item for case in cases for item in ast.walk(case.pattern)]
            case ast.Subscript(value=table, slice=index):
                return self._look_up(table, index)
            case ast.Call(func=ast.Attribute(value=table, attr="get"), args=[index, *_]):
                return self._look_up(table, index)
        return []

    def _look_up(self, table: ast.AST, index: ast.AST) -> Sequence[ast.AST]:
        by_topic = self.is_topic(table) or (isinstance(table, ast.Name) and table.id == "BY_NAME")
        return [index] * by_topic + [table] * (self.is_topic(index) and isinstance(table, ast.Dict))


def _names(node: ast.AST) -> list[str]:
    """Return the names of topics that an expression of literals holds."""
    match node:
        case ast.Constant(value=str(text)) if text in BY_NAME:
            return [text]
        case ast.Set(elts=parts) | ast.Tuple(elts=parts) | ast.List(elts=parts) | ast.Dict(keys=parts):
            return [name for part in parts if part is not None for name in _names(part)]
    return []
