"""Requests to another computer's server, whose certificate is known by its fingerprint.

They block; call them in a thread.
"""

import json
import ssl
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from http.client import HTTPConnection, HTTPException, HTTPResponse, HTTPSConnection
from typing import Any
from urllib.parse import SplitResult, urlsplit

from server.http.sign_in.tokens import CODE_ALPHABET
from server.platform.certificate import fingerprint_of

PIN_LENGTH = 16
"""79 bits of a fingerprint: nobody makes another certificate with the same ones."""
ANSWER_BYTES_MAX = 8_000_000
"""Of a document: a session may have a million characters of notes."""
CONNECT_SECONDS_MAX = 5.0
REFUSED = 400
"""This status, and those after it."""
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


def known_by(fingerprint: str) -> Callable[[str], bool] | None:
    """Return `is_meant` for a server with this fingerprint; empty: public authorities vouch for it."""
    return (lambda shown: shown == fingerprint) if fingerprint else None


def send(
    address: str,
    method: str,
    path: str,
    *,
    is_meant: Callable[[str], bool] | None,
    token: str = "",
    body: Mapping[str, Any] | None = None,
    seconds: float,
) -> Any:
    """Send a request below /api of the server at `address`; return its answer, None where it is empty.

    Raise as `open_answer`.
    """
    with open_answer(
        address, method, path, is_meant=is_meant, token=token, body=body, seconds=seconds
    ) as answer:
        return read_document(address, answer)


def read_document(address: str, answer: HTTPResponse) -> Any:
    """Return the JSON of an answer, None where it is empty. Raise UnreachableError."""
    try:
        text = answer.read(ANSWER_BYTES_MAX)
        return json.loads(text) if text else None
    except (OSError, HTTPException, ValueError) as problem:
        raise _unreachable(address, problem) from problem


def read_piece(address: str, answer: HTTPResponse, size: int) -> bytes:
    """Return up to `size` bytes of an answer, none at its end. Raise UnreachableError."""
    try:
        return answer.read(size)
    except (OSError, HTTPException) as problem:
        raise _unreachable(address, problem) from problem


@contextmanager
def open_answer(
    address: str,
    method: str,
    path: str,
    *,
    is_meant: Callable[[str], bool] | None,
    token: str = "",
    body: Mapping[str, Any] | None = None,
    headers: Mapping[str, str] | None = None,
    seconds: float,
) -> Iterator[HTTPResponse]:
    """Send a request below /api of the server at `address`; yield its answer, for reading within the context.

    `is_meant` judges the fingerprint of an https server's certificate before anything is sent to it; with
    None, public authorities do. `seconds` may pass without a byte. Raise UnreachableError,
    OtherServerRefusedError.
    """
    sent = {**(headers or {}), **({"authorization": f"Bearer {token}"} if token else {})}
    data = None
    if body is not None:
        data, sent["content-type"] = json.dumps(body).encode(), "application/json"
    elif method == "POST":
        data = b""
    connection = _connection(urlsplit(address), min(seconds, CONNECT_SECONDS_MAX), is_meant is None)
    try:
        try:
            connection.connect()
            connection.sock.settimeout(seconds)
            if (
                isinstance(connection, HTTPSConnection)
                and is_meant is not None
                and not is_meant(_fingerprint(connection))
            ):
                raise UnreachableError(
                    f"The server at {address} has another certificate than the one that is meant. Somebody "
                    "may stand between, or the server was set up anew."
                )
            connection.request(method, f"/api{path}", data, sent)
            answer = connection.getresponse()
            refusal = answer.read(ANSWER_BYTES_MAX) if answer.status >= REFUSED else b""
        except (OSError, HTTPException, ValueError) as problem:
            raise _unreachable(address, problem) from problem
        if answer.status >= REFUSED:
            raise OtherServerRefusedError(answer.status, _detail(refusal, answer.status))
        yield answer
    finally:
        connection.close()


def _unreachable(address: str, problem: Exception) -> UnreachableError:
    reason = getattr(problem, "strerror", None) or str(problem) or type(problem).__name__
    return UnreachableError(f"{address} does not answer: {reason}.")


def _connection(address: SplitResult, seconds: float, trusted: bool) -> HTTPConnection:
    host, port = address.hostname or "", address.port or PORTS[address.scheme]
    if address.scheme == "http":
        return HTTPConnection(host, port, timeout=seconds)
    context = ssl.create_default_context()
    if not trusted:
        # The fingerprint says more than an authority could; and a clock that nobody has set refuses nothing.
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
