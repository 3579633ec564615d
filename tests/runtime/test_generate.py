"""Generated files: another definition gives another text, and the compiler agrees with the layout."""

import json
import subprocess
from pathlib import Path

import pytest

from robot_runtime.contract.packets import DEFINITIONS_HASH, PACKETS, definitions
from robot_runtime.contract.topics import TOPICS, Kind
from robot_runtime.control.faults import FAULTS
from robot_runtime.control.transitions import TRANSITIONS
from robot_runtime.generate import cpp, json_schema, safety, typescript


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


def test_the_page_knows_every_topic() -> None:
    text = typescript.module()
    for topic in TOPICS:
        assert f"  {topic.name}: " in text
        if topic.kind is Kind.ROWS:
            assert f"rowBytes: {topic.row_bytes}," in text


def test_the_document_shows_the_states_and_the_faults_as_they_are_in_the_code() -> None:
    text = (Path(__file__).resolve().parents[2] / "docs/reference/safety.md").read_text()
    assert safety.weave(text) == text
    for one in TRANSITIONS:
        assert f"    {one.before} --> {one.after}: {one.trigger}\n" in text
        assert f"| {one.before} | {one.trigger} | {one.after} | {one.why} |\n" in text
    for fault in FAULTS:
        assert f"| `{fault.name}` | {fault.limit:g} s |" in text


def test_a_document_without_its_marks_is_refused() -> None:
    with pytest.raises(ValueError, match="lacks its marks of states"):
        safety.weave("# Safety\n")
