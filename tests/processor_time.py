"""Processor time of the tests, by file: where the minutes of `make test` go, also on a busy computer."""

import os
from collections import defaultdict
from contextlib import suppress

import psutil
import pytest

LINES = 8
"""Files in the summary."""


class ProcessorTime:
    """A plugin of pytest that counts the time of this process and of all that it has started."""

    def __init__(self) -> None:
        self._spent: defaultdict[str, float] = defaultdict(float)
        self._before = spent()

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item, nextitem: pytest.Item | None) -> object:
        """Count at the end of a file, since each look at all processes takes milliseconds."""
        result = yield
        if nextitem is None or nextitem.path != item.path:
            now = spent()
            # What a process took that nobody waits for, such as a daemon, is gone with it.
            self._spent[item.nodeid.partition("::")[0]] += max(0.0, now - self._before)
            self._before = now
        return result

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """Write the files that took most."""
        whole = sum(self._spent.values())
        terminalreporter.section(f"processor time: {whole:.0f} s")
        for name, seconds in sorted(self._spent.items(), key=lambda entry: -entry[1])[:LINES]:
            terminalreporter.line(f"{seconds:7.1f} s {name}")


def spent() -> float:
    """Return s of this process, its ended children and its living descendants."""
    times = os.times()
    whole = times.user + times.system + times.children_user + times.children_system
    for process in psutil.Process().children(recursive=True):
        with suppress(psutil.Error):
            own = process.cpu_times()
            whole += own.user + own.system + own.children_user + own.children_system
    return whole
