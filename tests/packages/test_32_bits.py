"""The wheel on a 32-bit Debian 13 without OpenCV: a root file system of i386, made once, in build/roots."""

import os
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from packages.constraints import write_constraints
from tests.proofs.installed import InstalledRobot, config_with_board, install_wheels
from tests.proofs.roots import I386, NO_CAMERA

RECORDED = 5.0
"""s"""


def may_enter() -> bool:
    """Return True where this process may make a root file system, and enter it."""
    return os.geteuid() == 0 and subprocess.run(["unshare", "--mount", "true"], check=False).returncode == 0


@pytest.mark.stack
@pytest.mark.skipif(
    not may_enter(), reason="only root, with the right to mount, may enter a root file system"
)
def test_it_swims_without_a_camera_and_says_so(mucat_wheel: Path) -> None:
    root = replace(I386, name="i386-trixie-small", packages=NO_CAMERA, wheels=mucat_wheel.parent)
    root.make()
    write_constraints(root.wheels)
    install_wheels(root)
    assert root.run("python3", "-c", "import struct; print(struct.calcsize('P'))") == "4\n"
    with config_with_board(root.baud) as config:
        robot = InstalledRobot(root, config)
        try:
            robot.wait_for_page()
            robot.wait_for_health()
            robot.api.post("/sessions", json={"name": "32 bits"}).raise_for_status()
            robot.arm()
            recording = robot.wait_for_recording(RECORDED)
            camera = robot.api.get("/robot").json()["camera"]
            robot.api.post("/robot/stop").raise_for_status()
            session = robot.api.get(f"/sessions/{recording['id']}").json()
        finally:
            robot.end()
    assert "install them (Debian: sudo apt install python3-opencv)" in camera
    assert len(session["firmware"]) == 16
    assert session["samples"] > 0
