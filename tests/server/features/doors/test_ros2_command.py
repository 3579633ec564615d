"""`mucat certificate ros2`, as somebody types it, and a program with what it has printed."""

import asyncio
import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from server.cli import mucat
from server.features.doors.ros2_door import Ros2Door
from server.platform.running_server import announce
from server.platform.settings import Settings
from tests.server.features.doors.ros2_rig import ros2_peer, with_ros2
from tests.server.serving import Served


@pytest.fixture
def settings(settings: Settings) -> Settings:
    return with_ros2(settings)


async def test_a_certificate_lets_a_program_in_with_its_scope(
    settings: Settings, tmp_path: Path, served: Served
) -> None:
    announce(served.settings)

    async def shell(*arguments: str) -> str:
        common = ("--data", str(settings.data.path), "--config", str(settings.config))
        command = ["certificate", "ros2", *arguments, *common]
        return (await asyncio.to_thread(CliRunner().invoke, mucat, command)).output

    folder = tmp_path / "lab"
    answer = await shell("lab", "--to", str(folder))
    assert "The door is closed: set ros2 = true" in answer  # the file on disk does not open it
    assert "exists" in await shell("lab", "--to", str(folder))
    assert "no name of a certificate" in await shell("../lab")
    assert "lab" in await shell("lab", "--to", str(tmp_path / "again"))
    assert not (tmp_path / "again").exists()
    (printed,) = re.findall(r"ZENOH_CONFIG_OVERRIDE='(.*)' ros2 run", answer)
    host, port = served.get(Ros2Door).address
    printed = printed.replace("ADDRESS:7448", f"{host}:{port}").replace('"lab/', f'"{folder}/')
    async with ros2_peer(served, printed) as peer:
        success, reason = await asyncio.to_thread(peer.call, "/mucat/take_control")
        assert (success, "operator" in reason) == (False, True)
    names = [device["name"] for device in (await served.api.get("/access/devices")).json()]
    assert names == ["lab"]


async def test_a_certificate_that_cannot_be_made_leaves_no_program(
    settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    announce(served.settings)
    monkeypatch.setenv("PATH", "")
    command = [
        "certificate",
        "ros2",
        "lab",
        "--to",
        str(tmp_path / "lab"),
        "--data",
        str(settings.data.path),
    ]
    done = await asyncio.to_thread(CliRunner().invoke, mucat, command)
    assert "openssl" in done.output
    assert (await served.api.get("/access/devices")).json() == []
