"""`python -m tests.proofs.missions [MISSIONS]`: ends each leaf in each way; status 1 if one fails.

The firmware on the emulated chip, the whole runtime and the water, in simulated time. Then lanes by dead
reckoning, and so many random missions, with readings that jump; a share of them swims.
"""

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from robot_runtime.commands import Commands
from robot_runtime.contract.commands import MissionCommand
from robot_runtime.contract.documents import Mission
from robot_runtime.contract.topics import MISSION
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.run import PRELUDE, RunLoop
from robot_runtime.experiments.scenario.simulated_robot import SimulatedRobot
from robot_runtime.simulation.boards.emulator_process import Water
from robot_runtime.simulation.boards.stepped_board import PERIOD, SteppedBoard
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion
from tests.proofs.lanes import prove_lanes
from tests.proofs.pool import processes
from tests.proofs.watching import WatchedMotions
from tests.runtime.control.flight import Flight
from tests.runtime.experiments.scenario.staging import Output
from tests.runtime.missions.random_missions import STEPS, check_random_mission, write
from tests.runtime.missions.water import mission

HEARTBEAT = 4.0
"""s, as the server has the runtime started."""
REST, OFF = 0.6, 1.1
"""s after which the fins rest, and after which the motors have no power; the chip alone needs no longer."""
TICKS = 0.35
"""s until the next tick of the control loop has been seen."""
LEAF_FOR = 1.5
"""s of the leaf before it is ended."""
CALM = 60.0
"""s within which all is well."""
SETS = (
    "{ do = 'set', parameter = 'depth.pid.kp', value = 4.5 }",
    "{ do = 'set', parameter = 'fins.gain', value = 0.5 }",
)
"""Of the runtime, and of the board."""
ARRIVE = "{ do = 'dive', depth = 0.6, within = 1.0, timeout = 30 }"
TURN = "{ do = 'turn', by = 1.0, within = 3.0, timeout = 20 }"
LEAF = "5"
"""The place of the tested leaf, or of the branch that repeats it, as it takes only a tick."""
LEAVES = {
    "wait_for": "{ do = 'wait_for', sees = 'red', timeout = 60 }",
    "is": "{ do = 'while_true', steps = ["
    "{ do = 'is', above = 9 }, { do = 'hold', seconds = 60, within = 9 }] }",
    "set": "{ do = 'repeat', times = 300, steps = ["
    "{ do = 'set', parameter = 'fins.gain', value = 0.6 }, "
    "{ do = 'set', parameter = 'fins.gain', value = 0.5 }] }",
    "mark": "{ do = 'repeat', times = 1000, steps = [{ do = 'mark', text = 'here' }] }",
    "dive": "{ do = 'dive', depth = 1.4, within = 0.01, timeout = 60 }",
    "hold": "{ do = 'hold', seconds = 60, within = 9 }",
    "turn": "{ do = 'turn', by = 3.0, within = 0.02, timeout = 60 }",
    "swim": "{ do = 'swim', x = 0.5, seconds = 60 }",
    "go": "{ do = 'go', distance = 50, heading = 1.0, timeout = 60 }",
    "to_light": "{ do = 'to_light', timeout = 60, lost = 60 }",
    "wait": "{ do = 'wait', seconds = 60 }",
    "count_down": "{ do = 'repeat', times = 3, steps = [{ do = 'count_down', seconds = 20 }] }",
    # Under water it is over at once; it rises meanwhile, and then waits.
    "wait_until_wet": "{ do = 'repeat', times = 50, steps = [{ do = 'wait_until_wet', timeout = 60 }] }",
    # Its end falls together with what else would end it.
    "surface": "{ do = 'hold', seconds = 1.5, within = 9 }, { do = 'surface' }",
}
SEEDS = 20
"""Of the lanes by dead reckoning."""
LIMITS = "depth = 2.0\ntime = 3400\nbattery = 7.0"


