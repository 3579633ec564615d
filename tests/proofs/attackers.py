"""The attackers of `attacks.py`, in a process of their own: each repeats one until its input is closed.

`python -m tests.proofs.attackers URL VIEWER OPERATOR ROS2 [WORDS]`, with two tokens and the folder of a
viewer's certificate for the door of ROS 2, prints a JSON object: for each attack an empty text where it was
held, else what went wrong. All loads are bounded, and on the loopback.
With words, it runs the attacks that have them in their names.
"""

import base64
import json
import logging
import shutil
import sys
import tempfile
import time
import zlib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing, suppress
from pathlib import Path
from threading import Event

import httpx
from websockets.exceptions import WebSocketException

from tests.proofs.field import PATIENCE, AttackedRobot
from tests.proofs.floods import FLOODS
from tests.released import ARCHIVE, RELEASED, SIGNALS
from tests.runtime.contract.test_toml_text import BOMBS, CHEAP
from tests.server.features.exports.test_imports import change, row_bomb, tell
from tests.server.features.exports.test_malformed_archives import MALFORMED

HOLD_SECONDS = 3.0
CROWD = "127.0.0.3"
"""The address of more connections than one may have, for which the server closes others of it."""
CONNECTIONS = 260
SOCKETS = 50
TRICKS = [
    "..",
    "%2e%2e",
    "..%2f",
    "%2e%2e%2f",
    "..%5c",
    "....//",
    "..;/",
    "%252e%252e",
    "%c0%ae%c0%ae",
    "/..//..",
]
FILES = ["etc/passwd", "data/mucat.db"]
HOSTS = [
    "evil.example",
    "evil.example:80",
    "127.0.0.1.evil.example",
    "",
    "[::2]",
    "localhost@evil.example",
    "0",
]
METHODS = ["TRACE", "CONNECT", "PROPFIND", "DELETE"]
COMMANDS: list[object] = [
    {},
    [],
    {"default": "x"},
    {"default": 1e999},
    {"default": None},
    {"name": "\ud800"},
    "x",
    None,
]


def paths(field: AttackedRobot) -> None:
    for trick in TRICKS:
        for file in FILES:
            head = f"GET /{trick}/{trick}/{file} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"
            data = field.send(head.encode())
            assert not data.startswith(b"HTTP/1.1 5"), (trick, data)


def hosts(field: AttackedRobot) -> None:
    for host in HOSTS:
        data = field.send(f"GET /api/robot HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n".encode())
        assert data.startswith(b"HTTP/1.1 4"), (host, data)
    for method in METHODS:
        field.refuse(method, "/api/robot", field.viewer)


def authorizations(field: AttackedRobot) -> None:
    token = field.viewer["authorization"].removeprefix("Bearer ")
    basic = base64.b64encode(f"x:{token}".encode()).decode()
    forms = [
        f"Basic {basic}",
        token,
        f"bearer{token}",
        f"Token {token}",
        "Bearer",
        f"Bearer {token[:-1]}",
        "Bearer x",
    ]
    for form in forms:
        assert field.ask("GET", "/api/robot", {"authorization": form}) == 401, form
    assert field.ask("GET", f"/api/robot?token={token}", {"x-forwarded-for": "127.0.0.1"}) == 401


def codes(field: AttackedRobot) -> None:
    for code in ("0000-0000", "", "x" * 1000, "\ud800"):
        field.refuse("POST", "/api/access/pair", {"origin": field.url}, content=json.dumps({"code": code}))


def forgeries(field: AttackedRobot) -> None:
    for origin in ("http://evil.example", "null", "http://127.0.0.1:1"):
        field.refuse("POST", "/api/robot/commands/arm", {"origin": origin, "cookie": "mucat=x"}, json={})


def escalations(field: AttackedRobot) -> None:
    for method, path in (
        ("POST", "/api/robot/commands/arm"),
        ("POST", "/api/control/take"),
        ("POST", "/api/access/tokens"),
        ("POST", "/api/imports"),
        ("DELETE", "/api/sessions/1"),
        ("GET", "/api/access/devices"),
        ("POST", "/api/scenarios/runs"),
    ):
        assert field.ask(method, path, field.viewer, json={}) in (403, 404, 405, 422), path


def takes(field: AttackedRobot) -> None:
    with ThreadPoolExecutor(12) as threads:
        list(threads.map(lambda _: field.ask("POST", "/api/control/take", field.operator), range(12)))
    field.ask("POST", "/api/control/release", field.operator)


def nonsense(field: AttackedRobot) -> None:
    with suppress(OSError, WebSocketException), field.open(field.viewer) as page:
        for message in ("{", "[]", '{"op": 5}', '{"op": "drive"}', '{"op": "ping", "id": 1e999}', "x" * 5000):
            page.send(message)
        for number in range(300):
            page.send(json.dumps({"op": "ping", "id": number}))


def many_sockets(field: AttackedRobot) -> None:
    with ExitStack() as opened:
        for _ in range(SOCKETS):
            with suppress(OSError, WebSocketException):
                opened.enter_context(closing(field.open(field.viewer)))
        with field.open(field.operator) as page:
            page.recv(PATIENCE)


