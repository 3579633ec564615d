"""An installation into a folder: whole, repeated, cut off at every effect, and taken away again."""

import os
import shutil
import socket
import subprocess
from pathlib import Path

import pytest

from robot_runtime.config import load
from server.features.installation.boot_settings import describe_change, edit_config, edit_kernel_line
from server.features.installation.command import page_address
from server.features.installation.environments import WHEELS
from server.features.installation.installer import adapt_config
from server.features.installation.places import COMPLETE, InstallPlaces
from server.features.installation.release import read_release
from server.features.installation.units import write_command, write_units
from server.platform.settings import Settings, SetupError, read_settings
from tests.server.features.installation.computer import (
    CONFIG_TXT,
    KERNEL_LINE,
    Computer,
    PowerCutError,
    place_release,
)
from tests.server.features.installation.updatable import UpdatableComputer


def install(computer: Computer, folder: Path, cut: int = -1) -> None:
    computer.installer(computer.effects(cut)).install(read_release(folder))


@pytest.fixture
def release(tmp_path: Path) -> Path:
    return place_release(tmp_path / "release")


def test_an_installation_is_whole(tmp_path: Path, release: Path) -> None:
    computer = Computer(tmp_path / "pi")
    install(computer, release)
    places = computer.places
    assert places.version_of(places.current) == "1.0.0"
    assert places.is_complete(places.current)
    assert "mucat" in (tmp_path / "pi/etc/passwd").read_text()
    assert (
        tmp_path / "pi/etc/group"
    ).read_text() == "dialout:x:20:mucat\nvideo:x:44:somebody,mucat\nlp:x:7:\n"
    config = load(places.config)
    assert (config.robot.mode, config.vision.camera) == ("robot", "pi")
    settings = read_settings(places.config, None, None, None, {})
    assert (settings.server.host, settings.server.tls) == ("0.0.0.0", True)
    assert {file.name for file in places.units.iterdir()} == set(write_units(places))
    assert places.command.stat().st_mode & 0o777 == 0o755
    assert "SystemMaxUse=100M" in places.journal_limit.read_text()
    assert (places.current / "wheels/numpy-2.0-cp311-cp311-linux_x86_64.whl").exists()
    assert "µ-CAT 1.0.0 runs" in computer.lines


def test_done_again_it_changes_nothing(tmp_path: Path, release: Path) -> None:
    computer = Computer(tmp_path / "pi")
    install(computer, release)
    before = computer.tree()
    computer.places.config.write_text(before["etc/mucat/robot.toml"] + "# mine\n")
    computer.commands.clear()
    install(computer, release)
    assert computer.tree() == before | {"etc/mucat/robot.toml": before["etc/mucat/robot.toml"] + "# mine\n"}
    assert not [
        command
        for command in computer.commands
        if command.startswith(("useradd", "usermod", "/usr/bin/python3"))
    ]
    assert any(command.startswith("systemctl start") for command in computer.commands)


def test_cut_off_at_any_effect_it_is_done_again_to_the_same_end(tmp_path: Path, release: Path) -> None:
    whole = Computer(tmp_path / "whole")
    install(whole, release)
    expected = {name: text.replace("/whole/", "/N/") for name, text in whole.tree().items()}
    cuts = 0
    while True:
        computer = Computer(tmp_path / str(cuts))
        try:
            install(computer, release, cuts)
        except PowerCutError:
            install(computer, release)
            results = {name: text.replace(f"/{cuts}/", "/N/") for name, text in computer.tree().items()}
            assert results == expected, f"cut {cuts}: {computer.lines}"
            cuts += 1
        else:
            break
    assert cuts == sum(
        not line.startswith(("---", "µ-CAT", "They")) and "\n" not in line for line in whole.lines
    )


def test_an_environment_that_was_cut_off_is_built_anew(tmp_path: Path, release: Path) -> None:
    computer = Computer(tmp_path / "pi")
    half = computer.places.version("1.0.0")
    half.mkdir(parents=True)
    (half / "half").touch()
    install(computer, release)
    assert not (half / "half").exists()


