"""The identity of a caller: a browser, a program, a reading link, or the shell of this computer."""

from dataclasses import dataclass
from typing import Annotated, Literal

from fastapi import Depends
from starlette.requests import HTTPConnection

from server.platform.audit_file import SHELL_NAME

Role = Literal["viewer", "operator"]
Kind = Literal["browser", "program", "lab", "reader", "shell"]
Scope = Literal["read", "operate", "administer"]
"""Rights of a token: those of a viewer; of an operator who does not administer; of an operator."""

IDENTITY = "identity"
"""The entry of an ASGI scope that holds the caller's identity."""
SIGN_IN_ENDED = "sign_in_ended"
"""The entry of an ASGI scope that says why a sign-in that the caller shows counts no longer."""


@dataclass(frozen=True, slots=True)
class Identity:
    """A caller. `device` is the number of the browser, program, lab or reading link; 0 is the shell.

    A lab is one that this robot has joined: a viewer who may fetch sessions into an archive.
    `limited` is a program that may not administer, also not as an operator. `session` is the one session that
    a reader may read; None for all others.
    """

    device: int
    name: str
    role: Role
    kind: Kind
    limited: bool = False
    session: int | None = None


async def identify_caller(connection: HTTPConnection) -> Identity:
    """Return the identity behind a request that was admitted."""
    identity = connection.scope[IDENTITY]
    assert isinstance(identity, Identity)
    return identity


Caller = Annotated[Identity, Depends(identify_caller)]
"""A route's parameter that is the caller's identity."""

SHELL = Identity(device=0, name=SHELL_NAME, role="operator", kind="shell")
"""The identity of a shell that can read this computer's data folder."""
