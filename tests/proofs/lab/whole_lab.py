"""A whole lab with its robots: its failures are timed, its archive is compared with what they recorded."""

import shlex
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy.exc import SQLAlchemyError

from server.platform.settings import SetupError
from tests.proofs.lab.content import count_missed, read_content, read_identifiers, read_ticks
from tests.proofs.lab.network import LabNetwork
from tests.proofs.lab.programs import MucatServer, SwimmingRobot, wait_beside
from tests.proofs.lab.report import FailureOutcome, LabReport
from tests.waiting import wait_for

RADIO = "100kbit"
"""Of the robot whose sessions are pulled while something fails, so that a pull takes some seconds."""
LATE_BYTES = 40_000
"""That may have been on their way when something failed."""


@dataclass(frozen=True, slots=True)
class Download:
    """A session that is being downloaded by the lab."""

    identifier: str
    bytes: int


class ServedArchive(MucatServer):
    """`mucat lab run` with its archive in this database, or in its data folder."""

    def __init__(self, network: LabNetwork, folder: Path, database: str = "") -> None:
        config = f"""[server]
host = "0.0.0.0"
tls = true
[lab]
database = "{database}"
"""
        super().__init__(network.add("lab", 1), folder, config, "lab", "run")
        self.archive = database or self.data.database

    @property
    def address(self) -> str:
        """Its address for others."""
        return f"https://{self.computer.address}:8000"

    def wait_ready(self) -> None:
        """Wait until its page and its router answer."""
        self.wait_until(lambda roster: roster["problem"] == "", "/robots", "the lab")

    def let_join(self, robot: SwimmingRobot) -> None:
        """Make a code, and run the command that the lab prints on the robot's computer."""
        printed = self.shell("lab", "pair")
        assert printed.returncode == 0, printed.stderr
        _, *arguments = shlex.split(printed.stdout.splitlines()[-1])
        joined = robot.shell(*arguments)
        assert joined.returncode == 0, joined.stderr

    def present(self) -> set[str]:
        """Return the names of the robots that are there. Raise SetupError."""
        return {robot["name"] for robot in self.ask("GET", "/robots")["robots"] if robot["present"]}

    def find_download(self) -> Download | None:
        """Return the session that is being downloaded, if any."""
        for part in self.data.pulls.glob("*.part"):
            try:
                size = part.stat().st_size
            except FileNotFoundError:
                continue
            if size:
                return Download(part.name.partition("-")[0], size)
        return None

    def describe_pulls(self) -> str:
        """Return what the lab says of its pulls; or why it does not say it."""
        try:
            pulls = self.ask("GET", "/lab/pulls")
        except SetupError as problem:
            return str(problem)
        return "; ".join(f"{pull['robot']}: {pull['text']}" for pull in pulls)


