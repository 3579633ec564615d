"""A request to each route, and its answer for a permitted requester.

Most requests are valid, and about something that is there: their answer is the route's success. The others
are exceptions, each with its reason in `because` and its own words, which no router and no guard says.
"""

import json
from dataclasses import asdict, dataclass, field
from typing import Any

from robot_runtime.contract.calibration import EMULATED
from robot_runtime.contract.vision_settings import VisionSettings
from server.platform.settings import Settings

SESSION = "/api/sessions/{session}"
NOT_THERE = 404
GONE = "It would be gone for all that is asked afterwards."
STARTS = "It would start a process each time."
CODE = "a new code"
OPERATOR_CODE = "a new operator's code"
"""In a body: codes that the shell has just made."""
CALIBRATION = json.loads(json.dumps(asdict(EMULATED)))
NEW_NAME = "a new name"
"""In a body: a name that nobody has."""


@dataclass(frozen=True)
class Probe:
    """Request to a route, with the status and words of its answer."""

    status: int = 200
    body: Any = field(default_factory=dict)
    query: str = ""
    words: str = ""
    because: str = ""
    named: dict[str, str] = field(default_factory=dict)
    """Parts of the path that differ from `THERE`."""


THERE = {
    "session": "1",
    "run": "1",
    "device": "1",
    "layout": "1",
    "profile": "1",
    "panel": "mine",
    "mark": "1",
}
THERE |= {"export": "0" * 16, "path": "index.html"}


def absent(thing: str, words: str, because: str, **more: Any) -> Probe:
    """A request about something that does not exist."""
    return Probe(NOT_THERE, words=words, because=because, named={thing: "999"}, **more)


STEP: dict[str, Any] = {
    "kind": "step",
    "low": 2.0,
    "high": 0.0,
    "start": 0.3,
    "target": 0.6,
    "tolerance": 0.1,
}
STEP |= {"settle": 10.0, "duration": 20.0}

