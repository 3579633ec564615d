"""The runtime lives by the steady clock: setting the computer's date changes nothing of what it does."""

import ast
from collections import Counter

from robot_runtime.places import PACKAGES

CALENDAR = {"time", "time_ns", "localtime", "gmtime", "ctime", "strftime", "now", "utcnow", "today"}
"""Names by which `time` and `datetime` tell the date."""


def test_the_date_is_read_for_the_epochs_of_the_link_alone() -> None:
    """An epoch only has to differ from the one before."""
    readers: Counter[str] = Counter()
    for path in (PACKAGES / "robot_runtime").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                dated = node.value.id in ("time", "datetime", "date") and node.attr in CALENDAR
            else:
                # By another name it could not be told from others.
                dated = isinstance(node, ast.ImportFrom) and node.module in ("time", "datetime")
            readers[str(path.relative_to(PACKAGES))] += dated
    assert +readers == {"robot_runtime/robot.py": 1, "robot_runtime/experiments/bring_up/bench.py": 1}
