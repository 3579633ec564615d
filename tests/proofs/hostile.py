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
ENTRANCES: dict[str, Callable[["HostileField"], object]] = {}


class HostileField:
    """The target: a server whose folder holds a secret file and no marker file."""

    def __init__(self, surface: Surface, seed: int) -> None:
        self.surface = surface
        self.data = surface.served.settings.data
        self.folder = self.data.path.parent
        self.canary, self.secret = self.folder / "canary", self.folder / "secret.txt"
        self.secret.write_text(SECRET, encoding="utf-8")
        self.page = Page(surface.served.settings.page)
        self.vocabulary = Words(self.canary, self.secret, seed)

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
        assert sorted(file.name for file in self.folder.iterdir()) == AROUND
        stored = [file.name for file in self.data.scenarios.glob("*")]
        assert all(map(SCENARIO_FILE.fullmatch, stored)), stored


def entrance(name: str) -> Callable[[Callable[[HostileField], object]], Callable[[HostileField], object]]:
    """Register a function that sends a hostile word to one input."""

    def add(way: Callable[[HostileField], object]) -> Callable[[HostileField], object]:
        ENTRANCES[name] = way
        return way

    return add


def document(message: Words) -> list[dict[str, object]]:
    """Return a communication test with one hostile field, or with a hostile name only."""
    test: dict[str, object] = {
        "id": 1,
        "name": message.word() or "-",
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
    required = [field.name for field in fields(CommTest) if field.default is MISSING]
    field = message.choose((*(field.name for field in fields(CommTest)), *required, message.word()))
    value = message.value()
    test[field] = [value] if field in ("delay", "baud_rate", "arduinodelay") else value
    if field == "faults":
        test[field] = {message.choose(("bit_flips", "burst", "seed", message.word())): value}
    return [test]


def scenario(message: Words) -> str:
    """Return a valid scenario, but for one or two hostile words."""
    fields = {"name": "mine", "title": "Mine", "kind": "pool", "controller": "pid", "do": "arm"}
    for _ in range(2):
        fields[message.choose(tuple(fields))] = message.word()
    answer = {name: json.dumps(value) for name, value in fields.items()}
    return (
        f"name = {answer['name']}\ntitle = {answer['title']}\nduration = 10\n"
        f"[scene]\nkind = {answer['kind']}\ndepth = 1.5\nlength = 4.0\nwidth = 2.0\n"
        f"[control]\ncontroller = {answer['controller']}\n"
        f"[[events]]\nat = 1\ndo = {answer['do']}\n"
    )


@entrance("compiler")
def compile_arguments(field: HostileField) -> None:
    """An accepted document yields arguments of letters and digits only."""
    with suppress(ConfigError):
        for test in read_document(json.dumps(document(field.vocabulary))):
            for cell in test.cells:
                macros = _macros(test, cell.baud, cell.arduino_delay)
                assert all(MACRO.fullmatch(macro) for macro in macros), macros


@entrance("scenario's file")
def scenario_file(field: HostileField) -> None:
    """A document is stored under a valid name, or not at all."""
    with suppress(ConfigError, RefusedError):
        keep_scenario(field.data.scenarios, scenario(field.vocabulary))


@entrance("robot.toml")
def configuration(field: HostileField) -> None:
    """A value of the file that reaches a command line is one argument there."""
    message = field.vocabulary
    given = {
        "name": "turtle",
        "mode": "emulated",
        "port": "/dev/serial0",
        "reset": "dtr",
        "host": "127.0.0.1",
    }
    given[message.choose(tuple(given))] = message.word()
    answer = {name: json.dumps(value) for name, value in given.items()}
    text = f"[robot]\nname = {answer['name']}\nmode = {answer['mode']}\n[server]\nhost = {answer['host']}\n"
    text += f"[link]\nport = {answer['port']}\nreset = {answer['reset']}\n"
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "robot.toml"
        path.write_text(text, encoding="utf-8")
        with suppress(SetupError):
            settings = read_settings(path, Path(name), None, None, {})
            plain = plan(Settings(data=settings.data, config=path, robot=settings.robot, hil=settings.hil))
            commands = plan(settings)
            assert [len(command.arguments) for command in commands] == [
                len(command.arguments) for command in plain
            ]


@entrance("session's name")
def session_name(field: HostileField) -> None:
    """Send names in the headers of files, of letters and digits only."""
    answer = field.ask(
        "POST", "sessions", {"name": field.vocabulary.word()[:100], "note": field.vocabulary.word()}
    )
    if answer.ok:
        number = answer.json()["id"]
        assert field.ask("POST", f"sessions/{number}/stop").ok
        result = export_session(field.surface.session, number, base=f"{field.surface.url}/api")
        assert FILE_NAME.fullmatch(result.headers["content-disposition"]), result.headers
        members = zipfile.ZipFile(BytesIO(result.content)).namelist()
        assert all(re.fullmatch(r"[a-z_]+\.(csv|json|txt)", member) for member in members), members


@entrance("archive's members")
def archive(field: HostileField) -> None:
    """No member of an archive is unpacked to a path, and an unknown name refuses the archive."""
    with tempfile.NamedTemporaryFile() as file:
        name = field.vocabulary.word().encode(errors="replace").decode().lstrip("\0") or "x"
        with zipfile.ZipFile(file, "w") as zipped:
            zipped.writestr(field.vocabulary.choose((name, f"chunks/{name}", f"../{name}")), SECRET)
            zipped.writestr("session.json", "{}")
            zipped.writestr("checksums.json", "{}")
        file.flush()
        with suppress(ArchiveError), open_archive(Path(file.name), Archive):
            raise AssertionError(f"{name!r} was let in")


@entrance("page's path")
def page_path(field: HostileField) -> None:
    """No file outside of the page's folder is found."""
    result = field.page.find(field.vocabulary.word())
    assert result is None or result.is_relative_to(field.surface.served.settings.page)


@entrance("path over HTTP")
def path_over_http(field: HostileField) -> None:
    """Send a path unchanged, without a client that normalises it."""
    word = field.vocabulary.word().encode(errors="replace").decode()
    path = field.vocabulary.choose(
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


def escape(word: str) -> str:
    """Escape a word as one piece of a path or a query."""
    return quote(word.encode(errors="replace"), safe="")


@contextmanager
def open_field(seed: int = SEED) -> Iterator[HostileField]:
    """A field, until the context is left."""
    with run_surface() as surface:
        yield HostileField(surface, seed)


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
