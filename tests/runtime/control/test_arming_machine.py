"""Arming under commands, faults, silences and restarts in any order."""

from typing import Any

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from robot_runtime.contract.documents import Mode
from robot_runtime.contract.packets import Start, StatusFlag, Stop
from robot_runtime.control.transitions import ARMED, TRANSITIONS
from robot_runtime.errors import RefusedError
from tests.runtime.control.supervisor_rig import SupervisorRig

HEARTBEAT = 4.0
LOOK = 0.1
ALL_STOP = 0.6
"""s within which a lost depth, seen at the slowest look, ends control by depth."""
_WAYS = {(transition.before, transition.after) for transition in TRANSITIONS}


class ArmingMachine(RuleBasedStateMachine):
    """One supervisor, with a board that executes commands or not; its states are compared with a model."""

    def __init__(self) -> None:
        super().__init__()
        self.rig = SupervisorRig(heartbeat=HEARTBEAT)
        self.supervisor, self.board = self.rig.supervisor, self.rig.board
        self.depth = self.imu = self.server = self.pilot = self.speaks = True
        self.frozen = False
        self.without = {"depth": 0.0, "imu": 0.0, "server": 0.0, "pilot": 0.0, "board": 0.0}
        self.acknowledged = True
        self.alone = 0.0
        self.mode: Mode = "disarmed"
        self._live(LOOK)

    def _live(self, seconds: float) -> None:
        end = self.rig.clock.now() + seconds
        while self.rig.clock.now() < end:
            self.rig.clock.forward(0.05)
            detector = self.supervisor.detector
            if self.speaks:
                self.rig.report()
                if self.depth and self.imu:
                    self.rig.sense(frozen=self.frozen)
                elif self.depth:
                    self.rig.sense_depth(frozen=self.frozen)
                elif self.imu:
                    self.rig.sense_attitude()
            if self.server:
                detector.see_server(watched=True)
            if self.pilot:
                self.supervisor.pilot.taken = self.rig.clock.now()
            self._age(0.05)
            self._look()
            self.supervisor.continue_arming()
            self._look()
            self.supervisor.tick()
            self._look()

    def _age(self, seconds: float) -> None:
        lives = {
            "depth": self.depth and self.speaks and not self.frozen,
            "imu": self.imu or not self.speaks,
            "server": self.server,
            "pilot": self.pilot or self.supervisor.mode != "manual",
            "board": self.speaks and self.board.connected,
        }
        for name, alive in lives.items():
            self.without[name] = 0.0 if alive else self.without[name] + seconds

    def _look(self) -> None:
        """Check that each change of state is in the table, and none bypasses the acknowledgement."""
        now = self.supervisor.mode
        if now != self.mode:
            assert (self.mode, now) in _WAYS
            if now == "failsafe":
                self.acknowledged = False
            if now in ARMED:
                assert self.acknowledged
            self.mode = now

    @rule(mode=st.sampled_from(["automatic", "manual", "test"]), alone=st.sampled_from([0.0, 8.0]))
    def arm(self, mode: Any, alone: float) -> None:
        """Request arming; a refusal is possible."""
        reasons, armed = self.supervisor.refusals(), self.supervisor.armed
        before = sum(isinstance(packet, Start) for packet in self.board.sent)
        try:
            self.supervisor.begin_arming(mode, alone)
        except RefusedError:
            assert sum(isinstance(packet, Start) for packet in self.board.sent) == before
        else:
            assert armed or not reasons
            self.alone = self.alone if armed else alone
        self._live(0.2)

    @rule(mode=st.sampled_from(["automatic", "manual"]))
    def change(self, mode: Any) -> None:
        """Switch between automatic and manual, where possible."""
        armed = self.supervisor.mode in ("automatic", "manual")
        try:
            self.supervisor.change_mode(mode)
        except RefusedError:
            return
        assert armed
        self._look()

    @rule()
    def stop(self) -> None:
        """Stop: it ends every state at once, and STOP is sent each time."""
        failsafe = self.supervisor.mode == "failsafe"
        sent = len(self.board.sent)
        self.supervisor.stop("Stopped.")
        assert self.supervisor.mode == ("failsafe" if failsafe else "disarmed")
        assert any(isinstance(packet, Stop) for packet in self.board.sent[sent:])
        self._look()

    @rule()
    def acknowledge(self) -> None:
        """Acknowledge: the only way out of failsafe."""
        armed = self.supervisor.armed
        self.supervisor.acknowledge()
        assert self.supervisor.mode != "failsafe"
        assert self.supervisor.armed == armed
        self.acknowledged = True
        self._look()

    @rule(seconds=st.sampled_from([0.05, 0.3, 0.6, 2.0, 5.0]))
    def pass_time(self, seconds: float) -> None:
        """Pass time without a change."""
        self._live(seconds)

    @rule(what=st.sampled_from(["depth", "imu", "server", "pilot", "speaks"]))
    def fall_silent(self, what: str) -> None:
        """Silence a source of data from now on."""
        setattr(self, what, False)

    @rule()
    def freeze(self) -> None:
        """Freeze the pressure sensor."""
        self.frozen = True

    @rule()
    def unplug(self) -> None:
        """Cut the cable."""
        self.board.connected = False

    @rule(obeys=st.booleans())
    def will(self, obeys: bool) -> None:
        """Set the board's reaction to START."""
        self.board.obeys = obeys

    @rule()
    def mend(self) -> None:
        """Repair everything, and wait until that is detected."""
        self.depth = self.imu = self.server = self.pilot = self.speaks = True
        self.board.connected = self.board.obeys = True
        self.frozen = False
        self._live(0.2)

    @rule(mode=st.sampled_from(["automatic", "manual", "test"]))
    def begin_well(self, mode: Any) -> None:
        """Arm from any state, which random steps seldom reach."""
        self.mend()
        self.acknowledge()
        self.supervisor.stop("Stopped.")
        self.arm(mode, 0.0)
        assert self.supervisor.mode == mode

    @rule(
        mode=st.sampled_from(["automatic", "manual", "test"]),
        what=st.sampled_from(["depth", "imu", "server", "pilot", "speaks"]),
        seconds=st.floats(0.1, 6.0),
    )
    def lose_one_thing_under_way(self, mode: Any, what: str, seconds: float) -> None:
        """Silence one source of data while armed, with all else well."""
        self.begin_well(mode)
        self.fall_silent(what)
        self._live(seconds)

    @rule()
    def restart(self) -> None:
        """Restart the board, as by its watchdog."""
        self.board.epoch += 1
        self.board.flags &= ~StatusFlag.ARMED

    @rule()
    def disarm_by_itself(self) -> None:
        """Disarm the board, as after silence of the host."""
        self.board.flags &= ~StatusFlag.ARMED

    @invariant()
    def never_armed_with_an_open_failsafe(self) -> None:
        """A failsafe that is not acknowledged prevents arming."""
        assert self.acknowledged or not self.supervisor.armed
        assert (self.supervisor.armed_since is not None) == self.supervisor.armed

    @invariant()
    def limits_hold(self) -> None:
        """No state that steers outlasts the limits of its inputs."""
        mode = self.supervisor.mode
        if mode == "automatic":
            assert self.without["depth"] <= ALL_STOP
        if mode in ARMED:
            assert self.without["imu"] <= 0.3 + LOOK
            assert self.without["board"] <= 1.0 + LOOK
            assert self.without["server"] <= max(HEARTBEAT, self.alone) + 2 * LOOK
        if mode == "manual":
            assert self.without["pilot"] <= 3.0 + LOOK

    @invariant()
    def an_all_stop_is_an_alarm(self) -> None:
        """In failsafe there is an alarm."""
        if self.supervisor.mode == "failsafe":
            assert any(alarm.severity == "alarm" for alarm in self.supervisor.alarms)


TestArming = ArmingMachine.TestCase
TestArming.settings = settings(
    max_examples=100, stateful_step_count=30, deadline=None, suppress_health_check=list(HealthCheck)
)
