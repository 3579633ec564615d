"""Texts of people are read alike: a byte order mark is skipped, other encodings and slips are named."""

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from robot_runtime.config import load
from robot_runtime.contract.craft import load_craft
from robot_runtime.contract.limits import ConfigError
from robot_runtime.experiments.comm_test.__main__ import _decode as decode_comm_test
from robot_runtime.experiments.comm_test.document import read_document
from robot_runtime.vision.settings_file import VisionSettingsFile
from server.driving.profiles import ProfileError, read_file
from server.features.comm_tests import command as comm_tests
from server.features.events.outlet import OutletError, read_secret
from server.features.missions import command as missions
from server.features.panels.scripts import list_panels
from server.features.scenarios import command as scenarios
from server.features.vision.routes import read_document as read_vision
from server.platform.command_line import CommandError
from server.platform.settings import Settings, SetupError
from tests.server.serving import Served

ROOT = Path(__file__).resolve().parents[2]
SCENARIOS = ROOT / "robot_runtime/experiments/scenario/shipped"
Read = Callable[[Path, Settings], object]

TOML: dict[str, tuple[Read, str, str]] = {
    "robot.toml": (lambda file, _: load(file), "[control]\nset_point = 0.6\n", "set_point = 0.6"),
    "a craft": (lambda file, _: load_craft(file), 'title = "Mine"\n[craft]\nmass = 3.5\n', "mass = 3.5"),
    "a mission": (
        lambda file, settings: missions._read(str(file), settings),
        (ROOT / "robot_runtime/missions/shipped/endurance.toml").read_text(),
        "depth = 1.5",
    ),
    "a scenario": (
        lambda file, settings: scenarios._read(str(file), settings.data.scenarios),
        (SCENARIOS / "figure_14.toml").read_text(),
        "duration = 60",
    ),
    "vision settings": (
        lambda file, _: read_vision(file.read_bytes().decode()),
        '[vision]\ncamera = "card"\nopening = 0.01\n',
        "opening = 0.01",
    ),
}
COMM_TEST = (ROOT / "firmware/examples/comm_test/figure10.json").read_text()
PROFILE = '{"format": 1, "name": "Calm",\n"parameters": {"depth.pid.kp": 2.5}}'
JSON: dict[str, tuple[Read, str, str]] = {
    "a communication test": (lambda file, _: comm_tests._read(file), COMM_TEST, '"from_val": 1'),
    "a communication test by standard input": (
        lambda file, _: read_document(decode_comm_test(file.read_bytes())),
        COMM_TEST,
        '"from_val": 1',
    ),
    "a profile": (lambda file, _: read_file(file.read_bytes().decode()), PROFILE, '"depth.pid.kp": 2.5'),
    "the vision's settings": (
        lambda file, _: VisionSettingsFile(file).read(),
        '{"colour": "red",\n"opening": 0.01}',
        '"opening": 0.01',
    ),
}
OTHERS: dict[str, tuple[Read, str, str]] = {
    "an own panel": (lambda file, _: list_panels(file.parent)[0].problem, "export default 1\n", ""),
    "a secret": (lambda file, _: read_secret(file), "pass\n", ""),
}
TEXTS = TOML | JSON | OTHERS
READ_AS_TEXT = ("vision settings", "a profile")
"""Bodies of requests hold these as texts of JSON: `JsonRoute` has decoded them."""
ENCODINGS = {
    "utf-16": "is saved as UTF-16; save it as UTF-8",
    "utf-16-le": "is saved as UTF-16; save it as UTF-8",
    "utf-16-be": "is saved as UTF-16; save it as UTF-8",
    "utf-32": "is saved as UTF-32; save it as UTF-8",
    "utf-32-le": "is saved as UTF-32; save it as UTF-8",
}
MISLEADING = re.compile(r"codec|power cut|cut off|column 1\b")


def read(name: str, data: bytes, settings: Settings) -> object:
    file = settings.data.path / "given.js"
    file.write_bytes(data)
    file.chmod(0o600)
    return TEXTS[name][0](file, settings)


