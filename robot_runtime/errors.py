"""What goes wrong between the parts of the robot, told to whoever asked."""


class RefusedError(Exception):
    """A question was understood and refused; the text says why and what to do."""


class NoAnswerError(Exception):
    """Nobody answered a question in time."""
