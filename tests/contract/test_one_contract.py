"""A command and a topic are declared in one place each; everything else derives from there."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from robot_runtime.clock import SimulatedClock
from robot_runtime.commands import Commands
from robot_runtime.contract.commands import COMMANDS
from robot_runtime.generate.reference import make_core
from tests.stack import ROOT

COMMAND = '''
@command("blink", Need.CONTROL, tunes=True, in_scenarios=True, disturbs_experiment=True)
class BlinkCommand(RobotCommand):
    """Blinks the lamp."""

    times: Annotated[int, Range(1, 9)] = field(metadata={"description": "flashes"})


'''
TOPIC = 'LAMP = Topic(211, "lamp", documents.Truth, "light of the lamp", sender="simulator")\n'


def insert(path: Path, before: str, text: str) -> None:
    source = path.read_text(encoding="utf-8")
    assert source.count(before) == 1
    path.write_text(source.replace(before, text + before), encoding="utf-8")


def test_an_added_command_and_topic_are_found_everywhere(tmp_path: Path) -> None:
    # Other tests' processes write compiled modules under such names first, which are gone a moment later.
    left_out = shutil.ignore_patterns("page", "*.pyc.*")
    for room in ("robot_runtime", "server", "migrations", "tests"):
        shutil.copytree(ROOT / room, tmp_path / room, ignore=left_out)
    shutil.copy(ROOT / "robot.toml", tmp_path)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    contract = tmp_path / "robot_runtime/contract"
    insert(contract / "commands.py", '@command("end_experiment"', COMMAND.lstrip())
    source = (contract / "commands.py").read_text(encoding="utf-8")
    source = source.replace("import (\n    SET_POINTS,", "import (\n    SET_POINTS,\n    Range,", 1)
    source = source.replace("from typing import Any,", "from typing import Annotated, Any,", 1)
    (contract / "commands.py").write_text(source, encoding="utf-8")
    insert(contract / "topics.py", 'STATE = Topic(16, "state"', TOPIC)
    done = subprocess.run(
        [sys.executable, "-m", "tests.contract.added"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]


def test_the_runtime_performs_every_command() -> None:
    commands = Commands(make_core(SimulatedClock()))
    assert set(commands._handlers) == set(COMMANDS.values())
