"""The subjects that must have an entry in `guards.toml`, read from the tables of the code itself.

A test fails where one of these is new and has no entry: a fault of the robot, a reason of the board to refuse
or to disarm, a flag of a cookie.
"""

import ast
from collections.abc import Iterator

from robot_runtime.contract.packets import Disarming, Refusal
from robot_runtime.control.faults import ROBOT_FAULTS
from tests.board.rig import ROOT

COOKIE_FLAGS = {"httponly", "samesite", "secure"}


def list_guarded() -> set[str]:
    """Return the subjects of all guards that the code's tables demand."""
    return {
        *(f"fault {name}" for name in ROBOT_FAULTS),
        *_list_reasons_of_the_board(),
        *_list_cookie_flags(),
    }


def _list_reasons_of_the_board() -> Iterator[str]:
    for reasons in (Refusal, Disarming):
        names = (reason.name.title().replace("_", "") for reason in reasons if reason)
        yield from (f"{reasons.__name__}::k{name}" for name in names)


def _list_cookie_flags() -> Iterator[str]:
    for file in sorted((ROOT / "server").rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                given = (
                    {keyword.arg for keyword in node.keywords} if node.func.attr == "set_cookie" else set()
                )
                yield from (f"cookie {flag} {file.relative_to(ROOT)}" for flag in COOKIE_FLAGS & given)
