"""A sweep on two workers of a scheduler, of which some are killed: the table must be that of one computer."""

import sqlite3
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from server.platform.settings import DataFolder
from tests.proofs.lab.network import LabComputer, LabNetwork
from tests.proofs.lab.programs import DASK, MUCAT, ComputerProgram, wait_beside
from tests.proofs.lab.report import FailureOutcome
from tests.proofs.lab.whole_lab import WholeLab
from tests.server.features.sweeps.sweep_rig import EIGHT, keep_scenario, make_certificates

SWEEP = EIGHT.replace("seeds = 2", "seeds = 6")
RUNS = 24
PORT = 8786


class SweepCluster:
    """A scheduler on the lab's computer, workers on two others, and a desk where sweeps are started."""

    def __init__(self, network: LabNetwork, lab: LabComputer, folder: Path) -> None:
        folder.mkdir()
        self._folder = folder
        self._sweeps: list[ComputerProgram] = []
        self._certificates = make_certificates(folder / "tls")
        self._address = f"tls://{lab.address}:{PORT}"
        tls = [
            word
            for option, file in (("ca-file", "ca"), ("cert", "certificate"), ("key", "key"))
            for word in (f"--tls-{option}", str(self._certificates / f"{file}.pem"))
        ]
        command = (DASK, "scheduler", "--protocol", "tls", "--port", str(PORT), *tls)
        self.scheduler = ComputerProgram(lab, folder / "scheduler.log", *command)
        self.workers = [self.worker(network.add(f"worker-{number}", 20 + number)) for number in (1, 2)]
        self._desk = network.add("desk", 31)
        (folder / "sweep.toml").write_text(SWEEP)

    def worker(self, computer: LabComputer, certificates: Path | None = None) -> ComputerProgram:
        """Return a worker on this computer, not started yet."""
        tls = str(certificates or self._certificates)
        arguments = ("worker", "--scheduler", self._address, "--certificates", tls)
        log, data = self._folder / f"{computer.name}.log", str(self._folder / computer.name)
        return ComputerProgram(computer, log, MUCAT, *arguments, "--data", data)

    def sweep(self, name: str, computer: LabComputer, *arguments: str) -> "RunningSweep":
        """Return a sweep with a data folder of its own, not started yet."""
        folder = self._folder / name
        keep_scenario(DataFolder(folder).scenarios)
        table = self._folder / f"{name}.csv"
        file = str(self._folder / "sweep.toml")
        options = ("--table", str(table), "--data", str(folder), *arguments)
        log = self._folder / f"{name}.log"
        program = ComputerProgram(computer, log, MUCAT, "scenario", "sweep", file, *options)
        self._sweeps.append(program)
        return RunningSweep(program, DataFolder(folder).database, table)

    @contextmanager
    def running(self) -> Iterator[None]:
        """Run scheduler and workers."""
        programs = (self.scheduler, *self.workers)
        try:
            for program in programs:
                program.start()
            for worker in self.workers:
                wait_beside(lambda: "Computing for" in worker.read(), f"the worker {worker.computer.name}")  # noqa: B023
            yield
        finally:
            for program in (*self._sweeps, *programs):
                program.stop()

    def prove(self, whole: WholeLab) -> None:
        """Sweep, kill a worker and then the scheduler, and compare the table with that of one computer."""
        report = whole.report
        sweep = self.sweep("cluster", self._desk, "--scheduler", self._address, *self._with_certificates())
        sweep.program.start()
        first, _ = self.workers
        sweep.wait_for(3)
        self._fail(whole, sweep, "worker killed", first.kill)
        first.start()
        sweep.wait_for(12)

        def kill_scheduler() -> None:
            self.scheduler.kill()
            self.scheduler.start()

        self._fail(whole, sweep, "scheduler killed", kill_scheduler)
        report.check(sweep.wait() == 0, f"the sweep: {sweep.program.read()[-500:]}")
        own = self.sweep("own", self._desk)
        own.program.start()
        report.check(own.wait() == 0, f"the sweep on one computer: {own.program.read()[-500:]}")
        rows, expected = (each.table.read_text().splitlines()[1:] for each in (sweep, own))
        equal = len(set(rows) & set(expected))
        report.check(rows == expected, f"only {equal} rows of the sweep are those of one computer")
        report.check(len(rows) == RUNS, f"the sweep has {len(rows)} rows instead of {RUNS}")
        report.facts["rows of the sweep; equal to one computer's"] = f"{len(rows)}; {equal}"

    def _with_certificates(self) -> tuple[str, str]:
        return "--certificates", str(self._certificates)

    def _fail(self, whole: WholeLab, sweep: "RunningSweep", name: str, strike: Callable[[], None]) -> None:
        """Time a failure until the sweep goes on."""
        outcome = FailureOutcome(name, time.monotonic())
        before = sweep.count()
        strike()
        outcome.mended = time.monotonic()
        # What the living worker had begun before does not count.
        sweep.wait_for(before + 4)
        outcome.whole = time.monotonic()
        outcome.before, outcome.after = f"{before} runs", f"{sweep.count()} runs"
        for robot in whole.swimmers:
            whole.report.check(robot.is_armed, f"{name}: {robot.computer.name} does not swim on")
        whole.report.failures.append(outcome)
        whole.report.tell(outcome.row)

    def refuse(self, whole: WholeLab, stranger: LabComputer) -> None:
        """Try a worker and a sweep with certificates of another authority."""
        other = make_certificates(self._folder / "other_tls")
        worker = self.worker(stranger, other)
        worker.start()
        wait_beside(lambda: "does not answer" in worker.read(), "the stranger's worker to be refused")
        options = ("--scheduler", self._address, "--certificates", str(other))
        sweep = self.sweep("foreign", stranger, *options)
        sweep.program.start()
        status = sweep.program.wait()
        worker.stop()
        whole.report.check(status != 0 and sweep.count() == 0, f"a stranger's sweep: {sweep.program.read()}")
        whole.report.check("Computing for" not in worker.read(), f"a stranger's worker: {worker.read()}")
        whole.report.facts["sweep with a wrong certificate"] = sweep.program.read().strip()[-300:]


class RunningSweep:
    """A sweep from a shell, its database and its table."""

    def __init__(self, program: ComputerProgram, database: Path, table: Path) -> None:
        self.program, self.table = program, table
        self._database = database

    def count(self) -> int:
        """Return the number of runs that are stored."""
        if not self._database.exists():
            return 0
        with closing(sqlite3.connect(f"file:{self._database}?mode=ro", uri=True)) as database:
            try:
                (count,) = database.execute("SELECT count(*) FROM sweep_run").fetchone()
            except sqlite3.OperationalError:
                # It is being made.
                return 0
        return int(count)

    def wait(self) -> int:
        """Wait for its end, and return its exit status."""
        for runs in range(self.count() + 1, RUNS + 1):
            self.wait_for(runs)
        return self.program.wait()

    def wait_for(self, runs: int) -> None:
        """Wait until so many runs are stored."""

        def holds() -> bool:
            assert self.program.is_running or self.count() >= runs, self.program.read()[-4000:]
            return self.count() >= runs

        wait_beside(holds, f"{runs} runs of the sweep")
