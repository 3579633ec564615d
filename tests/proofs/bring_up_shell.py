"""A person who brings up a robot from a shell: answers `mucat bring-up`, with hands at the board."""

import os
import re
import select
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from robot_runtime.control.fin_check import FINS
from robot_runtime.experiments.bring_up.guide import NO_FIN, STEPS
from robot_runtime.simulation.boards.emulator_process import EmulatorProcess
from robot_runtime.simulation.boards.workbench import ALONG, BAROMETER, BATTERY, TIP_DOWN, Hands, Pose
from tests.board.rig import OPTIBOOT, PROGRAM, ROOT

PATIENCE = 60.0
"""s without a word, at most: the longest is the upload of a sketch."""
BEATS = 10
"""Changes of the surroundings, 40 ms each, that a person waits before pressing Enter."""
TURNED = 0.1
"""rad, from which a person sees that a fin turns."""
POSES: dict[str, Pose] = {
    "It lies level": "level",
    "Its nose points up": "nose_up",
    "Its right side points down": "right_down",
}


def bring_up_from_shell(mistakes: tuple[str, ...]) -> tuple[str | None, str, str]:
    """Bring up a new robot with these mistakes, the emulated board in place of a real one.

    Returns the first step that is wrong, its findings that say so, and the report.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        tty, socket = folder / "tty", folder / "board"
        config = folder / "robot.toml"
        config.write_text(
            f'[robot]\nmode = "robot"\n[link]\nport = "{tty}"\nreset = "board:{socket}"\n', encoding="utf-8"
        )
        options = ["--bootloader", str(OPTIBOOT), "--uncalibrated"]
        options += [word for mistake in mistakes for word in ("--mistake", mistake)]
        elf = ROOT / "build/firmware/robot.elf"
        with EmulatorProcess(PROGRAM, elf, tty, socket, *options), Hands(socket) as hands:
            person = ShellPerson(hands, "--config", str(config), "--data", str(folder / "data"))
            found, said = person.converse()
        return found, said, (folder / "data/bring-up.html").read_text(encoding="utf-8")


class ShellPerson:
    """Does what `mucat bring-up` asks until a step is wrong, and ends it then."""

    def __init__(self, hands: Hands, *options: str) -> None:
        self._hands = hands
        self._before = hands.fins.angles
        command = [sys.executable, "-c", "from server.cli import main; raise SystemExit(main())", "bring-up"]
        self._process = subprocess.Popen(
            [*command, *options],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env=os.environ | {"PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": "1"},
            cwd=ROOT,
        )
        self._said = ""
        """Since the present step began."""
        self._step = ""

    def converse(self) -> tuple[str | None, str]:
        """Answer all questions; returns the first step that is wrong, and all findings that say so."""
        assert self._process.stdin is not None
        found, said = None, ""
        while (question := self._hear()) is not None:
            if found is not None:
                answer = "q"
            elif question.startswith("Again?"):
                bad = [line.strip() for line in self._said.splitlines() if "BAD " in line]
                found, said, answer = self._step, " ".join(bad), "n"
            else:
                answer = self._answer(question)
            self._process.stdin.write(f"{answer}\n".encode())
            self._process.stdin.flush()
        status = self._process.wait(PATIENCE)
        assert status == (0 if found is None else 1), self._said
        return found, said

    def _hear(self) -> str | None:
        """The next question, once it is whole; None where there is none any more."""
        assert self._process.stdout is not None
        heard = ""
        while not heard.endswith(": "):
            assert select.select([self._process.stdout], [], [], PATIENCE)[0], heard
            data = os.read(self._process.stdout.fileno(), 65536).decode()
            if not data:
                self._said += heard
                return None
            heard += data
        steps = re.findall(r"^(\d+)/\d+  ", heard, re.MULTILINE)
        if steps:
            self._step = STEPS[int(steps[-1]) - 1].name
            self._said = ""
        self._said += heard
        return heard.rpartition("\n")[2]

    def _answer(self, question: str) -> str:
        label, bench = re.split(r" [\[(]", question)[0], self._hands.bench
        fin = int(self._step[-1]) if self._step[-1].isdigit() else 0
        if label in POSES:
            bench.pose = POSES[label]
        elif label in ("It points along its mount", "Its tip points down"):
            self._hands.turn(fin, ALONG if "along" in label else TIP_DOWN)
        elif label in ("In air", "In the bucket"):
            bench.depth = 0.0 if label == "In air" else 0.3
        elif label in ("Both are dark", "Lamp at the right", "Lamp at the left"):
            bench.lamp = "right" if "right" in label else "left" if "left" in label else "none"
        elif label == "Measure at rest":
            bench.pose = "level"
        self._wait()
        if label == "Hold to turn it":
            self._before = self._hands.fins.angles
        figures = {"Multimeter": BATTERY, "Barometer": BAROMETER / 100, "Depth": 30}
        if label in figures:
            return f"{figures[label]}"
        return self._seen() if label == "Fin" else ""

    def _seen(self) -> str:
        moved = [abs(now - then) for then, now in zip(self._before, self._hands.fins.angles, strict=True)]
        return FINS[moved.index(max(moved))] if max(moved) > TURNED else NO_FIN

    def _wait(self) -> None:
        """Wait until the readings have followed."""
        for _ in range(BEATS):
            then, end = self._hands.fins, time.monotonic() + PATIENCE
            while self._hands.fins is then:
                assert time.monotonic() < end, "the hands are gone"
                os.sched_yield()
