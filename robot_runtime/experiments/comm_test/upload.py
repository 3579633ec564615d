"""Uploads through the boot loader, with avrdude."""

import subprocess
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO

from robot_runtime.experiments.comm_test.line import Cancellation, check
from robot_runtime.simulation.boards.emulator_process import EmulatorClient

BOOT_BAUD = 115200
"""bit/s; optiboot's."""
WORDS_MAX = 300
LIMIT = 120.0
"""s for an upload, on a busy computer; 30 kB take 8 s."""
LOOK = 0.002
"""s between two looks whether it has ended, or has written something to a board that is paused."""
LISTEN_TIME = 0.02
"""s of emulated time after a reset until the boot loader listens, for 1 s."""
ATTEMPTS = 3
"""Uploads to a paused board before it counts as failed."""
ANSWER_SECONDS = 20.0
"""avrdude gives up sooner where it has lost step; where nothing answers, it asks for most of a minute."""
STEP = 0.002
"""s of emulated time that the boot loader takes for any answer, at most."""


class UploadError(Exception):
    """avrdude could not upload; the text says why, with its own words."""


def avrdude_version() -> str:
    """Return the version of avrdude, in its own words. Raise UploadError where avrdude is missing."""
    output = _run_briefly(["avrdude", "-?"])
    version = [line.partition(",")[0] for line in output.splitlines() if line.startswith("avrdude version")]
    return version[0] if version else "avrdude"


def upload(
    program: Path,
    port: str,
    baud: int,
    stop: Cancellation,
    attend: Callable[[], None] = lambda: None,
    progress: Path | None = None,
) -> None:
    """Write an Intel HEX file into the flash memory of a chip whose boot loader listens, and verify it.

    `attend` is called again and again meanwhile; avrdude's own output grows in the file `progress`. Raise
    UploadError, and StoppedError.
    """
    failure = f"could not upload {program.name}"
    _run_avrdude(f"flash:w:{program}:i", failure, port, baud, stop, attend, progress)


def read_out(program: Path, port: str, baud: int, stop: Cancellation, progress: Path | None) -> None:
    """Write the flash memory of a chip whose boot loader listens to an Intel HEX file, the boot loader too.

    Raise UploadError, and StoppedError.
    """
    _run_avrdude(
        f"flash:r:{program}:i", "could not read the firmware", port, baud, stop, lambda: None, progress
    )


def _run_avrdude(
    operation: str,
    failure: str,
    port: str,
    baud: int,
    stop: Cancellation,
    attend: Callable[[], None],
    progress: Path | None,
) -> None:
    # avrdude ends with this process in any case: it must not go on writing unsupervised.
    command = ["setpriv", "--pdeathsig", "KILL", "avrdude", "-c", "arduino", "-p", "m328p"]
    command += ["-b", str(baud), "-P", port, "-D", "-U", operation]
    command += [] if progress else ["-q", "-q"]
    with _open_output(progress) as output:
        try:
            avrdude = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=output, stderr=output, start_new_session=True
            )
        except OSError as problem:
            raise UploadError(
                f"avrdude cannot be started: {problem}; install the package avrdude"
            ) from problem
        try:
            status = _wait(avrdude, stop, attend)
        finally:
            if avrdude.poll() is None:
                avrdude.kill()
                avrdude.wait()
        output.seek(0)
        text = _shorten(output.read().decode(errors="replace"))
    if status is None:
        raise UploadError(f"avrdude did not end within {LIMIT:g} s: {text}")
    if status:
        raise UploadError(f"avrdude {failure} through {port}: {text}")


def _open_output(progress: Path | None) -> IO[bytes]:
    return progress.open("w+b") if progress else tempfile.TemporaryFile()


def upload_paused(program: Path, tty: Path, board: EmulatorClient, stop: Cancellation) -> None:
    """Upload to a paused board with a boot loader; its time passes only while there is something to do.

    The boot loader's patience, 1 s, does not run out, however busy the computer is. avrdude's does: it waits
    by its own clock, asks again, and loses step over the two answers. It then starts over, a few times.
    Raise BoardError too.
    """
    for attempt in range(1, ATTEMPTS + 1):
        began = time.monotonic()
        try:
            _upload_paused_once(program, tty, board, stop)
        except UploadError:
            if attempt == ATTEMPTS or time.monotonic() - began > ANSWER_SECONDS:
                raise
        else:
            return


def _upload_paused_once(program: Path, tty: Path, board: EmulatorClient, stop: Cancellation) -> None:
    board.reset()
    board.run(LISTEN_TIME)
    known = _traffic(board)

    def attend() -> None:
        nonlocal known
        while (now := _traffic(board)) != known:
            known = now
            board.run(STEP)

    upload(program, str(tty), BOOT_BAUD, stop, attend)


def _traffic(board: EmulatorClient) -> tuple[float, ...]:
    stats = board.stats()
    return tuple(stats[name] for name in ("bytes_from_host", "bytes_to_board", "bytes_to_host"))


def _wait(avrdude: subprocess.Popen[bytes], stop: Cancellation, attend: Callable[[], None]) -> int | None:
    """Wait for the process; return its exit status, None where it takes too long."""
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        check(stop)
        attend()
        with suppress(subprocess.TimeoutExpired):
            return avrdude.wait(LOOK)
    return None


def _shorten(output: str) -> str:
    lines = dict.fromkeys(line.removeprefix("avrdude: ").strip() for line in output.splitlines())
    text = " / ".join(line for line in lines if line and "| ##" not in line)
    return text if len(text) <= WORDS_MAX else "... " + text[-WORDS_MAX:]


def _run_briefly(command: list[str]) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT, check=False)
        return done.stderr
    except (OSError, subprocess.TimeoutExpired) as problem:
        raise UploadError(f"avrdude cannot be started: {problem}; install the package avrdude") from problem
