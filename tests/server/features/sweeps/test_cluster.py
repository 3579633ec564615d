"""Sweeps on a scheduler of Dask with certificates: killed workers, a killed scheduler, wrong workers."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, closing
from pathlib import Path

import pytest

from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.boards import BUILD
from server.features.sweeps.cluster import ClusterWorkers, explain, name_identity, read_certificates
from server.features.sweeps.config import find_problem
from server.features.sweeps.engine import RunResult, SweepEngine
from server.features.sweeps.run_task import WorkerIdentity, identify
from server.features.sweeps.simulation import probe, simulate
from tests.server.features.sweeps.sweep_rig import EIGHT, make_certificates, read, tasks_of, without_seconds
from tests.stack import free_port

SCHEDULER = """
import asyncio, sys
from distributed import Scheduler
from server.features.sweeps.cluster import read_certificates

async def serve():
    address, folder = sys.argv[1:]
    async with Scheduler(host="127.0.0.1", port=int(address.rpartition(":")[2]), protocol="tls",
                         security=read_certificates(address, folder), dashboard=False) as scheduler:
        await scheduler.finished()

asyncio.run(serve())
"""

STRANGER = """
import asyncio, sys
from distributed import Worker
from server.features.sweeps.cluster import read_certificates

async def serve():
    address, folder = sys.argv[1:]
    async with Worker(address, security=read_certificates(address, folder), nthreads=1) as worker:
        await worker.finished()

asyncio.run(serve())
"""


class Cluster:
    """A scheduler and workers, each a process of this test."""

    def __init__(self, folder: Path, address: str) -> None:
        self.folder = folder
        self.address = address
        self.processes: list[subprocess.Popen[bytes]] = []

    def start_scheduler(self) -> subprocess.Popen[bytes]:
        return self._start("-c", SCHEDULER, self.address, str(self.folder))

    def start_worker(self) -> subprocess.Popen[bytes]:
        where = ["--data", str(self.folder), "--certificates", str(self.folder)]
        return self._start("-m", "server.cli", "worker", "--scheduler", self.address, *where)

    def start_stranger(self) -> subprocess.Popen[bytes]:
        """Start a worker that has the certificates, and does not say what it computes with."""
        return self._start("-c", STRANGER, self.address, str(self.folder))

    def _start(self, *arguments: str) -> subprocess.Popen[bytes]:
        with (self.folder / f"{len(self.processes)}.log").open("wb") as log:
            process = subprocess.Popen([sys.executable, *arguments], stdout=log, stderr=log)
        self.processes.append(process)
        return process


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    made = Cluster(make_certificates(tmp_path / "tls"), f"tls://127.0.0.1:{free_port()}")
    with ExitStack() as ended:
        yield made
        for process in made.processes:
            process.kill()
            ended.callback(process.wait)


def test_killed_workers_and_a_killed_scheduler_lose_nothing(cluster: Cluster, tmp_path: Path) -> None:
    scheduler = cluster.start_scheduler()
    cluster.start_stranger()
    first, _ = cluster.start_worker(), cluster.start_worker()
    sweep = read(EIGHT.replace("seeds = 2", "seeds = 6"))
    messages: list[str] = []
    results: list[RunResult] = []
    workers = ClusterWorkers(cluster.address, str(cluster.folder), identify(BUILD), messages.append)
    with closing(workers):
        for result in SweepEngine(sweep, "", identify(BUILD), lambda _: {}, workers).perform():
            results.append(result)
            if len(results) == 3:
                first.kill()
            if len(results) == 8:
                scheduler.kill()
                scheduler.wait()
                scheduler = cluster.start_scheduler()
    expected = {task.key: without_seconds(simulate(task)) for _, task in tasks_of(sweep)[:4]}
    by_key = {result.outcome.key: without_seconds(result.outcome) for result in results}
    assert sorted(result.run.number for result in results) == [*range(1, 25)]
    assert not any(result.outcome.problem for result in results)
    assert any("is not used: it is none of µ-CAT" in message for message in messages)
    assert {key: by_key[key] for key in expected} == expected
    # Whoever has no certificate of this authority is not let in.
    other = make_certificates(tmp_path / "other")
    with (
        pytest.raises(RefusedError, match="does not answer"),
        closing(ClusterWorkers(cluster.address, str(other), identify(BUILD), messages.append)) as refused,
    ):
        refused.open()


def test_a_worker_of_other_bits_or_software_is_refused_in_words() -> None:
    own = probe()
    for other, text in (
        (WorkerIdentity(own.firmware, own.software, "0" * 16), "it computes other bits"),
        (
            WorkerIdentity(own.firmware, "0" * 16, own.bits),
            "it has other software (0000000000000000 instead of",
        ),
        (WorkerIdentity("0" * 16, own.software, own.bits), "it has other firmware"),
    ):
        assert text in explain(own, [name_identity(other)])
    assert explain(own, ["GPU"]) == "it is none of µ-CAT"


def test_a_scheduler_is_reached_with_certificates_alone(tmp_path: Path) -> None:
    for address, text in (
        ("tcp://lab.local:8786", "runs code on it"),
        ("tls://lab.local:8786", "say in `certificates`"),
        ("lab.local", "write tls://NAME:PORT"),
    ):
        problem = find_problem(address, "")
        assert problem is not None
        assert text in problem.text
    assert find_problem("tcp://127.0.0.1:8786", "") is None
    with pytest.raises(RefusedError, match=r"ca\.pem"):
        read_certificates("tls://lab.local:8786", str(tmp_path))
