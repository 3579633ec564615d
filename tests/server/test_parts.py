import asyncio
import os
import sys
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

import server.parts as parts_module
from robot_runtime.clock import SimulatedClock, SteadyClock
from robot_runtime.config import LinkConfig
from server.parts import Command, Part, Parts, plan
from server.settings import Settings
from tests.server.waiting import until


class Crew:
    """Parts made of small Python programs."""

    def __init__(self, folder: Path, *commands: Command) -> None:
        self.told: list[tuple[str, str]] = []
        self.parts = Parts(
            commands, folder, SteadyClock(), lambda kind, _, text: self.told.append((kind, text))
        )

    def part(self, name: str) -> Part:
        part = self.parts.get(name)
        assert part is not None
        return part

    def process(self, name: str) -> psutil.Process:
        pid = self.part(name).pid
        assert pid is not None
        return psutil.Process(pid)


def program(name: str, code: str, *needs: Path) -> Command:
    return Command(name, f"part {name}", (sys.executable, "-c", code), needs)


def run(crew: Crew, scenario: Callable[[], Awaitable[None]]) -> None:
    async def play() -> None:
        crew.parts.start()
        try:
            await scenario()
        finally:
            await crew.parts.stop()

    asyncio.run(play())


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parts_module, "BACKOFF_FIRST", 0.01)
    monkeypatch.setattr(parts_module, "BACKOFF_MAX", 0.04)


def test_what_dies_is_told_with_its_last_words_and_started_again(tmp_path: Path) -> None:
    count = tmp_path / "count"
    code = (
        f"import pathlib, sys, time; p = pathlib.Path({str(count)!r})\n"
        "n = len(p.read_text()) if p.exists() else 0; p.write_text('x' * (n + 1))\n"
        "if n < 2: print('no oil'); sys.exit(f'broken {n}')\n"
        "time.sleep(600)"
    )
    crew = Crew(tmp_path, program("engine", code))

    async def scenario() -> None:
        await until(lambda: count.exists() and count.read_text() == "xxx", "the third start")
        await until(lambda: crew.part("engine").state == "running", "running")
        assert [kind for kind, _ in crew.told] == ["engine", "engine"]
        assert "The part engine has ended with exit status 1." in crew.told[0][1]
        assert "no oil / broken 0" in crew.told[0][1]
        assert "started again in 0.0 s" in crew.told[0][1]

    run(crew, scenario)
    assert (tmp_path / "engine.log").read_text() == "no oil\nbroken 0\nno oil\nbroken 1\n"


def test_what_is_killed_is_told_by_its_signal_and_is_another_process_afterwards(tmp_path: Path) -> None:
    crew = Crew(tmp_path, program("engine", "import time; time.sleep(600)"))

    async def scenario() -> None:
        await until(lambda: crew.part("engine").pid, "the start")
        first = crew.process("engine")
        first.kill()
        await until(lambda: crew.told, "the news")
        await until(lambda: crew.part("engine").pid not in (None, first.pid), "the next start")
        assert "was ended by signal SIGKILL" in crew.told[0][1]

    run(crew, scenario)


def test_pauses_grow_to_a_limit_and_shrink_after_a_steady_life(monkeypatch: pytest.MonkeyPatch) -> None:
    pauses: list[float] = []
    lives = iter([0, 1, 2, 3, 20, 0])
    clock = SimulatedClock()
    part = Part(Command("engine", "engine", ()), None, clock, lambda *_: None)  # type: ignore[arg-type]

    async def live() -> str:
        clock.forward(next(lives))
        return "has ended"

    async def pause(seconds: float) -> None:
        pauses.append(seconds)
        if len(pauses) == 6:
            raise asyncio.CancelledError

    class Log:
        def close(self) -> None:
            return None

    monkeypatch.setattr(part, "_run_once", live)
    monkeypatch.setattr(part, "_log", Log())
    monkeypatch.setattr(asyncio, "sleep", pause)
    with suppress(asyncio.CancelledError):
        asyncio.run(part.run())
    assert pauses == [0.01, 0.02, 0.04, 0.04, 0.01, 0.02]


