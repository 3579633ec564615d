"""The firmware under libFuzzer: seeds of real frames, and a run. See firmware/host/proofs/fuzz_link.cpp.

`python -m tests.proofs.fuzz SECONDS` goes on from what earlier runs found.
"""

import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from robot_runtime.contract.packets import (
    DEFINITIONS_HASH,
    Acknowledge,
    Beacon,
    Debug,
    Heartbeat,
    Hello,
    Navigation,
    Packet,
    Start,
    Stop,
)
from robot_runtime.link.framing import build as build_frame
from robot_runtime.link.session import session_key
from tests.board.rig import ROOT, build

PROGRAM = ROOT / "build/firmware/fuzz_link"
CORPUS = ROOT / "build/fuzz"
INPUT_BYTES_MAX = 600
HOST, BOARD = 7, 1
"""Epochs; the board's is that of its first boot."""
_WAIT, _RAW, _SESSION, _OPEN, _CONTENT, _HELLO, _START, _RESET = (bytes([deed]) for deed in range(8))
_KEY = session_key(HOST, BOARD)
_FORWARD = Navigation(x=1.0, y=0.0, z=0.5, roll=0.0, pitch=-0.5, yaw=0.0)
_MOTION = bytes([127, 0, 64, 0, 192, 0])
_GREETING = Hello(definitions=DEFINITIONS_HASH, epoch=HOST, credit=4096)


class FuzzError(Exception):
    """A finding of the fuzzer, with its text."""


def raw(packets: Sequence[Packet], number: int, key: int = _KEY) -> bytes:
    """Return an action of the fuzzer's input: this frame, as the host encodes it."""
    frame = build_frame(packets, number, 0, key)
    return _RAW + bytes([len(frame)]) + frame


def seeds() -> dict[str, bytes]:
    """Seed inputs by name: packets of hosts, as real bytes and as actions of the fuzzer."""
    beats = b"".join(raw([Heartbeat(time=100 * i)], i) + _WAIT + bytes([99]) for i in range(7))
    greeted = raw([_GREETING], 0, 0) + beats
    armed = greeted + raw([Start(epoch=BOARD)], 0) + _WAIT + bytes([20])
    wrong = b"".join(raw([Start(epoch=900 + i)], i % 16) + _WAIT + bytes([30]) for i in range(8))
    steady = (_SESSION + bytes([0, 0, 0, 10]) + bytes(4) + _WAIT + bytes([99])) * 7
    return {
        "swim": armed + raw([_FORWARD, Acknowledge(held=0)], 8) + _WAIT + bytes([200]),
        "stop": armed + raw([Stop()], 0, 0) + _WAIT + bytes([50]),
        "refusals": greeted + wrong,
        "several": greeted + raw([Start(epoch=3), Start(epoch=BOARD), Start(epoch=4)], 0),
        "restart": armed + _RESET + bytes([4]) + greeted,
        "another host": armed + _HELLO + bytes([HOST + 1]) + steady,
        "words": _HELLO + bytes([HOST]) + steady + _START + b"\0" + _SESSION + bytes([0, 9, 0, 2]) + _MOTION,
        "not its own": raw([Beacon(time=1, right=1, left=0)], 3)
        + raw([Debug(time=1, level=2, text="heard")], 1)
        + _OPEN
        + bytes([0, 0, 1, 8, 0, 8])
        + bytes(8),
        "contents": _HELLO + bytes([1]) + _CONTENT + bytes([48, 0, Debug.type, *bytes(5), 40]) + b"a" * 40,
        "silence": armed + (_WAIT + b"\xff") * 6,
    }


def prepare(folder: Path) -> None:
    """Compile the fuzzer, and write the seeds."""
    build(ROOT / "firmware", "fuzz")
    folder.mkdir(parents=True, exist_ok=True)
    for name, seed in seeds().items():
        (folder / name.replace(" ", "_")).write_bytes(seed)


def run(corpus: Path, *limits: str) -> int:
    """Fuzz within these limits of libFuzzer; return the executions. Raise FuzzError at a finding."""
    command = [
        str(PROGRAM),
        f"-max_len={INPUT_BYTES_MAX}",
        f"-artifact_prefix={corpus.parent}/",
        "-timeout=20",
    ]
    done = subprocess.run(
        [*command, "-print_final_stats=1", *limits, str(corpus)], capture_output=True, text=True
    )
    if done.returncode != 0:
        raise FuzzError(done.stderr)
    return int(re.findall(r"number_of_executed_units:\s+(\d+)", done.stderr)[-1])


def main() -> None:
    """Fuzz for this many seconds."""
    seconds = sys.argv[1] if len(sys.argv) == 2 else "60"
    prepare(CORPUS / "corpus")
    try:
        executions = run(CORPUS / "corpus", f"-max_total_time={seconds}")
    except FuzzError as result:
        sys.exit(f"{result}\nThe input is in {CORPUS}; {PROGRAM} runs it again.")
    print(f"{executions} executions, no finding")  # noqa: T201 - it is the result


if __name__ == "__main__":
    main()
