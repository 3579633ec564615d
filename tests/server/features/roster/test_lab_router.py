"""The lab's router with the real Zenoh: TLS on the loopback, and the rights of each certificate."""

import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from robot_runtime.errors import NoAnswerError
from robot_runtime.transport.network import AUTHORITY
from robot_runtime.transport.zenoh_transport import ZenohTransport
from server.features.roster.fleet_session import FleetSession
from server.platform.authority import Authority
from server.platform.lab_network import ROBOTS, STOP, member_settings
from server.platform.settings import DataFolder, Settings
from tests.server.features.roster.lab_router import LabRouter, RobotEnd
from tests.server.ports import reserved_port
from tests.waiting import SECONDS, wait_for

SILENCE = 0.5
"""s after which a question that is passed on to nobody counts as unanswered."""


@pytest.fixture
def router(settings: Settings, tmp_path: Path) -> Iterator[LabRouter]:
    with reserved_port() as port:
        yield LabRouter(settings, tmp_path, port, "turtle-1", "turtle-2")


def hear(router: LabRouter, robot: RobotEnd, text: str) -> None:
    """Wait until the lab hears what this robot says."""

    def heard() -> bool:
        robot.say(text)
        return (robot.messages.robot, text.encode()) in router.presences

    wait_for(heard, f"the lab to hear {text}")


def stop(lab: FleetSession, robot: str) -> None:
    """Stop a robot, and repeat until Zenoh has announced who answers."""
    end = time.monotonic() + SECONDS
    while True:
        try:
            lab.stop(robot, SILENCE)
            return
        except NoAnswerError:
            assert time.monotonic() < end


def test_the_lab_hears_each_robot_and_stops_it(router: LabRouter) -> None:
    with (
        router.running(),
        router.lab() as lab,
        router.robot("turtle-1") as first,
        router.robot("turtle-2") as second,
    ):
        hear(router, first, "of the first")
        hear(router, second, "of the second")
        stop(lab, "turtle-1")
        assert (first.stopped, second.stopped) == (1, 0)
        second.ahead = 90
        assert lab.measure_clock("turtle-2") == pytest.approx(90, abs=2)
        assert router.alive == {"turtle-1": True, "turtle-2": True}


def test_a_robot_speaks_for_itself_alone_and_commands_nobody(router: LabRouter) -> None:
    with router.running(), router.lab() as lab, router.robot("turtle-1") as victim:
        # The certificate of the second, and the name of the first.
        certificate = router.folder / "turtle-2"
        network = member_settings(certificate)
        with (
            router.robot("turtle-1", certificate) as impostor,
            ZenohTransport("turtle-1", connect=[router.endpoint], network=network) as commander,
        ):
            heard: list[str] = []
            commander.subscribe("**", lambda name, _: heard.append(name))
            hear(router, victim, "of the first")
            impostor.say("invented")
            with pytest.raises(NoAnswerError):
                commander.query(STOP, {}, SILENCE)
            stop(lab, "turtle-1")
            assert (victim.stopped, impostor.stopped) == (1, 0)
            assert heard == []
        # What was sent before arrives before.
        hear(router, victim, "again")
        assert all(data != b"invented" for _, data in router.presences)
        # The token of the impostor was none.
        assert router.alive == {"turtle-1": True}


def test_without_a_certificate_of_this_lab_nobody_gets_in(router: LabRouter, tmp_path: Path) -> None:
    other = replace(router.settings, data=DataFolder(tmp_path / "other"))
    Authority(other, ROBOTS).issue("turtle-1", tmp_path / "of_another_lab")
    foreign = tmp_path / "of_another_lab"
    shutil.copyfile(tmp_path / "turtle-1" / AUTHORITY, foreign / AUTHORITY)
    tls = {"root_ca_certificate": str(tmp_path / "turtle-1" / AUTHORITY), "verify_name_on_connect": False}
    with router.running():
        for network in (
            member_settings(foreign),
            {"transport/link/protocols": ["tls"], "transport/link/tls": tls},
            {"transport/link/protocols": ["tcp", "tls"]},
        ):
            with pytest.raises(OSError, match="cannot reach"):
                ZenohTransport("turtle-1", connect=[router.endpoint], client=True, network=network).close()


def test_a_robot_does_not_take_another_robot_for_the_lab(router: LabRouter, tmp_path: Path) -> None:
    tls = {
        "root_ca_certificate": str(tmp_path / "turtle-2" / AUTHORITY),
        "listen_certificate": str(tmp_path / "turtle-2" / "certificate.pem"),
        "listen_private_key": str(tmp_path / "turtle-2" / "key.pem"),
        "enable_mtls": True,
    }
    impostor = {"transport/link/protocols": ["tls"], "transport/link/tls": tls}
    network = member_settings(tmp_path / "turtle-1")
    with (
        ZenohTransport("lab", listen=[router.endpoint], network=impostor),
        pytest.raises(OSError, match="cannot reach"),
    ):
        ZenohTransport("turtle-1", connect=[router.endpoint], client=True, network=network).close()


def test_a_removed_robot_is_let_in_no_more(router: LabRouter) -> None:
    with router.robot("turtle-1") as removed, router.robot("turtle-2") as other:
        with router.running(), router.lab():
            hear(router, removed, "before")
        router.authority.revoke("turtle-1")
        # The same name again does not revive the certificate that was revoked.
        router.authority.issue("turtle-1", router.folder / "again")
        router.alive.clear()
        with router.running(), router.lab() as lab:
            hear(router, other, "after")
            removed.say("after its removal")
            with pytest.raises(NoAnswerError):
                lab.stop("turtle-1", SILENCE)
            hear(router, other, "at last")
            assert ("turtle-1", b"after its removal") not in router.presences
            assert router.alive == {"turtle-2": True}


def test_a_robot_opens_without_the_router_and_both_ends_come_back_after_its_death(router: LabRouter) -> None:
    with router.robot("turtle-1") as robot:
        assert not robot.messages.routed
        robot.say("heard by nobody")
        process = router.start()
        try:
            with router.lab() as lab:
                hear(router, robot, "first")
                assert robot.messages.routed
                process.kill()
                process.communicate()
                wait_for(lambda: not robot.messages.routed, "the robot to notice")
                process = router.start()
                hear(router, robot, "second")
                stop(lab, "turtle-1")
                wait_for(lambda: router.alive.get("turtle-1"), "the robot's token")
        finally:
            process.kill()
            process.communicate()


FROZEN = """
import sys, time
from pathlib import Path
from tests.server.features.roster.lab_router import RobotEnd
end = RobotEnd("turtle-1", sys.argv[1], Path(sys.argv[2]))
print("there", flush=True)
time.sleep(1000)
"""


def test_a_frozen_robot_is_known_within_the_lease(router: LabRouter) -> None:
    with router.running(), router.lab():
        robot = subprocess.Popen(
            [sys.executable, "-c", FROZEN, router.endpoint, str(router.folder / "turtle-1")],
            stdout=subprocess.PIPE,
        )
        try:
            wait_for(lambda: router.alive.get("turtle-1"), "the robot's token")
            robot.send_signal(19)
            began = time.monotonic()
            wait_for(lambda: router.alive.get("turtle-1") is False, "the end of the robot's token")
            # Zenoh's own lease is 10 s.
            assert time.monotonic() - began < 8
        finally:
            robot.kill()
            robot.communicate()
