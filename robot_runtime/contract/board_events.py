"""Texts of the board's events, which it sends as numbers to keep them out of its memory.

A sketch's own lines come as text, by the packet Debug; both are shown on the console.
"""

from typing import NamedTuple

from robot_runtime.contract.packets import (
    FIN_COUNT,
    BoardEvent,
    BoardEventKind,
    CalibrationStep,
    DebugLevel,
    DeviceFault,
    Disarming,
    Refusal,
    ResetCause,
)
from robot_runtime.contract.wiring import FINS

_MPU_6050 = 0x68
_RESETS = {
    ResetCause.UNKNOWN: "unknown reset",
    ResetCause.POWER_ON: "power on",
    ResetCause.EXTERNAL: "reset pin",
    ResetCause.BROWN_OUT: "brown-out",
    ResetCause.WATCHDOG: "watchdog: the main loop hung",
}
_REFUSALS = {
    Refusal.NO_HELLO: "say HELLO first",
    Refusal.DEFINITIONS: "other definitions",
    Refusal.EPOCH: "epoch of another boot",
    Refusal.TRAFFIC: "no steady traffic yet",
    Refusal.BATTERY: "battery is low",
    Refusal.CALIBRATION: "not calibrated",
    Refusal.SURFACE: "depth uncertain",
    Refusal.LEAK: "water in the hull",
}
_DISARMINGS = {
    Disarming.STOP: "STOP",
    Disarming.SILENCE: "host silent for 1 s",
    Disarming.BATTERY: "battery is low",
    Disarming.DEFINITIONS: "other definitions",
    Disarming.HOST: "another host",
    Disarming.LEAK: "water in the hull",
}
_STEPS = {
    CalibrationStep.FINS: "fins",
    CalibrationStep.MOTORS: "motors",
    CalibrationStep.AXES: "IMU axes",
    CalibrationStep.GYRO: "gyroscope",
    CalibrationStep.PRESSURE: "pressure",
    CalibrationStep.BATTERY: "battery",
    CalibrationStep.BEACONS: "beacons",
}


class _FaultText(NamedTuple):
    """The texts of a device's fault: when it begins, and when it is over."""

    begins: str
    over: str


_FAULTS = {
    DeviceFault.IMU: _FaultText("IMU: no sensible answer", "IMU: ok"),
    DeviceFault.PRESSURE: _FaultText("pressure sensor: no sensible answer", "pressure sensor: ok"),
    DeviceFault.MAGNET: _FaultText("encoders: a magnet out of place", "encoders: magnets in place"),
    DeviceFault.SURFACE: _FaultText("depth uncertain: supply failed below", "depth certain again"),
    DeviceFault.LEAK: _FaultText("water in the hull", "no water in the hull"),
}
for _fin in range(FIN_COUNT):
    _name = FINS[_fin].position
    _FAULTS[DeviceFault(DeviceFault.ENCODER_FRONT_RIGHT << _fin)] = _FaultText(
        f"encoder {_name}: no sensible answer", f"encoder {_name}: ok"
    )
    _FAULTS[DeviceFault(DeviceFault.BRIDGE_FRONT_RIGHT << _fin)] = _FaultText(
        f"H-bridge {_name}: silent or tripped", f"H-bridge {_name}: ok"
    )
    _FAULTS[DeviceFault(DeviceFault.TRACKING_FRONT_RIGHT << _fin)] = _FaultText(
        f"fin {_name}: not following, stopped", f"fin {_name}: follows"
    )


class EventText(NamedTuple):
    """An event's severity, and its text for people."""

    level: DebugLevel
    text: str


def describe_event(event: BoardEvent) -> EventText:
    """Return an event in words. An unknown one, of another version's board, is described by its numbers."""
    try:
        return _describe(event)
    except (KeyError, ValueError):
        return EventText(DebugLevel.INFO, f"event {event.kind}: {event.detail}, {event.value}")


def _describe(event: BoardEvent) -> EventText:
    detail, value = event.detail, event.value
    match BoardEventKind(event.kind):
        case BoardEventKind.BOOT:
            level = DebugLevel.ERROR if detail == ResetCause.WATCHDOG else DebugLevel.INFO
            return EventText(level, f"boot {value}, {_RESETS[ResetCause(detail)]}")
        case BoardEventKind.ARMED:
            return EventText(DebugLevel.INFO, "armed")
        case BoardEventKind.REFUSED:
            steps = ", ".join(text for step, text in _STEPS.items() if value & step)
            reason = _REFUSALS[Refusal(detail)] + (f": {steps}" if steps else "")
            return EventText(DebugLevel.WARNING, f"START refused: {reason}")
        case BoardEventKind.DISARMED:
            return EventText(DebugLevel.INFO, f"disarmed: {_DISARMINGS[Disarming(detail)]}")
        case BoardEventKind.BATTERY:
            action = "fins down, disarmed" if detail else "arming refused"
            return EventText(DebugLevel.ERROR, f"battery at {value / 1000:.2f} V: {action}")
        case BoardEventKind.FAULT:
            return EventText(DebugLevel.WARNING, _FAULTS[DeviceFault(1 << detail)].begins + _identity(event))
        case BoardEventKind.FAULT_OVER:
            return EventText(DebugLevel.INFO, _FAULTS[DeviceFault(1 << detail)].over + _identity(event))


def _identity(event: BoardEvent) -> str:
    """Return the chip that answers at the IMU's address where it is another one than the robot's."""
    if 1 << event.detail != DeviceFault.IMU or event.value in (0, _MPU_6050):
        return ""
    return f", WHO_AM_I 0x{event.value:02X}"
