"""Hostile inputs to every way to a build, an upload, a file name or a path.

A canary is a file that a command in one of them would make, a secret a file that a path would lead to.
`python -m tests.proofs.hostile TIMES` takes that many words to each entrance; it fails where one gets in.
"""

import json
import re
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import MISSING, fields
from http.client import HTTPConnection
from io import BytesIO
from pathlib import Path
from urllib.parse import quote, urlsplit

import requests

from robot_runtime.contract.limits import ConfigError
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.comm_test.builder import _macros
from robot_runtime.experiments.comm_test.document import SKETCH, CommTest, read_document
from server.features.exports.archive_reader import Archive, ArchiveError, open_archive
from server.features.scenarios.library import keep_scenario
from server.http.page import Page
from server.http.serving import MESSAGE_BYTES_MAX
from server.platform.settings import Settings, SetupError, read_settings
from server.processes.supervisor import plan
from tests.exports import export_session
from tests.proofs.interface import Surface, run_surface
from tests.proofs.words import Words

SECRET = "carapace-of-slate"
MACRO = re.compile(r"-D[A-Z_]+=[A-Za-z0-9_.]+")
FILE_NAME = re.compile(r'attachment; filename="[A-Za-z0-9_.-]+"')
SCENARIO_FILE = re.compile(r"[a-z0-9][a-z0-9_-]{0,59}\.toml")
AROUND = ["data", "page", "robot.toml", "secret.txt"]
HEADERS = {"content-type": "application/json"}
SEED = 11
ENTRANCES: dict[str, Callable[["Field"], object]] = {}


class Field:
    """The target: a server whose folder holds a secret file and no marker file."""

    def __init__(self, surface: Surface, seed: int) -> None:
        self.surface = surface
        self.data = surface.served.settings.data
        self.folder = self.data.path.parent
        self.canary, self.secret = self.folder / "canary", self.folder / "secret.txt"
        self.secret.write_text(SECRET, encoding="utf-8")
        self.page = Page(surface.served.settings.page)
        self.words = Words(self.canary, self.secret, seed)

    def ask(self, method: str, path: str, body: object = None) -> requests.Response:
        """Send JSON as Python writes it, NaN included; never answered by a 5xx or the secret."""
        self.surface.take_control()
        data = None if body is None else json.dumps(body).encode()
        url = f"{self.surface.url}/api/{path}"
        answer = self.surface.session.request(method, url, data=data, headers=HEADERS, timeout=60)
        self.look(answer.status_code, answer.text)
        return answer

    def look(self, status: int, text: str) -> None:
        """Check that an answer holds no secret and no internal error."""
        assert status < 500, (status, text)
        assert SECRET not in text, text

    def survey(self) -> None:
        """Check that no file was created or changed by a hostile word."""
        assert not self.canary.exists(), "a command was carried out"
        assert self.secret.read_text(encoding="utf-8") == SECRET
        assert sorted(one.name for one in self.folder.iterdir()) == AROUND
        kept = [one.name for one in self.data.scenarios.glob("*")]
        assert all(map(SCENARIO_FILE.fullmatch, kept)), kept


def entrance(name: str) -> Callable[[Callable[[Field], object]], Callable[[Field], object]]:
    """Register a function that sends a hostile word to one input."""

    def add(way: Callable[[Field], object]) -> Callable[[Field], object]:
        ENTRANCES[name] = way
        return way

    return add


def document(words: Words) -> list[dict[str, object]]:
    """A communication test with one hostile field, or with a hostile name only."""
    test: dict[str, object] = {
        "id": 1,
        "name": words.word() or "-",
        "ino_path": SKETCH,
        "delay": [0.01],
        "baud_rate": [9600],
        "from_val": 0,
        "to_val": 2,
        "expected": 2,
        "arduinodelay": [0.0],
        "framing": "plain",
        "direction": "to_board",
    }
    required = [one.name for one in fields(CommTest) if one.default is MISSING]
    field = words.choose((*(one.name for one in fields(CommTest)), *required, words.word()))
    value = words.value()
    test[field] = [value] if field in ("delay", "baud_rate", "arduinodelay") else value
    if field == "faults":
        test[field] = {words.choose(("bit_flips", "burst", "seed", words.word())): value}
    return [test]


def scenario(words: Words) -> str:
    """A valid scenario, but for one or two hostile words."""
    fields = {"name": "mine", "title": "Mine", "kind": "pool", "controller": "pid", "do": "arm"}
    for _ in range(2):
        fields[words.choose(tuple(fields))] = words.word()
    said = {name: json.dumps(value) for name, value in fields.items()}
    return (
        f"name = {said['name']}\ntitle = {said['title']}\nduration = 10\n"
        f"[scene]\nkind = {said['kind']}\ndepth = 1.5\nlength = 4.0\nwidth = 2.0\n"
        f"[control]\ncontroller = {said['controller']}\n"
        f"[[events]]\nat = 1\ndo = {said['do']}\n"
    )


