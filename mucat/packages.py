"""Packages that not everybody has."""

from importlib import import_module
from typing import Any

from mucat.errors import RobotError


def load_package(module: str, package: str = "") -> Any:
    """Return a module of a package, whose name is the module's unless it is given.

    Raise RobotError where it is not installed.
    """
    package = package or module
    try:
        return import_module(module)
    except ImportError as problem:
        raise RobotError(f"This needs the package {package}: pip install {package}") from problem