def test_an_environment_is_complete_only_when_all_of_it_is_on_the_disk(
    tmp_path: Path, release: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    computer = Computer(tmp_path / "pi")
    environment = computer.places.version("1.0.0")
    synced: list[tuple[bool, bool]] = []

    def sync() -> None:
        synced.append(((environment / WHEELS).exists(), computer.places.is_complete(environment)))

    monkeypatch.setattr(os, "sync", sync)
    install(computer, release)
    assert synced == [(True, False)]


def test_nobody_but_root_can_change_what_later_updates_take(tmp_path: Path, release: Path) -> None:
    computer = Computer(tmp_path / "pi")
    install(computer, release)
    for wheel in release.iterdir():
        stored = computer.places.current / WHEELS / wheel.name
        before = stored.read_text()
        wheel.write_text("changed")
        assert stored.read_text() == before


def test_an_installation_is_not_built_anew_of_its_own_wheels(tmp_path: Path, release: Path) -> None:
    computer = Computer(tmp_path / "pi")
    install(computer, release)
    (computer.places.current / COMPLETE).unlink()
    before = computer.tree()
    with pytest.raises(SetupError, match="name the folder of a release"):
        install(computer, computer.places.current / WHEELS)
    assert computer.tree() == before


def test_another_version_comes_by_an_update_alone(tmp_path: Path, release: Path) -> None:
    computer = Computer(tmp_path / "pi")
    install(computer, release)
    before = computer.tree()
    with pytest.raises(SetupError, match=r"1\.0\.0 is installed here: sudo mucat update"):
        install(computer, place_release(tmp_path / "later", "2.0.0"))
    assert computer.tree() == before


def test_an_armed_robot_is_not_restarted(tmp_path: Path, release: Path) -> None:
    computer = UpdatableComputer(tmp_path / "pi")
    install(computer, release)
    computer.armed = True
    # Nothing is restarted where nothing is mended.
    install(computer, release)
    (computer.places.units / "mucat.service").write_text("[Service]\n")
    before = computer.tree()
    computer.commands.clear()
    with pytest.raises(SetupError, match="Disarm it first"):
        install(computer, release)
    assert computer.tree() == before
    assert not any(command.startswith("systemctl") for command in computer.commands)


def test_an_armed_robot_is_not_removed(tmp_path: Path, release: Path) -> None:
    computer = UpdatableComputer(tmp_path / "pi")
    install(computer, release)
    before = computer.tree()
    computer.commands.clear()
    computer.armed = True
    with pytest.raises(SetupError, match=r"The robot is armed, and this ends its runtime.* STOP on the page"):
        computer.installer(computer.effects()).uninstall()
    computer.armed, computer.recording = False, True
    with pytest.raises(SetupError, match="mucat record stop"):
        computer.installer(computer.effects()).uninstall()
    assert computer.tree() == before
    assert not any(command.startswith("systemctl") for command in computer.commands)
    computer.recording = False
    computer.installer(computer.effects()).uninstall()
    assert not computer.places.software.exists()


def test_a_dry_run_says_all_and_changes_nothing(tmp_path: Path, release: Path) -> None:
    computer = Computer(tmp_path / "pi")
    before = computer.tree()
    computer.installer(computer.effects(dry=True)).install(read_release(release))
    assert computer.tree() == before
    assert computer.commands == []
    dry = [line.removeprefix("would ") for line in computer.lines if line.startswith("would ")]
    install(computer, release)
    done = [line for line in computer.lines if not line.startswith("would ")]
    assert [line for line in dry if line not in done and "-c from" not in line] == []


def test_boot_settings_change_only_if_that_is_confirmed(tmp_path: Path, release: Path) -> None:
    computer = Computer(tmp_path / "pi")
    computer.installer(computer.effects(), yes=False).install(read_release(release))
    boot = tmp_path / "pi/boot/firmware"
    assert sorted(file.name for file in boot.iterdir()) == ["cmdline.txt", "config.txt"]
    assert (boot / "config.txt").read_text() == CONFIG_TXT
    assert any("+dtoverlay=disable-bt" in line for line in computer.lines)
    install(computer, release)
    assert (boot / "config.txt.before-mucat").read_text() == CONFIG_TXT
    assert (boot / "cmdline.txt.before-mucat").read_text() == KERNEL_LINE
    assert "console=serial0" not in (boot / "cmdline.txt").read_text()


def test_another_computer_has_no_boot_settings_and_an_emulated_board(tmp_path: Path, release: Path) -> None:
    computer = Computer(tmp_path / "pc", pi=False)
    install(computer, release)
    assert load(computer.places.config).robot.mode == "emulated"
    assert not (tmp_path / "pc/boot").exists()
    assert not computer.places.journal_limit.exists()


def test_the_page_s_address_is_that_of_the_configuration(settings: Settings, release: Path) -> None:
    # The paths of its sockets must be short.
    computer = Computer(settings.data.path.parent / "pi")
    install(computer, release)
    name = f"{socket.gethostname().lower()}.local"
    assert page_address(computer.places) == f"https://{name}:8000"
    config = computer.places.config
    text = config.read_text()
    config.write_text(text.replace("port = 8000", "port = 8123").replace("tls = true", "tls = false"))
    assert page_address(computer.places) == f"http://{name}:8123"


def test_it_is_removed_without_the_data(tmp_path: Path, release: Path) -> None:
    computer = Computer(tmp_path / "pi")
    install(computer, release)
    (computer.places.data / "mucat.db").write_text("dives")
    computer.installer(computer.effects()).uninstall()
    places = computer.places
    assert (places.data / "mucat.db").read_text() == "dives"
    assert places.config.exists()
    assert not places.software.exists()
    assert not places.command.exists()
    assert not places.journal_limit.exists()
    assert list(places.units.iterdir()) == []
    assert any(
        "systemctl disable --quiet --now mucat-runtime.service" in command for command in computer.commands
    )
    computer.installer(computer.effects()).uninstall()


@pytest.mark.parametrize(
    ("stderr", "message"),
    [
        (
            "ERROR: Could not find a version\nERROR: No matching distribution found for numpy",
            "no wheel of numpy",
        ),
        ("OSError: [Errno 28] No space left on device", "disk is full"),
        ("something else", "something else"),
    ],
)
def test_an_environment_that_cannot_be_built_is_one_line_and_nothing_half_done(
    tmp_path: Path, release: Path, stderr: str, message: str
) -> None:
    computer = Computer(tmp_path / "pi")
    computer.broken[" install --quiet"] = stderr
    with pytest.raises(SetupError, match=message) as caught:
        install(computer, release)
    assert "\n" not in str(caught.value)
    assert not computer.places.version("1.0.0").exists()
    assert not computer.places.current.is_symlink()


def test_a_disk_without_room_is_refused_before_anything(
    tmp_path: Path, release: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    computer = Computer(tmp_path / "pi")
    before = computer.tree()
    monkeypatch.setattr("server.features.installation.installer.free_bytes", lambda _: 10**8)
    with pytest.raises(SetupError, match="100 MB are free"):
        install(computer, release)
    assert computer.tree() == before


def test_with_32_bits_some_packages_are_those_of_the_system(
    tmp_path: Path, release: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("server.features.installation.environments.BITS", 32)
    computer = Computer(tmp_path / "pi")
    (tmp_path / "pi/usr/lib/python3/dist-packages/numpy").mkdir(parents=True)
    with pytest.raises(SetupError, match="32 bits pydantic must come from Debian: sudo apt"):
        install(computer, release)
    assert not computer.places.software.exists()
    (tmp_path / "pi/usr/lib/python3/dist-packages/pydantic").mkdir()
    install(computer, release)
    (made,) = [command for command in computer.commands if "-m venv" in command]
    assert "--system-site-packages" in made
    (installed,) = [command for command in computer.commands if " install --quiet" in command]
    assert installed.startswith("linux32 ")


def test_a_camera_library_that_comes_later_is_seen(tmp_path: Path, release: Path) -> None:
    computer = Computer(tmp_path / "pi")
    install(computer, release)
    settings = computer.places.current / "pyvenv.cfg"
    assert settings.read_text() == "include-system-site-packages = false\n"
    (tmp_path / "pi/usr/lib/python3/dist-packages/picamera2").mkdir(parents=True)
    install(computer, computer.places.current / WHEELS)
    assert settings.read_text() == "include-system-site-packages = true\n"


def test_a_server_that_does_not_start_is_one_line(
    tmp_path: Path, release: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    computer = Computer(tmp_path / "pi")
    computer.broken["installation.survey"] = "No server works on it"
    monkeypatch.setattr("server.features.installation.installer.FIRST_START_SECONDS", 0.1)
    monkeypatch.setattr("server.features.installation.installer.LOOK_SECONDS", 0.01)
    with pytest.raises(SetupError, match=r"not healthy within 0\.1 s: .*No server works on it"):
        install(computer, release)


def test_the_boot_settings_hold_for_every_model() -> None:
    header = "[all]\n# For the serial line to the robot's board, by mucat install\n"
    assert edit_config(CONFIG_TXT).endswith(f"{header}enable_uart=1\ndtoverlay=disable-bt\n")
    once = edit_config(CONFIG_TXT)
    assert edit_config(once) == once
    assert "enable_uart" not in edit_config("enable_uart = 1 # mine\n").partition("[all]")[2]
    # In another model's section it does not hold.
    assert edit_config("[pi5]\nenable_uart=1\ndtoverlay=disable-bt\n").count("enable_uart=1") == 2
    assert edit_config("").startswith("\n[all]\n")


def test_the_kernel_line_stays_one_line() -> None:
    assert edit_kernel_line(KERNEL_LINE) == "console=tty1 root=PARTUUID=1-02 rootwait cgroup_enable=memory\n"
    once = edit_kernel_line(KERNEL_LINE)
    assert edit_kernel_line(once) == once
    assert "+console=tty1" in describe_change("cmdline.txt", KERNEL_LINE, once)


def test_the_default_configuration_is_adapted_and_stays_valid(tmp_path: Path) -> None:
    from robot_runtime.places import DEFAULT_CONFIG

    path = tmp_path / "robot.toml"
    path.write_text(adapt_config(DEFAULT_CONFIG.read_text(), robot=False))
    config = load(path)
    assert (config.robot.mode, config.vision.camera) == ("emulated", "scene")
    assert read_settings(path, None, None, None, {}).server.host == "0.0.0.0"


def test_no_service_comes_before_a_path_unit() -> None:
    # Path units start before any service does: systemd would break the circle by leaving the service out.
    units = write_units(InstallPlaces(Path("/")))
    before = [line for text in units.values() for line in text.splitlines() if line.startswith("Before=")]
    assert before
    assert not [line for line in before if ".path" in line]


def test_no_crash_fills_the_card() -> None:
    units = write_units(InstallPlaces(Path("/")))
    for name in ("mucat.service", "mucat-runtime.service"):
        assert "LimitCORE=0" in units[name].splitlines()


def test_a_lab_has_services_and_needs_of_its_own(tmp_path: Path, release: Path) -> None:
    dry = Computer(tmp_path / "dry", lab=True)
    dry.installer(dry.effects(dry=True)).install(read_release(release))
    assert any("mucat-lab.service" in line for line in dry.lines)
    assert not any("mucat-runtime" in line for line in dry.lines)
    computer = Computer(tmp_path / "pi", lab=True)
    install(computer, release)
    places = computer.places
    units = {file.name: file.read_text() for file in places.units.iterdir()}
    assert "bin/mucat lab run\n" in units["mucat-lab.service"]
    assert units.keys() == {"mucat-lab.service", "mucat-recover.service"}
    assert any(line == "systemctl restart mucat-lab.service" for line in computer.commands)
    # No pins, no camera, no serial line.
    assert "mucat" not in (tmp_path / "pi/etc/group").read_text()
    assert (tmp_path / "pi/boot/firmware/config.txt").read_text() == CONFIG_TXT
    assert load(places.config).robot.mode == "emulated"
    # Without the option it stays one, also for the services of a later version.
    assert write_units(InstallPlaces(places.root)).keys() == units.keys()
    computer.installer(computer.effects()).uninstall()
    assert list(places.units.iterdir()) == []
    assert places.lab_mark.exists()


def test_a_lab_does_not_take_the_place_of_a_robot(tmp_path: Path, release: Path) -> None:
    computer = Computer(tmp_path / "pi")
    install(computer, release)
    computer.places = InstallPlaces(tmp_path / "pi", lab=True)
    before = computer.tree()
    with pytest.raises(SetupError, match="A robot is installed here"):
        install(computer, release)
    assert computer.tree() == before


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="there is no systemd")
@pytest.mark.parametrize("lab", [False, True])
def test_systemd_accepts_the_units(tmp_path: Path, lab: bool) -> None:
    places = InstallPlaces(tmp_path, lab=lab)
    (tmp_path / "opt/mucat/current/bin").mkdir(parents=True)
    for link in (places.current, places.previous):
        program = link / "bin/mucat"
        program.parent.mkdir(parents=True, exist_ok=True)
        program.write_text("#!/bin/sh\n")
        program.chmod(0o755)
    for name, text in write_units(places).items():
        (tmp_path / name).write_text(text)
    files = [str(tmp_path / name) for name in write_units(places)]
    done = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", *files], capture_output=True, text=True, check=False
    )
    complaints = [line for line in done.stderr.splitlines() if "mucat" in line]
    assert (done.returncode, complaints) == (0, [])


def test_only_what_changes_the_installation_is_run_by_root(tmp_path: Path) -> None:
    places = InstallPlaces(tmp_path)
    place_program(tmp_path / "opt/mucat/current/bin/mucat", 'echo "root: $*"')
    # In place of the system's: root becomes the user, whom this computer need not have.
    place_program(tmp_path / "bin/id", "echo 0")
    place_program(tmp_path / "bin/runuser", 'echo "$2: ${*:5}"')
    places.command.parent.mkdir(parents=True)
    places.command.write_text(write_command(places))
    places.command.chmod(0o755)

    def output_of(*arguments: str) -> str:
        path = {"PATH": f"{tmp_path}/bin:/usr/bin:/bin"}
        command = [str(places.command), *arguments]
        return subprocess.run(command, env=path, capture_output=True, text=True, check=True).stdout.strip()

    for name in ("install", "uninstall", "update", "rollback"):
        assert output_of(name, "--help") == f"root: {name} --help"
    for name in ("doctor", "sessions"):
        assert output_of(name, "--help") == f"mucat: {name} --help"


def place_program(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/bash\n{text}\n")
    path.chmod(0o755)
