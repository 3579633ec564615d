"""Faults of the processes around the robot that the server detects."""

from robot_runtime.contract.declarations import Declarations
from robot_runtime.control.alarms import FaultText, check_consequences
from robot_runtime.control.faults import ROBOT_FAULTS

_PART = "It crashed, was killed, or the computer ran out of memory."
_LOGS = "It is started again by itself. Where that goes on, the System page and its log say more."
_WITHOUT_WATER = ROBOT_FAULTS["simulator_silent"].consequences
SERVER_FAULTS: Declarations[str, FaultText] = Declarations("the name of a fault that the server detects")
SERVER_FAULTS["runtime_silent"] = FaultText(
    severity="alarm",
    what="The robot's runtime says nothing.",
    cause="It hangs, or the computer is overloaded.",
    remedy="The board stops the fins by itself after 1 s. After 10 s the runtime is ended and "
    "started again, disarmed; nothing is to be done.",
    consequences=("runtime_down", "runtime_stalled", "board_disarmed", "simulator_silent"),
)
SERVER_FAULTS["runtime_down"] = FaultText(
    severity="alarm",
    what="",
    cause=_PART,
    remedy="It is started again by itself, except a service that was stopped by hand. Where it does not "
    "come back, the System page and its log say more.",
    # It passes on what a simulator of a board in the loop sends.
    consequences=("simulator_silent",),
)
SERVER_FAULTS["board_down"] = FaultText(
    severity="alarm",
    what="",
    cause=_PART,
    remedy=_LOGS,
    consequences=("board_silent", "board_restarted", "board_disarmed", "simulator_silent"),
)
SERVER_FAULTS["simulator_down"] = FaultText(
    severity="caution",
    what="",
    cause=_PART,
    remedy=_LOGS,
    consequences=("simulator_silent", *_WITHOUT_WATER),
)
SERVER_FAULTS["scene_down"] = FaultText(
    severity="caution", what="", cause=_PART, remedy=_LOGS, consequences=("vision_stale",)
)
SERVER_FAULTS["simulator_silent"] = FaultText(
    severity="caution",
    what="The simulated water stands still.",
    cause="The simulator hangs, or the computer is overloaded.",
    remedy="End the simulator, which is then started again.",
    consequences=_WITHOUT_WATER,
)
SERVER_FAULTS["server_restarted"] = FaultText(
    severity="caution",
    what="",
    cause=_PART,
    remedy="A robot that was armed is stopped where the server is away for more than 4 s. "
    "Nothing is to be done; where it happens again, read the service's log: journalctl -u mucat.",
    consequences=("server_silent", "pilot_quiet", "pilot_lost"),
)
SERVER_FAULTS["server_task_failed"] = FaultText(
    severity="alarm",
    what="A part of the server has failed.",
    cause="A mistake in its software: the service's log says more (journalctl -u mucat).",
    remedy="Surface. Then restart it: sudo systemctl restart mucat.",
)
SERVER_FAULTS["disk_low"] = FaultText(
    severity="caution",
    what="The disk is almost full.",
    cause="Recordings or exports have filled it.",
    remedy="Remove sessions or exports, or have old ones removed by themselves (keep_free in robot.toml).",
    consequences=("store_failing",),
)
SERVER_FAULTS["store_failing"] = FaultText(
    severity="alarm",
    what="Nothing can be stored.",
    cause="The disk is full, broken or read-only.",
    remedy="Free some space, or check the disk. Up to 8 MB of a recording wait meanwhile.",
)
SERVER_FAULTS["configuration_damaged"] = FaultText(
    severity="caution",
    what="",
    cause="A power cut while it was written, or a slip in its last change.",
    remedy="Correct the file; then restart the services mucat-runtime and mucat.",
)
SERVER_FAULTS["undervoltage"] = FaultText(
    severity="caution",
    what="The Raspberry Pi's supply is too low.",
    cause="The battery is almost empty, or the regulator or a wire does not carry the current.",
    remedy="Surface, and charge the battery. Meanwhile the processor is slowed, and the card at risk.",
)
check_consequences(SERVER_FAULTS, ROBOT_FAULTS)
