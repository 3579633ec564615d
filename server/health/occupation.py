"""The occupation of the robot or its board by one task, for which others wait."""

from collections.abc import Callable

Reason = Callable[[], str | None]
"""A sentence that says who and until when; None where nobody has it."""


class Occupation:
    """The tasks that may occupy the robot or its board; a task with the robot has its board, too."""

    def __init__(self) -> None:
        self.robot: list[Reason] = []
        self.board: list[Reason] = []

    def of_robot(self) -> str | None:
        """Return the reason why the robot is not free now."""
        return next((why for reason in self.robot if (why := reason()) is not None), None)

    def of_board(self) -> str | None:
        """Return the reason why the board is not free now."""
        return self.of_robot() or next((why for reason in self.board if (why := reason()) is not None), None)
