"""`python -m tests.proofs.services [SYSTEM ...]`: install, update, roll back, uninstall, with systemd.

On a Debian 12, on a Debian 13 with 32 bits, and on a Debian 12 whose ARM processor is emulated; there without
a small computer's life, which the kernel decides. Three signed releases: of this version, a later one, and
one whose server does not start. The power is cut after the switch to that one. Prints a line for each step;
status 1 where one does not end as it must.
"""

import shutil
import sys
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

from packages.constraints import SMALL
from packages.release import build_release
from packages.signing import make_key, sign_folder, write_public_key
from robot_runtime.places import BUILD, DEFAULT_CONFIG
from robot_runtime.simulation.boards.firmware import firmware_path
from server import VERSION
from server.features.installation.installer import adapt_config
from tests.proofs.container import SYSTEMS, SystemdContainer
from tests.proofs.real_board import board, connect, mark_firmware, update_with_board
from tests.proofs.roots import RootSystem
from tests.proofs.small_computer import CONFIG, RECORDING, live
from tests.proofs.steps import Steps, ask_server

TARGETS = {
    "amd64": ("x86_64", "3.11"),
    "i386": ("i686", SMALL["python_version"]),
    "arm64": ("aarch64", "3.11"),
}
"""Machine and Python of a release, by Debian's name of the architecture."""
LATER, BROKEN = "98.0.0", "99.0.0"
BREAK = 'raise SystemExit("This release does not work.")\n'
SEND = """
send_file(data, "/update/release", Path("/releases/{name}"), 60.0)
print(ask(data, "POST", "/update")["phase"])
"""
"""Sends a release and begins the update, as the System page does."""
WATCH = """
print(ask(data, "GET", "/update")["text"])
"""


def main() -> int:
    """Run all steps on each system; return 1 where one failed."""
    systems = [system for system in SYSTEMS if not sys.argv[1:] or system.name in sys.argv[1:]]
    return 1 if sum(map(prove, systems)) or not systems else 0


def prove(system: RootSystem) -> int:
    """Return the number of steps that did not end as they must."""
    print(f"     {system.name}", flush=True)
    with tempfile.TemporaryDirectory() as name:
        releases = Path(name)
        # The user of the data sends one.
        releases.chmod(0o755)
        make_releases(system, releases)
        position = releases / "board"
        position.mkdir()
        with (
            board(position, system.baud) as options,
            SystemdContainer(system, releases, *options) as container,
        ):
            return try_all(container)


