"""Identifiers of runs in the server's memory, and the refusal of ended ones.

A number from 1 would come again with each start of the server: a page or a program from before it would then
read or cancel another run than it means.
"""

from secrets import token_hex

from server.platform.errors import ConflictError

RUN_BYTES = 8
RUN_MEANING = f"{2 * RUN_BYTES} hexadecimal digits, never used again"


class RunOverError(ConflictError):
    """This run is over"""

    def __init__(self, what: str) -> None:
        super().__init__(f"This {what} is over, or of an earlier start of the server. Nothing was changed.")


def new_run() -> str:
    """Return an identifier for a run that begins."""
    return token_hex(RUN_BYTES)


def require_run(meant: str | int | None, present: str | int | None, what: str) -> None:
    """Refuse a request that means another run than the present one; one without a run means any.

    Raise RunOverError.
    """
    if meant is not None and meant != present:
        raise RunOverError(what)
