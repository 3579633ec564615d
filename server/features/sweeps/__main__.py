"""Computes a sweep in a process beside the server.

    python -m server.features.sweeps DATABASE

The standard input is a `SweepOrder` as JSON. The standard output has lines of JSON: {"workers"} at each
change of their number, {"notice"} for a person, {"run"} for each run that is done, at last {"end": true} or
{"problem"}. Figures that DATABASE has are not computed again; the process does not write it.
"""

import json
import logging
import sys
import traceback
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from typing import Any

from robot_runtime.contract.limits import ConfigError
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.boards import BUILD
from robot_runtime.transport.lifetime import end_with_parent, give_way
from server.features.sweeps.config import NO_DASK, has_dask
from server.features.sweeps.engine import SweepEngine
from server.features.sweeps.executors import LocalWorkers, Workers
from server.features.sweeps.order import SweepOrder, reopen
from server.features.sweeps.run_task import WorkerIdentity, identify
from server.features.sweeps.simulation import NICENESS
from server.features.sweeps.store import find_outcomes
from server.platform.engine import read_location
from server.platform.errors import ApiError
from server.platform.store import Reader


def main() -> int:
    """Compute one sweep."""
    end_with_parent()
    give_way(NICENESS)
    logging.basicConfig(level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s")
    order = SweepOrder.model_validate_json(sys.stdin.buffer.read())
    try:
        _perform(order, read_location(sys.argv[1]))
    except (ConfigError, RefusedError, ApiError) as problem:
        _say({"problem": str(problem)})
    except Exception as problem:
        traceback.print_exc()
        _say({"problem": f"The sweep cannot go on: {type(problem).__name__}: {problem}"})
    else:
        _say({"end": True})
    return 0


def _perform(order: SweepOrder, database: Path | str) -> None:
    sweep = reopen(order.text, order.scenario)
    identity = identify(BUILD)
    with closing(Reader(database)) as store, closing(_workers(order, identity)) as workers:
        engine = SweepEngine(sweep, order.craft, identity, lambda keys: find_outcomes(store, keys), workers)
        reported = -1
        for result in engine.perform():
            if workers.count != reported:
                reported = workers.count
                _say({"workers": reported})
            _say({"run": asdict(result.run), "outcome": asdict(result.outcome), "stored": result.stored})


def _workers(order: SweepOrder, identity: WorkerIdentity) -> Workers:
    if not order.scheduler:
        return LocalWorkers(order.workers)
    if not has_dask():
        raise RefusedError(NO_DASK)
    # Only here: most do without Dask, which is large.
    from server.features.sweeps.cluster import ClusterWorkers

    return ClusterWorkers(order.scheduler, order.certificates, identity, lambda text: _say({"notice": text}))


def _say(message: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(message, allow_nan=False, separators=(",", ":")) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
