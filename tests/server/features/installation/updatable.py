"""A computer with an installation, whose versions have schemas and firmware; some of them do not work."""

import json
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from server.features.installation.release import read_release
from server.features.installation.report import UpdateReport
from server.features.installation.survey import Survey
from server.features.installation.units import write_units
from server.features.installation.updater import Updater
from tests.server.features.installation.computer import Computer, place_release
from tests.server.features.installation.signing import sign

DIVES = "ten dives"


class UpdatableComputer(Computer):
    """Its database is a text "SCHEMA sessions"; a version reads every schema up to its own.

    `schemas` and `firmware` are by version; `sick` versions never answer, `wrong` are the doctor's findings.
    A `silent` server answers nothing, though it works.
    """

    def __init__(self, root: Path) -> None:
        super().__init__(root)
        self.schemas: dict[str, int] = {}
        self.firmware: dict[str, str] = {}
        self.sick: set[str] = set()
        self.wrong: dict[str, str] = {}
        self.running = ""
        self.armed = self.recording = self.silent = False
        self.board = ""

    @property
    def database(self) -> Path:
        return self.places.data / "mucat.db"

    @property
    def schema(self) -> int:
        return int(self.database.read_text().split()[0]) if self.database.exists() else 0

    def schema_of(self, version: str) -> int:
        return self.schemas.get(version, 1)

    def boot(self) -> None:
        """Its power comes back: the way back first, if an update was cut off, then the services."""
        self.running = ""
        Updater(self.places, self.effects()).recover(starting=True)
        self.start()

    def start(self) -> None:
        version = self.places.version_of(self.places.current)
        if self.schema > self.schema_of(version):
            return
        if self.schema < self.schema_of(version):
            self.migrate(version)
        self.running = "" if version in self.sick else version

    def migrate(self, version: str) -> None:
        """As the server does: with a copy from before."""
        if self.database.exists():
            self.copy(self.schema).write_text(self.database.read_text())
        stored = self.database.read_text().partition(" ")[2] if self.database.exists() else "no sessions"
        self.database.write_text(f"{self.schema_of(version)} {stored}")

    def copy(self, schema: int) -> Path:
        folder = self.places.data / "backups"
        folder.mkdir(exist_ok=True)
        return folder / f"mucat-before-{schema}.db"

    def run(
        self, command: Sequence[str], environment: Mapping[str, str], seconds: float
    ) -> "subprocess.CompletedProcess[str]":
        answered = super().run(command, environment, seconds)
        if answered.returncode != 0:
            return answered
        text = list(command)
        if text[0] == "systemctl" and set(self.places.services) <= set(text):
            self.running = ""
            if text[1] != "stop":
                self.start()
        if text[0] == "runuser":
            answered.stdout = self._answer(Path(text[4]).parents[1].name, text[5:])
        elif text[-1].endswith("installation.services"):
            version = Path(text[0]).parents[1].name
            for name in write_units(self.places):
                (self.places.units / name).write_text(f"{name} of {version}")
        return answered

    def _answer(self, link: str, message: list[str]) -> str:
        version = self.places.version_of(self.places.current) if link == "current" else link
        if message[0] == "doctor":
            findings = [{"name": "python", "text": "It is 3.13.", "verdict": "ok"}]
            if text := self.wrong.get(version):
                findings.append({"name": text, "text": text, "verdict": "wrong"})
            return json.dumps(findings)
        if message[0] == "upload":
            self.board = self.firmware.get(version, "")
        elif message[0] == "restore":
            self.database.write_text(Path(message[1]).read_text())
        else:
            reads = self.schema <= self.schema_of(version)
            copies = [item for item in range(self.schema_of(version), 0, -1) if self.copy(item).exists()]
            running = "" if self.silent else self.running
            problem = "" if running else "No server works on it."
            return json.dumps(
                asdict(
                    Survey(
                        version=version,
                        running=running,
                        problem=problem,
                        armed=self.armed if running else None,
                        recording=self.recording,
                        reads=reads,
                        copy="" if reads or not copies else str(self.copy(copies[0])),
                        firmware=self.firmware.get(version, ""),
                    )
                )
            )
        return ""


def signed(folder: Path, keys: Path, version: str) -> Path:
    place_release(folder, version)
    sign(folder, keys / "secret.pem")
    return folder


def installed(root: Path, keys: Path) -> UpdatableComputer:
    """Return a computer on which 1.0.0 runs, with dives; 2.0.0 has another schema and other firmware."""
    computer = UpdatableComputer(root)
    computer.schemas, computer.firmware = {"1.0.0": 1, "2.0.0": 2}, {"1.0.0": "old", "2.0.0": "new"}
    folder = place_release(root.parent / "first", "1.0.0")
    shutil.copy(keys / "release.pem", folder)
    computer.installer(computer.effects()).install(read_release(folder))
    computer.database.write_text(f"1 {DIVES}")
    computer.board = "old"
    return computer


def update(computer: UpdatableComputer, path: Path, cut: int = -1) -> str:
    return Updater(computer.places, computer.effects(cut)).update(path)


def roll_back(computer: UpdatableComputer) -> str:
    return Updater(computer.places, computer.effects()).roll_back()


def report_of(computer: UpdatableComputer) -> tuple[str, str]:
    report = UpdateReport(computer.places.report).read()
    assert report is not None
    return report.phase, report.text
