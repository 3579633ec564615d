"""The one error of this package."""


class RobotError(Exception):
    """The robot refused, or did not answer; the text is the server's reason."""
