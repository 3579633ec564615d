"""The table of faults: time to detection, action, and the text for the operator.

What the chip does by itself, and how each is tested, is in docs/reference/safety.md.
"""

from dataclasses import dataclass
from typing import Literal

from robot_runtime.contract.documents import Mode, Severity
from robot_runtime.control.alarms import FaultText, check_consequences

CHECK_PERIOD = 0.1
"""s between two checks at most."""

Action = Literal["all-stop", "neutral", "drop set points", "alarm only"]


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultRule(FaultText):
    """A fault of the robot; most are alarms that stop it. `limit`: s to detection at the default baud."""

    name: str
    limit: float
    severity: Severity = "alarm"
    action: Action = "all-stop"
    automatic_only: bool = False
    """True if it stops the robot only in automatic; elsewhere it raises an alarm only."""
    always: bool = False
    """True if it is also checked while the robot is disarmed."""

    def stops(self, mode: Mode) -> bool:
        """True if it stops the robot in this mode."""
        return self.action == "all-stop" and not (self.automatic_only and mode != "automatic")


_CABLE = "The board has no power or hangs, or a wire of the serial line is loose."
_SENSOR = "Check its cable and reset the board. Arm again when the depth on Operate changes."
_WITH_THE_BOARD = ("board_disarmed", "depth_stale", "imu_stale", "simulator_silent")
"""Without its telemetry the simulated water stands still, too."""
_WITH_THE_RUNTIME = (
    "pilot_quiet",
    "pilot_lost",
    "server_silent",
    "board_silent",
    "board_disarmed",
    "depth_stale",
    "imu_stale",
    "vision_stale",
)
"""Faults of what arrived while a runtime stalled, so that it seems to have been absent."""

FAULTS = (
    FaultRule(
        name="pilot_quiet",
        severity="caution",
        limit=0.5,
        action="neutral",
        what="No pilot input; the fins are stopped.",
        cause="The page is hidden or closed, the gamepad is off, or the network is slow.",
        remedy="Go back to the page and move the sticks, or switch to automatic.",
    ),
    FaultRule(
        name="pilot_lost",
        limit=3.0,
        what="No pilot input for 3 s.",
        cause="The page is hidden or closed, the gamepad is off, or the network is gone.",
        remedy="Check the network and the gamepad, then arm again.",
        consequences=("pilot_quiet",),
    ),
    FaultRule(
        name="server_silent",
        limit=5.0,
        what="The server sends no heartbeat; nobody could stop the robot.",
        cause="The server ended or hangs, or this computer is overloaded.",
        remedy="It restarts by itself. If this repeats, read its log.",
        consequences=("pilot_quiet", "pilot_lost"),
    ),
    FaultRule(
        name="board_silent",
        limit=1.0,
        what="The board sends nothing.",
        cause=_CABLE,
        remedy="The board stops the fins by itself. Check its power and cable.",
        consequences=_WITH_THE_BOARD,
    ),
    FaultRule(
        name="board_restarted",
        limit=1.0,
        what="The board restarted; it is disarmed.",
        cause="Its watchdog restarted a program that hung, or its supply voltage dropped.",
        remedy="The console shows the reason. Check the battery, then arm again.",
        consequences=("board_silent", *_WITH_THE_BOARD),
    ),
    FaultRule(
        name="board_disarmed",
        limit=1.0,
        what="The board disarmed itself.",
        cause="It received nothing valid from this computer for 1 s, or its battery is low.",
        remedy="The console shows the reason. Check the serial line and the load of this computer.",
    ),
    FaultRule(
        name="runtime_stalled",
        limit=1.0,
        what="The robot's software stalled for longer than the board waits.",
        cause="This computer is overloaded, or the process was suspended.",
        remedy="The board has stopped the fins by itself. Check the load of this computer, then arm again.",
        consequences=_WITH_THE_RUNTIME,
    ),
    FaultRule(
        name="depth_stale",
        limit=0.5,
        automatic_only=True,
        what="The depth is too old for control.",
        cause="The pressure sensor does not answer, or the serial line loses too many frames.",
        remedy=_SENSOR,
    ),
    FaultRule(
        name="depth_frozen",
        limit=0.5,
        automatic_only=True,
        what="The pressure reading is frozen.",
        cause="The pressure sensor hangs; in simulated water, the simulator has ended.",
        remedy=_SENSOR,
        consequences=("not_rising",),
    ),
    FaultRule(
        name="depth_range",
        limit=0.5,
        automatic_only=True,
        what="The depth is out of this robot's range.",
        cause="The pressure sensor is damaged, or the board was started under water.",
        remedy="Zero the depth at the surface, on the page System.",
    ),
    FaultRule(
        name="imu_stale",
        limit=0.2,
        what="The IMU sends nothing; a capsize would go unnoticed.",
        cause="The IMU hangs, or its wires on the I2C bus are loose.",
        remedy="Check its cable and reset the board.",
    ),
    FaultRule(
        name="imu_frozen",
        limit=0.5,
        what="The IMU repeats its reading; a capsize would go unnoticed.",
        cause="The IMU hangs; in simulated water, the simulator has ended.",
        remedy="Check its cable and reset the board.",
    ),
    FaultRule(
        name="capsized",
        limit=2.0,
        what="The robot lies on its side or on its back.",
        cause="Its trim is wrong, it is caught on something, or a fin fails.",
        remedy="Let it rise and take it out. Check trim and fins.",
    ),
    FaultRule(
        name="vision_stale",
        severity="caution",
        limit=1.0,
        action="drop set points",
        what="No picture from the camera for 1 s; its set point is dropped.",
        cause="The camera failed, or this computer is too slow for the chosen rate.",
        remedy="Check the camera on the Operate page, or lower its rate.",
    ),
    FaultRule(
        name="not_rising",
        limit=20.0,
        action="alarm only",
        always=True,
        what="The robot was stopped under water and does not rise.",
        cause="It is caught on something, has taken in water, or is trimmed too heavy.",
        remedy="Fetch it, or drive it up in manual.",
    ),
    FaultRule(
        name="battery_low",
        limit=20.5,
        always=True,
        what="The battery was below its alarm voltage for 20 s; the fins were slowed and stopped.",
        cause="The battery is empty or old.",
        remedy="Let the robot rise, and charge it.",
        consequences=("board_disarmed",),
    ),
    FaultRule(
        name="fin_failing",
        severity="caution",
        limit=0.5,
        action="alarm only",
        what="A fin does not follow.",
        cause="Its encoder or its H-bridge is loose, its motor's leads are swapped, or the fin is blocked.",
        remedy="STOP and inspect that fin, then run the fin check.",
    ),
    FaultRule(
        name="simulator_silent",
        limit=0.6,
        always=True,
        what="The simulator has been silent for 0.5 s; the board has no sensor readings.",
        cause="The simulator ended, or the network to it is down.",
        remedy="Check that it runs and that the network works.",
        consequences=("depth_stale", "depth_frozen", "imu_stale", "imu_frozen", "vision_stale"),
    ),
    FaultRule(
        name="control_failed",
        limit=0.1,
        what="The control loop failed.",
        cause="An error in the software.",
        remedy="Report it, with the runtime's log.",
    ),
)
BY_NAME = {one.name: one for one in FAULTS}
check_consequences(BY_NAME)
