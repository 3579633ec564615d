"""The table of faults: time to detection, action, and the text for the operator.

What the chip does by itself is in docs/reference/safety.md.
"""

from dataclasses import dataclass
from typing import Literal

from robot_runtime.contract.declarations import Declarations
from robot_runtime.contract.documents import Mode, Severity
from robot_runtime.control.alarms import FaultText, check_consequences

CHECK_PERIOD = 0.1
"""s between two checks at most."""

Action = Literal["all-stop", "neutral", "drop set points", "alarm only"]


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultRule(FaultText):
    """A fault of the robot; most are alarms that stop it. `limit`: s to detection at the default baud."""

    limit: float
    severity: Severity = "alarm"
    action: Action = "all-stop"
    automatic_only: bool = False
    """True if it stops the robot only in automatic; elsewhere it raises an alarm only."""
    always: bool = False
    """True if it is also checked while the robot is disarmed."""

    def stops(self, mode: Mode) -> bool:
        """Return True if it stops the robot in this mode."""
        return self.action == "all-stop" and not (self.automatic_only and mode != "automatic")


_CABLE = "The board has no power or hangs, or a wire of the serial line is loose."
_SENSOR = "Check its cable and reset the board. Arm again when the depth on Operate changes."
_WITH_THE_BOARD = ("board_disarmed", "depth_stale", "imu_stale", "simulator_silent")
"""Without its telemetry the simulated water stands still, too."""
_WITH_THE_RUNTIME = (
    "pilot_quiet",
    "pilot_lost",
    "server_silent",
    "unwatched",
    "board_silent",
    "board_disarmed",
    "depth_stale",
    "imu_stale",
    "vision_stale",
)
"""Faults of what arrived while a runtime stalled, so that it seems to have been absent."""

