"""The one error of this package."""


class RobotError(Exception):
    """The robot refused, or did not answer; the text is the server's reason.

    `status` is the server's HTTP status; None where it did not answer.
    """

    def __init__(self, text: str, status: int | None = None) -> None:
        super().__init__(text)
        self.status = status
