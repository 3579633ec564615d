"""Schema of error answers."""

from typing import Any

from pydantic import BaseModel

from server.platform.errors import ApiError


class Problem(BaseModel):
    """An error: its cause, and the remedy."""

    detail: str


def answers(*errors: type[ApiError], **codes: str) -> dict[int | str, dict[str, Any]]:
    """Descriptions of answers by status, for the interface's document: of errors, or `_409="..."`."""
    texts = {error.status: str(error.__doc__).partition("\n")[0] for error in errors}
    texts |= {int(code[1:]): text for code, text in codes.items()}
    return {status: {"model": Problem, "description": text} for status, text in texts.items()}


EVERYWHERE: dict[int | str, dict[str, Any]] = {
    "4XX": {
        "model": Problem,
        "description": "Refused: not signed in (401), not allowed or from elsewhere (403), too large (413), "
        "not valid (422)",
    }
}
"""The answers that every operation may give."""

SILENT = answers(_503="The runtime is not running", _504="The runtime did not answer within 2 s")
"""Of what is asked of the runtime."""
COMMAND = {
    **answers(
        _409="The runtime refuses", _422="The request is not valid", _423="Control is with somebody else"
    ),
    **SILENT,
}
"""Of commands to the robot."""
