import os
import signal
import socket
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import click
import httpx
import psutil
import pytest

from robot_runtime.simulation.boards.mistakes import write_list
from server import VERSION, cli
from server.platform.folder_lock import runner_of
from server.platform.pidfile import pid_file, running_parts
from server.platform.settings import DataFolder, Settings, SetupError, make_folders, read_settings
from tests.server.ports import reserved_port
from tests.server.waiting import SECONDS, alive
from tests.waiting import wait_for

ROOT = Path(__file__).resolve().parents[2]


def mucat(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "server.cli", *arguments]
    return subprocess.run(
        command,
        cwd=ROOT,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )


@contextmanager
def running(settings: Settings, port: int) -> Iterator[subprocess.Popen[str]]:
    """`mucat run` for a robot without hardware: its runtime finds no port, and the server serves."""
    settings.config.write_text('[robot]\nname = "tested"\nmode = "robot"\n[link]\nport = "/nowhere"\n')
    command = [sys.executable, "-m", "server.cli", "run", "--port", str(port)]
    command += ["--config", str(settings.config), "--data", str(settings.data.path)]
    with subprocess.Popen(
        command,
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    ) as process:
        try:
            wait_for_answer(port, process)
            yield process
        finally:
            # In order: a real robot's runtime outlives a server that is killed.
            process.terminate()
            process.wait(SECONDS)


def wait_for_answer(port: int, process: subprocess.Popen[str] | None) -> None:
    end = time.monotonic() + SECONDS
    while time.monotonic() < end and (process is None or process.poll() is None):
        try:
            httpx.get(f"http://127.0.0.1:{port}/api/health")
        except httpx.TransportError:
            time.sleep(0.05)
        else:
            return
    assert process is not None, "the server does not answer any more"
    process.terminate()
    raise AssertionError(f"the server did not answer: {process.stdout and process.stdout.read()}")


def group_of(process: subprocess.Popen[str]) -> list[int]:
    """Return the server and what belongs to it; the runtime is in a group of its own."""
    results: list[int] = []
    for item in psutil.Process(process.pid).children(recursive=True):
        with suppress(ProcessLookupError):
            if os.getpgid(item.pid) == process.pid:
                results.append(item.pid)
    return results


@pytest.fixture
def port() -> Iterator[int]:
    with reserved_port() as number:
        yield number


def test_the_version_is_the_project_s() -> None:
    document = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert document["project"]["dynamic"] == ["version"]
    assert document["tool"]["setuptools"]["dynamic"]["version"] == {"attr": "server.VERSION"}
    assert mucat("--version").stdout == f"mucat {VERSION}\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_ends_in_order_and_leaves_nothing_behind(
    settings: Settings, port: int, number: signal.Signals
) -> None:
    with running(settings, port) as process:
        mine = psutil.Process(process.pid)
        wait_for(lambda: mine.children(recursive=True), "the server")
        children = mine.children(recursive=True)
        process.send_signal(number)
        output, _ = process.communicate(timeout=SECONDS)
        assert (process.returncode, "Traceback" in output) == (0, False)
        assert f"http://localhost:{port}/" in output
        assert not any(child.is_running() for child in children)


def test_the_runtime_of_a_killed_server_is_adopted_by_the_next(settings: Settings, port: int) -> None:
    with running(settings, port) as process:
        wait_for(lambda: "runtime" in running_parts(settings.data.run), "the runtime")
        runtime, group = running_parts(settings.data.run)["runtime"].pid, group_of(process)
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        # On a busy computer a killed server lives for a moment, and has its port and its folder till then.
        wait_for(lambda: not any(map(alive, group)), "the server's end")
    with running(settings, port):
        assert running_parts(settings.data.run)["runtime"].pid == runtime
        assert alive(runtime)
    assert not alive(runtime)


