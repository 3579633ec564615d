"""Random missions with a robot that measures anything."""

from math import inf
from random import Random
from typing import Any

from hypothesis import strategies as st

from robot_runtime.contract.documents import Mission
from robot_runtime.contract.missions import LEVELS_MAX
from robot_runtime.missions.document import read_mission
from robot_runtime.missions.node import LoadedMission
from tests.runtime.missions.mission_rig import TICK, MissionRig, SetSenses
from tests.runtime.missions.water import mission

ROUNDING = 0.001
"""s to which documents round their times."""
GAIN = "depth.pid.kp"
SECONDS = st.floats(0.1, 3.0).map(lambda value: round(value, 1))


def _leaf(do: str, **values: st.SearchStrategy[Any]) -> st.SearchStrategy[dict[str, Any]]:
    return st.fixed_dictionaries({"do": st.just(do), **values})


CONDITIONS = _leaf("is", below=st.sampled_from([0.2, 0.5, 0.8])) | _leaf("is", sees=st.just("light"))
LEAVES = (
    CONDITIONS
    | _leaf("dive", depth=st.sampled_from([0.3, 0.6]), within=st.just(0.5), timeout=SECONDS)
    | _leaf("hold", seconds=SECONDS, within=st.sampled_from([0.2, 2.0]))
    | _leaf("turn", by=st.sampled_from([-1.0, 1.0]), timeout=SECONDS)
    | _leaf("swim", x=st.just(0.5), seconds=SECONDS)
    | _leaf("go", distance=st.just(0.5), heading=st.sampled_from([-1.0, 1.0]), timeout=SECONDS)
    | _leaf("to_light", timeout=SECONDS, lost=SECONDS)
    | _leaf("wait_for", sees=st.just("light"), timeout=SECONDS)
    | _leaf("set", parameter=st.just(GAIN), value=st.sampled_from([2.0, 4.0]))
    | _leaf("mark", text=st.just("here"))
    | _leaf("surface")
)


def _branches(steps: st.SearchStrategy[dict[str, Any]]) -> st.SearchStrategy[dict[str, Any]]:
    some = st.lists(steps, min_size=1, max_size=4)
    guarded = st.tuples(CONDITIONS, _leaf("sequence", steps=some)).map(list)
    return (
        _leaf("sequence", steps=some)
        | _leaf("first_of", steps=some)
        | _leaf("try", steps=some)
        | _leaf("repeat", times=st.integers(1, 3), steps=some)
        | _leaf("timeout", seconds=SECONDS, steps=some)
        | _leaf("invert", steps=st.lists(steps, min_size=1, max_size=1))
        | _leaf("until", timeout=SECONDS, steps=guarded)
        | _leaf("while_true", steps=guarded)
        | _leaf("race", steps=st.tuples(CONDITIONS, steps).map(list))
        | _leaf("all", steps=st.tuples(_leaf("mark", text=st.just("side")), steps).map(list))
    )


def count_levels(step: dict[str, Any]) -> int:
    """Return the levels of a step and those below it."""
    return 1 + max(map(count_levels, step.get("steps", [])), default=0)


STEPS = st.recursive(LEAVES, _branches, max_leaves=12).filter(lambda step: count_levels(step) < LEVELS_MAX)


def write(step: dict[str, Any]) -> str:
    """Return the step as an inline table."""

    def value(entry: Any) -> str:
        if isinstance(entry, list):
            return f"[{', '.join(map(write, entry))}]"
        return f"'{entry}'" if isinstance(entry, str) else f"{entry}"

    return "{ " + ", ".join(f"{name} = {value(entry)}" for name, entry in step.items()) + " }"


class AnySenses(SetSenses):
    """Readings that jump: one draw for each question."""

    random = Random(0)

    @property
    def depth(self) -> float:
        """m."""
        return self.random.uniform(0.0, 1.0)

    @property
    def heading(self) -> float:
        """rad."""
        return self.random.uniform(-3.0, 3.0)

    @property
    def way(self) -> tuple[float, float]:
        """m."""
        return self.random.uniform(-1.0, 1.0), self.random.uniform(-1.0, 1.0)

    @property
    def light(self) -> bool:
        """True in one of three draws."""
        return self.random.random() < 0.3


class Swim:
    """A mission of one first step, ticked until it ends; pages are open until `leave` s."""

    def __init__(self, text: str, seed: int = 1, leave: float = inf) -> None:
        rig = MissionRig(AnySenses)
        assert isinstance(rig.senses, AnySenses)
        rig.senses.random = Random(seed)
        self.documents, self.stops, self.core = rig.documents, rig.stops, rig.core
        runner = rig.runner
        self.document = read_mission(text)
        self.before = self.core.parameters.values()[GAIN]
        runner.prepare(LoadedMission(self.document, text))
        for _ in range(int(self.document.limits.time / TICK) + 3):
            runner.tick("automatic")
            if not runner.active:
                break
            if rig.clock.now() < leave:
                runner.see_pages(1)
            rig.clock.forward(TICK)
        self.active = runner.active


def check_failure(last: Mission) -> None:
    """Fail unless the mission's end names a failed step below failed ones alone, with its words."""
    states = {step.path: step for step in last.steps}
    where, _, answer = last.text.partition(": ")
    path = "" if where == "The mission" else where.removeprefix("Step ").split(",")[0]
    assert (states[path].status, states[path].text) == ("failed", answer)
    while path:
        path = path.rpartition(".")[0]
        assert states[path].status == "failed"


def check_random_mission(steps: list[dict[str, Any]], seed: int) -> None:
    """Swim a mission of these steps. Fails where it does not end in its time, or leaves something behind."""
    text = mission(*map(write, steps), limits="time = 3600")
    swum = Swim(text, seed)
    last = swum.documents[-1]
    assert not swum.active
    assert last.phase in ("succeeded", "failed")
    assert "An error in the software" not in last.text
    assert last.elapsed <= swum.document.longest + ROUNDING
    assert not any(step.status == "running" for step in last.steps)
    progress = [document.progress for document in swum.documents]
    assert progress == sorted(progress)
    if last.phase == "failed":
        check_failure(last)
    assert len(swum.stops) == 1
    assert swum.core.parameters.values()[GAIN] == swum.before
    control = swum.core.control
    assert (control.depth.override, control.heading.override) == (None, None)