def slow(field: AttackedRobot) -> None:
    beginnings = [
        b"",
        b"GET /api/robot HT",
        b"POST /api/access/pair HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99\r\n\r\n{",
    ]
    with ExitStack() as opened:
        for number in range(CONNECTIONS):
            with suppress(OSError):
                line = opened.enter_context(field.reach(5, CROWD))
                line.sendall(beginnings[number % len(beginnings)])
        time.sleep(HOLD_SECONDS)


def bodies(field: AttackedRobot) -> None:
    path = "/api/scenarios/check"
    for content in (
        b"[" * 100_000,
        b'{"text": ' + b"[" * 50_000,
        b'{"text": NaN}',
        b"\xff",
        b"x" * 3_000_000,
    ):
        field.refuse("POST", path, field.viewer, content=content)
    head = f"POST {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n".encode()
    for rest in (b"Content-Length: -1\r\n\r\n", b"X: " + b"x" * 20_000_000 + b"\r\n\r\n"):
        with suppress(ConnectionError, TimeoutError):
            data = field.send(head + rest)
            assert not data.startswith(b"HTTP/1.1 5"), data


def toml_bombs(field: AttackedRobot) -> None:
    for text in [*BOMBS.values(), *CHEAP.values()]:
        status = field.ask("POST", "/api/scenarios/check", field.viewer, json={"text": text})
        assert status in (200, 413, 422, 429, 503), (status, text[:40])
        field.refuse("POST", "/api/vision/read", field.viewer, json={"text": text[:19_000]})
        field.refuse("POST", "/api/scenarios/runs", field.operator, json={"text": text, "place": "simulated"})


def odd_commands(field: AttackedRobot) -> None:
    for body in COMMANDS:
        field.refuse("POST", "/api/robot/commands/set_points", field.operator, content=json.dumps(body))
    for number in ("nan", "inf", "1e999", "-1e308", "x", ""):
        field.ask("GET", f"/api/compare/report?sessions=1&view_start={number}&view_end=1", field.viewer)
        field.ask("GET", f"/api/sessions/1/blocks?start={number}&end=1", field.viewer)


def archives(field: AttackedRobot) -> None:
    edits = [row_bomb, *(edit for edit, _ in MALFORMED.values())]
    gaps = [{"topic": "depth", "kind": "missed", "time": 1.5, "missed": 1}] * 100_000
    with tempfile.TemporaryDirectory() as folder:
        for edit in [*edits, tell(gaps=gaps, state="odd")]:
            path = Path(shutil.copy(RELEASED / "0.2.0" / ARCHIVE, folder))
            change(path, edit)
            field.refuse("POST", "/api/imports", field.operator, content=path.read_bytes())


def heavy_reading(field: AttackedRobot) -> None:
    query = {"sessions": [1], "signals": SIGNALS, "view": {"start": -1e308, "end": 1e308}}
    field.ask("POST", "/api/compare", field.viewer, json=query)
    field.ask("GET", f"/api/compare/report?sessions=1&signals={','.join(SIGNALS)}", field.viewer)
    field.ask("GET", "/api/sessions/1/blocks?start=0&end=120&history=60", field.viewer)
    field.ask("POST", "/api/exports", field.viewer, json={"session": 1, "format": "csv"})


ATTACKS: dict[str, Callable[[AttackedRobot], None]] = {
    "path tricks": paths,
    "hosts and methods": hosts,
    "forms of Authorization": authorizations,
    "codes": codes,
    "forged requests": forgeries,
    "viewer's escalations": escalations,
    "twelve takes at once": takes,
    "odd messages on a socket": nonsense,
    "fifty sockets": many_sockets,
    "slow heads and bodies, 260 connections": slow,
    "odd and large bodies": bodies,
    "TOML bombs": toml_bombs,
    "odd commands and numbers": odd_commands,
    "bombs and lies in archives": archives,
    "comparisons, reports, replays, exports": heavy_reading,
}


def repeat(attack: Callable[[AttackedRobot], None], field: AttackedRobot, end: Event) -> tuple[str, int]:
    """Repeat an attack, once at least, until the end; return what went wrong, and how often it was made."""
    made, ended = 0, False
    while not ended:
        try:
            attack(field)
        except (
            AssertionError,
            httpx.HTTPError,
            OSError,
            WebSocketException,
            TimeoutError,
            zlib.error,
        ) as problem:
            return f"{type(problem).__name__}: {problem}"[:300], made
        made += 1
        ended = end.is_set()
    return "", made


def choose(message: str) -> dict[str, Callable[[AttackedRobot], None]]:
    """Return the attacks that have these words in their names, or the flood of this name."""
    if message in FLOODS:
        return {message: FLOODS[message]}
    return {name: attack for name, attack in ATTACKS.items() if message in name}


def main() -> None:
    """Run every attack at once."""
    # It logs an internal error, with its trace, where a connection ends in the middle of a message.
    logging.getLogger("websockets").setLevel(logging.CRITICAL)
    url, viewer, operator, ros2, *arguments = sys.argv[1:]
    field, end, attacks = (
        AttackedRobot(url, viewer, operator, Path(ros2)),
        Event(),
        choose(" ".join(arguments)),
    )
    with ThreadPoolExecutor(len(attacks)) as threads:
        result = threads.map(lambda attack: repeat(attack, field, end), attacks.values())
        sys.stdin.read()
        end.set()
    print(json.dumps(dict(zip(attacks, result, strict=True))))


if __name__ == "__main__":
    main()