def refusal(name: str, data: bytes, settings: Settings) -> str:
    try:
        result = read(name, data, settings)
    except (ConfigError, CommandError, ProfileError, OutletError, SetupError) as problem:
        result = str(problem)
    assert isinstance(result, str), result
    assert not MISLEADING.search(result), result
    return result


@pytest.mark.parametrize("name", TEXTS)
def test_a_byte_order_mark_and_other_line_ends_change_nothing(name: str, settings: Settings) -> None:
    text = TEXTS[name][1]
    plain = read(name, text.encode(), settings)
    for changed in (
        "\ufeff" + text,
        "\ufeff" + text.replace("\n", "\r\n"),
        text.replace("\n", "\r\n"),
    ):
        result = read(name, changed.encode(), settings)
        assert repr(result).replace("\\r\\n", "\\n").replace("\\ufeff", "") == repr(plain)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("name", [name for name in TEXTS if name not in READ_AS_TEXT])
def test_another_encoding_is_named(name: str, encoding: str, settings: Settings) -> None:
    assert ENCODINGS[encoding] in refusal(name, TEXTS[name][1].encode(encoding), settings)


@pytest.mark.parametrize("name", [name for name in TEXTS if name not in READ_AS_TEXT])
def test_letters_of_windows_and_zero_bytes_are_named(name: str, settings: Settings) -> None:
    text = TEXTS[name][1].encode()
    assert "in line 1 that is not UTF-8; it is probably saved as Windows-1252" in refusal(
        name, "# 5 µs\n".encode("cp1252") + text, settings
    )
    assert "has a zero byte in line 1, so it is no text" in refusal(name, b"# \0\n" + text, settings)
    assert "nothing but zero bytes" in refusal(name, bytes(len(text)), settings)


@pytest.mark.parametrize("name", TOML | JSON)
def test_a_decimal_comma_is_named(name: str, settings: Settings) -> None:
    _, text, entry = TEXTS[name]
    assert entry in text
    before, number = re.fullmatch(r"(.*?)(\d+(?:\.\d+)?)", entry).groups()  # type: ignore[union-attr]
    right = number if "." in number else f"{number}.5"
    wrong = text.replace(entry, before + right.replace(".", ","), 1)
    line = text[: text.index(entry)].count("\n") + 1
    message = f"has {right.replace('.', ',')} in line {line}; write {right} with a decimal point, not a comma"
    assert message in refusal(name, wrong.encode(), settings)


@pytest.mark.parametrize("name", TOML | JSON)
def test_a_key_that_comes_twice_is_named_with_its_line(name: str, settings: Settings) -> None:
    _, text, entry = TEXTS[name]
    between = ", " if name in JSON else "\n"
    wrong = text.replace(entry, f"{entry}{between}{entry}" if name in JSON else f"{entry}\n{entry}", 1)
    line = text[: text.index(entry)].count("\n") + (1 if name in JSON else 2)
    key = re.match(r'"?([\w.]+)', entry)
    assert key is not None
    assert f"names the key '{key[1]}' twice, the second time in line {line}" in refusal(
        name, wrong.encode(), settings
    )


@pytest.mark.parametrize("name", TOML | JSON)
@pytest.mark.parametrize(
    ("letter", "message"),
    [("“", 'has a typographic quotation mark “ (U+201C) in line {}; write " instead'),
     ("\u00a0", "has a space that is not the plain one (U+00A0) in line {}; write a plain space instead"),
     ("−", "has a typographic dash − (U+2212) in line {}; write - instead")],
)  # fmt: skip
def test_letters_of_editors_and_chats_are_named(
    name: str, letter: str, message: str, settings: Settings
) -> None:
    _, text, entry = TEXTS[name]
    at = re.search(r"\d+(\.\d+)?$", entry)
    assert at is not None
    wrong = text.replace(entry, entry[: at.start()] + letter + at[0], 1)
    line = text[: text.index(entry)].count("\n") + 1
    assert message.format(line) in refusal(name, wrong.encode(), settings)


@pytest.mark.parametrize("name", JSON)
def test_an_empty_text_and_what_is_no_number_are_named(name: str, settings: Settings) -> None:
    _, text, entry = TEXTS[name]
    assert "is empty" in refusal(name, b"", settings)
    key = entry.partition(":")[0]
    for number in ("NaN", "-Infinity", "1e999"):
        wrong = text.replace(entry, f"{key}: {number}", 1)
        assert f"holds {number} in line" in refusal(name, wrong.encode(), settings)


