"""The proxy with faults in front of a real port: effects on bytes, counts, repeatability."""

import os
import random
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path

import pytest
import serial

from robot_runtime.experiments.line_faults.faults import (
    DIRECTIONS,
    KINDS,
    Direction,
    FaultyChannel,
    Kind,
    Recurrence,
)
from robot_runtime.experiments.line_faults.pty_proxy import PtyProxy, execute
from robot_runtime.link.link_driver import PortError
from tests.runtime.board_end import BoardEnd
from tests.waiting import SECONDS, wait_for

DATA = random.Random(5).randbytes(20_000)
LOOK = 0.05
"""s after which nothing more comes from a line that holds something back."""


def is_part(part: bytes, whole: bytes) -> bool:
    """Return True where `part` is `whole` with some bytes left out."""
    rest = iter(whole)
    return all(byte in rest for byte in part)


def wrong_bits(sent: bytes, arrived: bytes) -> int:
    return sum((a ^ b).bit_count() for a, b in zip(sent, arrived, strict=True))


@pytest.fixture
def channel() -> FaultyChannel:
    return FaultyChannel("to_board", seed=1)


def test_a_channel_without_faults_changes_nothing(channel: FaultyChannel) -> None:
    assert channel.carry(DATA) == DATA
    assert not any(channel.counts.values())


@pytest.mark.parametrize("rate", [0.0005, 0.02, 0.5, 1.0])
def test_the_count_of_wrong_bits_is_exact(channel: FaultyChannel, rate: float) -> None:
    channel.set_rate("bit_errors", rate)
    wrong = wrong_bits(DATA, channel.carry(DATA))
    assert wrong == channel.counts["bit_errors"]
    bits = 8 * len(DATA)
    assert abs(wrong - rate * bits) <= 4 * (bits * rate * (1 - rate)) ** 0.5


def test_dropped_bytes_are_missing(channel: FaultyChannel) -> None:
    channel.set_rate("drop", 0.1)
    arrived = channel.carry(DATA)
    assert len(DATA) - len(arrived) == channel.counts["drops"]
    assert 1800 < channel.counts["drops"] < 2200
    assert is_part(arrived, DATA)


@pytest.mark.parametrize(("kind", "count"), [("double", "doubles"), ("insert", "inserts")])
def test_the_count_of_added_bytes_is_exact(channel: FaultyChannel, kind: Kind, count: str) -> None:
    channel.set_rate(kind, 0.1)
    arrived = channel.carry(DATA)
    assert len(arrived) - len(DATA) == channel.counts[count]
    assert 1800 < channel.counts[count] < 2200
    assert is_part(DATA, arrived)


def test_doubled_bytes_come_twice_in_a_row(channel: FaultyChannel) -> None:
    channel.set_rate("double", 1.0)
    assert channel.carry(b"abc") == b"aabbcc"


