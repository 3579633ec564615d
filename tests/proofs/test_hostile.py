"""A short version of `make hostile`."""

import ast
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from robot_runtime.experiments.comm_test.document import SKETCH
from tests.board.rig import ROOT
from tests.proofs.hostile import ENTRANCES, HostileField, open_field
from tests.proofs.words import SHELL, Words

TIMES = 15
SLOW = {"session's name": 3}
"""Each makes an export, by a process of its own."""
SHELLS = {("os", "system"), ("os", "popen"), ("subprocess", "getoutput"), ("subprocess", "getstatusoutput")}
TESTS_RUN = 3


@pytest.fixture(scope="module")
def field() -> Iterator[HostileField]:
    with open_field() as field:
        yield field


@pytest.mark.parametrize("name", ENTRANCES)
def test_no_hostile_input_takes_effect(field: HostileField, name: str) -> None:
    for _ in range(SLOW.get(name, TIMES)):
        ENTRANCES[name](field)
    field.survey()


def test_the_canary_detects_an_executed_command(tmp_path: Path) -> None:
    canary, secret = tmp_path / "canary", tmp_path / "secret.txt"
    secret.write_text("secret")
    text = Words(canary, secret, 1)
    for _ in range(100):
        word = text.word().replace("\0", "")
        subprocess.run(f"true {word}", shell=True, capture_output=True, cwd=tmp_path, timeout=60)
        if canary.exists():
            return
    pytest.fail("no word of a hundred made the canary, in a shell that obeyed them")


def test_no_code_calls_a_shell() -> None:
    for folder in ("robot_runtime", "server", "migrations"):
        for path in (ROOT / folder).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if not isinstance(node, ast.Call):
                    continue
                assert not any(keyword.arg == "shell" for keyword in node.keywords), f"{path}:{node.lineno}"
                called = node.func
                if isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name):
                    assert (called.value.id, called.attr) not in SHELLS, f"{path}:{node.lineno}"


def test_a_shell_runs_hostile_documents_as_they_are(tmp_path: Path) -> None:
    """The document runs by `mucat commtest`, down to the compiler and the boards."""
    canary = tmp_path / "canary"
    named = [
        template.format(canary=canary, secret=ROOT / "README.md", name="x") for template in SHELL[:TESTS_RUN]
    ]
    test: dict[str, object] = {"ino_path": SKETCH, "delay": [0.0], "baud_rate": [115200]}
    test |= {"arduinodelay": [0.0], "from_val": 0, "to_val": 2, "expected": 2, "framing": "plain"}
    file = tmp_path / f"$(touch {canary.name}).json"
    file.write_text(json.dumps([test | {"id": i, "name": name} for i, name in enumerate(named)]))
    command = [sys.executable, "-m", "server.cli", "commtest", "run", str(file), "--place", "emulated"]
    command += ["--data", str(tmp_path / "data")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert all(repr(name)[1:-1] in repr(done.stdout) for name in named)
    assert {path.name for path in tmp_path.iterdir()} == {"data", file.name}