class WholeLab:
    """A lab and its robots, which have joined it; the first robot is reached by a poor radio link."""

    def __init__(self, network: LabNetwork, lab: ServedArchive, robots: Sequence[SwimmingRobot]) -> None:
        self.network, self.lab, self.robots = network, lab, robots
        self.first, *self.swimmers = robots
        self.report = LabReport()

    @contextmanager
    def running(self) -> Iterator[None]:
        """Run all of it."""
        with ExitStack() as ended:
            for server in (self.lab, *self.robots):
                server.start()
                ended.callback(server.stop)
            self.lab.wait_ready()
            for robot in self.robots:
                robot.wait_ready()
            self.report.tell("lab and robots run")
            yield

    def swim(self) -> None:
        """Arm the others: they swim, and record, from here to the end."""
        for robot in self.swimmers:
            robot.arm()

    def record(self, seconds: float) -> None:
        """Record a session on the first robot, which has not joined yet; meanwhile nothing fails."""
        calm = FailureOutcome("none", time.monotonic())
        self.first.record("pulled through all of it", seconds)
        self.report.tell("a session is recorded")
        calm.mended = calm.whole = time.monotonic()
        self.report.failures.append(calm)

    def join(self) -> None:
        """Add all robots to the lab by codes, and wait for their tiles."""
        began = time.monotonic()
        for robot in (*self.swimmers, self.first):
            self.lab.let_join(robot)
        self.wait_present()
        self.report.facts["all robots joined and on their tiles after"] = f"{time.monotonic() - began:.1f} s"
        self._look_at_tiles()
        self.report.tell("all robots have joined")

    def _look_at_tiles(self) -> None:
        tiles = {robot["name"]: robot for robot in self.lab.ask("GET", "/robots")["robots"]}
        for name, tile in tiles.items():
            seen = tile["presence"]
            missing = [field for field in ("mode", "depth", "battery", "disk_free") if seen[field] is None]
            self.report.check(not missing, f"the tile of {name} lacks {', '.join(missing)}")
        self.lab.wait_until(
            lambda roster: all(robot["clock_offset"] is not None for robot in roster["robots"]),
            "/robots",
            "the clocks to be measured",
        )

    def wait_present(self) -> float:
        """Wait until all robots are there again; return the time (s, steady clock)."""
        names = {robot.computer.name for robot in self.robots}
        return self.lab.wait_until(
            lambda roster: {robot["name"] for robot in roster["robots"] if robot["present"]} == names,
            "/robots",
            "all robots to be there",
        )

    @contextmanager
    def failure(self, name: str) -> Iterator[FailureOutcome]:
        """Time a failure, which begins during a download, and ends when all is whole again."""
        download = self._wait_for_download()
        outcome = FailureOutcome(name, time.monotonic(), before=f"{download.bytes / 1e3:.0f} kB")
        self.report.tell(f"{name}, at byte {download.bytes} of the download of {download.identifier}")
        yield outcome
        self.conclude(outcome, download)
        self.report.failures.append(outcome)
        self.report.tell(outcome.row)

    def _wait_for_download(self) -> Download:
        """Wait until a download grows."""
        downloads: list[Download] = []

        def look() -> bool:
            download = self.lab.find_download()
            if download is not None and download not in downloads:
                downloads.append(download)
            return len(downloads) > 1

        try:
            wait_for(look, "a download")
        except AssertionError as problem:
            raise AssertionError(f"{problem}: {self.lab.describe_pulls()}") from problem
        return downloads[-1]

    def conclude(self, outcome: FailureOutcome, download: Download) -> None:
        """Wait until the interrupted download goes on where it was, and every robot is on its tile."""
        outcome.mended = time.monotonic()
        wait_beside(lambda: self._goes_on(download, outcome), f"more of {download.identifier}")
        self.wait_present()
        outcome.whole = time.monotonic()
        for robot in self.swimmers:
            name = robot.computer.name
            self.report.check(robot.is_armed, f"{outcome.name}: {name} does not swim on")

    def _goes_on(self, download: Download, outcome: FailureOutcome) -> bool:
        now = self.lab.find_download()
        if now is not None and now.identifier == download.identifier:
            outcome.after = f"{now.bytes / 1e3:.0f} kB"
            self.report.check(now.bytes >= download.bytes, f"{outcome.name}: it began anew")
            return now.bytes > download.bytes + LATE_BYTES
        outcome.after = "all of it"
        return download.identifier in self._archived()

    def _archived(self) -> set[str]:
        try:
            return set(read_identifiers(self.lab.archive))
        except SQLAlchemyError:
            return set()

    def wait_for_all(self) -> None:
        """Wait until each session of each robot is in the archive, and the robot knows."""
        began = time.monotonic()
        for robot in self.robots:
            robot.wait_until(
                lambda sessions: all(session["archived"] for session in sessions),
                "/sessions",
                f"{robot.computer.name} to hear that its sessions are archived",
            )
        self.report.facts["the rest pulled after"] = f"{time.monotonic() - began:.1f} s"
        self.report.tell("all sessions are pulled")

    def compare(self) -> None:
        """Compare the archive with what the robots have recorded."""
        report, stored = self.report, read_content(self.lab.archive)
        recorded: dict[str, str] = {}
        for robot in self.robots:
            recorded |= read_content(robot.data.database)
        identifiers = read_identifiers(self.lab.archive)
        lost, invented = recorded.keys() - stored.keys(), stored.keys() - recorded.keys()
        differing = [key for key in recorded.keys() & stored.keys() if recorded[key] != stored[key]]
        report.check(not lost, f"lost: {', '.join(lost)}")
        report.check(not invented, f"of no robot: {', '.join(invented)}")
        report.check(not differing, f"other samples: {', '.join(differing)}")
        twice = len(identifiers) - len(set(identifiers))
        report.check(twice == 0, f"{twice} sessions are there twice")
        report.facts["sessions recorded, in the archive, with the same SHA-256, twice"] = (
            f"{len(recorded)}, {len(stored)}, {len(recorded) - len(lost) - len(differing)}, {twice}"
        )
        for robot in self.swimmers:
            ticks = read_ticks(robot.data.database)
            for failure in report.failures:
                failure.missed[robot.computer.name] = count_missed(ticks, failure.began, failure.whole)

    def stop_within_reach(self) -> None:
        """Stop all robots by the lab's command while the last one is out of reach."""
        last = self.robots[-1]
        name = last.computer.name
        self.network.cut(last.computer)
        began = time.monotonic()
        refused = self.lab.shell("lab", "stop")
        took = time.monotonic() - began
        self.report.facts["`mucat lab stop` with one robot out of reach"] = (
            f"{took:.1f} s, status {refused.returncode}: {_join(refused.stdout)}"
        )
        self.report.check(
            refused.returncode == 1 and f"{name}: NOT STOPPED" in refused.stdout,
            f"STOP all with {name} out of reach: {refused.stdout}{refused.stderr}",
        )
        self.report.check(last.is_armed, f"{name} was stopped by a broken cable")
        self.network.mend(last.computer)
        self.wait_present()

    def stop_all(self) -> None:
        """Stop all robots by the lab's command."""
        stopped = self.lab.shell("lab", "stop")
        self.report.facts["`mucat lab stop`"] = _join(stopped.stdout)
        self.report.check(stopped.returncode == 0, f"STOP all: {stopped.stdout}{stopped.stderr}")
        armed = [robot.computer.name for robot in self.robots if robot.is_armed]
        self.report.check(not armed, f"still armed: {', '.join(armed)}")

    def remove_first(self) -> None:
        """Remove a robot: its certificate lets it in no more."""
        name = self.first.computer.name
        removed = self.lab.shell("lab", "remove", name)
        self.report.check(removed.returncode == 0, removed.stderr)
        self.first.wait_until(lambda lab: not lab["connected"], "/lab", f"{name} to be let in no more")
        self.lab.wait_until(
            lambda roster: name not in [robot["name"] for robot in roster["robots"]], "/robots", "its end"
        )


def _join(printed: str) -> str:
    return "; ".join(" ".join(line.split()) for line in printed.splitlines())