class MissionSwim(Flight):
    """A flight with a mission; the fins are looked at every `PERIOD`."""

    def __init__(self, board: str = "host") -> None:
        self.moved = self.powered = -inf
        """s; when the fins moved last, and when the motors had power last."""
        self._readings = 0
        self._motion = WatchedMotions()
        self.missions: list[Mission] = []
        super().__init__(partial(self._make, board))
        self.supervisor._heartbeat = HEARTBEAT
        self.robot.bus.on_document(MISSION, self._see_mission)
        self.until(lambda: not self.supervisor.refusals(), CALM)
        self.before = self.settings()

    @property
    def mission(self) -> Mission:
        """The newest document."""
        return self.missions[-1]

    def begin(self, text: str) -> None:
        """Arm the robot and begin a mission."""
        arming = Commands(self.robot).begin_mission(MissionCommand(text=text, library={}))
        while not arming.over:
            self.run(0.1)
            self.supervisor.continue_arming()
        assert arming.refusal == ""

    def status(self, path: str) -> str:
        """Return the status of a step."""
        steps = self.mission.steps if self.missions else []
        return next((step.status for step in steps if step.path == path), "")

    def settings(self) -> dict[str, Any]:
        """Return everything that a mission may change: parameters, set points, course."""
        control = self.robot.control
        points = {name: loop.set_point_in_force for name, loop in control.loops.items()}
        return self.robot.parameters.values() | {
            "set points": points,
            "defaults": (control.set_point_default, control.set_point_detected),
            "steering": control.steering,
            "overrides": [loop.override for loop in control.loops.values()],
            "course": control._course_override,
        }

    def coast(self, seconds: float) -> None:
        """The board and the water go on, and nobody hears it."""
        self.stage.run(round(seconds / PERIOD))

    def restart_runtime(self) -> None:
        """A new runtime on the same board."""
        stage = self.stage
        scenario = replace(stage.scenario, seed=stage.scenario.seed + 1)
        self.robot = stage.robot = SimulatedRobot(scenario, stage.clock, lambda _: None, stage._open_camera)
        self.supervisor = self.robot.supervisor
        self.robot.link.attach(stage.board.write)
        self.robot.bus.on_document(MISSION, self._see_mission)
        self._performance = RunLoop(stage, Output(), lambda: False)

    def _see_mission(self, document: object) -> None:
        assert isinstance(document, Mission)
        self.missions.append(document)

    def _make(self, board: str, water: Water) -> SteppedBoard:
        def feel(fins: FinMotion) -> Reading:
            self._readings += 1
            now = self._readings * PERIOD - PRELUDE
            if self._motion.see(now, fins):
                self.moved = now
            if fins.powered:
                self.powered = now
            return water(fins)

        return boards()[board](feel)


@dataclass(frozen=True, kw_only=True)
class Cause:
    """Something that ends a mission: what is done, and the phase and words of the end within `limit` s."""

    name: str
    do: Callable[[MissionSwim], None]
    phase: str = "ended"
    words: str = "The robot was stopped for a fault"
    limit: float
    mend: Callable[[MissionSwim], None] = lambda _: None


def _no_server(swim: MissionSwim) -> None:
    swim.server = False


def _server(swim: MissionSwim) -> None:
    swim.server = True


CAUSES = (
    Cause(name="stop", do=lambda swim: swim.command("stop"), words="The robot was stopped.", limit=TICKS),
    Cause(name="server killed", do=_no_server, mend=_server, limit=HEARTBEAT + TICKS),
    Cause(
        name="line cut",
        do=lambda swim: swim.cut(on=True),
        mend=lambda swim: swim.cut(on=False),
        limit=1.0 + TICKS,
    ),
    Cause(
        name="pressure sensor fails",
        do=lambda swim: swim.break_("pressure", "bus"),
        mend=lambda swim: swim.break_("pressure", "none"),
        limit=0.7 + TICKS,
    ),
    Cause(
        name="inertial sensor fails",
        do=lambda swim: swim.break_("gyroscope", "bus"),
        mend=lambda swim: swim.break_("gyroscope", "none"),
        limit=0.7 + TICKS,
    ),
    Cause(
        name="battery low",
        do=lambda swim: swim.break_("battery", "drift", speed=-1.0),
        mend=lambda swim: swim.break_("battery", "none"),
        phase="failed",
        words="its limit is 7 V",
        limit=6.0,
    ),
)
BY_HAND, RUNTIME = "take-over", "runtime killed"
NAMES = (*(cause.name for cause in CAUSES), BY_HAND, RUNTIME)


