"""The OpenAPI document of the interface: FastAPI's description of the routes, with sign-in and examples."""

from typing import Any

from fastapi import FastAPI

from server.http.sign_in.access import PAGE_HEADER
from server.http.sign_in.policy import DECLARED, LINKED, Need

TOKEN, COOKIE, SECRET = "token", "cookie", "pageSecret"
SERVER = {"url": "/", "description": "the robot that serves this document"}
MISSION = """\
format = 1
name = "short_dive"
title = "A short dive"

[mission]
do = "sequence"
steps = [
  { do = "dive", depth = 0.6, timeout = 30 },
  { do = "surface" },
]
"""
SCENARIO = """\
name = "short"
title = "A short run"
duration = 10

[scene]
kind = "pool"
depth = 3.0
length = 10.0
width = 5.0

[[events]]
at = 1
do = "arm"
"""
BODIES: dict[str, Any] = {
    "pairBrowser": {"code": "2345-6789", "name": "Anna's laptop"},
    "makeToken": {"name": "notebook", "scope": "operate"},
    "startSession": {"name": "Dive 7", "note": "calm water"},
    "changeSession": {"tags": ["calm", "pid"]},
    "addMark": {"text": "here it turned"},
    "commandArm": {"mode": "manual"},
    "commandMode": {"mode": "automatic"},
    "commandLoop": {"name": "depth", "set_point": 0.8, "gains": {"kp": 4.0}},
    "commandParameters": {"values": {"depth.pid.kp": 4.0}},
    "commandSteering": {"by": "beacons"},
    "commandCard": {"colour": "yellow"},
    "startExport": {"session": 1, "format": "csv"},
    "compareSessions": {"sessions": [1, 2], "signals": ["depth.depth"]},
    "keepMission": {"text": MISSION},
    "checkMission": {"text": MISSION},
    "startMission": {"text": MISSION},
    "startMissionTrial": {"text": MISSION, "seeds": 3},
    "keepScenario": {"text": SCENARIO},
    "checkScenario": {"text": SCENARIO},
    "startScenario": {"text": SCENARIO, "place": "simulated", "board": "host"},
    "saveProfile": {"name": "calm water"},
    "undoParameters": {"change": 3},
    "pickColour": {"x": 0.5, "y": 0.5},
}
"""Examples of bodies that programs send, by operation."""


class DescribedApp(FastAPI):
    """An application whose document describes the sign-in; `cookie` is the name of a browser's cookie."""

    def __init__(self, *, cookie: str, **options: Any) -> None:
        super().__init__(servers=[SERVER], **options)
        self._cookie = cookie

    def openapi(self) -> dict[str, Any]:
        """Return the OpenAPI document, always the same."""
        document = super().openapi()
        document["components"]["securitySchemes"] = _schemes(self._cookie)
        for methods in document["paths"].values():
            for operation in methods.values():
                operation["security"] = _security(operation)
                if (body := BODIES.get(operation["operationId"])) is not None:
                    operation["requestBody"]["content"]["application/json"]["example"] = body
        return document


def _schemes(cookie: str) -> dict[str, Any]:
    return {
        TOKEN: {
            "type": "http",
            "scheme": "bearer",
            "description": "A program's token, of `mucat access token NAME --scope SCOPE`. It counts alone.",
        },
        COOKIE: {
            "type": "apiKey",
            "in": "cookie",
            "name": cookie,
            "description": "A browser's sign-in, of `POST /api/access/pair`. Its name has the server's port.",
        },
        SECRET: {
            "type": "apiKey",
            "in": "header",
            "name": PAGE_HEADER,
            "description": "`page_secret` of the answer of `POST /api/access/pair`, beside the cookie.",
        },
    }


def _security(operation: dict[str, Any]) -> list[dict[str, list[str]]]:
    """Return the ways to sign in for an operation; none where it needs no sign-in."""
    if operation[DECLARED] == Need.NOTHING.name.lower():
        return []
    browser: dict[str, list[str]] = {COOKIE: []} if LINKED in operation else {COOKIE: [], SECRET: []}
    return [{TOKEN: []}, browser]
