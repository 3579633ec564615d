"""The one error of this package."""


class RobotError(Exception):
    """The robot refused, or did not answer; the text says why, in the server's words."""