@entrance("compiler")
def compile_arguments(field: Field) -> None:
    """An accepted document yields arguments of letters and digits only."""
    with suppress(ConfigError):
        for test in read_document(json.dumps(document(field.words))):
            for cell in test.cells:
                macros = _macros(test, cell.baud, cell.arduino_delay)
                assert all(MACRO.fullmatch(one) for one in macros), macros


@entrance("document over HTTP")
def check_document(field: Field) -> None:
    """A document is checked and its errors are reported."""
    assert field.ask("POST", "comm-tests/check", {"text": json.dumps(document(field.words))}).ok


@entrance("place of a run")
def start_run(field: Field) -> None:
    """An upload that is no test starts no run."""
    text = json.dumps([{"id": field.words.value(), "name": field.words.word()}])
    answer = field.ask("POST", "comm-tests/runs", {"text": text, "place": field.words.value()})
    assert answer.status_code == 422


@entrance("number of a run")
def run_number(field: Field) -> None:
    """The number of a run is parsed as a number."""
    ending = field.words.choose(("", "/csv", "/json"))
    field.ask("GET", f"comm-tests/runs/{escape(field.words.word())}{ending}")


@entrance("scenario's file")
def scenario_file(field: Field) -> None:
    """A document is stored under a valid name, or not at all."""
    with suppress(ConfigError, RefusedError):
        keep_scenario(field.data.scenarios, scenario(field.words))


@entrance("scenario over HTTP")
def scenario_over_http(field: Field) -> None:
    """A scenario is checked, or stored."""
    text = scenario(field.words)
    field.ask("POST", field.words.choose(("scenarios/check", "scenarios")), {"text": text})


@entrance("scenario to run")
def scenario_to_run(field: Field) -> None:
    """A scenario is refused; none runs live where there is no simulator."""
    wanted = {"text": scenario(field.words), "place": "live", "board": field.words.value()}
    assert field.ask("POST", "scenarios/runs", wanted).status_code in (409, 422)


@entrance("robot.toml")
def configuration(field: Field) -> None:
    """A value of the file that reaches a command line is one argument there."""
    words = field.words
    given = {
        "name": "turtle",
        "mode": "emulated",
        "port": "/dev/serial0",
        "reset": "dtr",
        "host": "127.0.0.1",
    }
    given[words.choose(tuple(given))] = words.word()
    said = {name: json.dumps(value) for name, value in given.items()}
    text = f"[robot]\nname = {said['name']}\nmode = {said['mode']}\n[server]\nhost = {said['host']}\n"
    text += f"[link]\nport = {said['port']}\nreset = {said['reset']}\n"
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "robot.toml"
        path.write_text(text, encoding="utf-8")
        with suppress(SetupError):
            settings = read_settings(path, Path(name), None, None, {})
            plain = plan(Settings(settings.data, path, mode=settings.mode, hil=settings.hil))
            commands = plan(settings)
            assert [len(one.arguments) for one in commands] == [len(one.arguments) for one in plain]


@entrance("session's name")
def session_name(field: Field) -> None:
    """Names in the headers of files have letters and digits only."""
    answer = field.ask("POST", "sessions", {"name": field.words.word()[:100], "note": field.words.word()})
    if answer.ok:
        number = answer.json()["id"]
        assert field.ask("POST", f"sessions/{number}/stop").ok
        found = export_session(field.surface.session, number, base=f"{field.surface.url}/api")
        assert FILE_NAME.fullmatch(found.headers["content-disposition"]), found.headers
        members = zipfile.ZipFile(BytesIO(found.content)).namelist()
        assert all(re.fullmatch(r"[a-z_]+\.(csv|json|txt)", one) for one in members), members


@entrance("session's words")
def session_words(field: Field) -> None:
    """Names, notes and tags of a session are plain text."""
    wanted = {field.words.choose(("name", "note")): field.words.value(), "tags": [field.words.value()]}
    field.ask("PATCH", "sessions/1", wanted)


@entrance("search")
def search(field: Field) -> None:
    """A search's words are plain text, no query language."""
    field.ask("GET", f"sessions?search={escape(field.words.word())}&tag={escape(field.words.word())}")


@entrance("mark")
def mark(field: Field) -> None:
    """The text of a bookmark is plain text."""
    field.ask("POST", "sessions/1/markers", {"time": field.words.value(), "text": field.words.word()})


@entrance("number of a session")
def session_number(field: Field) -> None:
    """The number of a session is parsed as a number."""
    ending = field.words.choose(("", "/timeline", "/signals", "/thumbnail?time=0", "/restore"))
    field.ask("GET", f"sessions/{escape(field.words.word())}{ending}")


