"""Somebody who has signed in: a person's browser, a program, or the shell of this computer."""

from dataclasses import dataclass
from typing import Literal

from starlette.requests import HTTPConnection

Role = Literal["viewer", "operator"]
Kind = Literal["browser", "program", "shell"]

IDENTITY = "identity"
"""The entry of an ASGI scope that holds who asks."""


@dataclass(frozen=True, slots=True)
class Identity:
    """Who asks. `device` is the number of the browser or program that was paired; 0 is the shell."""

    device: int
    name: str
    role: Role
    kind: Kind

    @staticmethod
    def of(connection: HTTPConnection) -> "Identity":
        """Who asks this; of a request that was admitted there is one."""
        identity = connection.scope[IDENTITY]
        assert isinstance(identity, Identity)
        return identity


SHELL = Identity(device=0, name="the shell of this computer", role="operator", kind="shell")
"""Whoever can read this computer's data folder."""