def test_processes_of_a_killed_runner_are_adopted_by_the_next_start(settings: Settings, port: int) -> None:
    with running(settings, port) as process:
        wait_for(lambda: "runtime" in running_parts(settings.data.run), "the runtime")
        runtime, group = running_parts(settings.data.run)["runtime"].pid, group_of(process)
        process.kill()
        process.wait()
        wait_for(lambda: not any(map(alive, group)), "the server's end")
    with running(settings, port) as process:
        assert runner_of(settings.data) == process.pid
        assert running_parts(settings.data.run)["runtime"].pid == runtime
    assert not alive(runtime)


def test_one_server_per_folder_and_one_per_port(settings: Settings, port: int) -> None:
    with running(settings, port):
        config = ("--config", str(settings.config))
        same_folder = mucat("run", "--port", str(port + 1), "--data", str(settings.data.path), *config)
        assert_refused(same_folder, "Another server works on")
        other = settings.data.path.parent / "other"
        same_port = mucat("run", "--port", str(port), *config, MUCAT_DATA=str(other))
        assert_refused(same_port, f"Port {port} of 127.0.0.1 cannot be had")


def test_an_impossible_start_is_refused_in_one_line(settings: Settings, tmp_path: Path) -> None:
    data = ("--data", str(settings.data.path))
    assert_refused(mucat("run", *data, "--config", str(tmp_path / "no.toml")), "no.toml cannot be read")
    bad = tmp_path / "bad.toml"
    for text, message in (
        ("[robot]\nname = 3", "name"),
        ('[robot]\nname = "a/b"', "robot.name"),
        ("[server]\nport = 0", "port"),
        ("[sever]\nport = 1", "sever"),
        ('[control]\ncontroller = "pidd"', "there is no controller 'pidd'"),
        ("nonsense", "cannot be read"),
    ):
        bad.write_text(text)
        assert_refused(mucat("run", *data, "--config", str(bad)), message)
    long = tmp_path / ("x" * 90)
    good = ("--config", str(settings.config))
    assert_refused(mucat("run", "--data", str(long), *good), "too long")
    assert not long.exists()
    assert_refused(mucat("run", "--port", "70000", *data, *good), "70000")
    assert_refused(mucat("run", "--host", "203.0.113.1", *data, *good), "203.0.113.1")
    bad.write_text('[robot]\nmode = "robot"\n')
    real = mucat("run", *data, "--config", str(bad), "--mistake", "imu-strap")
    assert_refused(real, "--mistake is for the emulated board")
    unknown = mucat("run", *data, *good, "--mistake", "imu")
    assert (unknown.returncode, "there is no mistake 'imu'; there are" in unknown.stderr) == (2, True)


