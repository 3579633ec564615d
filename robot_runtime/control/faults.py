"""The table of faults: time to detection, action, and the text for the operator.

What the chip does by itself, and how each is tested, is in docs/reference/safety.md.
"""

from dataclasses import dataclass
from typing import Literal

from robot_runtime.contract.documents import Mode
from robot_runtime.control.alarms import FaultText

LOOK = 0.1
"""s between two checks at most."""

Action = Literal["all-stop", "neutral", "drop set points", "alarm only"]


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultRule(FaultText):
    """One row of the table; `limit` is the s within which it is noticed, on a line of full speed."""

    name: str
    limit: float
    action: Action
    steered_by: bool = False
    """True if only depth control needs it: in manual and in the fin check it raises an alarm only."""
    always: bool = False
    """True if it is checked while the robot is disarmed, too."""

    def stops(self, mode: Mode) -> bool:
        """True if the robot is stopped for it in this mode."""
        return self.action == "all-stop" and not (self.steered_by and mode != "automatic")


_CABLE = "The board lost its power, hangs, or a wire of the serial line is loose."
_SENSOR = "Look at its cable; reset the board. Arm again once Operate shows a depth that moves."

FAULTS = (
    FaultRule(
        name="pilot_quiet",
        severity="caution",
        limit=0.5,
        action="neutral",
        what="No pilot input; the fins rest.",
        cause="The page is hidden or closed, the gamepad is off, or the network is slow.",
        remedy="Go back to the page and move the sticks, or switch to automatic.",
    ),
    FaultRule(
        name="pilot_lost",
        severity="alarm",
        limit=3.0,
        action="all-stop",
        what="No pilot input for 3 s.",
        cause="The page is hidden or closed, the gamepad is off, or the network is gone.",
        remedy="Look at the network and the gamepad, then arm again.",
    ),
    FaultRule(
        name="server_silent",
        severity="alarm",
        limit=5.0,
        action="all-stop",
        what="The server fell silent; nobody could have stopped the robot.",
        cause="The server ended or hangs, or this computer is overloaded.",
        remedy="It is started again by itself. Look at its log if that repeats.",
    ),
    FaultRule(
        name="board_silent",
        severity="alarm",
        limit=1.0,
        action="all-stop",
        what="The board fell silent.",
        cause=_CABLE,
        remedy="The board stops the fins by itself. Look at power and cable.",
    ),
    FaultRule(
        name="board_restarted",
        severity="alarm",
        limit=1.0,
        action="all-stop",
        what="The board restarted by itself; it is disarmed.",
        cause="Its watchdog ended a main loop that hung, or its supply broke down.",
        remedy="The console says why it started. Look at the battery; then arm again.",
    ),
    FaultRule(
        name="board_disarmed",
        severity="alarm",
        limit=1.0,
        action="all-stop",
        what="The board disarmed itself.",
        cause="It heard nothing valid of this computer for 1 s, or its battery is low.",
        remedy="The console says why. Look at the serial line and the load of this computer.",
    ),
    FaultRule(
        name="runtime_stalled",
        severity="alarm",
        limit=1.0,
        action="all-stop",
        what="The robot's software stood still for longer than the board waits.",
        cause="This computer is overloaded, or somebody suspended the process.",
        remedy="The board had stopped the fins by itself. Look at the load of this computer; then arm again.",
    ),
    FaultRule(
        name="depth_stale",
        severity="alarm",
        limit=0.5,
        action="all-stop",
        steered_by=True,
        what="The depth is too old to steer by.",
        cause="The pressure sensor does not answer, or the serial line loses too much.",
        remedy=_SENSOR,
    ),
    FaultRule(
        name="depth_frozen",
        severity="alarm",
        limit=0.5,
        action="all-stop",
        steered_by=True,
        what="The pressure does not change by a single count, as if the sensor were frozen.",
        cause="The pressure sensor hangs; in simulated water: the simulator ended.",
        remedy=_SENSOR,
    ),
    FaultRule(
        name="depth_range",
        severity="alarm",
        limit=0.5,
        action="all-stop",
        steered_by=True,
        what="The depth is not where this robot can be.",
        cause="The pressure sensor is damaged, or the board was started under water.",
        remedy="Switch the board off and on at the surface, so that it learns the surface anew.",
    ),
    FaultRule(
        name="imu_stale",
        severity="alarm",
        limit=0.2,
        action="all-stop",
        what="The IMU says nothing; nobody would notice that the robot turns over.",
        cause="It hangs, or its wires on the I2C bus are loose.",
        remedy="Look at its cable; reset the board.",
    ),
    FaultRule(
        name="capsized",
        severity="alarm",
        limit=2.0,
        action="all-stop",
        what="The robot lies on its side or on its back.",
        cause="Its trim is wrong, it holds on to something, or a fin fails.",
        remedy="Let it rise and take it out. Look at trim and fins.",
    ),
    FaultRule(
        name="vision_stale",
        severity="caution",
        limit=1.0,
        action="drop set points",
        what="The camera has shown nothing for 1 s; its set point no longer counts.",
        cause="The camera failed, or this computer is too slow for the chosen rate.",
        remedy="Look at the camera on the Operate page; lower its rate.",
    ),
    FaultRule(
        name="not_rising",
        severity="alarm",
        limit=20.0,
        action="alarm only",
        always=True,
        what="The robot was stopped under water and does not rise.",
        cause="It holds on to something, took in water, or is trimmed too heavy.",
        remedy="Fetch it, or drive it up by hand.",
    ),
    FaultRule(
        name="battery_low",
        severity="alarm",
        limit=20.5,
        action="all-stop",
        always=True,
        what="The battery was below 6.20 V for 20 s; the fins were turned down and stopped.",
        cause="It is empty, or old.",
        remedy="Let the robot rise, and charge it.",
    ),
    FaultRule(
        name="fin_failing",
        severity="caution",
        limit=0.5,
        action="alarm only",
        what="A fin gives no sensible answer; it is not driven.",
        cause="Its encoder or its H-bridge is loose, or the fin is blocked.",
        remedy="STOP, and look at that fin; then check the fins.",
    ),
    FaultRule(
        name="simulator_silent",
        severity="alarm",
        limit=0.6,
        action="all-stop",
        always=True,
        what="The simulator has been silent for 0.5 s; without it the board feels nothing.",
        cause="It ended, or the network between is down.",
        remedy="Look whether it runs and whether the network between is well.",
    ),
    FaultRule(
        name="control_failed",
        severity="alarm",
        limit=0.1,
        action="all-stop",
        what="The control loop failed.",
        cause="An error in the software.",
        remedy="The runtime's log says more; report it.",
    ),
)
BY_NAME = {one.name: one for one in FAULTS}