@entrance("thumbnail's time")
def thumbnail(field: Field) -> None:
    """The time of a thumbnail is parsed as a number."""
    field.ask("GET", f"sessions/1/thumbnail?time={escape(str(field.words.value()))}")


@entrance("stretch")
def stretch(field: Field) -> None:
    """Start and end of a range are parsed as numbers."""
    start, end = (escape(str(field.words.value())) for _ in range(2))
    field.ask("GET", f"sessions/1/blocks?start={start}&end={end}")


@entrance("report")
def report(field: Field) -> None:
    """The report is asked for hostile signals and bookmarks."""
    words = field.words
    query = (
        f"sessions=1&signals={escape(words.word())}&marker={escape(words.word())}&by={escape(words.word())}"
    )
    field.ask("GET", f"compare/report?{query}")


@entrance("export")
def export(field: Field) -> None:
    """Formats are an enumeration, topics are known names."""
    words = field.words
    wanted = {"session": 1, "format": words.choose(("csv", words.word())), "topics": [words.word()]}
    assert not field.ask("POST", "exports", wanted | {"start": words.value()}).ok


@entrance("export's name")
def export_name(field: Field) -> None:
    """Names of export files are the server's own."""
    method, ending = field.words.choose((("GET", ""), ("GET", "/file"), ("DELETE", "")))
    answer = field.ask(method, f"exports/{escape(field.words.word())}{ending}")
    assert not answer.ok or answer.url.endswith("/exports/")


@entrance("archive's members")
def archive(field: Field) -> None:
    """No member of an archive is unpacked to a path, and an unknown name refuses the archive."""
    with tempfile.NamedTemporaryFile() as file:
        name = field.words.word().encode(errors="replace").decode().lstrip("\0") or "x"
        with zipfile.ZipFile(file, "w") as zipped:
            zipped.writestr(field.words.choose((name, f"chunks/{name}", f"../{name}")), SECRET)
            zipped.writestr("session.json", "{}")
            zipped.writestr("checksums.json", "{}")
        file.flush()
        with suppress(ArchiveError), open_archive(Path(file.name), Archive):
            raise AssertionError(f"{name!r} was let in")


@entrance("page's path")
def page_path(field: Field) -> None:
    """No file outside of the page's folder is found."""
    found = field.page.find(field.words.word())
    assert found is None or found.is_relative_to(field.surface.served.settings.page)


@entrance("path over HTTP")
def path_over_http(field: Field) -> None:
    """Send a path unchanged, without a client that normalises it."""
    word = field.words.word().encode(errors="replace").decode()
    path = field.words.choose(
        (escape(word), quote(word, safe="/.%;\\"), quote(word, safe="/."), f"assets/{escape(word)}")
    )
    line = HTTPConnection(urlsplit(field.surface.url).netloc, timeout=60)
    try:
        line.putrequest("GET", f"/{path}", skip_accept_encoding=True)
        line.endheaders()
        answer = line.getresponse()
        field.look(answer.status, answer.read().decode(errors="replace"))
    finally:
        line.close()


@entrance("words to the robot")
def robot_words(field: Field) -> None:
    """Commands are checked before they reach the runtime."""
    words = field.words
    path, body = words.choose(
        (
            ("loop", {"name": "depth", "controller": words.value(), "gains": {words.word(): words.value()}}),
            ("parameters", {"values": {words.word(): words.value()}, words.word(): 1}),
            ("card", {"colour": words.value()}),
            ("vision_settings", {"rate": words.value(), "colour": words.value()}),
        )
    )
    field.ask("POST", f"robot/commands/{path}", body)


@entrance("words on the live socket")
def live_words(field: Field) -> None:
    """Messages are executed or refused; the socket stays open."""
    words = field.words
    message = {"op": words.choose(("ping", "watch", words.word())), "id": words.value()}
    text = json.dumps(message | {"pictures": [words.value()]})
    with field.surface.connect() as live:
        live.send(text[:MESSAGE_BYTES_MAX])
        live.send('{"op": "ping", "id": "the last"}')
        while not (isinstance(said := live.recv(60), str) and '"pong", "id": "the last"' in said):
            assert isinstance(said, bytes | str)


def escape(word: str) -> str:
    """Escape a word as one piece of a path or a query."""
    return quote(word.encode(errors="replace"), safe="")


@contextmanager
def open_field(seed: int = SEED) -> Iterator[Field]:
    """A field, until the context is left."""
    with run_surface() as surface:
        yield Field(surface, seed)


def main() -> int:
    """Exit status."""
    times = int(sys.argv[1])
    with open_field() as field:
        for name, way in ENTRANCES.items():
            for _ in range(times):
                way(field)
            field.survey()
            print(f"{name}: {times} words", flush=True)
    print(f"{times * len(ENTRANCES)} words through {len(ENTRANCES)} entrances: no canary")
    return 0


if __name__ == "__main__":
    sys.exit(main())
