"""The table of what is allowed names everything that there is, and nothing else."""

from pathlib import Path

from server.app import create_app
from server.http.sign_in.gate import OPEN
from server.http.sign_in.policy import OPERATIONS, Need
from server.platform.settings import DataFolder, Settings


def operations() -> dict[str, tuple[str, str]]:
    """Method and path of each operation."""
    app = create_app(Settings(data=DataFolder(Path("data")), config=Path("robot.toml")))
    return {
        operation["operationId"]: (method.upper(), path)
        for path, methods in app.openapi()["paths"].items()
        for method, operation in methods.items()
    }


def test_every_operation_has_an_entry_and_every_entry_an_operation() -> None:
    assert set(operations()) == set(OPERATIONS)


def test_the_gate_is_open_for_what_needs_nothing_alone() -> None:
    there = operations()
    assert {there[name] for name, need in OPERATIONS.items() if need is Need.NOTHING} == OPEN
