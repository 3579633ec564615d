"""Requests to another computer's server, whose self-signed certificate is known by its fingerprint.

Blocks; call it in a thread.
"""

import json
import ssl
from collections.abc import Callable, Mapping
from http.client import HTTPConnection, HTTPException, HTTPSConnection
from typing import Any
from urllib.parse import SplitResult, urlsplit

from server.http.sign_in.tokens import CODE_ALPHABET
from server.platform.certificate import fingerprint_of

PIN_LENGTH = 16
"""79 bits of a fingerprint: nobody makes another certificate with the same ones."""
ANSWER_BYTES_MAX = 1_000_000
PORTS = {"http": 80, "https": 443}


class UnreachableError(Exception):
    """The other server cannot be reached, or is not the one that is meant; the text says which, in words."""


class OtherServerRefusedError(Exception):
    """The other server refused; the text is its reason."""

    def __init__(self, status: int, text: str) -> None:
        super().__init__(text)
        self.status = status


def pin_of(fingerprint: str) -> str:
    """Return the characters of a certificate's fingerprint that are part of a joining code."""
    number, pin = int(fingerprint.replace(":", ""), 16), ""
    for _ in range(PIN_LENGTH):
        number, digit = divmod(number, len(CODE_ALPHABET))
        pin += CODE_ALPHABET[digit]
    return pin


def send(
    address: str,
    method: str,
    path: str,
    *,
    is_meant: Callable[[str], bool],
    token: str = "",
    body: Mapping[str, Any] | None = None,
    seconds: float,
) -> Any:
    """Send a request below /api of the server at `address`; return its answer, None where it is empty.

    `is_meant` judges the fingerprint of an https server's certificate before anything is sent to it.
    Raise UnreachableError, OtherServerRefusedError.
    """
    headers = {"authorization": f"Bearer {token}"} if token else {}
    data = None
    if body is not None:
        data, headers["content-type"] = json.dumps(body).encode(), "application/json"
    elif method == "POST":
        data = b""
    connection = _connection(urlsplit(address), seconds)
    try:
        connection.connect()
        if isinstance(connection, HTTPSConnection) and not is_meant(_fingerprint(connection)):
            raise UnreachableError(
                f"The server at {address} has another certificate than the one that is meant. Somebody may "
                "stand between, or the server was set up anew."
            )
        connection.request(method, f"/api{path}", data, headers)
        answer = connection.getresponse()
        text = answer.read(ANSWER_BYTES_MAX)
        if answer.status >= 400:
            raise OtherServerRefusedError(answer.status, _detail(text, answer.status))
        return json.loads(text) if text else None
    except (OSError, HTTPException, ValueError) as problem:
        reason = getattr(problem, "strerror", None) or str(problem) or type(problem).__name__
        raise UnreachableError(f"{address} does not answer: {reason}.") from problem
    finally:
        connection.close()


def _connection(address: SplitResult, seconds: float) -> HTTPConnection:
    host, port = address.hostname or "", address.port or PORTS[address.scheme]
    if address.scheme == "http":
        return HTTPConnection(host, port, timeout=seconds)
    # The fingerprint says more than an authority could; and a clock that nobody has set refuses nothing.
    context = ssl.create_default_context()
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    return HTTPSConnection(host, port, timeout=seconds, context=context)


def _fingerprint(connection: HTTPSConnection) -> str:
    certificate = connection.sock.getpeercert(binary_form=True)
    return fingerprint_of(certificate or b"")


def _detail(text: bytes, status: int) -> str:
    try:
        return str(json.loads(text)["detail"])
    except (ValueError, KeyError, TypeError):
        return f"It refused with status {status}, and gave no reason."