def test_bursts_hit_half_of_their_bits(channel: FaultyChannel) -> None:
    channel.burst(0.0005, 40)
    zeros = bytes(len(DATA))
    arrived = channel.carry(zeros)
    counts = channel.counts
    assert 50 < counts["bursts"] < 110
    assert wrong_bits(zeros, arrived) == counts["burst_errors"]
    assert 18 < counts["burst_errors"] / counts["bursts"] < 22
    wrong = [at for at in range(8 * len(arrived)) if arrived[at // 8] >> at % 8 & 1]
    groups = 1 + sum(late - early >= 40 for early, late in pairwise(wrong))
    assert groups <= counts["bursts"]
    assert groups > 0.8 * counts["bursts"]


def test_a_dropped_byte_is_not_doubled_as_well(channel: FaultyChannel) -> None:
    channel.set_rate("drop", 1.0)
    channel.set_rate("double", 1.0)
    assert channel.carry(b"abc") == b""
    assert (channel.counts["drops"], channel.counts["doubles"]) == (3, 0)


def test_a_bit_in_a_burst_gets_no_other_fault(channel: FaultyChannel) -> None:
    channel.burst(1.0, 100)
    channel.set_rate("bit_errors", 1.0)
    wrong = wrong_bits(DATA, channel.carry(DATA))
    assert wrong == channel.counts["burst_errors"]
    assert channel.counts["bit_errors"] == 0


def test_a_cut_channel_loses_everything(channel: FaultyChannel) -> None:
    channel.cut(True)
    assert channel.carry(b"lost") == b""
    channel.cut(False)
    assert channel.carry(b"kept") == b"kept"
    assert channel.counts["cuts"] == 4


def everything(seed: int, portion: int, name: str = "to_board") -> bytes:
    channel = FaultyChannel(name, seed)
    for kind in KINDS:
        channel.set_rate(kind, 0.01)
    channel.burst(0.001, 30)
    return b"".join(channel.carry(DATA[i : i + portion]) for i in range(0, len(DATA), portion))


def test_faults_depend_on_the_seed_and_not_on_the_pieces() -> None:
    whole = everything(1, len(DATA))
    assert everything(1, 1) == everything(1, 61) == whole
    assert everything(2, len(DATA)) != whole
    assert everything(1, len(DATA), "from_board") != whole


def test_the_same_seed_repeats_the_faults(channel: FaultyChannel) -> None:
    channel.set_rate("drop", 0.1)
    channel.seed(9)
    first = channel.carry(DATA)
    channel.seed(9)
    assert channel.carry(DATA) == first


def test_clean_ends_all_faults_and_keeps_the_counts(channel: FaultyChannel) -> None:
    channel.set_rate("drop", 1.0)
    channel.burst(1.0, 10_000)
    channel.carry(b"lost")
    channel.cut(True)
    channel.clean()
    assert channel.carry(DATA) == DATA
    assert channel.counts["drops"] == 4


def test_the_smallest_rate_hits_nothing_and_the_largest_everything() -> None:
    assert Recurrence(5e-324, random.Random(1)).hits(1_000_000_000) == []
    assert Recurrence(1.0, random.Random(1)).hits(3) == [0, 1, 2]


@pytest.mark.parametrize("rate", [-0.1, 1.1, float("nan")])
def test_an_invalid_rate_is_refused(rate: float) -> None:
    with pytest.raises(ValueError, match="a rate is from 0 to 1"):
        Recurrence(rate, random.Random(1))


class PtyEnds:
    """A proxy, the host's end of it, and the far end of the port behind it."""

    def __init__(self, folder: Path) -> None:
        self.far = BoardEnd(folder / "port")
        self.link = folder / "link"
        self.line = PtyProxy(str(folder / "port"), 250_000, self.link, seed=1)
        self.host = serial.Serial(str(self.link), 250_000, timeout=0)

    def send(self, direction: Direction, data: bytes) -> None:
        os.write(self.host.fileno() if direction == "to_board" else self.far.master, data)

    def receive(self, direction: Direction, count: int, limit: float = SECONDS) -> bytes:
        """Read this many bytes, or those that arrive within the limit (s)."""
        file = self.far.master if direction == "to_board" else self.host.fileno()
        data, end = b"", time.monotonic() + limit
        while len(data) < count and select.select([file], [], [], max(end - time.monotonic(), 0))[0]:
            data += os.read(file, 4096)
        return data

    def close(self) -> None:
        self.host.close()
        self.line.close()


@pytest.fixture
def ends(tmp_path: Path) -> Iterator[PtyEnds]:
    ends = PtyEnds(tmp_path)
    yield ends
    ends.close()


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_the_proxy_passes_every_byte_unchanged(ends: PtyEnds, direction: Direction) -> None:
    every = bytes(range(256))
    ends.send(direction, every)
    assert ends.receive(direction, 256) == every


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_the_proxy_disturbs_one_direction_as_its_channel_does(ends: PtyEnds, direction: Direction) -> None:
    ends.line.channels[direction].set_rate("bit_errors", 0.01)
    twin = FaultyChannel(direction, seed=1)
    twin.set_rate("bit_errors", 0.01)
    expected = twin.carry(DATA[:3000])
    ends.send(direction, DATA[:3000])
    assert ends.receive(direction, 3000) == expected != DATA[:3000]
    other: Direction = "from_board" if direction == "to_board" else "to_board"
    ends.send(other, DATA[:3000])
    assert ends.receive(other, 3000) == DATA[:3000]


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_stall_delays_bytes_and_loses_none(ends: PtyEnds, direction: Direction) -> None:
    ends.line.stall(direction, 3600)
    ends.send(direction, b"late")
    assert ends.receive(direction, 4, limit=LOOK) == b""
    ends.line.stall(direction, 0)
    assert ends.receive(direction, 4) == b"late"
    assert ends.line.channels[direction].counts["stalls"] == 1


def test_a_stall_ends_by_itself(ends: PtyEnds) -> None:
    begin = time.monotonic()
    ends.line.stall("to_board", 0.1)
    ends.send("to_board", b"late")
    assert ends.receive("to_board", 4) == b"late"
    assert time.monotonic() - begin >= 0.1


def test_a_host_that_does_not_read_loses_bytes_and_blocks_nothing(ends: PtyEnds) -> None:
    sent = 0
    while not ends.line.channels["from_board"].counts["lost"]:
        assert sent < 1_000_000, "the operating system keeps everything"
        ends.send("from_board", bytes(1000))
        sent += 1000
    ends.send("to_board", b"still here")
    assert ends.receive("to_board", 10) == b"still here"


def test_it_ends_when_the_port_goes_away(ends: PtyEnds) -> None:
    ends.far.vanish()
    wait_for(lambda: not ends.line.running(), "the end of the line")
    assert "went away" in ends.line.failure


def test_the_symbolic_link_is_removed_at_the_end(tmp_path: Path) -> None:
    ends = PtyEnds(tmp_path)
    ends.close()
    assert not ends.link.is_symlink()


def test_an_existing_file_is_not_overwritten(tmp_path: Path) -> None:
    end = BoardEnd(tmp_path / "port")
    (tmp_path / "file").write_text("kept")
    with pytest.raises(PortError, match=r"cannot make .*file"):
        PtyProxy(str(tmp_path / "port"), 250_000, tmp_path / "file")
    assert (tmp_path / "file").read_text() == "kept"
    end.vanish()


def test_a_path_that_is_no_port_is_refused(tmp_path: Path) -> None:
    with pytest.raises(PortError, match="cannot open /nowhere"):
        PtyProxy("/nowhere", 250_000, tmp_path / "link")


def test_commands_work_as_the_emulated_board_s(ends: PtyEnds) -> None:
    assert execute(ends.line, "seed 4") == "ok"
    assert execute(ends.line, "line to_board drop 1.0") == "ok"
    ends.send("to_board", b"gone")
    wait_for(lambda: "to_board_drops=4" in execute(ends.line, "stats"), "the bytes to be dropped")
    assert execute(ends.line, "line to_board clean") == "ok"
    assert execute(ends.line, "line from_board burst 0.1 8") == "ok"
    assert execute(ends.line, "line from_board stall 60") == "ok"
    assert execute(ends.line, "line from_board clean") == "ok"
    assert execute(ends.line, "line from_board cut on") == "ok"
    ends.send("from_board", b"lost")
    wait_for(lambda: "from_board_cuts=4" in execute(ends.line, "stats"), "the bytes to be lost")


@pytest.mark.parametrize(
    "command",
    [
        "",
        "line",
        "line sideways drop 0.1",
        "line to_board drop much",
        "line to_board drop 2",
        "line to_board burst 0.1 0",
        "line to_board stall -1",
        "line to_board cut perhaps",
        "seed one",
        "quit",
    ],
)
def test_invalid_commands_are_refused(ends: PtyEnds, command: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        execute(ends.line, command)


@contextmanager
def run(folder: Path, *options: str) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-m", "robot_runtime.experiments.line_faults.pty_proxy", *options]
    command += ["--port", str(folder / "port"), "--link", str(folder / "link")]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True) as program:
        try:
            assert program.stdout
            assert program.stdout.readline() == "ready\n"
            yield program
        finally:
            program.kill()


def read(file: int, count: int) -> bytes:
    data = b""
    while len(data) < count:
        assert select.select([file], [], [], SECONDS)[0]
        data += os.read(file, 4096)
    return data


def test_it_runs_as_a_program(tmp_path: Path) -> None:
    end = BoardEnd(tmp_path / "port")
    options = ("--seed", "1", "--bit-errors", "0.01", "--direction", "to_board")
    with run(tmp_path, *options) as program:
        twin = FaultyChannel("to_board", seed=1)
        twin.set_rate("bit_errors", 0.01)
        host = os.open(tmp_path / "link", os.O_RDWR | os.O_NOCTTY)
        os.write(host, DATA[:1000])
        assert read(end.master, 1000) == twin.carry(DATA[:1000])
        os.write(end.master, DATA[:200])
        assert read(host, 200) == DATA[:200]
        assert program.stdin
        assert program.stdout
        program.stdin.write("stats\nline to_board fly\n")
        program.stdin.flush()
        assert f"to_board_bit_errors={twin.counts['bit_errors']} " in program.stdout.readline()
        assert program.stdout.readline().startswith("error ")
        program.send_signal(signal.SIGTERM)
        assert program.wait(SECONDS) == 0
        os.close(host)
    assert not (tmp_path / "link").is_symlink()
    end.vanish()


def test_the_program_ends_with_its_port(tmp_path: Path) -> None:
    end = BoardEnd(tmp_path / "port")
    with run(tmp_path) as program:
        end.vanish()
        _, output = program.communicate(timeout=SECONDS)
        assert program.returncode == 1
    assert output.startswith(f"fault line: {tmp_path / 'port'} went away")
    assert not (tmp_path / "link").is_symlink()


def test_the_program_reports_why_it_cannot_start(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "robot_runtime.experiments.line_faults.pty_proxy", "--port", "/nowhere"]
    done = subprocess.run([*command, "--link", str(tmp_path / "link")], capture_output=True, text=True)
    assert done.returncode == 1
    assert done.stderr.startswith("fault line: cannot open /nowhere")
    assert done.stderr.count("\n") == 1
