"""The words of the board's events."""

from collections.abc import Sequence

import pytest

from robot_runtime.contract.board_events import describe_event
from robot_runtime.contract.packets import (
    BoardEvent,
    BoardEventKind,
    CalibrationStep,
    DebugLevel,
    DeviceFault,
    Disarming,
    Refusal,
    ResetCause,
)

DETAILS: dict[BoardEventKind, Sequence[int]] = {
    BoardEventKind.BOOT: list(ResetCause),
    BoardEventKind.ARMED: [0],
    BoardEventKind.REFUSED: [reason for reason in Refusal if reason],
    BoardEventKind.DISARMED: [reason for reason in Disarming if reason],
    BoardEventKind.BATTERY: [0, 1],
    BoardEventKind.FAULT: [fault.bit_length() - 1 for fault in DeviceFault],
    BoardEventKind.FAULT_OVER: [fault.bit_length() - 1 for fault in DeviceFault],
}


def event(kind: int, detail: int = 0, value: int = 0) -> BoardEvent:
    return BoardEvent(time=0, kind=kind, detail=detail, value=value)


@pytest.mark.parametrize("kind", BoardEventKind)
def test_every_event_that_the_board_sends_has_words_of_its_own(kind: BoardEventKind) -> None:
    texts = [describe_event(event(kind, detail)).text for detail in DETAILS[kind]]
    assert not any(text.startswith("event ") for text in texts)
    assert len(set(texts)) == len(texts)


def test_values_are_in_the_words() -> None:
    steps = CalibrationStep.FINS | CalibrationStep.BEACONS
    assert describe_event(event(BoardEventKind.REFUSED, Refusal.CALIBRATION, steps)) == (
        DebugLevel.WARNING,
        "START refused: not calibrated: fins, beacons",
    )
    assert (
        describe_event(event(BoardEventKind.BATTERY, 1, 6149)).text
        == "battery at 6.15 V: fins down, disarmed"
    )
    assert describe_event(event(BoardEventKind.BOOT, ResetCause.WATCHDOG, 7)).level == DebugLevel.ERROR


@pytest.mark.parametrize("unknown", [event(200, 1, 2), event(BoardEventKind.FAULT, 40), event(0, 99)])
def test_an_unknown_event_is_described_by_its_numbers(unknown: BoardEvent) -> None:
    assert describe_event(unknown).text.startswith(f"event {unknown.kind}: {unknown.detail}")