def test_a_scenario_by_standard_input_in_another_encoding_is_refused() -> None:
    text = (SCENARIOS / "figure_14.toml").read_text()
    done = subprocess.run(
        [sys.executable, "-m", "robot_runtime.experiments.scenario"],
        input=text.encode("utf-16"),
        cwd=ROOT,
        capture_output=True,
        check=False,
    )
    assert done.returncode == 2
    assert b"the scenario is saved as UTF-16; save it as UTF-8" in done.stdout


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (b'{"name": "a", "name": "b"}', "names the key 'name' twice, the second time in line 1"),
        ('{"name": "a"}'.encode("utf-16"), "is saved as UTF-16; save it as UTF-8"),
        ('{"name": "Tauchgang für µ"}'.encode("cp1252"), "probably saved as Windows-1252"),
        (b'{"name": NaN}', "holds NaN in line 1; a number must be finite"),
        (b"{", "is not JSON: Expecting property name"),
    ],
)
async def test_bodies_of_requests_are_read_so(body: bytes, message: str, served: Served) -> None:
    kind = {"content-type": "application/json"}
    answer = await served.api.post("/layouts", content=body, headers=kind)
    assert answer.status_code == 422
    assert answer.json()["detail"].startswith("The request is not valid. Its body ")
    assert message in answer.json()["detail"]
    layout = b'{"name": "Calm", "document": {"format": "mucat-layout", "version": 1, "panels": []}}'
    marked = await served.api.post("/layouts", content=b"\xef\xbb\xbf" + layout, headers=kind)
    assert marked.status_code == 201


READERS = re.compile(r"\btomllib\.|\bjson\.load\(|\.read_text\(")
READ_THEIR_OWN = {
    "robot_runtime/clock.py",
    "robot_runtime/contract/toml_text.py",
    "robot_runtime/experiments/mission_trial/__main__.py",
    "robot_runtime/experiments/scenario/library.py",
    "robot_runtime/generate/__main__.py",
    "robot_runtime/generate/markdown.py",
    "robot_runtime/missions/library.py",
    "server/features/backup/restoration.py",
    "server/features/bench/live_viewer.py",
    "server/features/bench/measurement.py",
    "server/features/bench/process_figures.py",
    "server/features/bench/report.py",
    "server/features/bench/robot_processes.py",
    "server/features/board/firmware_upload.py",
    "server/features/board/previous_firmware.py",
    "server/features/bring_up/bring_up_run.py",
    "server/features/comm_tests/reference/__init__.py",
    "server/features/comm_tests/shipped.py",
    "server/features/doctor/machine.py",
    "server/features/installation/effects.py",
    "server/features/installation/environments.py",
    "server/features/installation/installer.py",
    "server/features/installation/release.py",
    "server/features/installation/report.py",
    "server/features/installation/units/__init__.py",
    "server/features/installation/updater.py",
    "server/features/panels/frame.py",
    "server/features/roster/roster.py",
    "server/features/scenarios/live_setup.py",
    "server/features/sweeps/runner.py",
    "server/http/help_pages.py",
    "server/openapi.py",
    "server/platform/audit_file.py",
    "server/platform/certificate.py",
    "server/platform/memory_reserve.py",
    "server/platform/pidfile.py",
    "server/platform/report_page.py",
    "server/platform/running_server.py",
    "server/platform/settings.py",
    "server/platform/sqlite_file.py",
    "server/platform/supply_voltage.py",
}
"""Modules that read what this program, its release or the system has written, not what people hand over."""


def test_every_other_module_reads_texts_by_text_input() -> None:
    files = [file for room in ("robot_runtime", "server", "mucat") for file in (ROOT / room).rglob("*.py")]
    match = {str(file.relative_to(ROOT)) for file in files if READERS.search(file.read_text())}
    assert match == READ_THEIR_OWN, (
        "read what people hand over by robot_runtime.contract.text_input; list what is read otherwise"
    )
