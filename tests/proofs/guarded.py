"""The subjects that must have an entry in `guards.toml`, read from the tables of the code itself.

A test fails where one of these is new and has no entry: a fault, a reason of the board to refuse or to
disarm, a security header, a flag of a cookie, an operation that needs control, a module that asks for room
on the disk.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from fastapi.routing import iter_route_contexts

from robot_runtime.control.faults import BY_NAME
from server.app import create_app
from server.health.faults import FAULTS
from server.http.security import HEADERS
from server.http.sign_in.policy import MESSAGES, Need, need_of
from server.platform.settings import DataFolder, Settings
from tests.board.rig import ROOT

ARMING = ROOT / "firmware/src/safety/arming.h"
PYTHON_ROOMS = ("robot_runtime", "server")
FULL_DISK = re.compile(r"\bENOSPC\b|\bdisk_usage\(|\bstatvfs\(|\"disk is full\" in\b")
"""A module that asks how much room there is, or whether an error was a full disk."""
COOKIE_FLAGS = {"httponly", "samesite", "secure"}


def list_guarded() -> set[str]:
    """The subjects of all guards that the code's tables demand."""
    return {
        *(f"fault {name}" for name in BY_NAME),
        *(f"server fault {name}" for name in FAULTS),
        *(f"header {name}" for name in HEADERS),
        *_list_reasons_of_the_board(),
        *_list_cookie_flags(),
        *_list_control(),
        *_list_full_disk(),
    }


def _list_reasons_of_the_board() -> Iterator[str]:
    text = ARMING.read_text(encoding="utf-8")
    for name in ("Refusal", "Disarming"):
        (body,) = re.findall(rf"enum class {name} : uint8_t {{([^}}]*)}};", text)
        yield from (f"{name}::{one.strip()}" for one in body.split(",") if one.strip() != "kNone")


def _list_cookie_flags() -> Iterator[str]:
    for file in _sources():
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                given = {one.arg for one in node.keywords} if node.func.attr == "set_cookie" else set()
                yield from (f"cookie {flag} {_name(file)}" for flag in COOKIE_FLAGS & given)


def _list_control() -> Iterator[str]:
    app = create_app(Settings(data=DataFolder(Path("data", every_feature=True)), config=Path("robot.toml")))
    for route in iter_route_contexts(app.routes):
        if need_of(route) is Need.CONTROL:
            yield from (f"control {method} {route.path}" for method in route.methods or ())
    yield from (f"control {message}" for message, need in MESSAGES.items() if need is Need.CONTROL)


def _list_full_disk() -> Iterator[str]:
    yield from (f"full disk {_name(file)}" for file in _sources() if FULL_DISK.search(file.read_text()))


def _sources() -> Iterator[Path]:
    for room in PYTHON_ROOMS:
        yield from sorted((ROOT / room).rglob("*.py"))


def _name(file: Path) -> str:
    return str(file.relative_to(ROOT))
