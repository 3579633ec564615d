"""Sweeps in the database, on SQLite and on PostgreSQL."""

from dataclasses import replace

from robot_runtime.experiments.scenario.document import SEED
from server.features.sweeps.run_task import RunOutcome, WorkerIdentity
from server.features.sweeps.store import StoredRun, SweepStore, find_outcomes
from server.platform.models import SweepRow
from server.platform.store import Store

BOTH_DATABASES = True
IDENTITY = WorkerIdentity("firmware", "software")


def outcome(key: str, rmse: float) -> RunOutcome:
    return RunOutcome(
        key=key, problem="", simulated=60.0, seconds=1.5, figures={"rmse": rmse, "overshoot": None}, words={}
    )


async def test_runs_are_kept_once_and_what_is_computed_again_takes_their_place(store: Store) -> None:
    sweeps = SweepStore(store)
    number = await sweeps.add(
        SweepRow(
            name="pid",
            title="PID",
            scenario="figure_14",
            text="",
            scenario_text="",
            craft="",
            who="Ada",
            state="running",
            runs=2,
            best_figure="rmse",
            parameters="[]",
            made=1.0,
        )
    )
    first = StoredRun(1, 1, int(SEED.maximum), (1.5,), outcome("a", 0.031))
    failed = StoredRun(
        2, 2, 1, (3.0,), replace(outcome("b", 0.0), problem="ended", figures={}, lasting=False)
    )
    await sweeps.keep(number, IDENTITY, [first, failed], {"done": 2, "failed": 1})
    again = StoredRun(2, 2, 1, (3.0,), outcome("b", 0.042))
    await sweeps.keep(number, IDENTITY, [first, again], {"done": 2, "failed": 0})
    assert sweeps.runs(number) == [first, again]
    assert (sweeps.find(number).done, sweeps.find(number).failed) == (2, 0)
    assert find_outcomes(store, ["a", "b", "c"]) == {"a": first.outcome, "b": again.outcome}
