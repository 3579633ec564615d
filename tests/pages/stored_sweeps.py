"""Sweeps as a server has stored them, with figures that follow from their values."""

import asyncio
import json
from collections.abc import Iterator
from itertools import product
from typing import Any

from robot_runtime.experiments.scenario.library import shipped_scenarios
from server.analysis.definitions import RUN_FIGURES
from server.features.sweeps.run_task import RunOutcome, WorkerIdentity
from server.features.sweeps.store import StoredRun, SweepStore
from server.platform.models import SweepRow
from server.platform.settings import Settings
from server.platform.store import Store

SCENARIO = "hover_in_a_current"
KP, KD = "control.gains.pid.kp", "control.gains.pid.kd"
GRID, LINE, CANCELLED = 1, 2, 3
"""Numbers of the sweeps."""
KPS, KDS = (5.0, 10.0, 20.0, 30.0), (1.0, 2.0, 4.0)
BEST, WITHOUT_FIGURES = 5, 12
"""Variants of the grid: kp 10 with kd 2, and one that never armed."""
SEEDS = (1, 2, 3)
NEVER_ARMED = "The robot was never armed."


def store_sweeps(store: Store, _: Settings) -> None:
    """Store a grid of two gains, a sweep of one gain, and one that was cancelled half way."""
    asyncio.run(_store_all(SweepStore(store)))


def text_of(title: str, **vary: tuple[float, ...]) -> str:
    """Return a sweep of these values of PID's gains."""
    entries = "\n".join(f'"control.gains.pid.{name}" = {list(values)}' for name, values in vary.items())
    head = f'format = 1\nname = "stored"\ntitle = "{title}"\nscenario = "{SCENARIO}"\nseeds = {len(SEEDS)}\n'
    return f"{head}\n[vary]\n{entries}\n"


async def _store_all(sweeps: SweepStore) -> None:
    grid = text_of("PID in a current", kp=KPS, kd=KDS)
    await _add(sweeps, grid, (KP, KD), list(_runs([KPS, KDS], fails=WITHOUT_FIGURES)), "complete")
    await _add(sweeps, text_of("One gain", kp=KPS), (KP,), list(_runs([KPS])), "complete")
    half = [run for run in _runs([KPS, KDS]) if run.variant <= 6]
    await _add(sweeps, text_of("Half of it", kp=KPS, kd=KDS), (KP, KD), half, "cancelled", runs=36)


async def _add(
    sweeps: SweepStore,
    text: str,
    names: tuple[str, ...],
    done: list[StoredRun],
    state: str,
    runs: int | None = None,
) -> None:
    means: dict[int, list[float]] = {}
    for run in done:
        if (value := run.outcome.figures.get("rmse")) is not None:
            means.setdefault(run.variant, []).append(value)
    variant = min(means, key=lambda number: sum(means[number]))
    values = next(run.values for run in done if run.variant == variant)
    best = {"variant": variant, "values": values, "mean": sum(means[variant]) / len(SEEDS)}
    number = await sweeps.add(
        SweepRow(
            name="stored",
            title=text.split('title = "')[1].split('"')[0],
            scenario=SCENARIO,
            text=text,
            scenario_text=shipped_scenarios()[SCENARIO],
            craft="",
            who="Ada",
            state=state,
            runs=runs or len(done),
            best=json.dumps(best),
            best_figure="rmse",
            parameters=json.dumps(names),
            made=1_790_000_000.0,
            started=1_790_000_000.0,
            ended=1_790_000_060.0,
        )
    )
    failed = sum(bool(run.outcome.problem) for run in done)
    progress: dict[str, Any] = {"done": len(done), "failed": failed}
    await sweeps.keep(number, WorkerIdentity("firmware", "software"), done, progress)


def _runs(values: list[tuple[float, ...]], fails: int | None = None) -> Iterator[StoredRun]:
    number = 0
    for variant, chosen in enumerate(product(*values), 1):
        for seed in SEEDS:
            number += 1
            outcome = _outcome(number, chosen, seed, failed=variant == fails)
            yield StoredRun(number, variant, seed, chosen, outcome)


def _outcome(number: int, values: tuple[float, ...], seed: int, *, failed: bool) -> RunOutcome:
    """Return figures whose RMSE is the least at kp 10 and kd 2, and differs a little by the seed."""
    kp, kd = (*values, 2.0)[:2]
    size = 0.02 + 0.001 * abs(kp - 10) + 0.01 * abs(kd - 2)
    measured = {"rmse": size + 0.002 * seed, "overshoot": 200 * size, "effort": 500 * size + seed}
    return RunOutcome(
        key=f"{values} {number}",
        problem=NEVER_ARMED if failed else "",
        simulated=60.0,
        seconds=2.0,
        figures={meaning.name: None if failed else measured.get(meaning.name) for meaning in RUN_FIGURES},
        words={},
    )
