"""Generated files: another definition gives another text, and the compiler agrees with the layout."""

import json
import re
import subprocess
from pathlib import Path

import pytest

from robot_runtime.contract.packets import DEFINITIONS_HASH, PACKETS, definitions
from robot_runtime.contract.topics import TOPICS, Kind
from robot_runtime.control.faults import ROBOT_FAULTS
from robot_runtime.control.transitions import TRANSITIONS
from robot_runtime.generate import __main__ as generate
from robot_runtime.generate import cpp, json_schema, typescript
from robot_runtime.generate.reference import faults_page, packets_page


def test_a_changed_field_changes_the_hash() -> None:
    text = definitions.canonical()
    assert "depth:1h*0.001m" in text
    assert len(set(text.splitlines())) == len(text.splitlines())


def test_the_board_s_compiler_finds_the_same_offsets(tmp_path: Path) -> None:
    checks = []
    for cls in PACKETS.values():
        at = 0
        for name, wire in cls.wires.items():
            checks.append(
                f'static_assert(__builtin_offsetof(mucat::{cls.__name__}, {name}) == {at}, "{name}");'
            )
            at += wire.size
    (tmp_path / "packets.gen.h").write_text(cpp.header())
    source = tmp_path / "check.cpp"
    source.write_text('#include "packets.gen.h"\n' + "\n".join(checks))
    command = [
        "avr-g++",
        "-mmcu=atmega328p",
        "-std=gnu++14",
        "-Wall",
        "-Werror",
        f"-I{generate.ROOT / 'firmware/src'}",
        "-c",
        source.name,
        "-o",
        "check.o",
    ]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_schema_is_json_and_names_every_packet() -> None:
    document = json.loads(json_schema.schema())
    assert document["definitions_hash"] == f"{DEFINITIONS_HASH:08x}"
    assert {cls.__name__ for cls in PACKETS.values()} <= document["$defs"].keys()


def test_the_page_knows_every_topic_that_it_is_sent() -> None:
    text = typescript.module()
    for topic in (topic for topic in TOPICS if topic.kind is not Kind.FILM):
        assert f"  {topic.name}: " in text
        if topic.kind is Kind.ROWS:
            assert f"rowBytes: {topic.row_bytes}," in text


def test_the_reference_shows_the_states_and_the_faults_as_they_are_in_the_code() -> None:
    text = faults_page()
    for transition in TRANSITIONS:
        assert (
            f"| `{transition.before}` | {transition.trigger} | `{transition.after}` | {transition.why} |\n"
            in text
        )
    for name, fault in ROBOT_FAULTS.items():
        assert f"| `{name}` | {fault.limit:g} s |" in text


def test_the_reference_has_a_chapter_for_every_packet_with_all_its_fields() -> None:
    chapters = dict(re.findall(r"^## (\w+)\n(.*?)(?=^## |\Z)", packets_page(), re.MULTILINE | re.DOTALL))
    for packet in PACKETS.values():
        for name in packet.wires:
            assert f"- `{name}` (" in chapters[packet.__name__]


def test_the_check_names_a_reference_page_that_is_not_current(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(generate, "ROOT", tmp_path)
    monkeypatch.setattr("sys.argv", ["generate"])
    assert generate.main() == 0
    monkeypatch.setattr("sys.argv", ["generate", "--check"])
    assert generate.main() == 0
    page = tmp_path / "docs/reference/packets.md"
    page.write_text(page.read_text().replace("## Navigation\n", ""))
    assert generate.main() == 1
    assert capsys.readouterr().out.startswith("docs/reference/packets.md is not current")