ROBOT_FAULTS: Declarations[str, FaultRule] = Declarations("the name of a fault of the robot")
ROBOT_FAULTS["pilot_quiet"] = FaultRule(
    severity="caution",
    limit=0.5,
    action="neutral",
    what="No page sends pilot input; the fins are stopped.",
    cause="The page is hidden or closed, or the network is slow. A page sends its sticks also at rest.",
    remedy="Go back to the page and move the sticks, or switch to automatic.",
)
ROBOT_FAULTS["pilot_lost"] = FaultRule(
    limit=3.0,
    what="No page has sent pilot input for 3 s.",
    cause="The page is hidden or closed, or the network is gone. A page sends its sticks also at rest.",
    remedy="Check the page and the network, then arm again.",
    consequences=("pilot_quiet",),
)
ROBOT_FAULTS["server_silent"] = FaultRule(
    limit=5.0,
    what="The server sends no heartbeat; nobody could stop the robot.",
    cause="The server ended or hangs, or this computer is overloaded.",
    remedy="It restarts by itself. If this repeats, read its log.",
    consequences=("pilot_quiet", "pilot_lost", "unwatched"),
)
ROBOT_FAULTS["unwatched"] = FaultRule(
    limit=30.0,
    what="Nobody watches the robot.",
    cause="Every operator's page is closed or out of reach, as under water, and no program has control.",
    remedy="Open the page and arm again. A longer time without a page is chosen at the arming.",
)
ROBOT_FAULTS["board_silent"] = FaultRule(
    limit=1.0,
    what="The board sends nothing.",
    cause=_CABLE,
    remedy="The board stops the fins by itself. Check its power and cable.",
    consequences=_WITH_THE_BOARD,
)
ROBOT_FAULTS["board_restarted"] = FaultRule(
    limit=1.0,
    what="The board restarted; it is disarmed.",
    cause="Its watchdog restarted a program that hung, or its supply voltage dropped.",
    remedy="The console shows the reason. Check the battery, then arm again.",
    consequences=("board_silent", *_WITH_THE_BOARD),
)
ROBOT_FAULTS["board_disarmed"] = FaultRule(
    limit=1.0,
    what="The board disarmed itself.",
    cause="It received nothing valid from this computer for 1 s.",
    remedy="The console shows the reason. Check the serial line and the load of this computer.",
)
ROBOT_FAULTS["runtime_stalled"] = FaultRule(
    limit=1.0,
    what="The robot's software stalled for longer than the board waits.",
    cause="This computer is overloaded, or the process was suspended.",
    remedy="The board has stopped the fins by itself. Check the load of this computer, then arm again.",
    consequences=_WITH_THE_RUNTIME,
)
ROBOT_FAULTS["depth_stale"] = FaultRule(
    limit=0.5,
    automatic_only=True,
    what="The depth is too old for control.",
    cause="The pressure sensor does not answer, or the serial line loses too many frames.",
    remedy=_SENSOR,
)
ROBOT_FAULTS["depth_frozen"] = FaultRule(
    limit=0.5,
    automatic_only=True,
    what="The pressure reading is frozen.",
    cause="The pressure sensor hangs; in simulated water, the simulator has ended.",
    remedy=_SENSOR,
    consequences=("not_rising",),
)
ROBOT_FAULTS["depth_range"] = FaultRule(
    limit=0.5,
    automatic_only=True,
    what="The depth is out of this robot's range.",
    cause="The pressure sensor is damaged, or the board was started under water.",
    remedy="Zero the depth at the surface, on the page System.",
)
ROBOT_FAULTS["too_deep"] = FaultRule(
    limit=0.5,
    what="The robot is deeper than it may be.",
    cause="It is trimmed too heavy, has taken in water, or a current takes it down.",
    remedy="Let it rise and take it out. Check trim, seals, and [control] deepest in robot.toml.",
)
ROBOT_FAULTS["imu_stale"] = FaultRule(
    limit=0.2,
    what="The IMU sends nothing; a capsize would go unnoticed.",
    cause="The IMU hangs, or its wires on the I2C bus are loose.",
    remedy="Check its cable and reset the board.",
)
ROBOT_FAULTS["imu_frozen"] = FaultRule(
    limit=0.5,
    what="The IMU repeats its reading; a capsize would go unnoticed.",
    cause="The IMU hangs; in simulated water, the simulator has ended.",
    remedy="Check its cable and reset the board.",
)
ROBOT_FAULTS["capsized"] = FaultRule(
    limit=2.0,
    what="The robot lies on its side or on its back.",
    cause="Its trim is wrong, it is caught on something, or a fin fails.",
    remedy="Let it rise and take it out. Check trim and fins.",
)
ROBOT_FAULTS["vision_stale"] = FaultRule(
    severity="caution",
    limit=1.0,
    action="drop set points",
    what="No picture from the camera for 1 s; its set point is dropped.",
    cause="The camera failed, or this computer is too slow for the chosen rate.",
    remedy="Check the camera on the Operate page, or lower its rate.",
)
ROBOT_FAULTS["not_rising"] = FaultRule(
    limit=20.0,
    action="alarm only",
    always=True,
    what="The robot was stopped under water and does not rise.",
    cause="It is caught on something, has taken in water, or is trimmed too heavy.",
    remedy="Fetch it, or drive it up in manual.",
)
ROBOT_FAULTS["battery_low"] = FaultRule(
    limit=20.5,
    always=True,
    what="The battery was below its alarm voltage for 20 s; the fins were slowed and stopped.",
    cause="The battery is empty or old.",
    remedy="Let the robot rise, and charge it.",
)
ROBOT_FAULTS["leak"] = FaultRule(
    limit=0.5,
    always=True,
    what="There is water in the hull; the board stopped the fins.",
    cause="A seal leaks, or the leak sensor's wires touch.",
    remedy="Fetch the robot at once, switch it off, dry it and find the leak.",
)
ROBOT_FAULTS["memory_low"] = FaultRule(
    limit=0.5,
    always=True,
    what="The board's memory is nearly full.",
    cause="Its program has variables that leave too little memory for its stack.",
    remedy="Let the robot rise. Upload firmware that `make firmware` built: it checks the memory.",
)
ROBOT_FAULTS["fin_failing"] = FaultRule(
    severity="caution",
    limit=0.5,
    action="alarm only",
    what="A fin does not follow.",
    cause="Its encoder or its H-bridge is loose, its motor's leads are swapped, "
    "or the fin is blocked or too stiff.",
    remedy="STOP and inspect that fin: by hand it turns easily. Then run the fin check.",
)
ROBOT_FAULTS["simulator_silent"] = FaultRule(
    limit=0.6,
    always=True,
    what="The simulator has been silent for 0.5 s; the board has no sensor readings.",
    cause="The simulator ended, or the network to it is down.",
    remedy="Check that it runs and that the network works.",
    consequences=("depth_stale", "depth_frozen", "imu_stale", "imu_frozen", "vision_stale"),
)
ROBOT_FAULTS["control_failed"] = FaultRule(
    limit=0.1,
    what="The control loop failed.",
    cause="An error in the software.",
    remedy="Report it, with the runtime's log.",
)
check_consequences(ROBOT_FAULTS)
