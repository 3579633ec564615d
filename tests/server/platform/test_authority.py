"""The authority's certificates with the real Zenoh: TLS on the loopback."""

import shutil
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from robot_runtime.__main__ import open_transport
from robot_runtime.config import Config, RobotConfig, ZenohConfig
from robot_runtime.contract.limits import ConfigError
from robot_runtime.errors import NoAnswerError
from robot_runtime.transport.network import AUTHORITY, CERTIFICATE, KEY, connect_settings
from robot_runtime.transport.zenoh_transport import ZenohTransport, join
from server.platform.authority import AUTHORITY_KEY, Authority
from server.platform.settings import Settings, SetupError
from tests.server.ports import reserved_port
from tests.server.waiting import SECONDS
from tests.waiting import wait_for


class NetworkedRobot:
    """A robot that listens on the network, and a server that is connected to it as on the robot."""

    def __init__(self, settings: Settings, port: int) -> None:
        self.settings = settings
        self.endpoint = f"tls/127.0.0.1:{port}"
        self.config = Config(
            robot=RobotConfig(name=settings.robot.name), zenoh=ZenohConfig(listen=[self.endpoint])
        )
        self.armed: list[Mapping[str, Any]] = []
        self.heard: list[tuple[str, bytes]] = []

    @contextmanager
    def running(self) -> Iterator[ZenohTransport]:
        """The runtime's transport, with a command and the subscriptions of runtime and server."""
        folder = self.settings.data
        with (
            open_transport(self.config, folder.path) as runtime,
            ZenohTransport(
                self.settings.robot.name, connect=[f"unixsock-stream/{folder.runtime_socket}"]
            ) as server,
        ):
            runtime.serve("command/arm", self.armed.append)
            for name in ("pilot", "sense"):
                runtime.subscribe(name, lambda *message: self.heard.append(message))
            for name in ("stream", "simulator/stream"):
                server.subscribe(name, lambda *message: self.heard.append(message))
            yield runtime

    def join(self, network: Mapping[str, Any]) -> ZenohTransport:
        """Return a client on another computer, once it is let in."""
        return join(self.settings.robot.name, [self.endpoint], network)

    def try_to_join(self, network: Mapping[str, Any]) -> None:
        """Raise OSError where it is not let in at once."""
        ZenohTransport(
            self.settings.robot.name, connect=[self.endpoint], client=True, network=network
        ).close()


@pytest.fixture
def port() -> Iterator[int]:
    with reserved_port() as number:
        yield number


@pytest.fixture
def robot(settings: Settings, port: int) -> NetworkedRobot:
    Authority(settings).prepare()
    return NetworkedRobot(settings, port)


@pytest.fixture
def pool(robot: NetworkedRobot, tmp_path: Path) -> Path:
    """The folder of the certificate of a simulator called pool."""
    Authority(robot.settings).issue("pool", tmp_path / "pool")
    return tmp_path / "pool"


def ask(robot: ZenohTransport, name: str) -> Mapping[str, Any]:
    """Ask, and repeat until Zenoh has announced who answers."""
    end = time.monotonic() + SECONDS
    while True:
        try:
            return robot.query(name, {}, 0.5)
        except NoAnswerError:
            assert time.monotonic() < end
            time.sleep(0.01)


def test_a_simulator_does_its_work_and_commands_nothing(robot: NetworkedRobot, pool: Path) -> None:
    with robot.running() as runtime, robot.join(connect_settings(pool)) as simulator:
        simulator.serve("simulator/surroundings", lambda _: {"world": "pool"})
        motors: list[bytes] = []
        everything: list[str] = []
        simulator.subscribe("motor", lambda _, data: motors.append(data))
        simulator.subscribe("**", lambda name, _: everything.append(name))
        assert ask(runtime, "simulator/surroundings")["world"] == "pool"
        wait_for(lambda: runtime.watched("motor") and simulator.watched("sense"))
        runtime.publish("picture", b"of the robot")
        runtime.publish("motor", b"angles")
        # Each subscription has a thread of its own.
        wait_for(lambda: motors and "motor" in everything)
        assert (motors, everything) == ([b"angles"], ["motor"])
        for name in ("arm", "stop"):
            with pytest.raises(NoAnswerError):
                simulator.query(f"command/{name}", {}, 0.5)
        # What it sends arrives in order: the last of all shows that the others do not arrive.
        for name in ("pilot", "stream", "**", "sense", "simulator/stream"):
            simulator.publish(name, b"of the simulator")
        wait_for(lambda: len(robot.heard) >= 2)
        assert sorted(robot.heard) == [
            ("sense", b"of the simulator"),
            ("simulator/stream", b"of the simulator"),
        ]
        assert robot.armed == []


def test_the_own_processes_need_no_certificate(robot: NetworkedRobot) -> None:
    with (
        robot.running(),
        join(robot.settings.robot.name, [f"unixsock-stream/{robot.settings.data.runtime_socket}"]) as server,
    ):
        ask(server, "command/arm")
        assert robot.armed == [{}]


