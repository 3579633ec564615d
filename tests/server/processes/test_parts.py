import asyncio
import json
import os
import subprocess
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

import robot_runtime.backoff as backoff_module
import server.processes.managed_process as parts_module
from robot_runtime.clock import SimulatedClock, SteadyClock
from robot_runtime.config import LinkConfig
from server.platform.pidfile import end_parts, pid_file, running_parts
from server.platform.settings import DataFolder, Settings, make_folders
from server.processes.logs import ProcessLog
from server.processes.managed_process import ManagedProcess, ProcessCommand
from server.processes.supervisor import ProcessSupervisor, plan
from tests.server.waiting import SECONDS, alive, until


class Crew:
    """A supervisor of processes that are small Python programs."""

    def __init__(self, folder: Path, *commands: ProcessCommand) -> None:
        self.changes: list[tuple[str, str]] = []
        data = DataFolder(folder)
        make_folders(data)
        self.parts = ProcessSupervisor(
            commands, data, SteadyClock(), lambda name, text: self.changes.append((name, text))
        )

    def part(self, name: str) -> ManagedProcess:
        part = self.parts.get(name)
        assert part is not None
        return part

    def process(self, name: str) -> psutil.Process:
        pid = self.part(name).pid
        assert pid is not None
        return psutil.Process(pid)


def program(name: str, code: str, *needs: Path) -> ProcessCommand:
    return ProcessCommand(name, f"part {name}", (sys.executable, "-c", code), needs)


@asynccontextmanager
async def running(crew: Crew) -> AsyncIterator[None]:
    crew.parts.start()
    try:
        yield
    finally:
        await crew.parts.stop()


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(backoff_module, "FIRST", 0.01)
    monkeypatch.setattr(backoff_module, "KILLED_MAX", 0.02)
    monkeypatch.setattr(backoff_module, "MAX", 0.04)


async def test_a_process_that_dies_is_reported_with_its_last_output_and_restarted(tmp_path: Path) -> None:
    count = tmp_path / "count"
    code = (
        f"import pathlib, sys, time; p = pathlib.Path({str(count)!r})\n"
        "n = len(p.read_text()) if p.exists() else 0; p.write_text('x' * (n + 1))\n"
        "if n < 2: print('no oil'); sys.exit(f'broken {n}')\n"
        "time.sleep(600)"
    )
    crew = Crew(tmp_path, program("engine", code))

    async with running(crew):
        await until(lambda: count.exists() and count.read_text() == "xxx", "the third start")
        await until(lambda: crew.part("engine").state == "running", "running")
        assert [kind for kind, _ in crew.changes] == ["engine", "engine"]
        assert "The part engine has ended with exit status 1." in crew.changes[0][1]
        assert "no oil / broken 0" in crew.changes[0][1]
        assert "It is started again at once." in crew.changes[0][1]
        assert "It is started again in 0.0 s." in crew.changes[1][1]
    assert (tmp_path / "logs" / "engine.log").read_text() == "no oil\nbroken 0\nno oil\nbroken 1\n"


async def test_a_killed_process_is_reported_with_the_signal_and_replaced(tmp_path: Path) -> None:
    crew = Crew(tmp_path, program("engine", "import time; time.sleep(600)"))

    async with running(crew):
        await until(lambda: crew.part("engine").pid, "the start")
        first = crew.process("engine")
        first.kill()
        await until(lambda: crew.changes, "the news")
        await until(lambda: crew.part("engine").pid not in (None, first.pid), "the next start")
        assert "was ended by signal SIGKILL" in crew.changes[0][1]


async def test_a_hung_process_is_killed_reported_and_restarted(tmp_path: Path) -> None:
    crew = Crew(tmp_path, program("engine", "import time; time.sleep(600)"))

    async with running(crew):
        await until(lambda: crew.part("engine").pid, "the start")
        first = crew.process("engine")
        first.suspend()
        crew.part("engine").end_hung("said nothing, and was ended")
        await until(lambda: crew.part("engine").pid not in (None, first.pid), "the next start")
        assert crew.changes == [
            ("engine", "The part engine said nothing, and was ended. It is started again at once.")
        ]
        crew.process("engine").kill()
        await until(lambda: len(crew.changes) > 1, "the news")
        assert "was ended by signal SIGKILL" in crew.changes[1][1]


@pytest.mark.parametrize(
    ("killed", "expected"),
    [(False, [0, 0.01, 0.02, 0.04, 0.04, 0, 0.01]), (True, [0, 0.01, 0.02, 0.02, 0.02, 0, 0.01])],
)
def test_pauses_grow_to_a_limit_and_reset_after_a_steady_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, killed: bool, expected: list[float]
) -> None:
    pauses: list[float] = []
    lives = iter([0, 1, 2, 3, 4, 20, 0])
    clock = SimulatedClock()
    part = ManagedProcess(
        ProcessCommand("engine", "engine", ()), ProcessLog(tmp_path), tmp_path, clock, lambda *_: None
    )

    async def live() -> tuple[str, bool]:
        clock.forward(next(lives))
        return "has ended", killed

    async def pause(seconds: float) -> None:
        pauses.append(seconds)
        if len(pauses) == 7:
            raise asyncio.CancelledError

    monkeypatch.setattr(part, "_run_once", live)
    monkeypatch.setattr(asyncio, "sleep", pause)
    with suppress(asyncio.CancelledError):
        asyncio.run(part.run())
    assert pauses == expected


