"""Cuts the power while the server stores, and finds losses of acknowledged data.

`python -m tests.proofs.power 10000` writes down what the server's own parts do to their files
(`power_work.py`, `disk_log.c`), cuts the power at so many moments, builds what the disk may then hold
(`disk.py`), opens it with SQLite, and compares. The same with weaker settings shows that it can see a loss.
Status 1 where something was lost, or where a weaker setting lost nothing.
"""

import hashlib
import json
import random
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from itertools import cycle
from pathlib import Path
from typing import Any, get_args

from tests.proofs import disk
from tests.proofs.disk import Cut, DiskStep, LoggedDisk
from tests.proofs.facts import DamagedDataError, holds, read_facts
from tests.stack import ROOT

MEMORY = "/dev/shm" if Path("/dev/shm").is_dir() else None
"""Where to sync costs nothing: what matters is that it was done, and when."""
CUTS: tuple[Cut, ...] = get_args(Cut)
WEAKER = {
    "FULL, sectors shared": ("FULL", "1"),
    "NORMAL": ("NORMAL", "0"),
    "OFF": ("OFF", "0"),
}
"""PRAGMA synchronous, and whether SQLite takes for granted that a cut spoils no neighbouring bytes."""


@dataclass
class PowerReport:
    """Result of the cuts: count of each kind, acknowledged facts, and problems."""

    cuts: Counter[Cut] = field(default_factory=Counter)
    facts: int = 0
    damaged: Counter[Cut] = field(default_factory=Counter)
    lossy: Counter[Cut] = field(default_factory=Counter)
    lost: int = 0
    words: list[str] = field(default_factory=list)

    @property
    def bad(self) -> int:
        """Cuts with a problem."""
        return self.damaged.total() + self.lossy.total()

    def row(self, name: str) -> str:
        """Describe the result for a person."""
        kinds = ", ".join(f"{cut} {self.damaged[cut] + self.lossy[cut]}" for cut in CUTS)
        return (
            f"{name:<22}{self.cuts.total():>8}{self.damaged.total():>9}{self.lossy.total():>8}{self.lost:>9}"
            f"   {kinds}"
        )


HEADER = f"{'':<22}{'states':>8}{'damaged':>9}{'lossy':>8}{'lost':>9}   bad states by kind"


def record(folder: Path, library: Path, *weaker: str) -> tuple[Path, LoggedDisk, list[DiskStep]]:
    """Run the work in `folder`; return its data folder, the disk before it, and its steps."""
    log = folder / "steps"
    work = folder / "work"
    work.mkdir()
    log.touch()
    before = LoggedDisk(work)
    command = [sys.executable, "-m", "tests.proofs.power_work", str(work), str(log), *weaker]
    subprocess.run(command, cwd=ROOT, env=disk.logging(library, work, log), check=True)
    return work / "data", before, list(disk.read(log))


def replay(data: Path, at: LoggedDisk, steps: list[DiskStep], states: int, seed: int) -> PowerReport:
    """Cut the power at this many moments, as many of each kind, and check the data."""
    chance = random.Random(seed)
    kinds = cycle(CUTS)
    moments = Counter(chance.randrange(1, len(steps) + 1) for _ in range(states))
    report, demands = PowerReport(), dict[str, list[Any]]()
    with tempfile.TemporaryDirectory(dir=MEMORY) as folder:
        for number, step in enumerate(steps, 1):
            if step.kind == "a":
                _demand(demands, step)
            else:
                at.take(step)
            for _ in range(moments[number]):
                cut = next(kinds)
                _look(at.after(cut, chance), demands, data, Path(folder), cut, report)
    return report


def is_whole(data: Path, at: LoggedDisk) -> bool:
    """Return True if the recorded steps explain every byte in the folder."""
    seen = at.after("kept", random.Random(0))
    watched = [data / "mucat.db", *data.glob("exports/*"), *data.glob("backups/*"), *data.glob("scenarios/*")]
    return all(seen.get(str(path)) == path.read_bytes() for path in watched) and not any(
        name not in map(str, watched) for name in seen if Path(name).parent.name in ("exports", "backups")
    )


def _demand(demands: dict[str, list[Any]], step: DiskStep) -> None:
    for name, allowed in json.loads(step.data).items():
        if allowed is None:
            demands.pop(name, None)
        else:
            demands[name] = allowed


def _look(
    files: dict[str, bytearray],
    demands: dict[str, list[Any]],
    data: Path,
    folder: Path,
    cut: Cut,
    report: PowerReport,
) -> None:
    report.cuts[cut] += 1
    report.facts += len(demands)
    facts: dict[str, Any] = {
        f"file/{name.removeprefix(f'{data}/')}": hashlib.sha256(files[name]).hexdigest()
        for name in files
        if f"file/{name.removeprefix(f'{data}/')}" in demands
    }
    database = folder / "mucat.db"
    for end in ("", "-wal", "-journal"):
        content = files.get(f"{data}/mucat.db{end}")
        path = database.with_name(database.name + end)
        path.unlink(missing_ok=True)
        if content is not None:
            path.write_bytes(content)
    database.with_name("mucat.db-shm").unlink(missing_ok=True)
    try:
        if database.exists():
            facts |= read_facts(database, "rw")
    except DamagedDataError as problem:
        report.damaged[cut] += 1
        report.words.append(f"{cut}: {problem}")
        return
    missing = [
        name
        for name, allowed in demands.items()
        if not holds(facts.get(name), allowed, grows=name.startswith("samples/"))
    ]
    report.lost += len(missing)
    if missing:
        report.lossy[cut] += 1
        report.words.append(f"{cut}: {len(missing)} of {len(demands)}, such as {missing[0]}")


def main() -> int:
    """Exit status."""
    states = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    print(HEADER, flush=True)
    status = 0
    for name, weaker in {"FULL (as it is)": (), **WEAKER}.items():
        with tempfile.TemporaryDirectory(prefix="mucat-", dir=MEMORY) as folder:
            data, before, steps = record(Path(folder), disk.build(Path(folder)), *weaker)
            report = replay(data, before, steps, states if not weaker else states // 4, seed=1)
            print(report.row(name), flush=True)
            if not weaker:
                print(f"{len(steps)} steps", *report.words[:5], sep="\n", flush=True)
            if not is_whole(data, before) or bool(report.bad) != bool(weaker):
                status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
