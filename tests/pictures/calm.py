"""Takes again what a busy computer has spoiled: samples that come late raise alarms."""

import sys
from collections.abc import Callable

from tests.stack import Stack

TRIES = 5


def take_calm(take: Callable[[], list[str]]) -> None:
    """Take something until no alarm stands on it; `take` returns those that do."""
    for _ in range(TRIES):
        if not (alarms := take()):
            return
        print("again:", *alarms)  # noqa: T201 - it is run from a shell
    sys.exit(f"Alarms each of {TRIES} times. Is the computer busy?")


def find_alarms(stack: Stack) -> list[str]:
    """Return the alarms and cautions that stand; none during a bring-up, which has the robot's board."""
    return [alarm["what"] for alarm in stack.api.get("/robot").json().get("alarms", ())]
