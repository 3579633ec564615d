"""Changes of a Python function that remove a guard, found in its syntax tree rather than in its text.

A name (a variable, an attribute or a text) must occur once in the function; else a longer one is quoted:

    drop = "name"             the statement (a call, a `raise`) that uses it
    never, always = "name"    the condition that uses it becomes false, or true
    without = "name"          what uses it in an `and`, an `or` or a list; the keyword or entry of this name
    false = "name"            the value of this variable or entry becomes false
    returns = "True"          the function returns this at once
    unwrap = "name"           its call goes, the argument stays
    swap = ["old", "new"]     another name or text stands in its place
"""

import ast
from collections.abc import Callable, Iterator
from functools import partial

Change = Callable[[], object]
Scope = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


class MutationError(Exception):
    """The mutation does not fit its function; the text gives the reason."""


def mutate(source: str, scope: str, kind: str, *names: str) -> str:
    """Return the source without a guard in the function or class of this qualified name (none: the module).

    The change is made at the only place for it. Raise MutationError where there is none, or more than one.
    """
    tree = ast.parse(source)
    results = [change for node in ast.walk(_find_scope(tree, scope)) for change in KINDS[kind](node, *names)]
    if len(results) != 1 and kind != "returns":
        raise MutationError(f"{scope} has {len(results)} places for {kind} {' '.join(names)}, not one")
    results[0]()
    return ast.unparse(tree)


def replace(source: str, old: str, new: str) -> str:
    """Return the source with another text at the only place of the old one. Raise MutationError."""
    if (count := source.count(old)) != 1:
        raise MutationError(f"its text is there {count} times, not once")
    return source.replace(old, new)


def _find_scope(tree: ast.Module, name: str) -> Scope:
    scope: Scope = tree
    for part in filter(None, name.split(".")):
        inner = [
            child for child in scope.body if isinstance(child, Scope) and getattr(child, "name", "") == part
        ]
        if len(inner) != 1:
            raise MutationError(f"there is no {name}")
        scope = inner[0]
    return scope


def _uses(node: ast.AST, name: str) -> bool:
    """Return whether an expression has this variable, attribute (`limit` or `self.limit`) or text."""
    for inner in ast.walk(node):
        match inner:
            case ast.Name(id=own) | ast.Constant(value=own) if own == name:
                return True
            case ast.Attribute() if name in (inner.attr, ast.unparse(inner)):
                return True
    return False


def _drop(node: ast.AST, name: str) -> Iterator[Change]:
    """Drop the statement that calls something or raises an error, and uses this name."""
    for field in ("body", "orelse", "finalbody"):
        block = getattr(node, field, None)
        if isinstance(block, list):
            for index, byte in enumerate(block):
                if isinstance(byte, ast.Expr | ast.Raise) and _uses(byte, name):
                    yield partial(block.__setitem__, index, ast.Pass())


def _decide(node: ast.AST, name: str, value: bool) -> Iterator[Change]:
    if isinstance(node, ast.If | ast.While | ast.IfExp) and _uses(node.test, name):
        yield partial(setattr, node, "test", ast.Constant(value))


def _never(node: ast.AST, name: str) -> Iterator[Change]:
    """Make the condition that uses this name false."""
    return _decide(node, name, False)


def _always(node: ast.AST, name: str) -> Iterator[Change]:
    """Make the condition that uses this name true."""
    return _decide(node, name, True)


def _without(node: ast.AST, name: str) -> Iterator[Change]:
    """Drop what uses this name from `and`, `or` or a list, or the keyword or entry of this name."""
    match node:
        case ast.BoolOp(values=parts) | ast.List(elts=parts):
            for part in parts:
                if _uses(part, name) and not isinstance(part, ast.List):
                    yield partial(parts.remove, part)
        case ast.Call(keywords=keywords):
            for keyword in keywords:
                if keyword.arg == name:
                    yield partial(keywords.remove, keyword)
        case ast.Dict(keys=keys):
            for index, key in enumerate(keys):
                if isinstance(key, ast.Constant) and key.value == name:
                    yield partial(_remove_entry, node, index)


def _remove_entry(node: ast.Dict, position: int) -> None:
    del node.keys[position], node.values[position]


def _false(node: ast.AST, name: str) -> Iterator[Change]:
    """Make the variable, or the entry of this key, false."""
    match node:
        case ast.Assign(targets=[ast.Name(id=own)]) if own == name:
            yield partial(setattr, node, "value", ast.Constant(False))
        case ast.Dict(keys=keys, values=values):
            for index, key in enumerate(keys):
                if isinstance(key, ast.Constant) and key.value == name:
                    yield partial(values.__setitem__, index, ast.Constant(False))


def _returns(node: ast.AST, value: str) -> Iterator[Change]:
    """Return this at once from the function."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        yield partial(node.body.insert, 0, ast.Return(ast.parse(value, mode="eval").body))


def _unwrap(node: ast.AST, name: str) -> Iterator[Change]:
    """Put the argument in the place of the call of this function."""
    for field, value in ast.iter_fields(node):
        if isinstance(value, ast.Call) and value.args and _uses(value.func, name):
            yield partial(setattr, node, field, value.args[0])


def _swap(node: ast.AST, old: str, new: str) -> Iterator[Change]:
    """Put one name or text in the place of another."""
    match node:
        case ast.Name(id=own, ctx=ast.Load()) if own == old:
            yield partial(setattr, node, "id", new)
        case ast.Attribute(attr=own) if own == old:
            yield partial(setattr, node, "attr", new)
        case ast.Constant(value=own) if own == old:
            yield partial(setattr, node, "value", new)


KINDS: dict[str, Callable[..., Iterator[Change]]] = {
    "drop": _drop,
    "never": _never,
    "always": _always,
    "without": _without,
    "false": _false,
    "returns": _returns,
    "unwrap": _unwrap,
    "swap": _swap,
}
"""Mutations by name; each yields its possible changes of a node."""
