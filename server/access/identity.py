"""Somebody who has signed in: a person's browser, a program, or the shell of this computer."""

from dataclasses import dataclass
from typing import Literal

Role = Literal["viewer", "operator"]
Kind = Literal["browser", "program", "shell"]


@dataclass(frozen=True, slots=True)
class Identity:
    """Who asks. `device` is the number of the browser or program that was paired; 0 is the shell."""

    device: int
    name: str
    role: Role
    kind: Kind
