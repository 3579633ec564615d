"""Sweeps as people ask for them: plans, results, single runs, and what is made of them."""

import asyncio
import os
from itertools import islice

import tomli_w

from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.document import DURATION, Scenario, read_scenario
from robot_runtime.experiments.sweep.document import Sweep, SweepRun
from server.driving.profiles import Profile, Profiles
from server.driving.simulated_starts import SimulatedStarts
from server.features.sweeps.config import SweepsConfig
from server.features.sweeps.description import describe_parameters, gains_of, write_template
from server.features.sweeps.order import reopen
from server.features.sweeps.run_task import identify, plan_task
from server.features.sweeps.runner import PlannedSweep, SweepRunner
from server.features.sweeps.schemas import LOOKED_UP_MAX, SweepPlan, SweepRunDetail
from server.features.sweeps.store import StoredRun, SweepStore, find_outcomes, find_rate
from server.features.sweeps.variants import find_failure
from server.library.scenarios import scenario_texts
from server.platform.errors import NotFoundError
from server.platform.models import SweepRow
from server.platform.settings import Settings

RUNS_LISTED_MAX = 5000
"""In one answer."""


class UnknownRunError(NotFoundError):
    """There is no such run"""


class SweepLibrary:
    """The sweeps of a server. Methods block; they raise StoreError, and UnknownSweepError without one."""

    def __init__(
        self,
        settings: Settings,
        store: SweepStore,
        runner: SweepRunner,
        profiles: Profiles,
        starts: SimulatedStarts,
    ) -> None:
        self._settings = settings
        self._store = store
        self._runner = runner
        self._profiles = profiles
        self._starts = starts

    def plan(self, text: str) -> SweepPlan:
        """Return what a sweep would do. Raise ConfigError with its problems."""
        planned = self._runner.read(text)
        sweep = planned.sweep
        stored = 0 if sweep.search is not None else self._count_stored(planned)
        config = self._settings.section(SweepsConfig)
        workers = 0 if config.scheduler else config.workers or len(os.sched_getaffinity(0))
        rate = find_rate(self._store.reader, identify(self._settings.build))
        seconds = None
        if rate is not None:
            duration = float(sweep.table.get("duration", DURATION.minimum))
            seconds = (sweep.runs - stored) * duration * rate / max(workers, 1)
        return SweepPlan(
            problems=[],
            runs=sweep.runs,
            variants=sweep.variants,
            parameters=describe_parameters(sweep),
            seconds=seconds,
            workers=workers,
            stored=stored,
        )

    def template(self, name: str) -> str:
        """Return a sweep of a scenario of the library to begin with. Raise NotFoundError, ConfigError."""
        texts = scenario_texts(self._settings.data.scenarios)
        if name not in texts:
            raise NotFoundError(f"There is no scenario {name!r}; there are {', '.join(texts)}.")
        return write_template(name, read_scenario(texts[name], self._settings.read_craft()))

    def open(self, sweep: int) -> tuple[SweepRow, Sweep, list[StoredRun]]:
        """Return a sweep, its document, and its runs that are done."""
        row = self._store.find(sweep)
        return row, reopen(row.text, row.scenario_text), self._store.runs(sweep)

    def list_runs(self, sweep: int, variant: int | None) -> list[SweepRunDetail]:
        """Return the runs that are done, of one variant or of all. Raise RefusedError where they are many."""
        row = self._store.find(sweep)
        if variant is None and row.done > RUNS_LISTED_MAX:
            raise RefusedError(f"These are more than {RUNS_LISTED_MAX} runs. Ask for those of one variant.")
        read = reopen(row.text, row.scenario_text)
        sessions = self._store.sessions(row.scenario)
        return [_describe(read, run, sessions) for run in self._store.runs(sweep, variant)]

    def scenario_text(self, sweep: int, run: int) -> str:
        """Return the scenario of a run that is done, as TOML. Raise UnknownRunError, ConfigError."""
        _, read, runs = self.open(sweep)
        done = next((entry for entry in runs if entry.number == run), None)
        if done is None:
            raise UnknownRunError(f"Sweep {sweep} has no run {run} that is done.")
        return _write_scenario(read, done)

    def start_session(self, text: str, who: str) -> str:
        """Run a scenario as a session, and return its run. Raise ConfigError, RefusedError."""
        return self._starts.start(text, who)

    async def save_profile(self, sweep: int, variant: int, name: str, who: str) -> Profile:
        """Save the gains of a variant as a profile. Raise UnknownRunError, RefusedError."""
        title, gains = await asyncio.to_thread(self._gains, sweep, variant)
        return await self._profiles.save(name, f"Sweep “{title}”, variant {variant}", gains, who)

    def _gains(self, sweep: int, variant: int) -> tuple[str, dict[str, float | str]]:
        """Return the sweep's title, and the robot's parameters of a variant."""
        row = self._store.find(sweep)
        runs = self._store.runs(sweep, variant)
        if not runs:
            raise UnknownRunError(f"Sweep {sweep} has no variant {variant} of which a run is done.")
        read = reopen(row.text, row.scenario_text)
        controller = _controller(read, runs[0], self._settings)
        return row.title, gains_of(read, runs[0].values, controller)

    def _count_stored(self, planned: PlannedSweep) -> int:
        sweep = planned.sweep
        identity = identify(self._settings.build)
        grid = enumerate(sweep.grid(), 1)
        runs = (run for variant, values in grid for run in sweep.runs_of(variant, values))
        keys = [plan_task(sweep, run, planned.craft, identity).key for run in islice(runs, LOOKED_UP_MAX)]
        return len(find_outcomes(self._store.reader, keys))


def _controller(sweep: Sweep, run: StoredRun, settings: Settings) -> str:
    scenario: Scenario = read_scenario(_write_scenario(sweep, run), settings.read_craft())
    return scenario.control.controller


def _write_scenario(sweep: Sweep, run: StoredRun) -> str:
    chosen = SweepRun(number=run.number, variant=run.variant, seed=run.seed, values=run.values)
    return tomli_w.dumps(sweep.scenario_of(chosen))


def _describe(sweep: Sweep, run: StoredRun, sessions: dict[str, int]) -> SweepRunDetail:
    reason = find_failure(sweep.figures.best, run.outcome)
    # Most have none, and writing thousands of scenarios takes seconds.
    session = sessions.get(_write_scenario(sweep, run)) if sessions else None
    return SweepRunDetail(
        number=run.number,
        variant=run.variant,
        seed=run.seed,
        values=list(run.values),
        state="failed" if reason else "complete",
        reason=reason,
        seconds=run.outcome.seconds,
        figures=run.outcome.figures,
        session=session,
    )
