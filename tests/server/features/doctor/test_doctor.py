"""The doctor from a shell and in a server, on this computer and on one made of files."""

import json
import os
import pty
import socket
import sqlite3
import sys
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest

from server.cli import main
from server.features.doctor.checks import examine
from server.features.doctor.findings import Finding
from server.features.doctor.machine import Machine, read_machine
from server.platform.pidfile import PidFile
from server.platform.schema import prepare
from server.platform.settings import Settings
from tests.stack import free_port

NOBODY = 65534
ROBOT = '[robot]\nmode = "robot"\n[link]\nport = "{port}"\nreset = "dtr"\n[server]\nport = {web}\n'


@pytest.fixture
def web() -> int:
    return free_port()


def doctor(settings: Settings, *more: str) -> int:
    return main(["doctor", "--data", str(settings.data.path), "--config", str(settings.config), *more])


def read_findings(capsys: pytest.CaptureFixture[str]) -> dict[str, Finding]:
    return {document["name"]: Finding(**document) for document in json.loads(capsys.readouterr().out)}


def test_it_tells_a_person_and_a_program_the_same(
    settings: Settings, web: int, capsys: pytest.CaptureFixture[str]
) -> None:
    settings.config.write_text(ROBOT.format(port="/dev/nowhere", web=web))
    assert doctor(settings) == 1
    text = capsys.readouterr().out
    assert "wrong Serial port: There is no /dev/nowhere. Serial ports that are there: " in text
    assert "\n      → Set link.port" in text
    assert doctor(settings, "--json") == 1
    findings = read_findings(capsys)
    assert findings["port"].verdict == "wrong"
    assert all(f"{finding.verdict:6}{finding.title}: " in text for finding in findings.values())


def test_a_port_that_opens_is_good_and_stays_free(
    settings: Settings, web: int, capsys: pytest.CaptureFixture[str]
) -> None:
    board, line = pty.openpty()
    settings.config.write_text(ROBOT.format(port=os.ttyname(line), web=web))
    doctor(settings, "--json")
    findings = read_findings(capsys)
    assert (findings["port"].verdict, findings["board"].verdict) == ("ok", "look")
    assert findings["libraries"].verdict == "ok"
    os.close(board)
    os.close(line)


def test_a_configuration_that_cannot_be_read_is_a_finding(
    settings: Settings, capsys: pytest.CaptureFixture[str]
) -> None:
    settings.config.write_text("[robot\n")
    assert doctor(settings, "--json") == 1
    findings = read_findings(capsys)
    assert findings["configuration"].verdict == "wrong"
    assert "robot.toml" in findings["configuration"].text
    assert findings["data"].verdict != "wrong"


def test_a_database_of_a_newer_version_is_wrong(
    settings: Settings, capsys: pytest.CaptureFixture[str]
) -> None:
    prepare(settings.data)
    with closing(sqlite3.connect(settings.data.database)) as connection, connection:
        connection.execute("UPDATE alembic_version SET version_num = '9999'")
    assert doctor(settings, "--json") == 1
    assert "newer version" in read_findings(capsys)["database"].text


def test_it_changes_nothing(settings: Settings, capsys: pytest.CaptureFixture[str]) -> None:
    settings.data.run.rmdir()
    before = sorted(settings.data.path.rglob("*"))
    doctor(settings)
    capsys.readouterr()
    assert sorted(settings.data.path.rglob("*")) == before