def test_the_end_is_asked_for_first_and_then_forced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parts_module, "TERM_SECONDS", 0.3)
    up = "print('up')\ntime.sleep(600)"
    polite = f"import signal, sys, time; signal.signal(15, lambda *_: sys.exit(print('bye')))\n{up}"
    deaf = f"import signal, time; signal.signal(15, signal.SIG_IGN)\n{up}"
    crew = Crew(tmp_path, program("polite", polite), program("deaf", deaf))
    processes: list[psutil.Process] = []

    async def scenario() -> None:
        for name in ("polite", "deaf"):
            log = tmp_path / f"{name}.log"
            await until(lambda log=log: log.exists() and log.read_text() == "up\n", f"{name} to be up")  # type: ignore[misc]
            processes.append(crew.process(name))

    run(crew, scenario)
    assert (tmp_path / "polite.log").read_text() == "up\nbye\n"
    assert not any(process.is_running() for process in processes)
    assert crew.told == []


def test_children_of_a_part_end_with_it(tmp_path: Path) -> None:
    code = "import subprocess, time; print(subprocess.Popen(['sleep', '600']).pid); time.sleep(600)"
    crew = Crew(tmp_path, program("parent", code))
    log = tmp_path / "parent.log"

    async def scenario() -> None:
        await until(lambda: log.exists() and log.read_text().endswith("\n"), "the child")
        crew.process("parent").kill()
        await until(lambda: crew.told, "the news")
        first, *_ = map(int, log.read_text().split())
        await until(lambda: not alive(first), "the child's end")
        await until(lambda: len(log.read_text().split()) == 2, "the next child")

    run(crew, scenario)
    children = [int(pid) for pid in log.read_text().split()]
    # They have been killed; the system may still be about to bury them.
    asyncio.run(until(lambda: not any(map(alive, children)), "the last child's end"))


def test_a_part_starts_when_what_it_needs_is_there(tmp_path: Path) -> None:
    socket = tmp_path / "board.sock"
    crew = Crew(tmp_path, program("water", "import time; time.sleep(600)", socket))

    async def scenario() -> None:
        await asyncio.sleep(0.2)
        assert (crew.part("water").state, crew.part("water").pid) == ("waiting", None)
        socket.touch()
        await until(lambda: crew.part("water").state == "running", "the start")

    run(crew, scenario)


def test_a_missing_program_is_told_and_the_others_run(tmp_path: Path) -> None:
    missing = Command("board", "board", (str(tmp_path / "no" / "board"),))
    crew = Crew(tmp_path, missing, program("other", "import time; time.sleep(600)"))

    async def scenario() -> None:
        await until(lambda: crew.told and crew.part("other").state == "running", "both")
        assert "No such file" in crew.told[0][1]
        assert crew.part("board").state in ("failed", "waiting")

    run(crew, scenario)


def test_what_is_paused_does_not_run_until_it_is_resumed(tmp_path: Path) -> None:
    crew = Crew(tmp_path, program("engine", "import time; time.sleep(600)"))

    async def scenario() -> None:
        await until(lambda: crew.part("engine").pid, "the start")
        before = crew.process("engine")
        await crew.parts.pause("engine", "It is lent.")
        await crew.parts.pause("sail", "There is none.")
        assert not before.is_running()
        assert (crew.part("engine").state, crew.part("engine").problem) == ("paused", "It is lent.")
        crew.parts.start()
        await asyncio.sleep(0)
        assert crew.part("engine").state == "paused"
        crew.parts.resume("engine")
        await until(lambda: crew.part("engine").pid, "the next start")
        assert crew.told == []

    run(crew, scenario)


def test_ctrl_c_reaches_the_server_alone(tmp_path: Path) -> None:
    crew = Crew(tmp_path, program("engine", "import time; time.sleep(600)"))

    async def scenario() -> None:
        await until(lambda: crew.part("engine").pid, "the start")
        pid = crew.part("engine").pid
        assert pid is not None
        assert os.getpgid(pid) == pid != os.getpgid(0)

    run(crew, scenario)


def test_a_real_robot_needs_the_runtime_alone_and_an_emulated_one_everything(settings: Settings) -> None:
    assert [command.name for command in plan(replace(settings, mode="robot"))] == ["runtime"]
    commands = {command.name: command for command in plan(settings)}
    assert list(commands) == ["board", "runtime", "simulator", "scene"]
    assert all(command.arguments[-1] == "--with-parent" for command in commands.values())
    assert str(settings.build / "firmware/optiboot.hex") in commands["board"].arguments
    assert commands["runtime"].needs == (settings.data.board_tty,)
    assert str(settings.data.board_tty) in commands["runtime"].arguments
    assert "--port" not in plan(replace(settings, mode="robot"))[0].arguments


def test_the_board_runs_the_firmware_for_the_configured_speed(settings: Settings) -> None:
    elf = settings.build / "firmware/9600/robot.elf"
    assert str(elf) in plan(replace(settings, link=LinkConfig(baud=9600)))[0].arguments


def alive(pid: int) -> bool:
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False
