"""Errors of the server, each with the HTTP status of the answer that tells it.

The text of an error says what happened, why, and what to do. The first line of its class's docstring
describes it in the interface's document.
"""

from collections.abc import Mapping
from typing import ClassVar


class ApiError(Exception):
    """Something went wrong in the server"""

    status: ClassVar[int] = 500

    @property
    def answer_status(self) -> int:
        """The HTTP status of this one; a class whose errors differ overrides it."""
        return self.status

    @property
    def detail(self) -> str:
        """The text of the answer."""
        return str(self)

    @property
    def headers(self) -> Mapping[str, str]:
        """Additional headers of the answer."""
        return {}


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
