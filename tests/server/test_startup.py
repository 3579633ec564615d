"""Start and end of the server: the libraries of its runner, signals, a full disk, and a part that fails."""

import asyncio
import sqlite3
import subprocess
import sys
import threading
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from robot_runtime.durable_files import PART
from server.app import create_app
from server.http.listener import open_socket
from server.http.serving import make_server
from server.platform.running_server import announce
from server.platform.settings import Settings, SetupError
from server.processes.supervisor import ProcessSupervisor
from tests.server.new_database import place_empty
from tests.server.waiting import SECONDS

LIBRARIES = ("fastapi", "sqlalchemy", "pydantic", "uvicorn", "asyncio")

PROGRAM = """
import sys
from pathlib import Path
import server.startup as startup
from robot_runtime.config import RobotConfig
from server.platform.server_config import ServerConfig
from server.platform.settings import DataFolder, Settings
from server.processes.server_runner import ServerRunner

folder, profile, *libraries = sys.argv[1:]
ServerRunner.run = lambda _: print(*sorted(name for name in libraries if name in sys.modules)) or 0
data = DataFolder(Path(folder))
data.run.mkdir()
sys.exit(startup._serve(Settings(
    data=data,
    config=Path("robot.toml"),
    robot=RobotConfig(mode="robot", profile=profile),
    sections={ServerConfig: ServerConfig(port=0)},
)))
"""


@pytest.mark.parametrize(("profile", "held"), [("full", sorted(LIBRARIES)), ("lean", [])])
def test_the_runner_of_a_small_computer_holds_no_copy_of_the_server_s_libraries(
    tmp_path: Path, profile: str, held: list[str]
) -> None:
    ran = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(tmp_path), profile, *LIBRARIES],
        capture_output=True,
        text=True,
        check=True,
    )
    assert ran.stdout.split() == held


STOPPED = """
import os
import signal
import sys
import types
from pathlib import Path
import server.startup as startup
from robot_runtime.config import RobotConfig
from server.platform.server_config import ServerConfig
from server.platform.settings import DataFolder, Settings

def load(*_):
    os.kill(os.getppid(), signal.SIGTERM)
    signal.pause()
    print("loaded")

sys.modules["server.loading"] = types.SimpleNamespace(load=load)
data = DataFolder(Path(sys.argv[1]))
data.run.mkdir()
sys.exit(startup._serve(Settings(
    data=data,
    config=Path("robot.toml"),
    robot=RobotConfig(mode="robot", profile="lean"),
    sections={ServerConfig: ServerConfig(port=0)},
)))
"""


def test_a_server_that_is_stopped_while_its_libraries_load_ends(tmp_path: Path) -> None:
    command = [sys.executable, "-c", STOPPED, str(tmp_path)]
    ran = subprocess.run(command, capture_output=True, text=True, check=True, timeout=SECONDS)
    assert ran.stdout == ""


def test_a_server_whose_address_cannot_be_written_keeps_that_of_the_one_before(settings: Settings) -> None:
    announce(settings)
    before = settings.data.address.read_text()
    settings.data.address.with_name(settings.data.address.name + PART).mkdir()
    announce(settings)
    assert settings.data.address.read_text() == before


WHOLE = """
import asyncio
import sys
from pathlib import Path
from robot_runtime.config import RobotConfig
from server.platform.settings import DataFolder, Settings
from tests.server.serving import serve

data = DataFolder(Path(sys.argv[1]))
data.run.mkdir()

async def look() -> None:
    robot = RobotConfig(mode="robot")
    async with serve(Settings(data=data, config=Path("robot.toml"), robot=robot)) as served:
        (await served.api.get("/health")).raise_for_status()
        print(*(name for name in ("numpy", "cv2") if name in sys.modules))

asyncio.run(look())
"""


def test_a_server_that_serves_has_not_loaded_libraries_that_may_end_its_process() -> None:
    # Sockets have short paths.
    with TemporaryDirectory(prefix="mucat-") as folder:
        ran = subprocess.run(
            [sys.executable, "-c", WHOLE, folder], capture_output=True, text=True, timeout=SECONDS
        )
    assert (ran.returncode, ran.stdout.strip()) == (0, ""), ran.stderr


async def live_once(settings: Settings) -> None:
    """Start a server and end it."""
    app = create_app(settings)
    async with app.router.lifespan_context(app):
        pass


def test_a_server_that_cannot_hear_the_runtime_says_so(settings: Settings) -> None:
    place_empty(settings.data)
    settings.data.server_socket.mkdir()
    with pytest.raises(SetupError, match="cannot listen for the robot's runtime"):
        asyncio.run(live_once(settings))


def test_a_damaged_page_of_the_database_is_said_with_its_remedy(
    settings: Settings, capsys: pytest.CaptureFixture[str]
) -> None:
    place_empty(settings.data)
    with closing(sqlite3.connect(settings.data.database)) as database:
        database.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        (page,) = database.execute("SELECT rootpage FROM sqlite_master WHERE name = 'device'").fetchone()
        (size,) = database.execute("PRAGMA page_size").fetchone()
    with settings.data.database.open("r+b") as file:
        file.seek((page - 1) * size)
        file.write(b"x" * size)
    with open_socket("127.0.0.1", 0) as listener, pytest.raises(SystemExit):
        make_server(create_app(settings)).run(sockets=[listener])
    output = capsys.readouterr().err
    assert "the database is damaged: " in output
    assert "Put back a copy (`mucat restore`), or move it away to start with an empty one." in output
    assert "Traceback" not in output


def test_a_part_that_cannot_be_closed_keeps_nothing_else_open(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def fail(_: ProcessSupervisor) -> None:
        raise ChildProcessError("a process that nobody can end")

    place_empty(settings.data)
    monkeypatch.setattr(ProcessSupervisor, "stop", fail)
    before = set(threading.enumerate())
    with pytest.raises(ChildProcessError, match="nobody can end"):
        asyncio.run(live_once(settings))
    # Zenoh's threads end soon after their session. One that stays keeps the process, as a writer's would.
    for thread in set(threading.enumerate()) - before:
        thread.join(SECONDS)
        assert not thread.is_alive(), thread.name
