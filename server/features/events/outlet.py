"""The secrets of an outlet to other programs, and its condition as text."""

import ssl
import stat
from pathlib import Path
from typing import Literal, NamedTuple

from robot_runtime.contract.text_input import TextError, decode_text

SECRET_BYTES_MAX = 1000
_DER = b"\x30"
"""The tag of a sequence, with which a certificate in DER begins."""


class OutletError(Exception):
    """Events cannot be sent; the text says why."""


class OutletCondition(NamedTuple):
    """The state of an outlet, and a sentence about it."""

    state: Literal["ok", "starting", "failed"]
    text: str


def read_secret(path: Path) -> str:
    """Return the first line of a file that only its owner can read. Raise OutletError."""
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
    """Return a context that trusts this authority alone; without one, the computer's own authorities.

    Raise OutletError.
    """
    try:
        return ssl.create_default_context(cadata=_read_authority(authority) if authority else None)
    except (OSError, ValueError) as problem:  # a broken certificate as well
        named = f"events.ca_file, {authority}," if authority else "The computer's own list of authorities"
        raise OutletError(f"{named} cannot be used: {problem}.") from problem


def _read_authority(path: Path) -> str | bytes:
    """Return the certificates in a file: PEM as a text, or one in DER, as Windows exports it."""
    data = path.read_bytes()
    if data.startswith(_DER):
        return data
    # What stands between the certificates may have any letters; OpenSSL takes ASCII alone.
    return decode_text(data).encode("ascii", "replace").decode("ascii")


def name_problem(problem: BaseException) -> str:
    """Return a problem of the network as text."""
    if isinstance(problem, ssl.SSLCertVerificationError):
        return f"its certificate is not trusted: {problem.verify_message}"
    if isinstance(problem, TimeoutError):
        return "it does not answer"
    return str(getattr(problem, "strerror", None) or problem or type(problem).__name__)