async def stop_when_up(folder: Path, code: str) -> str:
    """Start a program that says "up" and sleeps, and stop it; return its log. Afterwards it is gone."""
    crew = Crew(folder, program("engine", f"import signal, sys, time\n{code}\nprint('up')\ntime.sleep(600)"))
    log = folder / "logs/engine.log"

    async with running(crew):
        await until(lambda: log.exists() and log.read_text() == "up\n", "it to be up")
        process = crew.process("engine")
    assert not process.is_running()
    assert crew.changes == []
    return log.read_text()


async def test_a_process_is_terminated_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # It may take its time on a busy computer.
    monkeypatch.setattr(parts_module, "TERM_SECONDS", SECONDS)
    polite = "signal.signal(15, lambda *_: sys.exit(print('bye')))"
    assert await stop_when_up(tmp_path, polite) == "up\nbye\n"


async def test_a_process_that_does_not_end_when_terminated_is_killed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parts_module, "TERM_SECONDS", 0.3)
    assert await stop_when_up(tmp_path, "signal.signal(15, signal.SIG_IGN)") == "up\n"


async def test_children_of_a_process_end_with_it(tmp_path: Path) -> None:
    code = "import subprocess, time; print(subprocess.Popen(['sleep', '600']).pid); time.sleep(600)"
    crew = Crew(tmp_path, program("parent", code))
    log = tmp_path / "logs" / "parent.log"

    async with running(crew):
        await until(lambda: log.exists() and log.read_text().endswith("\n"), "the child")
        crew.process("parent").kill()
        await until(lambda: crew.changes, "the news")
        first, *_ = map(int, log.read_text().split())
        await until(lambda: not alive(first), "the child's end")
        await until(lambda: len(log.read_text().split()) == 2, "the next child")
    children = [int(pid) for pid in log.read_text().split()]
    # They have been killed; the system may not have reaped them yet.
    await until(lambda: not any(map(alive, children)), "the last child's end")


async def test_a_process_starts_when_the_files_that_it_needs_exist(tmp_path: Path) -> None:
    socket = tmp_path / "board.sock"
    crew = Crew(tmp_path, program("water", "import time; time.sleep(600)", socket))

    async with running(crew):
        await asyncio.sleep(0.2)
        assert (crew.part("water").state, crew.part("water").pid) == ("waiting", None)
        socket.touch()
        await until(lambda: crew.part("water").state == "running", "the start")


async def test_a_missing_program_is_reported_and_the_others_run(tmp_path: Path) -> None:
    missing = ProcessCommand("board", "board", (str(tmp_path / "no" / "board"),))
    crew = Crew(tmp_path, missing, program("other", "import time; time.sleep(600)"))

    async with running(crew):
        await until(lambda: crew.changes and crew.part("other").state == "running", "both")
        assert "No such file" in crew.changes[0][1]
        assert crew.part("board").state in ("failed", "waiting")


async def test_a_paused_process_does_not_run_until_it_is_resumed(tmp_path: Path) -> None:
    crew = Crew(tmp_path, program("engine", "import time; time.sleep(600)"))

    async with running(crew):
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
        assert crew.changes == []


class Left:
    """A process that a killed server has left."""

    def __init__(self, folder: Path, command: ProcessCommand) -> None:
        self.command = command
        data = DataFolder(folder)
        make_folders(data)
        # Somebody else's child, as a killed server's are.
        code = (
            "import subprocess, sys; "
            "print(subprocess.Popen(sys.argv[1:], start_new_session=True, stdout=2).pid)"
        )
        arguments = [sys.executable, "-c", code, *command.arguments]
        done = subprocess.run(arguments, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True)
        self.process = psutil.Process(int(done.stdout))
        pid_file(data.run, command.name).write(self.process.pid, command.fingerprint())


async def test_a_process_of_a_killed_server_is_adopted(tmp_path: Path) -> None:
    remaining = Left(tmp_path, program("engine", "import time; time.sleep(600)", tmp_path / "never"))
    crew = Crew(tmp_path, remaining.command)

    started = crew.part("engine").since

    async with running(crew):
        await until(lambda: crew.part("engine").state == "running", "the adoption")
        assert crew.part("engine").pid == remaining.process.pid
        assert crew.part("engine").since == started
        (tmp_path / "never").touch()
        remaining.process.kill()
        await until(lambda: crew.changes, "the news")
        assert (
            "has ended; its exit status is not known, because an earlier server had started it"
            in crew.changes[0][1]
        )
        await until(lambda: crew.part("engine").pid not in (None, remaining.process.pid), "the next")
    assert not alive(remaining.process.pid)
    assert not list((tmp_path / "run").iterdir())


