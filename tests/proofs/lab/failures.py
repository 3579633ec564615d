"""The failures of a lab, one after the other, each in the middle of a pull while the other robots swim."""

import os
import shutil
import time
from contextlib import suppress
from pathlib import Path

from server.platform.settings import SetupError
from tests.proofs.lab.programs import wait_beside
from tests.proofs.lab.whole_lab import WholeLab
from tests.server.postgres import PostgresServer

CUT_SECONDS = 25.0
"""More than the 20 s that the pull waits for a byte."""
LAB_CUT_SECONDS = 8.0
"""Several times the lease of Zenoh."""
DATABASE_SECONDS = 8.0
FULL_SECONDS = 35.0
"""More than the 30 s between two looks at the robots."""
LEFT_BYTES = 200_000
"""Of the full disk."""


def cut_robot(whole: WholeLab, seconds: float = CUT_SECONDS) -> None:
    """Cut the cable of the robot that is pulled from."""
    computer = whole.first.computer
    with whole.failure(f"cable of {computer.name} cut") as outcome:
        whole.network.cut(computer)
        time.sleep(seconds)
        outcome.message = whole.lab.describe_pulls()
        whole.network.mend(computer)


def cut_lab(whole: WholeLab) -> None:
    """Cut the lab's own cable."""
    with whole.failure("cable of the lab cut") as outcome:
        whole.network.cut(whole.lab.computer)
        time.sleep(LAB_CUT_SECONDS)
        wait_beside(
            lambda: not any(robot.is_in_a_lab for robot in whole.robots), "the robots to miss the lab"
        )
        outcome.message = f"there are {', '.join(sorted(whole.lab.present())) or 'no robots'}"
        whole.network.mend(whole.lab.computer)


def kill_lab(whole: WholeLab) -> None:
    """Kill all of the lab with -9, and start it again."""
    with whole.failure("lab killed"):
        whole.lab.kill()
        wait_beside(
            lambda: not any(robot.is_in_a_lab for robot in whole.robots), "the robots to miss the lab"
        )
        whole.lab.start()


def stop_database(whole: WholeLab, database: PostgresServer) -> None:
    """End PostgreSQL as a crash does, and start it again."""
    with whole.failure("PostgreSQL stopped") as outcome:
        database.stop()
        time.sleep(DATABASE_SECONDS)
        outcome.message = _ask_for_sessions(whole)
        database.start()


def fill_disk(whole: WholeLab, database: PostgresServer) -> None:
    """Fill the disk of lab and PostgreSQL, and free it again."""
    with whole.failure("disk of lab and PostgreSQL full") as outcome:
        ballast = database.folder.parent / "ballast"
        _fill(ballast)
        time.sleep(FULL_SECONDS)
        outcome.message = (
            f"{whole.lab.describe_pulls()}; PostgreSQL {'runs' if database.runs else 'has ended'}"
        )
        ballast.unlink()
        if not database.runs:
            # As systemd does.
            database.start()


def _ask_for_sessions(whole: WholeLab) -> str:
    try:
        return f"{len(whole.lab.ask('GET', '/sessions'))} sessions"
    except SetupError as problem:
        return str(problem)


def _fill(ballast: Path) -> None:
    with ballast.open("wb", buffering=0) as file:
        size = 0
        while (room := shutil.disk_usage(ballast.parent).free - LEFT_BYTES) > 0:
            with suppress(OSError):
                os.posix_fallocate(file.fileno(), size, room)
                size += room