def test_a_user_who_may_not_read_the_data_is_told_who_may(
    settings: Settings, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = settings.data.path
    folder.parent.chmod(0o755)
    folder.chmod(0)
    user = os.geteuid()
    if user == 0:
        os.seteuid(NOBODY)
    try:
        status = doctor(settings)
    finally:
        os.seteuid(user)
        folder.chmod(0o700)
    output = capsys.readouterr().err
    assert (status, output.count("\n")) == (1, 1)
    assert "sudo mucat doctor" in output


def test_a_server_that_is_starting_says_nothing_about_the_board(
    settings: Settings, web: int, capsys: pytest.CaptureFixture[str]
) -> None:
    settings.config.write_text(ROBOT.format(port="/dev/nowhere", web=web))
    PidFile(settings.data.runner).write(os.getpid(), "")
    doctor(settings, "--json")
    board = read_findings(capsys)["board"]
    assert (board.verdict, board.text) == ("look", "Not asked: the server does not answer.")


def test_an_address_that_is_taken_is_wrong(settings: Settings) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        taken = settings.with_section(replace(settings.server, port=other.getsockname()[1]))
        machine = read_machine(taken, 0.0, thorough=False)
    assert "in use" in machine.address_problem
    assert read_machine(taken, 0.0, thorough=False).address_problem == ""


def test_the_address_is_that_of_the_running_server(settings: Settings) -> None:
    own = f"{settings.server.host}:{settings.server.port}"
    assert read_machine(settings, 0.0, thorough=False).address == own
    settings.data.address.write_text("https://127.0.0.1:8123\n")
    assert read_machine(settings, 0.0, thorough=False).address == own
    PidFile(settings.data.runner).write(os.getpid(), "")
    assert read_machine(settings, 0.0, thorough=False).address == "127.0.0.1:8123"


def write(root: Path, name: str, text: str) -> None:
    (root / name).parent.mkdir(parents=True, exist_ok=True)
    (root / name).write_text(text)


def look(settings: Settings, root: Path) -> Machine:
    return read_machine(settings, 0.0, thorough=False, root=root)


def test_a_raspberry_pi_is_read_from_its_files(settings: Settings, tmp_path: Path) -> None:
    write(tmp_path, "etc/os-release", 'NAME="Debian"\nPRETTY_NAME="Debian GNU/Linux 13 (trixie)"\n')
    write(tmp_path, "proc/device-tree/model", "Raspberry Pi Zero 2 W Rev 1.0\0")
    write(tmp_path, "boot/firmware/config.txt", "enable_uart=1\n")
    write(tmp_path, "boot/firmware/cmdline.txt", "console=tty1\n")
    write(tmp_path, "proc/swaps", "Filename Type Size\n/dev/zram0 partition 1 2 3\n")
    write(tmp_path, "proc/cgroups", "#subsys_name hierarchy num_cgroups enabled\nmemory 0 1 0\n")
    write(tmp_path, "sys/devices/platform/soc/soc:firmware/get_throttled", "50005\n")
    write(tmp_path, "sys/class/video4linux/video0/name", "unicam-image\n")
    write(tmp_path, "sys/class/video4linux/video1/name", "bcm2835-codec\n")
    write(tmp_path, "etc/systemd/system/mucat.service", "[Service]\nUser=nobody\n")
    write(tmp_path, "etc/systemd/system/getty.target.wants/serial-getty@serial0.service", "")
    (tmp_path / "dev").mkdir()
    (tmp_path / "dev/serial0").symlink_to("ttyS0")
    machine = look(settings, tmp_path)
    assert machine.system == "Debian GNU/Linux 13 (trixie)"
    assert machine.model == "Raspberry Pi Zero 2 W Rev 1.0"
    assert (machine.boot_settings, machine.kernel_line) == ("enable_uart=1\n", "console=tty1\n")
    assert machine.boot_folder == "/boot/firmware"
    assert machine.serial0_target == "ttyS0"
    assert machine.swaps == ("/dev/zram0",)
    assert machine.throttled == 0x50005
    assert machine.cameras == ("unicam-image",)
    assert machine.user == "nobody"
    assert machine.login_on_port
    assert not machine.memory_cgroup
    write(tmp_path, "sys/fs/cgroup/cgroup.controllers", "cpu memory pids\n")
    assert look(settings, tmp_path).memory_cgroup


def test_programs_that_take_a_port_are_found(settings: Settings, tmp_path: Path) -> None:
    assert look(settings, tmp_path).port_takers == ()
    write(tmp_path, "usr/lib/udev/rules.d/85-brltty.rules", 'ENV{PRODUCT}=="1a86/7523/*", GOTO="brltty"\n')
    write(tmp_path, "proc/77/comm", "ModemManager\n")
    assert look(settings, tmp_path).port_takers == ("brltty", "ModemManager")
    write(tmp_path, "etc/udev/rules.d/85-brltty.rules", "")
    assert look(settings, tmp_path).port_takers == ("ModemManager",)


@pytest.mark.parametrize(
    ("mounts", "given_up"),
    [
        ("/dev/root / ext4 rw,relatime,emergency_ro 0 0\n", True),
        ("/dev/root / ext4 rw,noatime 0 0\n/dev/sda /media/emergency_ro ext4 rw 0 0\n", False),
        ("/dev/root / ext4 rw 0 0\n/dev/sda {data} ext4 rw,abort,emergency_ro 0 0\n", True),
        ("/dev/sda {data} ext4 rw,emergency_ro 0 0\n/dev/sdb {data} ext4 rw 0 0\n", False),
        ("", False),
        ("nonsense\n", False),
    ],
)
def test_a_disk_that_the_kernel_has_given_up_is_read_only(
    settings: Settings, tmp_path: Path, mounts: str, given_up: bool
) -> None:
    write(tmp_path, "proc/mounts", mounts.format(data=settings.data.path))
    assert look(settings, tmp_path).disk_read_only == given_up


def test_a_library_that_cannot_be_imported_is_named(
    settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, "cv2.py", "raise ImportError('libGL.so.1 is missing')")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), *filter(None, sys.path)]))
    machine = read_machine(settings, 0.0)
    assert machine.broken_libraries == {"cv2": "libGL.so.1 is missing"}
    assert (
        "cv2: libGL.so.1 is missing"
        in {finding.name: finding for finding in examine(machine)}["libraries"].text
    )


def test_the_weighed_reserve_is_carried_into_warm_fresh_water(settings: Settings, web: int) -> None:
    robot = ROBOT.format(port="/dev/nowhere", web=web)
    settings.config.write_text(robot)
    assert read_machine(settings, 0, thorough=False).reserve == 0
    settings.config.write_text(f"{robot}[craft]\nreserve = 30.0\ntemperature = 10.0\n")
    machine = read_machine(settings, 0, thorough=False)
    assert (machine.mass, machine.reserve) == (3.0, 30.0)
    assert machine.warm_reserve == pytest.approx(22, abs=0.5)
