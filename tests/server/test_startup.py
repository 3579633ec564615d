"""The runner of the server: the libraries that it holds in its memory."""

import subprocess
import sys
from pathlib import Path

import pytest

LIBRARIES = ("fastapi", "sqlalchemy", "pydantic", "uvicorn", "asyncio")

PROGRAM = """
import sys
from pathlib import Path
import server.startup as startup
from server.platform.settings import DataFolder, Settings
from server.processes.server_runner import ServerRunner

folder, profile, *libraries = sys.argv[1:]
ServerRunner.run = lambda _: print(*sorted(name for name in libraries if name in sys.modules)) or 0
data = DataFolder(Path(folder))
data.run.mkdir()
sys.exit(startup._serve(Settings(data, Path("robot.toml"), mode="robot", profile=profile, port=0)))
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
