"""Kills the server with -9 at random moments of recording, restarts it, and looks for losses.

The whole robot as a person starts it, in real time. `python -m tests.proofs.kills 100` prints what it finds;
status 1 where a proof fails. Every fourth time the server is killed again while it starts.
"""

import json
import random
import sqlite3
import sys
import time
from collections import defaultdict
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import httpx

from robot_runtime.contract.chunks import decode_documents, decode_pictures, decode_rows
from robot_runtime.contract.film_picture import FilmPicture
from robot_runtime.contract.topics import BY_NAME, TIME, Kind
from server.library.film import decode_film
from tests.stack import Stack

RECORDED_MAX = 2.0
"""s of recording before the next kill."""
STARTING_MAX = 0.5
"""s after which a server that starts is killed, now and then."""
PATIENCE = 60.0
PICTURE_SECONDS = 1 / 15
"""s between two pictures of the film."""
PARTS = ("board", "runtime", "simulator")


class SampleHole(NamedTuple):
    """Missing samples of a topic, and the duration of the gap."""

    topic: str
    samples: int
    seconds: float


@dataclass
class KillReport:
    """Results of the kills."""

    kills: int = 0
    rows: int = 0
    seconds: float = 0.0
    lost: int = 0
    """Samples that the server had told of as stored, and that were not there after its next start."""
    away: list[float] = field(default_factory=list)
    """s from each kill until the next server answered."""
    holes: list[SampleHole] = field(default_factory=list)
    doubles: int = 0
    gaps: list[tuple[str, str, int]] = field(default_factory=list)
    replaced: list[str] = field(default_factory=list)
    """Parts that did not outlive the server."""
    stops: int = 0
    """Times that the robot was stopped because no server came back in time."""
    tick_longest: float = 0.0
    integrity: str = ""
    pictures: int = 0
    """Pictures of the film."""
    shown: int = 0
    """Pictures that a decoder gives, from the first to the last."""
    picture_longest: float = 0.0
    """s between two pictures."""
    picture_apart: float = 0.0
    """s between a picture and the nearest sample of the depth, at most."""

    @property
    def problems(self) -> list[str]:
        """Problems found."""
        results = [f"{hole.samples} samples of {hole.topic} are missing" for hole in self.holes]
        results += [f"a gap is noted: {missed} of {topic} ({kind})" for topic, kind, missed in self.gaps]
        results += [f"the {name} did not outlive the server" for name in self.replaced]
        if self.lost:
            results.append(f"{self.lost} samples that were stored are gone")
        if self.doubles:
            results.append(f"{self.doubles} samples are there twice or out of order")
        if self.shown != self.pictures:
            results.append(f"of {self.pictures} pictures of the film {self.shown} can be shown")
        if self.picture_apart > PICTURE_SECONDS:
            results.append(f"a picture is {self.picture_apart:.3f} s from the depth's samples")
        if self.integrity != "ok":
            results.append(f"the database is damaged: {self.integrity}")
        return results

    def table(self) -> str:
        """Describe the result for a person."""
        away = sorted(self.away)
        longest = max((hole.seconds for hole in self.holes), default=0.0)
        lines = [
            f"{self.kills} kills in {self.seconds:.0f} s of recording, {self.rows} samples stored",
            f"holes: {len(self.holes)}, longest {longest:.2f} s; stored and lost again: {self.lost}; "
            f"twice: {self.doubles}; gaps noted: {len(self.gaps)}; integrity: {self.integrity}",
            f"server away: median {away[len(away) // 2]:.1f} s, longest {away[-1]:.1f} s; "
            f"robot stopped for it {self.stops} times",
            f"longest pause between two control ticks: {self.tick_longest:.3f} s",
            f"film: {self.pictures} pictures, of which {self.shown} can be shown; longest pause "
            f"{self.picture_longest:.3f} s; at most {self.picture_apart:.3f} s from a sample of the depth",
        ]
        return "\n".join([*lines, *self.problems])


def measure(kills: int, seed: int, tell: Callable[[str], None] = lambda _: None) -> KillReport:
    """Record, kill and restart a robot of its own repeatedly; then check the stored samples."""
    with TemporaryDirectory(prefix="mucat-") as name, Stack(Path(name) / "data") as stack:
        film = {"record": True, "rate": 1 / PICTURE_SECONDS, "quality": "medium"}
        stack.api.put("/film", json=film).raise_for_status()
        return measure_on(stack, kills, seed, tell)