def perform(leaf: str, cause: str, board: str = "host") -> list[str]:
    """End a leaf in this way. Return the broken promises."""
    with MissionSwim(board) as swim:
        swim.begin(mission(*SETS, ARRIVE, TURN, LEAVES[leaf], limits=LIMITS))
        swim.until(lambda: swim.status(LEAF) == "running", CALM)
        swim.run(LEAF_FOR)
        if swim.robot.parameters.values()["fins.gain"] == swim.before["fins.gain"]:
            return ["the mission set nothing"]
        if cause == BY_HAND:
            problems = _take_over(swim, leaf)
        elif cause == RUNTIME:
            problems = _kill_runtime(swim)
        else:
            problems = _end(swim, next(item for item in CAUSES if item.name == cause), leaf)
    return [f"{leaf}, {cause}: {problem}" for problem in problems]


def _end(swim: MissionSwim, cause: Cause, leaf: str) -> list[str]:
    began = swim.now
    cause.do(swim)
    swim.until(lambda: not swim.robot.missions.active, cause.limit)
    ended, last = swim.now, swim.mission
    problems = []
    own = leaf == "surface" and (last.phase, last.text) == ("succeeded", "It is done.")
    if not own and (last.phase != cause.phase or cause.words not in last.text):
        problems.append(f"it {last.phase}: {last.text}")
    swim.run(OFF + TICKS)
    problems += _find_motion(swim, began if cause.name == "line cut" else ended, ended)
    cause.mend(swim)
    return problems + _find_remains(swim)


def _take_over(swim: MissionSwim, leaf: str) -> list[str]:
    over = leaf == "surface" and not swim.robot.missions.active
    swim.sticks = [0.0] * 6
    try:
        swim.command("mode", mode="manual")
    except RefusedError:
        return [] if over else ["it could not be taken over"]
    swim.run(1.0)
    problems, first = [], swim.mission
    if first.phase != "paused":
        # It came up in the tick before.
        return _find_remains(swim) if leaf == "surface" else [f"it is {first.phase}: {first.text}"]
    swim.run(1.5)
    paused = swim.mission
    if paused.elapsed != first.elapsed or paused.paused <= first.paused:
        problems.append("its clock does not stand still")
    if swim.settings()["overrides"] != swim.before["overrides"]:
        problems.append("it holds what somebody steers by hand")
    swim.sticks = None
    swim.command("mode", mode="automatic")
    swim.run(1.0)
    if leaf != "surface" and (swim.mission.phase, swim.status(LEAF)) != ("running", "running"):
        problems.append(f"handed back, it is {swim.mission.phase}: {swim.mission.text}")
    if swim.mission.elapsed <= paused.elapsed:
        problems.append("handed back, its clock stands still")
    if swim.robot.missions.active:
        swim.command("mission_end")
        swim.until(lambda: not swim.robot.missions.active, TICKS)
    ended = swim.now
    if leaf != "surface" and (swim.mission.phase, swim.mission.text) != ("ended", "An operator ended it."):
        problems.append(f"it {swim.mission.phase}: {swim.mission.text}")
    swim.run(OFF + TICKS)
    return problems + _find_motion(swim, ended, ended) + _find_remains(swim)