def test_without_a_certificate_of_this_robot_nobody_gets_in(
    robot: NetworkedRobot, pool: Path, tmp_path: Path
) -> None:
    tls = {"root_ca_certificate": str(pool / AUTHORITY), "verify_name_on_connect": False}
    other = replace(robot.settings, data=type(robot.settings.data)(tmp_path / "other"))
    Authority(other).issue("pool", tmp_path / "of_another_robot")
    shutil.copyfile(pool / AUTHORITY, tmp_path / "of_another_robot" / AUTHORITY)
    with robot.running():
        for network in (
            {"transport/link/protocols": ["tcp", "tls"]},
            {"transport/link/protocols": ["tls"], "transport/link/tls": tls},
            connect_settings(tmp_path / "of_another_robot"),
        ):
            with pytest.raises(OSError, match="cannot reach"):
                robot.try_to_join(network)
        robot.join(connect_settings(pool)).close()


def test_a_revoked_certificate_gets_nothing_from_the_next_start_on(
    robot: NetworkedRobot, pool: Path, tmp_path: Path
) -> None:
    authority = Authority(robot.settings)
    with robot.running(), robot.join(connect_settings(pool)) as simulator:
        wait_for(lambda: simulator.watched("sense"))
    authority.revoke("pool")
    # The same name again: it does not revive the certificate that was revoked.
    authority.issue("pool", tmp_path / "again")
    with robot.running() as runtime:
        with robot.join(connect_settings(pool)) as revoked:
            revoked.serve("simulator/surroundings", lambda _: {"world": "of the revoked"})
            revoked.publish("sense", b"of the revoked")
            with robot.join(connect_settings(tmp_path / "again")) as simulator:
                simulator.serve("simulator/ready", lambda _: {})
                ask(runtime, "simulator/ready")
                with pytest.raises(NoAnswerError):
                    runtime.query("simulator/surroundings", {}, 0.5)
                simulator.publish("sense", b"of the new")
                wait_for(lambda: robot.heard)
        assert robot.heard == [("sense", b"of the new")]


def test_no_certificate_in_force_lets_nobody_in(robot: NetworkedRobot, pool: Path) -> None:
    Authority(robot.settings).revoke("pool")
    with robot.running() as runtime, robot.join(connect_settings(pool)) as revoked:
        revoked.serve("simulator/surroundings", lambda _: {})
        with pytest.raises(NoAnswerError):
            revoked.query("command/arm", {}, 0.5)
        with pytest.raises(NoAnswerError):
            runtime.query("simulator/surroundings", {}, 0.5)
    assert robot.armed == []


def test_a_simulator_s_certificate_cannot_pose_as_the_robot(robot: NetworkedRobot, pool: Path) -> None:
    tls = {
        "root_ca_certificate": str(pool / AUTHORITY),
        "listen_certificate": str(pool / CERTIFICATE),
        "listen_private_key": str(pool / KEY),
        "enable_mtls": True,
    }
    impostor = {"transport/link/protocols": ["tls"], "transport/link/tls": tls}
    with (
        ZenohTransport(robot.settings.robot.name, listen=[robot.endpoint], network=impostor),
        pytest.raises(OSError, match="cannot reach"),
    ):
        robot.try_to_join(connect_settings(pool))


def test_a_process_without_certificates_connects_through_no_network(robot: NetworkedRobot, port: int) -> None:
    plain = f"tcp/127.0.0.1:{port}"
    open_to_all = {"transport/link/protocols": ["tcp"]}
    with (
        ZenohTransport(robot.settings.robot.name, listen=[plain], network=open_to_all),
        pytest.raises(OSError, match="cannot reach"),
    ):
        ZenohTransport(robot.settings.robot.name, connect=[plain], client=True).close()


def test_a_robot_without_certificates_is_refused_in_words(settings: Settings, port: int) -> None:
    with pytest.raises(ConfigError, match=r"lacks authority\.pem, certificate\.pem, key\.pem for"):
        open_transport(NetworkedRobot(settings, port).config, settings.data.path)


def test_keys_are_readable_by_their_user_alone(robot: NetworkedRobot, pool: Path) -> None:
    folder = robot.settings.data.zenoh
    for path in (folder, pool):
        assert path.stat().st_mode & 0o777 == 0o700
    for path in (folder / KEY, folder / AUTHORITY_KEY, pool / KEY):
        assert path.stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize("name", ["", "../pool", "pool.1", "a" * 33, "pool\n", "/tmp/pool"])
def test_names_of_certificates_are_plain(settings: Settings, tmp_path: Path, name: str) -> None:
    with pytest.raises(SetupError, match="is no name of a certificate"):
        Authority(settings).issue(name, tmp_path / "issued")
    assert not settings.data.zenoh.exists()


def test_a_name_has_one_certificate_at_a_time(robot: NetworkedRobot, pool: Path, tmp_path: Path) -> None:
    authority = Authority(robot.settings)
    with pytest.raises(SetupError, match="Revoke it first"):
        authority.issue("pool", tmp_path / "second")
    with pytest.raises(SetupError, match="cannot be made"):
        authority.issue("tank", pool)
    assert [certificate.name for certificate in authority.issued()] == ["pool"]
    with pytest.raises(SetupError, match="There is no certificate tank"):
        authority.revoke("tank")
