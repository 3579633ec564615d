"""Errors that answer a request."""


class RefusedError(Exception):
    """A request was refused; the text says why and what to do."""


class NoAnswerError(Exception):
    """A request was not answered in time."""
