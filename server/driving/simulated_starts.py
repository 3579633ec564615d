"""The start of scenarios in simulated time, for features that do not run scenarios themselves."""

from collections.abc import Callable

from robot_runtime.errors import RefusedError

Start = Callable[[str, str], str]
"""Runs the scenario of a text for a person, and returns its run. Raises ConfigError, RefusedError."""


class SimulatedStarts:
    """The one who runs scenarios in simulated time, each as a session."""

    def __init__(self) -> None:
        self._start: Start | None = None

    def provide(self, start: Start) -> None:
        """Be the one."""
        self._start = start

    def start(self, text: str, who: str) -> str:
        """Run a scenario and return its run. Raise ConfigError, RefusedError."""
        if self._start is None:
            raise RefusedError("Scenarios are off on this server.")
        return self._start(text, who)
