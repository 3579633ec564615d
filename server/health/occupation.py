"""The occupation of the robot or its board by one task, for which others wait."""

from collections.abc import Callable

Reason = Callable[[], str | None]
"""A sentence that says who and until when; None where nobody has it."""


class Occupation:
    """Asks those who may have the robot or its board; whoever has the robot has its board, too."""

    def __init__(self) -> None:
        self.robot: list[Reason] = []
        self.board: list[Reason] = []

    def of_robot(self) -> str | None:
        """The reason why the robot cannot be had now."""
        return next((why for reason in self.robot if (why := reason()) is not None), None)

    def of_board(self) -> str | None:
        """The reason why the board cannot be had now."""
        return self.of_robot() or next((why for reason in self.board if (why := reason()) is not None), None)
