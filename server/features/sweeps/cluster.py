"""Workers of a scheduler of Dask, as an executor; and the worker itself. Needs the package distributed.

A worker offers its identity as a resource: firmware, software and the bits of a probe. Runs ask for the
identity of this computer, so that the scheduler gives none to a worker that would compute other bits.
"""

import asyncio
import logging
import time
from collections.abc import Callable
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

import dask
from distributed import Client, Security, Worker

from robot_runtime.errors import RefusedError
from server.features.sweeps.run_task import WorkerIdentity
from server.features.sweeps.simulation import probe, settle_worker

log = logging.getLogger(__name__)

RETRIES = 2
"""Of a run whose worker has ended."""
CONNECT_SECONDS = 10.0
AGAIN_SECONDS = 1.0
LOOK_SECONDS = 1.0
MARK = "mucat"
SELDOM = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "5s",
}
"""Settings of Dask by which a worker seldom watches itself: 150 times a second interrupt its run."""


def read_certificates(scheduler: str, folder: str) -> Security | None:
    """Return the certificates for a scheduler; None for one without. Raise RefusedError."""
    if not scheduler.startswith("tls:"):
        return None
    files = {name: Path(folder) / f"{name}.pem" for name in ("ca", "certificate", "key")}
    missing = [str(file) for file in files.values() if not file.is_file()]
    if missing:
        raise RefusedError(f"The scheduler is reached with certificates; {', '.join(missing)} is not there.")
    roles = {
        f"tls_{role}_{part}": str(files[name])
        for role in ("client", "worker", "scheduler")
        for part, name in (("cert", "certificate"), ("key", "key"))
    }
    return Security(tls_ca_file=str(files["ca"]), require_encryption=True, **roles)


class ClusterWorkers:
    """The workers of a scheduler that compute the same bits as this computer; `tell` takes words."""

    alone = False

    def __init__(
        self, scheduler: str, certificates: str, identity: WorkerIdentity, tell: Callable[[str], None]
    ) -> None:
        self._scheduler = scheduler
        self._security = read_certificates(scheduler, certificates)
        self._own = probe()
        assert (self._own.firmware, self._own.software) == (identity.firmware, identity.software)
        self._tell = tell
        self._client: Client | None = None
        self._looked = 0.0
        self._count = 0
        self._refused: frozenset[str] = frozenset()

    @property
    def count(self) -> int:
        """The number of workers that compute the same bits."""
        now = time.monotonic()
        if self._client is not None and now - self._looked >= LOOK_SECONDS:
            self._looked = now
            self._look(self._client.scheduler_info(n_workers=-1)["workers"])
        return self._count

    def open(self) -> Executor:
        """Return an executor; wait for a scheduler that has gone. Raise RefusedError for one never there."""
        first = self._client is None
        self.close()
        while True:
            try:
                self._client = Client(
                    self._scheduler,
                    security=self._security,
                    timeout=CONNECT_SECONDS,
                    set_as_default=False,
                )
                break
            except (OSError, TimeoutError) as problem:
                text = f"The scheduler {self._scheduler} does not answer ({problem})."
                if first:
                    raise RefusedError(text) from problem
                self._tell(f"{text} What is missing is computed when it is back.")
                time.sleep(AGAIN_SECONDS)
        executor: Executor = self._client.get_executor(
            retries=RETRIES, pure=False, resources={name_identity(self._own): 1}
        )
        return executor

    def close(self) -> None:
        """End the connection, and what is computed for it."""
        if self._client is not None:
            self._client.close()

    def _look(self, workers: dict[str, dict[str, Any]]) -> None:
        own = name_identity(self._own)
        offered = {address: [*worker.get("resources", {})] for address, worker in workers.items()}
        self._count = sum(own in names for names in offered.values())
        refused = {address: names for address, names in offered.items() if own not in names}
        for address in refused.keys() - self._refused:
            self._tell(f"The worker {address} is not used: {explain(self._own, refused[address])}.")
        self._refused = frozenset(refused)
        if not self._count:
            self._tell("It waits for a worker: start one with “mucat worker”.")


def name_identity(identity: WorkerIdentity) -> str:
    """Return the resource of a worker of this identity."""
    return f"{MARK}-{identity.software}-{identity.firmware}-{identity.bits}"


def explain(own: WorkerIdentity, offered: list[str]) -> str:
    """Return why a worker with these resources is not used, in words that follow it."""
    mine = name_identity(own).split("-")
    theirs = next((name.split("-") for name in offered if name.startswith(f"{MARK}-")), None)
    if theirs is None or len(theirs) != len(mine):
        return "it is none of µ-CAT"
    for word, here, there in zip(("", "software", "firmware", "bits"), mine, theirs, strict=True):
        if here != there:
            if word == "bits":
                return "it computes other bits: its processor or its libraries differ"
            return f"it has other {word} ({there} instead of {here}); install the same version of µ-CAT"
    return "it has no free place"


async def serve_worker(scheduler: str, certificates: str, tell: Callable[[str], None]) -> None:
    """Compute runs of a scheduler until this is cancelled; wait for one that has gone.

    Raise RefusedError, BoardError.
    """
    security = read_certificates(scheduler, certificates)
    dask.config.set(SELDOM)
    settle_worker()
    resource = name_identity(probe())
    while True:
        try:
            async with Worker(
                scheduler,
                security=security,
                nthreads=1,
                resources={resource: 1},
                # Its own limit ends a run that takes too much; Dask's would end the worker.
                memory_limit=0,
                dashboard=False,
                death_timeout=CONNECT_SECONDS,
            ) as worker:
                tell(f"Computing for {scheduler} at {worker.address}.")
                await worker.finished()
            tell(f"{scheduler} has ended; waiting for it.")
        except (OSError, TimeoutError, RuntimeError) as problem:
            tell(f"{scheduler} does not answer ({problem}); trying again.")
        await asyncio.sleep(AGAIN_SECONDS)
