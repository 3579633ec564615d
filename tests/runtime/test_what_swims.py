"""The installed robot loads nothing of the simulation, the experiments and the generators."""

import json
import subprocess
import sys
from pathlib import Path

APART = ("robot_runtime.simulation", "robot_runtime.experiments", "robot_runtime.generate", "server")
SCRIPT = """
import json, sys
from robot_runtime import __main__ as runtime
from robot_runtime.robot import RobotRuntime

publish = RobotRuntime.publish_tick

def publish_and_close(robot):
    publish(robot)
    robot.close()

RobotRuntime.publish_tick = publish_and_close
assert runtime.main() == 0
print(json.dumps(sorted(sys.modules)))
"""


def test_the_robot_loads_neither_simulation_nor_experiments(tmp_path: Path) -> None:
    config = tmp_path / "robot.toml"
    config.write_text(
        f'[robot]\nmode = "robot"\n[link]\nport = "{tmp_path}/serial"\n[vision]\ncamera = "card"\n'
    )
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, "--config", config.name, "--data", "d"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    loaded = json.loads(done.stdout.splitlines()[-1])
    assert "robot_runtime.control.supervisor" in loaded
    # A decoder that crashes would take control with it: the vision process alone loads these.
    assert [name for name in loaded if name in ("cv2", "numpy")] == []
    assert [name for name in loaded if name.startswith(APART)] == []