def try_all(container: SystemdContainer) -> int:
    """Return the number of steps that did not end as they must."""
    steps = Steps(container)
    current = container.root / "opt/mucat/current"
    if container.system.is_emulated:
        # Two emulators within each other do not swim: its board is outside from the beginning.
        config = container.root / CONFIG.lstrip("/")
        config.parent.mkdir()
        default = adapt_config(DEFAULT_CONFIG.read_text(), robot=False)
        config.write_text(connect(default, container.system.baud))
    steps.take("begin to install", "systemd-run --unit=install --collect sh /releases/first/install.sh", "")
    steps.wait("it builds", lambda: any(container.root.glob("opt/mucat/versions/*/bin/pip")))
    cut_power(container)
    steps.follow("Install", f"µ-CAT {VERSION} runs")
    steps.runs(VERSION)
    for title in ("Look", "Every day", "It does not start"):
        steps.follow(title)
    steps.runs(VERSION)
    steps.take("record", "mucat record start pool", "has begun")
    steps.take("update while it records", f"mucat update /releases/{LATER}", "is being recorded", status=1)
    steps.take("end the recording", "mucat record stop", "has ended")
    for unit in ("mucat.service", "mucat-runtime.service"):
        steps.take(f"kill {unit}", f"systemctl kill -s KILL {unit}", "")
        steps.runs(VERSION)
    steps.take("record again", "mucat record start cut", "has begun")
    stored = ask_server(RECORDING.format(name="cut"))
    steps.wait("it is stored", lambda: "True" in container.order(stored)[1])
    cut_power(container)
    steps.runs(VERSION)
    steps.take("what was stored is there", f"{stored}; mucat sessions list", "True\n(.|\n)*interrupted")
    if not container.system.is_emulated:
        live(container, steps, VERSION)
    steps.take("a cut ZIP file", "mucat update /releases/cut.zip", "no whole ZIP file", status=1)
    steps.take("another's signature", "mucat update /releases/other", "signature .* is wrong", status=1)
    steps.take("update", f"mucat update /releases/{LATER}.zip", f"µ-CAT {LATER} is in use")
    steps.runs(LATER)
    steps.take("the recording is there", "mucat sessions list", "pool")
    steps.take("roll back", "mucat rollback", f"µ-CAT {VERSION} is in use")
    steps.runs(VERSION)
    steps.take("send a cut release as the page does", ask_server(SEND.format(name="cut.zip")), "asked")
    steps.wait("it is refused", lambda: tells(container, "no whole ZIP file"))
    steps.runs(VERSION)
    steps.take("update as the page does", ask_server(SEND.format(name=f"{LATER}.zip")), "asked")
    steps.wait("the page tells its end", lambda: tells(container, f"µ-CAT {LATER} is in use."))
    steps.runs(LATER)
    again = f"{LATER} is in use again"
    steps.take("an update that does not work", f"mucat update /releases/{BROKEN}", again, status=1)
    steps.runs(LATER)
    begin = f"systemd-run --unit=update --collect mucat update /releases/{BROKEN}"
    steps.take("begin it once more", begin, "")
    steps.wait("it has switched", lambda: current.is_symlink() and current.readlink().name == BROKEN)
    cut_power(container)
    steps.runs(LATER)
    steps.take("roll back", "mucat rollback", f"µ-CAT {VERSION} is in use")
    update_with_board(container, steps, VERSION, LATER)
    steps.take("uninstall", "mucat uninstall", "stay")
    steps.take("the data stay", "ls /var/lib/mucat/mucat.db; ls /opt/mucat 2>&1 || true", "No such file")
    return steps.failed


def cut_power(container: SystemdContainer) -> None:
    """Cut the power, and start the computer again."""
    container.cut_power()
    print("     the power is cut", flush=True)
    container.start()


def tells(container: SystemdContainer, message: str) -> bool:
    """Return True once the page would show these words of the update."""
    return message in container.order(ask_server(WATCH))[1]


def make_releases(system: RootSystem, folder: Path) -> None:
    """Build the releases, all signed with one key but "other"."""
    key = folder / "key.pem"
    built = build_release(key, *TARGETS[system.architecture], folder / "dist")
    first = folder / "first"
    built.rename(first)
    packaged = firmware_path(Path("mucat_build"), system.baud, ".hex")
    firmware = folder / "robot.hex"
    shutil.copy(firmware_path(BUILD, system.baud, ".hex"), firmware)
    mark_firmware(firmware)
    for version, changed in (
        (LATER, {str(packaged): firmware.read_bytes()}),
        (BROKEN, {"server/startup.py": BREAK.encode()}),
    ):
        release = folder / version
        shutil.copytree(first, release)
        wheel = next(release.glob("mucat-*.whl"))
        raise_version(wheel, version, changed)
        sign_folder(release, key)
    shutil.make_archive(str(folder / LATER), "zip", folder / LATER)
    (folder / "cut.zip").write_bytes((folder / f"{LATER}.zip").read_bytes()[:-1000])
    shutil.copytree(folder / LATER, folder / "other")
    make_key(folder / "other.pem")
    sign_folder(folder / "other", folder / "other.pem")
    write_public_key(folder / "other.pem", folder / "other/release.pem")


def raise_version(wheel: Path, version: str, changed: Mapping[str, bytes]) -> None:
    """Make another version of a wheel of mucat, with these files changed."""
    goal = wheel.with_name(f"mucat-{version}-py3-none-any.whl")
    with zipfile.ZipFile(wheel) as source, zipfile.ZipFile(goal, "w", zipfile.ZIP_DEFLATED) as copy:
        for name in source.namelist():
            data = source.read(name)
            if name == "server/__init__.py" or ".dist-info/" in name:
                data = data.replace(VERSION.encode(), version.encode())
            copy.writestr(name.replace(f"mucat-{VERSION}", f"mucat-{version}"), changed.get(name, data))
    wheel.unlink()


if __name__ == "__main__":
    sys.exit(main())