NO_ADDRESS = Probe(404, words="There is no such address", because="It answers what nothing has.")
PROBES: dict[tuple[str, str], Probe] = {
    ("GET", "/api"): NO_ADDRESS,
    **{
        (method, "/api/{path:path}"): NO_ADDRESS
        for method in ("GET", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")
    },
    ("POST", "/api/robot/commands/{name}"): Probe(
        404, words="There is no command 'fly'", because="It answers what nothing has.", named={"name": "fly"}
    ),
    ("GET", "/help"): Probe(307),
    ("GET", "/api/alive"): Probe(204),
    ("POST", "/api/access/pair"): Probe(body={"code": CODE, "name": "somebody"}),
    ("POST", "/api/access/confirm"): Probe(204, {"code": OPERATOR_CODE}),
    ("POST", "/api/access/codes"): Probe(201),
    ("PATCH", "/api/access/devices/{device}"): Probe(body={"name": "viewer"}),
    ("DELETE", "/api/access/devices/{device}"): absent("device", "There is no device 999", GONE),
    ("POST", "/api/access/tokens"): Probe(201, {"name": NEW_NAME}),
    ("POST", "/api/control/take"): Probe(query="over=true"),
    ("POST", "/api/robot/stop"): Probe(204),
    ("GET", "/api/firmware"): Probe(),
    ("POST", "/api/firmware"): Probe(
        409,
        {"firmware": "previous"},
        words="There is no previous firmware",
        because="It would upload to the board.",
    ),
    ("GET", "/api/bring-up"): Probe(),
    ("GET", "/api/bring-up/report"): Probe(
        NOT_THERE, words="There was no bring-up yet", because="A bring-up would upload to the board."
    ),
    ("POST", "/api/bring-up"): Probe(409, words="is being recorded", because="It would upload to the board."),
    ("POST", "/api/bring-up/actions"): Probe(
        409,
        {"step": "devices", "action": "scan"},
        words="The board is not ready",
        because="It needs a board with the sketch.",
    ),
    ("POST", "/api/bring-up/hands"): Probe(
        409, {"lamp": "right"}, words="Only an emulated robot", because="It needs a bring-up that goes on."
    ),
    ("DELETE", "/api/bring-up"): Probe(),
    ("POST", "/api/robot/commands/acknowledge"): Probe(204),
    ("POST", "/api/robot/commands/arm"): Probe(204),
    ("POST", "/api/robot/commands/mode"): Probe(204, {"mode": "manual"}),
    ("POST", "/api/robot/commands/check_fins"): Probe(204),
    ("POST", "/api/robot/commands/mission_pause"): Probe(204),
    ("POST", "/api/robot/commands/mission_skip"): Probe(204),
    ("POST", "/api/robot/commands/mission_end"): Probe(204),
    ("POST", "/api/robot/commands/calibrate"): Probe(204, {"values": CALIBRATION}),
    ("POST", "/api/robot/commands/measure_gyro"): Probe(204),
    ("POST", "/api/robot/commands/zero_depth"): Probe(204),
    ("POST", "/api/robot/commands/loop"): Probe(body={"name": "depth", "on": False}),
    ("POST", "/api/robot/commands/parameters"): Probe(body={"values": {"depth.set_point": 1.0}}),
    ("POST", "/api/robot/commands/vision_settings"): Probe(body=VisionSettings().table()),
    ("POST", "/api/robot/commands/steering"): Probe(body={"by": "none"}),
    ("POST", "/api/robot/commands/card"): Probe(204),
    ("PUT", "/api/vision"): Probe(204, {"settings": VisionSettings().table()}),
    ("POST", "/api/vision/pick"): Probe(body={"x": 0.5, "y": 0.5}),
    ("POST", "/api/vision/read"): Probe(body={"text": "[vision]"}),
    ("POST", "/api/parameters/undo"): Probe(
        409, {"change": 999}, words="change", because="Nothing has been changed."
    ),
    ("POST", "/api/profiles"): Probe(
        409, {"name": "first"}, words="There is a profile", because="Names are given once."
    ),
    ("POST", "/api/profiles/file"): Probe(
        422, {"text": "?"}, words="The file is not a profile", because="There would be more."
    ),
    ("GET", "/api/profiles/{profile}/file"): Probe(),
    ("POST", "/api/profiles/{profile}/restore"): Probe(
        409, words="holds no parameters", because="The runtime's end has none."
    ),
    ("DELETE", "/api/profiles/{profile}"): absent("profile", "There is no such profile", GONE),
    ("PUT", "/api/simulator"): Probe(
        409, {"here": True}, words="loop", because="The robot is not in the loop."
    ),
    ("PUT", "/api/scene/view"): Probe(
        503,
        {"name": "side", "azimuth": 0.0, "elevation": 0.0, "distance": 1.0},
        words="scene",
        because="There is no scene.",
    ),
    ("GET", "/api/past"): Probe(query="topic=depth&until=100"),
    ("POST", "/api/sessions"): Probe(
        409, words="record", because="One is recorded already; two of them are not possible."
    ),
    ("PATCH", SESSION): Probe(body={"name": "Dive"}),
    ("DELETE", SESSION): absent("session", "There is no session 999", GONE),
    ("POST", SESSION + "/stop"): absent("session", "There is no session 999", GONE),
    ("POST", SESSION + "/restore"): absent("session", "There is no session 999", GONE),
    ("POST", SESSION + "/purge"): absent("session", "There is no session 999", GONE),
    ("GET", SESSION + "/thumbnail"): Probe(404, query="time=100", words="picture", because="It has none."),
    ("GET", SESSION + "/blocks"): Probe(query="start=0&end=100"),
    ("POST", SESSION + "/markers"): absent("session", "There is no session 999", "There would be ever more."),
    ("PATCH", SESSION + "/markers/{mark}"): Probe(body={"text": "here"}),
    ("DELETE", SESSION + "/markers/{mark}"): absent("mark", "999", GONE),
    ("POST", "/api/compare"): Probe(body={"sessions": [1], "signals": ["depth.depth"]}),
    ("POST", "/api/compare/lines"): Probe(body={"sessions": [1], "signals": ["depth.depth"]}),
    ("GET", "/api/compare/report"): Probe(
        404, query="sessions=999", words="There is no session 999", because="It takes a second to make."
    ),
    ("POST", "/api/exports"): Probe(
        404, {"session": 999, "format": "csv"}, words="There is no session 999", because=STARTS
    ),
    ("GET", "/api/exports/{export}"): Probe(404, words="There is no export 0000", because=STARTS),
    ("DELETE", "/api/exports/{export}"): Probe(404, words="There is no export 0000", because=STARTS),
    ("GET", "/api/exports/{export}/file"): Probe(404, words="There is no export 0000", because=STARTS),
    ("POST", "/api/imports"): Probe(507, words="Free some space", because=STARTS),
    ("GET", "/api/update"): Probe(),
    ("POST", "/api/update"): Probe(409, words="not installed as a service", because=STARTS),
    ("POST", "/api/update/release"): Probe(409, words="not installed as a service", because=STARTS),
    ("POST", "/api/comm-tests/check"): Probe(body={"text": "[]"}),
    ("POST", "/api/comm-tests/runs"): Probe(
        422, {"text": "?", "place": "emulated"}, words="JSON", because=STARTS
    ),
    ("POST", "/api/comm-tests/cancel"): Probe(204),
    ("POST", "/api/missions"): Probe(422, {"text": "?"}, words="TOML", because="There would be more."),
    ("DELETE", "/api/missions/{name}"): Probe(
        404, named={"name": "none"}, words="no own mission", because="There is none."
    ),
    ("GET", "/api/missions/versions/{name}"): Probe(
        404, named={"name": "none"}, words="no own mission", because="There is none."
    ),
    ("POST", "/api/missions/check"): Probe(body={"text": "?"}),
    ("POST", "/api/missions/start"): Probe(422, {"text": "?"}, words="TOML", because=STARTS),
    ("POST", "/api/missions/trial"): Probe(422, {"text": "?"}, words="TOML", because=STARTS),
    ("POST", "/api/missions/trial/cancel"): Probe(
        409, words="No trial is running", because="There would have to be one."
    ),
    ("POST", "/api/scenarios"): Probe(422, {"text": "?"}, words="TOML", because="There would be more."),
    ("POST", "/api/scenarios/check"): Probe(body={"text": "?"}),
    ("POST", "/api/scenarios/runs"): Probe(
        422, {"text": "?", "place": "simulated"}, words="TOML", because=STARTS
    ),
    ("POST", "/api/scenarios/cancel"): Probe(204),
    ("POST", "/api/identification"): Probe(
        409, {"sessions": [1], "left_out": 1}, words="both fitted and left out", because=STARTS
    ),
    ("POST", "/api/identification/cancel"): Probe(
        409, words="No fit is running", because="There would have to be one."
    ),
    ("POST", "/api/identification/adopt"): Probe(
        409, words="no fitted craft", because="It would need a fit of a minute."
    ),
    ("POST", "/api/identification/undo"): Probe(
        409, words="no adoption to undo", because="It would need a fit of a minute."
    ),
    ("POST", "/api/layouts"): Probe(
        201, {"name": "pool", "document": {"format": "mucat-layout", "version": 1, "panels": []}}
    ),
    ("DELETE", "/api/layouts/{layout}"): absent("layout", "There is no layout 999", GONE),
    ("POST", "/api/tuning/runs"): Probe(
        409, STEP, words="The robot is disarmed", because="It is not armed here."
    ),
    ("POST", "/api/tuning/stop"): Probe(409, words="No experiment", because="None is running."),
    ("GET", "/api/tuning/runs/{run}"): absent("run", "There is no run 999", "None has been made."),
    ("PATCH", "/api/tuning/runs/{run}"): absent(
        "run", "There is no run 999", "None has been made.", body={"name": "mine"}
    ),
    ("DELETE", "/api/tuning/runs/{run}"): absent("run", "There is no run 999", "None has been made."),
    ("POST", "/api/access/sign-out"): Probe(204),
}
"""Of a route that is not here, the answer to an empty request is 200."""


def place_things(settings: Settings) -> None:
    """Write a page, a help page and a panel into their folders."""
    for folder, name in ((settings.page, "index.html"), (settings.help_pages, "index.html")):
        folder.mkdir(exist_ok=True)
        (folder / name).write_text("<!doctype html>")
    settings.data.panels.mkdir(exist_ok=True)
    (settings.data.panels / "mine.js").write_text("export default 1")
