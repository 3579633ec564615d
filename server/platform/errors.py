"""Errors of the server, each with the HTTP status of its answer.

The text of an error says what happened, why, and what to do. The first line of its class's docstring
describes it in the interface's document.
"""

from collections.abc import Mapping


class ApiError(Exception):
    """Something went wrong in the server"""

    status: int = 500
    headers: Mapping[str, str] = {}
    """Additional headers of the answer."""
    kind: str = ""
    """Tells a program what to do, where the status alone does not."""

    @property
    def detail(self) -> str:
        """The text of the answer."""
        return str(self)

    @classmethod
    def answers(cls) -> Mapping[int, str]:
        """Return the statuses of this error's answers, described for the interface's document."""
        return {cls.status: str(cls.__doc__).partition("\n")[0]}


class SignedOutError(ApiError):
    """Not signed in"""

    status = 401
    headers: Mapping[str, str] = {"www-authenticate": "Bearer"}


class ForbiddenError(ApiError):
    """Not allowed"""

    status = 403


class NotFoundError(ApiError):
    """There is no such thing"""

    status = 404


class ConflictError(ApiError):
    """Refused now"""

    status = 409


class InvalidError(ApiError):
    """The request is not valid"""

    status = 422


class UnavailableError(ApiError):
    """Something that the server needs does not work"""

    status = 503


class InsufficientStorageError(ApiError):
    """It cannot be written: the disk is full, or broken"""

    status = 507


def explain_internal_error(error: Exception) -> str:
    """Return a sentence for a person about an unforeseen error; the caller logs it."""
    return f"Internal error ({error!r}); the server's log has details."
