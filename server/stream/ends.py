"""Ends of runs, reported to other programs."""

from collections.abc import Callable

SeeEnd = Callable[[int, str, str, str], None]
"""Gets the number of a run, its name, its end in a word and its problem, which may be empty."""


class RunEnds:
    """The channel for the ends of communication tests."""

    def __init__(self) -> None:
        self.listeners: list[SeeEnd] = []

    def see(self, run: int, name: str, state: str, problem: str) -> None:
        """Pass an end on."""
        for listener in self.listeners:
            listener(run, name, state, problem)
