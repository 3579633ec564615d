"""A computer made of files: it carries out the commands of an installation in a folder."""

import json
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from robot_runtime.places import DEFAULT_CONFIG
from server.features.installation.effects import Effects
from server.features.installation.installer import Installer
from server.features.installation.places import COMPLETE, InstallPlaces
from server.features.installation.survey import Survey

CONFIG_TXT = "# Raspberry Pi\ndtparam=audio=on\n\n[cm5]\ndtoverlay=dwc2\n"
KERNEL_LINE = "console=serial0,115200 console=tty1 root=PARTUUID=1-02 rootwait\n"


class PowerCutError(Exception):
    """The power is cut."""


class Computer:
    """Its files are below `root`; `commands` are those that it was given, `broken` those that fail."""

    def __init__(self, root: Path, *, pi: bool = True, lab: bool = False) -> None:
        self.places = InstallPlaces(root, lab=lab)
        self.commands: list[str] = []
        self.lines: list[str] = []
        self.broken: dict[str, str] = {}
        self.answers: dict[str, str] = {}
        (root / "run").mkdir(parents=True)
        (root / "etc").mkdir()
        (root / "etc/passwd").write_text("root:x:0:0::/root:/bin/sh\n")
        (root / "etc/group").write_text("dialout:x:20:\nvideo:x:44:somebody\nlp:x:7:\n")
        if pi:
            (root / "boot/firmware").mkdir(parents=True)
            (root / "boot/firmware/config.txt").write_text(CONFIG_TXT)
            (root / "boot/firmware/cmdline.txt").write_text(KERNEL_LINE)

    def run(
        self, command: Sequence[str], _environment: Mapping[str, str], _seconds: float
    ) -> "subprocess.CompletedProcess[str]":
        message = " ".join(command)
        self.commands.append(message)
        problem = next((text for part, text in self.broken.items() if part in message), "")
        if problem:
            return subprocess.CompletedProcess(command, 1, "", problem)
        answer = next((text for part, text in self.answers.items() if part in message), None)
        if answer is None:
            answer = self._carry_out(command) or ""
        return subprocess.CompletedProcess(command, 0, answer, "")

    def _carry_out(self, command: Sequence[str]) -> str | None:
        program, *rest = command
        etc = self.places.root / "etc"
        if program == "useradd":
            with (etc / "passwd").open("a") as file:
                file.write(f"{rest[-1]}:x:999:999::{rest[-4]}:/usr/sbin/nologin\n")
        elif program == "usermod":
            chosen = rest[2].split(",")
            lines = [line.split(":") for line in (etc / "group").read_text().splitlines()]
            for item in lines:
                if item[0] in chosen:
                    item[-1] = ",".join(filter(None, [*item[-1].split(","), rest[-1]]))
            (etc / "group").write_text("".join(":".join(fields) + "\n" for fields in lines))
        elif program == "install":
            if rest[0] == "-d":
                Path(rest[-1]).mkdir(parents=True)
            else:
                Path(rest[-1]).touch()
        elif rest[:2] == ["-m", "venv"]:
            (Path(rest[-1]) / "bin").mkdir(parents=True)
            shared = str("--system-site-packages" in rest).lower()
            (Path(rest[-1]) / "pyvenv.cfg").write_text(f"include-system-site-packages = {shared}\n")
        elif "DEFAULT_CONFIG" in command[-1]:
            return DEFAULT_CONFIG.read_text()
        elif command[-1].endswith("installation.survey"):
            return json.dumps(
                asdict(Survey(running=self.places.version_of(self.places.current), armed=False))
            )
        return None

    def effects(self, cut: int = -1, *, dry: bool = False) -> Effects:
        """Return its effects; the power is cut before the one of number `cut`."""
        remaining = [cut]

        def before(_: str) -> None:
            if remaining[0] == 0:
                raise PowerCutError
            remaining[0] -= 1

        return Effects(self.lines.append, dry=dry, run=self.run, before=before)

    def installer(self, effects: Effects, *, yes: bool = True) -> Installer:
        return Installer(self.places, effects, lambda _: yes)

    def tree(self) -> dict[str, str]:
        """Return every file with its text, every link with its target, and every folder, but of /run."""
        root = self.places.root
        results = {}
        for path in sorted(root.rglob("*")):
            name = str(path.relative_to(root))
            if name.partition("/")[0] == "run":
                continue
            if path.is_symlink():
                results[name] = f"link to {path.readlink()}"
            else:
                results[name] = path.read_text() if path.is_file() else "folder"
        return results


def place_release(folder: Path, version: str = "1.0.0") -> Path:
    """Return a folder with wheels of this version, which hold nothing."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name in (f"mucat-{version}-py3-none-any.whl", "numpy-2.0-cp311-cp311-linux_x86_64.whl"):
        (folder / name).write_text(f"{name} of {version}")
    return folder


def place_version(computer: Computer, version: str) -> Path:
    """Return a complete environment."""
    environment = computer.places.version(version)
    (environment / "bin").mkdir(parents=True)
    (environment / COMPLETE).write_text(f"{version}\n")
    return environment