def _kill_runtime(swim: MissionSwim) -> list[str]:
    began, count = swim.now, len(swim.missions)
    swim.coast(OFF + TICKS)
    problems = _find_motion(swim, began, began)
    swim.restart_runtime()
    swim.until(lambda: not swim.supervisor.refusals(), CALM)
    swim.run(1.0)
    if len(swim.missions) != count or swim.robot.missions.active:
        problems.append("the new runtime goes on with it")
    return problems + _find_remains(swim)


def _find_motion(swim: MissionSwim, began: float, ended: float) -> list[str]:
    """Return the promises about fins and motors that are broken; `began`: when they had to rest from, s."""
    problems = []
    if swim.moved > began + REST:
        problems.append(f"the fins moved {swim.moved - began:.2f} s later")
    if swim.powered > began + OFF:
        problems.append(f"the motors had power {swim.powered - began:.2f} s later")
    if any(time > ended + TICKS for time, _ in swim.sent):
        problems.append("the fins were commanded afterwards")
    return problems


def _find_remains(swim: MissionSwim) -> list[str]:
    """Remains of the mission, once all is well again."""
    swim.sticks = None
    swim.until(lambda: not any(alarm.active for alarm in swim.supervisor.alarms), CALM)
    swim.until(lambda: not swim.robot.parameters.is_pending("fins.gain"), CALM)
    count = len(swim.missions)
    swim.run(1.5)
    problems = [
        f"{name} is {value}, and was {swim.before[name]}"
        for name, value in swim.settings().items()
        if value != swim.before[name]
    ]
    if any(step.status == "running" for step in swim.mission.steps) and swim.mission.phase != "running":
        problems.append("a step still runs")
    if swim.robot.missions.active or len(swim.missions) != count:
        problems.append("it goes on")
    if swim.supervisor.armed:
        problems.append("the robot is armed")
    return problems


def perform_all(
    pairs: Sequence[tuple[str, str]], board: str, workers: int = 2
) -> dict[tuple[str, str], list[str]]:
    """Perform these pairs of leaf and cause, some in parallel."""
    with processes(workers) as pool:
        running = {pair: pool.submit(perform, *pair, board) for pair in pairs}
        return {pair: run.result() for pair, run in running.items()}


def swim_random(steps: list[dict[str, Any]]) -> None:
    """A random mission with firmware and water. Fails where it does not end in its time and at rest."""
    text = mission(*map(write, steps), limits="time = 3600")
    with MissionSwim() as swim:
        swim.begin(text)
        swim.run(TICKS)
        longest = swim.mission.remaining
        swim.until(lambda: not swim.robot.missions.active, longest + 2.0)
        assert swim.mission.phase in ("succeeded", "failed"), swim.mission.text
        assert "An error in the software" not in swim.mission.text
        ended = swim.now
        swim.run(OFF + TICKS)
        assert _find_motion(swim, ended, ended) + _find_remains(swim) == []


def main() -> int:
    """Exit status."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    pairs = [(leaf, cause) for leaf in LEAVES for cause in NAMES]
    print(f"{len(LEAVES)} leaves, each ended in {len(NAMES)} ways, on the emulated chip ...", flush=True)
    problems = [problem for result in perform_all(pairs, "emulated").values() for problem in result]
    print("\n".join(problems) or "Every promise holds.", flush=True)
    swum = max(count // 20, 1)
    print(f"Lanes by dead reckoning over {SEEDS} seeds ...", flush=True)
    missed = prove_lanes(SEEDS)
    print("\n".join(missed) or "They lie as planned.", flush=True)
    print(f"{count} random missions with readings that jump, {swum} in the water ...", flush=True)
    some = st.lists(STEPS, min_size=1, max_size=4)
    lasting = settings(database=None, deadline=None, suppress_health_check=list(HealthCheck))
    settings(lasting, max_examples=count)(given(some, st.integers(0, 99))(check_random_mission))()
    settings(lasting, max_examples=swum)(given(some)(swim_random))()
    print("All end in their time, and take everything back.")
    return 1 if problems or missed else 0


if __name__ == "__main__":
    sys.exit(main())
