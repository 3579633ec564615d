"""Missions in simulated time, with the robot's own firmware."""

from typing import Any

from tests.runtime.experiments.scenario.staging import Told, document, perform

HEAD = 'format = 1\nname = "test"\nalone = 0\npause = 20\n'
DIVE = "{ do = 'dive', depth = 0.6, timeout = 30 }"
HOLD = "{ do = 'hold', seconds = 8 }"


def mission(*steps: str, limits: str = "time = 200", do: str = "sequence", head: str = HEAD) -> str:
    """The text of a mission of these steps, each an inline table."""
    return f"{head}[limits]\n{limits}\n[mission]\ndo = '{do}'\nsteps = [\n  " + ",\n  ".join(steps) + "\n]\n"


def begin(text: str, at: float = 1.0) -> str:
    """The event that begins a mission."""
    return (
        f'at = {at}; do = "mission"; text = '
        + '"""'
        + text.replace("\\", "\\\\").replace("\n", "\\n")
        + '"""'
    )


def swim(seconds: float, text: str, *events: str, seed: int = 7, more: str = "", board: str = "host") -> Told:
    """Performs a scenario with a mission that begins after a second."""
    return perform(document(seconds, begin(text), *events, seed=seed, more=more), board)


def end_of(told: Told) -> dict[str, Any]:
    """The last document of the mission."""
    last = told.documents["mission"][-1]
    assert last["phase"] not in ("running", "paused")
    return last


def statuses(document: dict[str, Any]) -> dict[str, str]:
    """The statuses of the steps by path."""
    return {one["path"]: one["status"] for one in document["steps"]}


def is_at_rest(told: Told, since: float) -> bool:
    """True if the board was told nothing but rest, and its fins stopped."""
    late = told.between("navigation", since, 1e9)
    last = told.rows["motor"][-1][1]
    return not late and not any(last.drive)