def test_commands_take_the_last_configuration_and_a_server_at_a_shell_does_not(
    settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("server.board_reservation.PORT_SECONDS", 0.1)
    bad = tmp_path / "bad.toml"
    bad.write_text("")
    settings.data.last_config.write_text('[robot]\nmode = "robot"\n[link]\nport = "/dev/nowhere"\n')
    where = ("--data", str(settings.data.path), "--config", str(bad))
    assert cli.main(["upload", *where]) == 1
    output = capsys.readouterr().err.splitlines()
    assert "seems to be cut off" in output[0]
    assert "/dev/nowhere" in output[-1]
    bad.write_text("[robot")
    assert_refused(mucat("run", *where), "bad.toml cannot be read")


def test_the_help_lists_the_mistakes() -> None:
    listed = mucat("run", "--help").stdout
    assert all(f"  {line}\n" in listed for line in write_list())


def assert_refused(result: subprocess.CompletedProcess[str], message: str) -> None:
    assert result.returncode == 1
    assert result.stdout == ""
    assert result.stderr.startswith("mucat: ")
    assert message in result.stderr
    assert result.stderr.count("\n") == 1


def test_command_line_before_environment_before_file(settings: Settings, tmp_path: Path) -> None:
    config = settings.config
    config.write_text('[server]\nport = 9001\nhost = "127.0.0.2"\nallowed_hosts = ["Turtle.local"]\n')
    environment = {"MUCAT_DATA": str(tmp_path / "env")}
    plain = read_settings(config, None, None, None, environment)
    assert (plain.server.port, plain.server.host, plain.data.path) == (9001, "127.0.0.2", tmp_path / "env")
    assert plain.server.allowed_hosts == ["turtle.local", "127.0.0.2"]
    chosen = read_settings(config, tmp_path / "line", "::1", 9002, environment)
    assert (chosen.server.port, chosen.server.host, chosen.data.path) == (9002, "::1", tmp_path / "line")
    assert chosen.server.allowed_hosts == ["turtle.local", "[::1]"]
    name = socket.gethostname().lower()
    everywhere = read_settings(config, None, "0.0.0.0", None, {})
    assert everywhere.server.allowed_hosts[0] == "turtle.local"
    assert everywhere.server.allowed_hosts[-2:] == [f"{name}.local", name]


def test_the_run_folder_is_emptied_and_the_rest_stays(settings: Settings) -> None:
    folder = settings.data
    (folder.run / "board.sock").touch()
    (folder.path / "kept").touch()
    make_folders(folder)
    assert not list(folder.run.iterdir())
    assert (folder.path / "kept").exists()
    assert folder.run.stat().st_mode & 0o777 == 0o700
    with pytest.raises(SetupError, match="cannot be used"):
        make_folders(DataFolder(folder.path / "kept"))


def test_folders_and_files_of_older_versions_become_private(settings: Settings) -> None:
    folder = settings.data
    folder.path.chmod(0o755)
    outside = folder.path.parent / "outside"
    outside.mkdir()
    outside.chmod(0o755)
    (folder.path / "link").symlink_to(outside)
    for path in (folder.database, folder.logs / "runtime.log", folder.exports / "old" / "a.csv"):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.parent.chmod(0o755)
        path.touch()
        path.chmod(0o644)
    make_folders(folder)
    assert _modes(folder.path) <= {"0700", "0600"}
    assert outside.stat().st_mode & 0o777 == 0o755


def test_what_the_shell_makes_is_private_whatever_it_inherits(settings: Settings) -> None:
    inherited = os.umask(0o022)
    try:
        folder = DataFolder(settings.data.path.parent / "new")
        assert (
            cli.main(["sessions", "list", "--data", str(folder.path), "--config", str(settings.config)]) == 0
        )
        assert folder.database.exists()
        assert _modes(folder.path) <= {"0700", "0600"}
    finally:
        os.umask(inherited)


def _modes(folder: Path) -> set[str]:
    results = [path for path in (folder, *folder.rglob("*")) if not path.is_symlink()]
    return {f"{path.stat().st_mode & 0o777:04o}" for path in results}


def test_the_run_folder_stays_while_a_process_of_a_killed_server_lives(settings: Settings) -> None:
    folder = settings.data
    (folder.run / "board.sock").touch()
    with subprocess.Popen(["sleep", "600"]) as part:
        pid_file(folder.run, "board").write(part.pid, "")
        make_folders(folder)
        assert (folder.run / "board.sock").exists()
        part.kill()
    make_folders(folder)
    assert not list(folder.run.iterdir())


def test_the_server_loads_no_heavy_library_and_nothing_of_a_feature_that_is_off(tmp_path: Path) -> None:
    (tmp_path / "robot.toml").write_text("[features]\nidentification = false\nsweeps = false\n")
    program = (
        "import sys, server.app; from pathlib import Path; from pkgutil import resolve_name\n"
        "from server.container import features_on; from server.platform.settings import read_settings\n"
        f"folder = Path({str(tmp_path)!r})\n"
        "for one in features_on(read_settings(folder / 'robot.toml', folder, None, None, {})):\n"
        "    [resolve_name(place) for place in (*one.routes, one.plug) if place]\n"
        "heavy = {'numpy', 'cv2', 'plotly', 'alembic', 'scipy', 'rosbags', 'paho', 'pyarrow', 'xlsxwriter'}\n"
        "off = ('doors', 'events', 'identification', 'sweeps')\n"
        "off = tuple(f'server.features.{name}.' for name in off)\n"
        "found = [one for one in sys.modules if one in heavy or one.startswith(off)]\n"
        "print(*sorted(one for one in found if not one.endswith('.config')))"
    )
    assert printed(program) == ""


def test_the_doctor_looks_at_a_current_database_without_alembic() -> None:
    """Each server that starts does: its loading would take most of a restart."""
    program = (
        "import sys; from pathlib import Path; from migrations import HEAD\n"
        "from server.platform.schema import refuse_unknown\n"
        "refuse_unknown(HEAD, Path('mucat.db')); print('alembic' in sys.modules)"
    )
    assert printed(program).strip() == "False"


@pytest.mark.parametrize(
    ("line", "completed", "shown"),
    [
        ("", "", "mucat run"),
        ("--version", "", "mucat"),
        ("--help", "", "mucat"),
        *((f"{name} --help", "", "mucat") for name in cli.COMMANDS if name != "run"),
        ("", "mucat export 3 --format c", "csv-grid"),
        ("", "mucat export 3", "slow:"),
        ("", "mucat scenario run fig", "figure_14"),
        ("", "mucat mission try first", "first_dive"),
    ],
)
def test_a_command_line_is_read_before_anything_slow_is_loaded(
    line: str, completed: str, shown: str, tmp_path: Path
) -> None:
    program = (
        "import atexit, sys, server.cli\n"
        "slow = {'sqlalchemy', 'pydantic', 'fastapi', 'numpy', 'alembic'}\n"
        "atexit.register(lambda: print('slow:', *sorted(slow & set(sys.modules))))\n"
        f"sys.exit(server.cli.main({line.split()}))"
    )
    parts = completed.split()
    completion = {
        "_MUCAT_COMPLETE": "bash_complete",
        "COMP_WORDS": completed,
        "COMP_CWORD": str(len(parts) - 1),
        "MUCAT_DATA": str(tmp_path),
    }
    output = printed(program, **(completion if completed else {}))
    assert output.splitlines()[-1] == "slow:"
    assert shown in output


def test_alone_it_says_what_one_may_want() -> None:
    done = mucat()
    assert done.returncode == 0
    for line in ("mucat run", "sudo mucat install RELEASE", "mucat lab run", "mucat --help"):
        assert line in done.stdout
    assert len(done.stdout.splitlines()) <= 10


def test_every_command_has_a_help_text() -> None:
    def find(name: str) -> click.Command | None:
        command: click.Command | None = cli.mucat
        for word in name.split():
            assert isinstance(command, click.Group)
            command = command.get_command(click.Context(command), word)
        return command

    commands = {name: find(name) for name in cli.places_of_commands()}
    assert {name: command and command.name for name, command in commands.items()} == {
        name: name.split()[-1] for name in commands
    }

    def undescribed(command: click.Command, path: str) -> Iterator[str]:
        if not command.help:
            yield path
        if isinstance(command, click.Group):
            for name, subcommand in command.commands.items():
                yield from undescribed(subcommand, f"{path} {name}")

    assert [
        path for name, subcommand in commands.items() if subcommand for path in undescribed(subcommand, name)
    ] == []


def test_wrong_usage_ends_with_status_2(capsys: pytest.CaptureFixture[str]) -> None:
    for line in ("fly", "export", "export x", "export 1 --format pdf", "record", "run --colour"):
        assert cli.main(line.split()) == 2, line
        report = capsys.readouterr()
        assert (report.out, "Usage: mucat" in report.err) == ("", True)


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_it_prints_the_completion_of_a_shell(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["completion", shell]) == 0
    assert f"_MUCAT_COMPLETE={shell}_complete" in capsys.readouterr().out


def test_importing_the_server_starts_no_thread() -> None:
    """The runner forks after it has loaded these modules, which requires a process without threads."""
    program = "import os, server.app, server.http.serving; print(*os.listdir('/proc/self/task'), os.getpid())"
    assert len(set(printed(program).split())) == 1


def printed(program: str, **environment: str) -> str:
    result = subprocess.run(
        [sys.executable, "-c", program],
        cwd=ROOT,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return result.stdout.strip()


def test_libraries_compute_in_one_thread_in_all_processes_that_it_starts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(os, "environ", {"OMP_NUM_THREADS": "2"})
    cli.main(["--version"])
    assert os.environ == {"OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "1"}
