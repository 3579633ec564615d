"""Rooms: no circle of imports among them, and none that no import contract names.

A room is a module or package directly inside one of the containers. Imports inside functions count too.
"""

import ast
import tomllib
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

CONTAINERS = (
    "robot_runtime",
    "robot_runtime.experiments",
    "robot_runtime.simulation",
    "server",
    "server.features",
)


def find_room_problems(root: Path) -> list[str]:
    """One line for each room that no contract names, and one for a circle."""
    modules = {_name(root, path): path for top in _tops() for path in sorted((root / top).rglob("*.py"))}
    graph = _import_graph(modules)
    named = _named_rooms(root / "pyproject.toml")
    return [
        *(
            f"{room}: no layer contract in pyproject.toml names this room"
            for room in sorted(set(graph) - named)
        ),
        *_find_circle(graph),
    ]


def _tops() -> list[str]:
    return [container for container in CONTAINERS if "." not in container]


def _name(root: Path, path: Path) -> str:
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _room(module: str) -> str | None:
    """The room of a module; None for a container itself."""
    container = max((one for one in CONTAINERS if module.startswith(f"{one}.")), key=len, default=None)
    if container is None or module in CONTAINERS:
        return None
    return f"{container}.{module[len(container) + 1 :].partition('.')[0]}"


def _import_graph(modules: dict[str, Path]) -> dict[str, set[str]]:
    """The rooms that each room imports."""
    graph: dict[str, set[str]] = {}
    for module, path in modules.items():
        room = _room(module)
        if room is None:
            continue
        imported = {_room(name) for name in _imports(path, modules)}
        graph.setdefault(room, set()).update(one for one in imported if one not in (None, room))
    return graph


def _imports(path: Path, modules: dict[str, Path]) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            for alias in node.names:
                name = f"{node.module}.{alias.name}"
                yield name if name in modules else node.module


def _named_rooms(pyproject: Path) -> set[str]:
    """The rooms that exhaustive layer contracts of import-linter name."""
    contracts = tomllib.loads(pyproject.read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
    return {
        f"{container}.{room.strip()}"
        for contract in contracts
        if contract["type"] == "layers" and contract.get("exhaustive")
        for container in contract["containers"]
        for layer in contract["layers"]
        for room in layer.replace("|", ":").split(":")
    }


def _find_circle(graph: dict[str, set[str]]) -> Iterator[str]:
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as problem:
        yield f"rooms import each other in a circle: {' <- '.join(problem.args[1])}"
