from pathlib import Path

import pytest

from tests.checks.rooms import find_room_problems

CONTRACT = """
[[tool.importlinter.contracts]]
name = "rooms"
type = "layers"
exhaustive = true
containers = ["server"]
layers = ["app", "features", "http : stream", "platform | health"]

[[tool.importlinter.contracts]]
name = "features"
type = "layers"
exhaustive = true
containers = ["server.features"]
layers = ["sessions | lease"]
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A made-up server in order."""
    (tmp_path / "pyproject.toml").write_text(CONTRACT)
    write(tmp_path, "server/__init__.py", "VERSION = 1")
    write(tmp_path, "server/app.py", "from server.features.lease import routes\nfrom server import VERSION")
    write(
        tmp_path,
        "server/features/lease/routes.py",
        "import server.platform.store\nfrom server.http import page",
    )
    write(tmp_path, "server/features/sessions/routes.py", "from server.platform.store import Store")
    write(tmp_path, "server/http/page.py", "from server.platform.store import Store")
    write(tmp_path, "server/platform/store.py", "class Store: ...")
    return tmp_path


def write(root: Path, path: str, text: str) -> None:
    file = root / path
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


def test_a_tree_in_order_has_no_problem(tree: Path) -> None:
    assert find_room_problems(tree) == []


@pytest.mark.parametrize(
    "back",
    [
        "from server.features.lease.routes import router",
        "from server.features.lease import routes",
        "import server.features.lease.routes",
        "def load():\n    from server.features.lease import routes\n    return routes",
    ],
)
def test_a_circle_of_rooms_is_found(tree: Path, back: str) -> None:
    write(tree, "server/platform/schema.py", back)
    (problem,) = find_room_problems(tree)
    assert problem.startswith("rooms import each other in a circle: ")
    assert "server.platform" in problem
    assert "server.features.lease" in problem


def test_a_circle_within_a_room_is_none_of_rooms(tree: Path) -> None:
    write(tree, "server/platform/store.py", "from server.platform import schema")
    write(tree, "server/platform/schema.py", "from server.platform import store")
    assert find_room_problems(tree) == []


@pytest.mark.parametrize(
    ("path", "room"),
    [
        ("server/features/missions/__init__.py", "server.features.missions"),
        ("server/extras.py", "server.extras"),
        ("robot_runtime/sonar/node.py", "robot_runtime.sonar"),
    ],
)
def test_a_room_without_a_contract_is_found(tree: Path, path: str, room: str) -> None:
    write(tree, path, "")
    assert find_room_problems(tree) == [f"{room}: no layer contract in pyproject.toml names this room"]


def test_a_contract_that_is_not_exhaustive_names_nothing(tree: Path) -> None:
    (tree / "pyproject.toml").write_text(CONTRACT.replace("exhaustive = true", "exhaustive = false"))
    assert "server.http: no layer contract in pyproject.toml names this room" in find_room_problems(tree)