def measure_on(
    stack: Stack, kills: int, seed: int, tell: Callable[[str], None] = lambda _: None
) -> KillReport:
    """Record, kill and restart repeatedly; then check the samples of this session."""
    chance = random.Random(seed)
    report = KillReport()
    data = stack.data
    parts = {part: _pid(data, part) for part in PARTS}
    session = stack.api.post("/sessions", json={"name": "kills"}).raise_for_status().json()["id"]
    while report.kills < kills:
        _arm(stack)
        time.sleep(chance.uniform(0, RECORDED_MAX))
        stored = _samples(stack, session)
        killed = time.monotonic()
        _kill(stack, report)
        while chance.random() < 0.25 and report.kills < kills:
            time.sleep(chance.uniform(0, STARTING_MAX))
            _kill(stack, report)
        _wait_for_answer(stack)
        report.away.append(time.monotonic() - killed)
        report.lost += max(stored - _samples(stack, session), 0)
        report.replaced += [part for part in PARTS if _pid(data, part) != parts[part]]
        tell(f"{report.kills:>4} of {kills}: away for {report.away[-1]:.1f} s after {stored} samples")
    time.sleep(RECORDED_MAX)
    stack.api.post(f"/sessions/{session}/stop").raise_for_status()
    _examine(data / "mucat.db", session, report)
    return report


def _arm(stack: Stack) -> None:
    """Arm, so that samples flow; after a refusal, the next round tries again."""
    stack.api.post("/robot/commands/arm", json={"unwatched": 0})


def _samples(stack: Stack, session: int) -> int:
    answer = stack.api.get(f"/sessions/{session}").json()
    assert answer["state"] == "recording", answer
    samples: int = answer["samples"]
    return samples


def _kill(stack: Stack, report: KillReport) -> None:
    stack.kill()
    report.kills += 1


def _wait_for_answer(stack: Stack) -> None:
    end = time.monotonic() + PATIENCE
    while True:
        try:
            stack.api.get("/health")
        except httpx.TransportError:
            assert time.monotonic() < end, stack.log.read_text()[-2000:]
            time.sleep(0.02)
        else:
            return


def _pid(data: Path, part: str) -> int:
    text: int = json.loads((data / "run" / f"{part}.pid").read_text())["pid"]
    return text


def _examine(database: Path, session: int, report: KillReport) -> None:
    with closing(sqlite3.connect(database)) as connection:
        (report.integrity,) = connection.execute("PRAGMA integrity_check").fetchone()
        gaps = "SELECT topic, kind, missed FROM gap WHERE session_id = ?"
        report.gaps = connection.execute(gaps, (session,)).fetchall()
        duration = connection.execute("SELECT duration FROM session WHERE id = ?", (session,))
        (report.seconds,) = duration.fetchone()
        chunks = connection.execute(
            "SELECT topic, first, count, first_time, last_time, data FROM chunk"
            " WHERE session_id = ? ORDER BY topic, number",
            (session,),
        )
        ends: dict[str, tuple[int, float]] = {}
        ticks: list[float] = []
        depths: list[float] = []
        pictures: list[tuple[float, bytes]] = []
        reports: dict[str, int] = defaultdict(int)
        for topic, first, count, first_time, last_time, data in chunks:
            number, time_before = ends.get(topic, (first, first_time))
            if first > number:
                report.holes.append(SampleHole(topic, first - number, first_time - time_before))
            report.doubles += max(number - first, 0)
            ends[topic] = (first + count, last_time)
            report.rows += count
            if topic == "control":
                ticks += row_times(topic, data)
            elif topic == "depth":
                depths += row_times(topic, data)
            elif topic == "film":
                pictures += decode_pictures(data)
            elif topic == "event":
                for event in decode_documents(data):
                    reports[event["text"].partition(";")[0]] += 1
    report.stops = reports["The server sends no heartbeat"]
    report.tick_longest = max((after - before for before, after in pairwise(ticks)))
    _examine_film(pictures, depths, report)


def _examine_film(pictures: list[tuple[float, bytes]], depths: list[float], report: KillReport) -> None:
    report.pictures = len(pictures)
    if not pictures:
        return
    film = [(time, FilmPicture(picture)) for time, picture in pictures]
    report.shown = sum(1 for _ in decode_film(film))
    report.picture_longest = max((after - before for (before, _), (after, _) in pairwise(film)), default=0.0)
    # Before the first sample and after the last one there is none to compare with.
    inside = [time for time, _ in film if depths[0] <= time <= depths[-1]]
    report.picture_apart = max(min(abs(time - depth) for depth in depths) for time in inside)


def row_times(topic: str, data: bytes) -> list[float]:
    """Return the times of a chunk's rows, s."""
    assert BY_NAME[topic].kind is Kind.ROWS
    size = BY_NAME[topic].row_bytes
    rows = decode_rows(data, size)
    return [TIME.unpack_from(rows, position)[0] for position in range(0, len(rows), size)]


def main() -> int:
    """Exit status."""
    kills = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    report = measure(kills, seed=int(time.time()), tell=lambda text: print(text, flush=True))
    print(report.table())
    return 1 if report.problems else 0


if __name__ == "__main__":
    sys.exit(main())
