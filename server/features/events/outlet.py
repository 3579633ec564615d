"""The common part of all ways to other programs: their condition in words, and their secrets."""

import ssl
import stat
from pathlib import Path
from typing import Literal, NamedTuple, Protocol

from robot_runtime.contract.published_events import PublishedEvent
from robot_runtime.contract.text_input import TextError, decode_text

WAITING_MAX = 200
"""Events that wait while the other end is away; further ones are lost, and counted."""
CONNECT_SECONDS = 5.0
CLOSE_SECONDS = 2.0
"""The end of the server waits so long for what is still to be sent."""
SECRET_BYTES_MAX = 1000
_DER = b"\x30"
"""The tag of a sequence, with which a certificate in DER begins."""


class OutletError(Exception):
    """Events cannot be sent; the text says why."""


class OutletCondition(NamedTuple):
    """The state of an outlet, and a sentence about it."""

    state: Literal["ok", "starting", "failed"]
    text: str


class EventOutlet(Protocol):
    """A way to other programs. No method waits but `close`."""

    def open(self) -> None:
        """Connect from now on, in a thread of its own."""

    def publish(self, event: PublishedEvent) -> None:
        """Send an event as soon as the other end is there."""

    def retain(self, name: str, text: str) -> None:
        """Set what a program that comes later should find: JSON, by name."""

    def condition(self) -> OutletCondition:
        """The state, and a sentence about it."""

    def close(self) -> None:
        """Send what waits, for at most CLOSE_SECONDS, and end."""


class Tally:
    """The condition of an outlet, and how many messages were sent and lost."""

    def __init__(self, address: str) -> None:
        self._address = address
        self._condition: tuple[Literal["ok", "starting", "failed"], str] = ("starting", "Connecting.")
        self.sent = 0
        self.lost = 0

    def set(self, state: Literal["ok", "starting", "failed"], text: str) -> None:
        """Set state and sentence."""
        self._condition = (state, text)

    def describe(self) -> OutletCondition:
        """The condition, with the address and the numbers."""
        state, text = self._condition
        lost = f", lost: {self.lost}" if self.lost else ""
        return OutletCondition(state, f"{self._address}: {text} Messages sent: {self.sent}{lost}.")


def read_secret(path: Path) -> str:
    """The first line of a file that only its owner can read. Raises OutletError."""
    try:
        if path.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO):
            raise OutletError(f"Other users can read {path}. Mend it with: chmod 600 {path}")
        with path.open("rb") as file:
            secret = decode_text(file.readline(SECRET_BYTES_MAX)).strip()
    except OSError as problem:
        raise OutletError(f"{path} cannot be read: {problem}.") from problem
    except TextError as problem:
        raise OutletError(f"{path} cannot be read: it {problem}.") from problem
    if not secret or not secret.isprintable():
        raise OutletError(f"The first line of {path} is empty, or no plain text.")
    return secret


def make_tls(authority: Path | None) -> ssl.SSLContext:
    """A context that trusts this authority alone, the computer's own where there is none.

    Raises OutletError.
    """
    try:
        return ssl.create_default_context(cadata=_read_authority(authority) if authority else None)
    except (OSError, ValueError) as problem:  # a broken certificate as well
        named = f"events.ca_file, {authority}," if authority else "The computer's own list of authorities"
        raise OutletError(f"{named} cannot be used: {problem}.") from problem


def _read_authority(path: Path) -> str | bytes:
    """The certificates in a file: PEM as a text, or one in DER, as Windows exports it."""
    data = path.read_bytes()
    if data.startswith(_DER):
        return data
    # What stands between the certificates may have any letters; OpenSSL takes ASCII alone.
    return decode_text(data).encode("ascii", "replace").decode("ascii")


def name_problem(problem: BaseException) -> str:
    """A problem of the network in words."""
    if isinstance(problem, ssl.SSLCertVerificationError):
        return f"its certificate is not trusted: {problem.verify_message}"
    if isinstance(problem, TimeoutError):
        return "it does not answer"
    return str(getattr(problem, "strerror", None) or problem or type(problem).__name__)
