"""Missions in simulated time, with the robot's own firmware."""

from typing import Any

from tests.runtime.experiments.scenario.staging import Output, document, perform

HEAD = 'format = 1\nname = "test"\nalone = 0\npause = 20\n'
DIVE = "{ do = 'dive', depth = 0.6, timeout = 30 }"
HOLD = "{ do = 'hold', seconds = 8 }"


def mission(*steps: str, limits: str = "time = 200", do: str = "sequence", head: str = HEAD) -> str:
    """Return the text of a mission of these steps, each an inline table."""
    return f"{head}[limits]\n{limits}\n[mission]\ndo = '{do}'\nsteps = [\n  " + ",\n  ".join(steps) + "\n]\n"


def begin(text: str, at: float = 1.0) -> str:
    """Return the event that begins a mission."""
    return (
        f'at = {at}; do = "mission"; text = '
        + '"""'
        + text.replace("\\", "\\\\").replace("\n", "\\n")
        + '"""'
    )


def swim(
    seconds: float, text: str, *events: str, seed: int = 7, more: str = "", board: str = "host"
) -> Output:
    """Perform a scenario with a mission that begins after a second."""
    return perform(document(seconds, begin(text), *events, seed=seed, more=more), board)


def end_of(report: Output) -> dict[str, Any]:
    """Return the document of the mission's end; one more may follow when the robot has surfaced."""
    documents = report.documents["mission"]
    return next(
        state
        for state in documents
        if state["number"] == documents[-1]["number"] and state["phase"] not in ("running", "paused")
    )


def statuses(document: dict[str, Any]) -> dict[str, str]:
    """Return the statuses of the steps by path."""
    return {step["path"]: step["status"] for step in document["steps"]}


def is_at_rest(report: Output, since: float) -> bool:
    """Return True if the board was told nothing but rest, and its fins stopped."""
    late = report.between("navigation", since, 1e9)
    last = report.rows["motor"][-1][1]
    return not late and not any(last.drive)