async def test_an_adopted_process_is_terminated_first_and_then_killed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parts_module, "TERM_SECONDS", 0.3)
    up = tmp_path / "up"
    code = "import pathlib, signal, time; signal.signal(15, signal.SIG_IGN)\n"
    remaining = Left(tmp_path, program("deaf", code + f"pathlib.Path({str(up)!r}).touch(); time.sleep(600)"))
    crew = Crew(tmp_path, remaining.command)

    async with running(crew):
        await until(lambda: crew.part("deaf").pid == remaining.process.pid, "the adoption")
        await until(up.exists, "it to be deaf")
    assert not alive(remaining.process.pid)
    assert crew.changes == []


async def test_a_process_of_another_command_or_other_files_is_replaced(tmp_path: Path) -> None:
    read = tmp_path / "read"
    read.write_text("old")
    commands = [
        program("argument", "import time; time.sleep(600)"),
        replace(program("file", "import time; time.sleep(600)"), made_of=(read,)),
    ]
    remaining = [Left(tmp_path, command) for command in commands]
    read.write_text("new")
    changed = program("argument", "import time; time.sleep(601)")
    crew = Crew(tmp_path, changed, commands[1])

    async with running(crew):
        for server in remaining:
            await until(lambda item=server: not alive(item.process.pid), "the end of the old")  # type: ignore[misc]
        await until(lambda: crew.part("argument").pid and crew.part("file").pid, "the new")
        assert crew.changes == []


async def test_a_reused_process_number_is_not_adopted(tmp_path: Path) -> None:
    command = program("engine", "import time; time.sleep(600)")
    remaining = Left(tmp_path, command)
    file = tmp_path / "run" / "engine.pid"
    text = json.loads(file.read_text())
    file.write_text(json.dumps(text | {"started": text["started"] - 1}))
    crew = Crew(tmp_path, command)

    async with running(crew):
        await until(lambda: crew.part("engine").pid, "the start")
        assert crew.part("engine").pid != remaining.process.pid
    assert remaining.process.is_running()
    remaining.process.kill()


@pytest.mark.parametrize("text", ["", "nonsense", "[]", "{}", '{"pid": null}', '{"pid": 1, "started": 1}'])
def test_a_damaged_pid_file_is_ignored(tmp_path: Path, text: str) -> None:
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "engine.pid").write_text(text)
    assert running_parts(tmp_path / "run") == {}


async def test_a_process_that_is_paused_at_the_start_is_not_adopted(tmp_path: Path) -> None:
    remaining = Left(tmp_path, program("engine", "import time; time.sleep(600)"))
    crew = Crew(tmp_path, remaining.command)

    await crew.parts.pause("engine", "It is lent.")
    assert not alive(remaining.process.pid)


def test_a_process_that_the_next_server_does_not_use_is_ended(tmp_path: Path) -> None:
    remaining = Left(tmp_path, program("engine", "import time; time.sleep(600)"))
    crew = Crew(tmp_path, remaining.command)
    asyncio.run(crew.parts.end_others())
    assert alive(remaining.process.pid)
    asyncio.run(Crew(tmp_path, program("another", "")).parts.end_others())
    assert not alive(remaining.process.pid)
    remaining = Left(tmp_path, program("engine", "import time; time.sleep(600)"))
    end_parts(tmp_path / "run")
    assert not alive(remaining.process.pid)
    assert running_parts(tmp_path / "run") == {}


async def test_ctrl_c_reaches_the_server_alone(tmp_path: Path) -> None:
    crew = Crew(tmp_path, program("engine", "import time; time.sleep(600)"))

    async with running(crew):
        await until(lambda: crew.part("engine").pid, "the start")
        pid = crew.part("engine").pid
        assert pid is not None
        assert os.getpgid(pid) == pid != os.getpgid(0)


def test_a_real_robot_runs_only_the_runtime_and_an_emulated_one_all_processes(settings: Settings) -> None:
    real = replace(settings, robot=replace(settings.robot, mode="robot"))
    assert [command.name for command in plan(real)] == ["runtime"]
    commands = {command.name: command for command in plan(settings)}
    assert list(commands) == ["board", "runtime", "simulator", "scene"]
    lock = ("--server-lock", str(settings.data.lock))
    assert all(command.arguments[-2:] == lock for command in commands.values())
    assert str(settings.build / "firmware/optiboot.hex") in commands["board"].arguments
    assert commands["runtime"].needs == (settings.data.board_tty,)
    assert str(settings.data.board_tty) in commands["runtime"].arguments
    board = plan(replace(settings, mistakes=("imu-strap", "backlash:0.1")))[0].arguments
    assert " ".join(board).endswith("--mistake imu-strap --mistake backlash:0.1")
    alone = plan(replace(settings, robot=replace(settings.robot, mode="robot")))[0].arguments
    assert "--port" not in alone
    assert "--server-lock" not in alone
    assert "--heartbeat" in alone


def test_the_board_runs_the_firmware_for_the_configured_speed(settings: Settings) -> None:
    elf = settings.build / "firmware/9600/robot.elf"
    assert str(elf) in plan(replace(settings, link=LinkConfig(baud=9600)))[0].arguments
