"""Fan-out: no module of the product imports more than twenty others of ours."""

import ast
from pathlib import Path

PACKAGES = ("bench", "migrations", "mucat", "packages", "robot_runtime", "server")
IMPORTS_MAX = 20


def find_crowded_modules(root: Path) -> list[str]:
    """Return one line for each module that imports too many others; imports inside functions count too."""
    paths = [path for package in PACKAGES for path in sorted((root / package).rglob("*.py"))]
    counted = {path.relative_to(root).as_posix(): len(_imported(root, path)) for path in paths}
    return [
        f"{position}: imports {count} modules of ours, and {IMPORTS_MAX} is the most; split it by purpose"
        for position, count in counted.items()
        if count > IMPORTS_MAX
    ]


def _imported(root: Path, path: Path) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            names.update(_module(root, node.module, alias.name) for alias in node.names)
    return {name for name in names if name.partition(".")[0] in PACKAGES}


def _module(root: Path, package: str, name: str) -> str:
    """Return the module that `from package import name` imports: the package itself, or one inside it."""
    inside = root.joinpath(*package.split("."), name)
    return f"{package}.{name}" if inside.is_dir() or inside.with_suffix(".py").is_file() else package
