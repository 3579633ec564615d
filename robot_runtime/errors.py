"""What goes wrong between the parts of the robot, told to whoever asked."""


class Refused(Exception):  # noqa: N818 - it says what happened
    """A question was understood and refused; the text says why and what to do."""


class NoAnswer(Exception):  # noqa: N818 - it says what happened
    """Nobody answered a question in time."""
