"""Counters and estimates of the serial link, as a record."""

from typing import Annotated

from robot_runtime.contract.packets.layout import Record, Wire, record


@record()
class LinkStatistics(Record):
    """Counters of the serial link since the port was opened."""

    bytes_received: Annotated[int, Wire("I", unit="B", meaning="received")]
    bytes_sent: Annotated[int, Wire("I", unit="B", meaning="sent")]
    bytes_delivered: Annotated[int, Wire("I", unit="B", meaning="received payloads that were passed on")]
    frames_received: Annotated[int, Wire("I", meaning="valid frames received")]
    frames_sent: Annotated[int, Wire("I", meaning="frames sent")]
    frames_invalid: Annotated[int, Wire("I", meaning="frames dropped: garbage, wrong checksum or length")]
    frames_missed: Annotated[
        int, Wire("I", meaning="unreliable frames that their numbers show to be missing")
    ]
    frames_repeated: Annotated[int, Wire("I", meaning="reliable frames sent again")]
    frames_duplicate: Annotated[int, Wire("I", meaning="frames that came again and were not passed on again")]
    messages_discarded: Annotated[int, Wire("I", meaning="unacknowledged messages to a board that restarted")]
    round_trip: Annotated[float, Wire("f", unit="s", meaning="time from a frame to its acknowledgement")]
    round_trip_deviation: Annotated[float, Wire("f", unit="s", meaning="mean deviation of the round trip")]
    timeout: Annotated[float, Wire("f", unit="s", meaning="wait for an acknowledgement before sending again")]
    goodput: Annotated[float, Wire("f", unit="B/s", meaning="received payloads in the last second")]
    credit: Annotated[int, Wire("H", unit="B", meaning="bytes that the board can take in at once")]
    clock_error: Annotated[
        float, Wire("f", unit="s", meaning="standard deviation of the board's mapped time")
    ]
    clock_drift: Annotated[float, Wire("f", meaning="how much the board's clock is slow, as a share")]
