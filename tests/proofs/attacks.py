"""Every attack of the security review on a whole robot, while an operator arms it and presses STOP.

`python -m tests.proofs.attacks [WORDS]` prints a table of the attacks (of those that have the words in their
names), the delays of STOP, and the control loop's jitter with and without attacks; status 1 where one was not
held, or STOP came late. What needs no running robot, or another one, are tests, which are run first.

The floods of a viewer follow, each alone, since some of them stop the robot and it cannot be armed then. STOP
is pressed all the same, and the server that answers must be the same at the end.
"""

import json
import os
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import httpx

from robot_runtime.transport.blocks import read_blocks, read_rows
from server.platform.pidfile import pid_file
from tests.proofs.attackers import ATTACKS, choose
from tests.proofs.floods import FLOOD_SECONDS, FLOODS
from tests.stack import ROOT, Stack, free_port

PRESSES = 100
QUIET_PRESSES = 20
STOP_MAX = 0.5
"""s of the slowest but one of a hundred presses."""
JITTER_MAX = 0.02
"""s by which attacks may lengthen the loop's 99th percentile."""
NICENESS = -13
"""Of the sessions of `WEIGHTY` (sched(7), autogroup): a weight of 18 times the server's, as CPUWeight has
1000 and 50 in the units of an installed robot.
"""
WEIGHTY = ("runtime", "board", "simulator")
"""The last two are the chip and the water of a real robot, which share no processor with it."""
RECORD_SECONDS = 10.0
GAPS, BOOKMARKS = 400_000, 100_000
"""Of a session that an earlier version has imported."""
NOBODY = 65534
TESTS = {
    "half-sent requests over a revocation": "tests/server/sign_in/test_revoked_requests.py",
    "pairing, sessions, cookies, sign-out": "tests/server/sign_in/test_access.py",
    "secrets and codes": "tests/server/sign_in/test_codes.py",
    "security headers, stored scripts": "tests/server/http/test_security.py",
    "zip-slip, packed, checksums, cut": "tests/server/features/exports/test_imports.py",
    "malformed archives": "tests/server/features/exports/test_malformed_archives.py",
    "stored bombs": "tests/server/library/test_replay.py",
    "sessions of other versions": "tests/server/test_released_sessions.py",
    "formulas and exports": "tests/server/features/exports/test_tables.py",
    "panels and layouts": "tests/server/features/panels",
    "TLS": "tests/server/sign_in/test_tls.py",
    "connections, heads and bodies without end": "tests/server/http/test_connections.py",
    "X-Forwarded-For": "tests/server/http/test_proxies.py",
    "numbers that are none": "tests/server/http/test_body_numbers.py",
    "Zenoh over TCP": "tests/server/platform/test_authority.py",
    "a full disk": "tests/server/recording/test_full_disk.py",
    "exits of the panel sandbox": "tests/browser/test_panels.py",
    "modes of files, whatever the umask": "tests/server/test_cli.py -k private",
}


AFTERWARDS = ("files, sockets and serial line as nobody", "the runtime killed in mid-command")
LIVE = (*ATTACKS, *AFTERWARDS, *FLOODS)
PAUSE = 0.03
"""s between two presses in a flood."""
DOORS = '[doors]\nrosbridge = true\nfoxglove = true\nros2 = true\nros2_listen = "{}"\n'


def percentile(values: Sequence[float], share: float) -> float:
    """Return the value that this share does not exceed; infinite without values."""
    ordered = sorted(values)
    return ordered[min(int(share * len(ordered)), len(ordered) - 1)] if ordered else float("inf")


def press(stack: Stack, count: int) -> list[float]:
    """Return the delays of so many STOPs of the armed robot, s."""
    delays = []
    for _ in range(count):
        stack.arm()
        began = time.monotonic()
        answer = stack.api.post("/robot/stop", timeout=60)
        delays.append(time.monotonic() - began)
        assert answer.status_code < 300, answer.text
    return delays


def read_jitter(stack: Stack, start: float, end: float) -> float:
    """Return the 99th percentile of the control loop's deviation from its median period, s."""
    answer = stack.api.get("/past", params={"topic": "control", "until": end}, timeout=60).raise_for_status()
    times = [moment for block in read_blocks(answer.content) for moment, _ in read_rows(block)]
    periods = [later - earlier for earlier, later in pairwise(times) if start <= earlier <= end]
    usual = percentile(periods, 0.5)
    return percentile([abs(period - usual) for period in periods], 0.99)


def make_token(stack: Stack, scope: str) -> str:
    """Return a token of a new program."""
    name = f"attacker {len(stack.api.get('/access/devices').json())}"
    made = stack.api.post("/access/tokens", json={"name": name, "scope": scope}).raise_for_status()
    token: str = made.json()["token"]
    return token


def ros2_folder(stack: Stack) -> Path:
    """Return the folder of a viewer's certificate for the door of ROS 2."""
    return stack.data.parent / "ros2"


def certify(stack: Stack, config: Path, endpoint: str) -> None:
    """Make that certificate, and note the door's endpoint beside it."""
    folder = ros2_folder(stack)
    places = ["--config", str(config), "--data", str(stack.data), "--to", str(folder)]
    command = [sys.executable, "-m", "server.cli", "certificate", "ros2", "viewer", *places]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (folder / "endpoint").write_text(endpoint, encoding="utf-8")


def record(stack: Stack) -> None:
    """A session that viewers read."""
    session = stack.api.post("/sessions", json={"name": "attacked"}).raise_for_status().json()["id"]
    time.sleep(RECORD_SECONDS)
    stack.api.post(f"/sessions/{session}/stop").raise_for_status()


def crowd(stack: Stack) -> None:
    """A session with more gaps and bookmarks than are accepted now, as an earlier version has stored them."""
    session = stack.api.post("/sessions", json={"name": "crowded"}).raise_for_status().json()["id"]
    stack.api.post(f"/sessions/{session}/stop").raise_for_status()
    with closing(sqlite3.connect(stack.data / "mucat.db", timeout=60.0)) as database, database:
        (start,) = database.execute("SELECT started_steady FROM session WHERE id = ?", (session,)).fetchone()
        database.executemany(
            "INSERT INTO gap (session_id, topic, kind, time, missed) VALUES (?, 'depth', 'missed', ?, 1)",
            ((session, start + position / GAPS) for position in range(GAPS)),
        )
        database.executemany(
            "INSERT INTO marker (session_id, time, text, made) VALUES (?, ?, 'x', 0)",
            ((session, start + position / BOOKMARKS) for position in range(BOOKMARKS)),
        )


def weigh(stack: Stack) -> bool:
    """Give the parts their weights of an installed robot; false where user or kernel forbid it."""
    try:
        for name in WEIGHTY:
            Path(f"/proc/{stack.part(name).pid}/autogroup").write_text(str(NICENESS), "ascii")
    except OSError:
        return False
    return True


def look_as_nobody(data: Path) -> str:
    """Return the token, database, sockets and serial line that another user finds."""
    for folder in data.parents[: len(data.parts) - len(Path(tempfile.gettempdir()).parts) - 1]:
        folder.chmod(0o755)
    places = [data / "server.token", data / "run" / "runtime.sock", data / "run" / "board.tty"]
    command = ["/usr/bin/find", str(data), *map(str, places)]
    as_nobody: dict[str, Any] = {"user": NOBODY, "group": NOBODY, "extra_groups": []}
    result = subprocess.run(command, **as_nobody, capture_output=True, text=True)
    seen = [line for line in result.stdout.splitlines() if line != str(data)]
    line = str((data / "run" / "board.tty").resolve())
    ways = [["/usr/bin/test", way, line] for way in ("-r", "-w")]
    seen += [str(way) for way in ways if subprocess.run(way, **as_nobody).returncode == 0]
    return f"nobody finds {seen}" if seen or not result.stderr else ""


def kill_the_runtime(stack: Stack) -> str:
    """Kill the runtime while commands are sent: they fail with a reason, and the robot comes back."""
    stack.arm()
    running = pid_file(stack.data / "run", "runtime").read()
    assert running is not None
    with ThreadPoolExecutor(1) as thread:
        commands = [thread.submit(stack.api.post, "/robot/stop", timeout=60) for _ in range(20)]
        os.kill(running.pid, signal.SIGKILL)
        statuses = {command.result().status_code for command in commands}
    stack.wait_ready()
    armed = stack.api.get("/robot").json()["armed"]
    return "" if statuses <= {204, 503} and not armed else f"answers {statuses}, armed: {armed}"


@dataclass
class FloodOutcome:
    """The result of the attacks on a whole robot."""

    problems: dict[str, str] = field(default_factory=dict)
    delays: list[float] = field(default_factory=list)
    """s from each press of STOP to its answer."""
    quiet_jitter: float = 0.0
    """s; `read_jitter` before the attacks."""
    jitter: float = 0.0
    made: int = 0
    """Attacks that were made while STOP was pressed."""


def attack(stack: Stack, message: str) -> FloodOutcome:
    """Make the attacks that have these words in their names."""
    chosen = {} if message in FLOODS else choose(message)
    outcome = attack_while_pressing(stack, message) if chosen else FloodOutcome()
    nobody, killed = AFTERWARDS
    if message in nobody and os.geteuid() == 0:
        outcome.problems[nobody] = look_as_nobody(stack.data)
    if message in killed:
        outcome.problems[killed] = kill_the_runtime(stack)
    if any(message in name for name in FLOODS):
        crowd(stack)
    for name in FLOODS:
        if message in name:
            outcome.problems[name] = flood(stack, name)
    return outcome


def start_attackers(stack: Stack, message: str) -> subprocess.Popen[str]:
    """Return the process of the attackers, which attack until their input is closed."""
    tokens = [make_token(stack, scope) for scope in ("read", "administer")]
    command = [
        sys.executable,
        "-m",
        "tests.proofs.attackers",
        stack.url,
        *tokens,
        str(ros2_folder(stack)),
        message,
    ]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, cwd=ROOT, stdin=pipe, stdout=pipe, text=True)


def flood(stack: Stack, name: str) -> str:
    """Return the problem of a flood; empty where STOP was answered in time, always by the same server."""
    server, delays = stack.server, list[float]()
    with start_attackers(stack, name) as attackers:
        end = time.monotonic() + 2 * FLOOD_SECONDS
        while time.monotonic() < end or len(delays) < PRESSES:
            began = time.monotonic()
            try:
                stack.api.post("/robot/stop", timeout=60).raise_for_status()
            except httpx.HTTPError as failure:
                attackers.communicate()
                return f"STOP after {len(delays)} others: {type(failure).__name__} {failure}"
            delays.append(time.monotonic() - began)
            time.sleep(PAUSE)
        ((problem, _),) = json.loads(attackers.communicate()[0]).values()
    late = percentile(delays, 0.99)
    most = server.memory_info().rss / 1e6 if server.is_running() else 0.0
    print(f"{name}: {len(delays)} STOPs, p99 {late:.3f} s; the server has {most:.0f} MB", flush=True)
    if not server.is_running() or stack.server.pid != server.pid:
        return "the server has ended"
    if late > STOP_MAX:
        return f"STOP p99 {late:.3f} s"
    return str(problem)


def attack_while_pressing(stack: Stack, message: str) -> FloodOutcome:
    """Make those that the attackers repeat meanwhile."""
    record(stack)
    weight = "as in the units" if weigh(stack) else "not as in the units: that needs root and autogroups"
    print(f"Shares of the processors: {weight}", flush=True)
    began = time.monotonic()
    press(stack, QUIET_PRESSES)
    outcome = FloodOutcome(quiet_jitter=read_jitter(stack, began, time.monotonic()))
    with start_attackers(stack, message) as attackers:
        began = time.monotonic()
        outcome.delays = press(stack, PRESSES)
        outcome.jitter = read_jitter(stack, began, time.monotonic())
        output, _ = attackers.communicate()
    for name, (problem, made) in json.loads(output).items():
        outcome.problems[name] = problem
        outcome.made += made
    return outcome


def test(path: str) -> str:
    """Return the last line of a row's tests where one fails, all lines of which are printed; else empty."""
    chosen = [] if path.startswith("tests/browser") else ["-m", "not stack"]
    command = [sys.executable, "-m", "pytest", "-q", *chosen, "-p", "no:cacheprovider", *path.split()]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode == 0:
        return ""
    print(done.stdout, flush=True)
    return done.stdout.strip().splitlines()[-1]


def main() -> int:
    """Exit status: 1 where a row did not hold or STOP was late."""
    text = " ".join(sys.argv[1:])
    rows = {name: test(path) for name, path in TESTS.items() if text in name}
    outcome = FloodOutcome()
    if any(text in name for name in LIVE):
        with tempfile.TemporaryDirectory(prefix="mucat-") as folder:
            config = Path(folder) / "robot.toml"
            endpoint = f"tls/127.0.0.1:{free_port()}"
            config.write_text(DOORS.format(endpoint), encoding="utf-8")
            with Stack(Path(folder) / "data", "--config", str(config)) as stack:
                certify(stack, config, endpoint)
                outcome = attack(stack, text)
        rows |= outcome.problems
    if not rows:
        print(f"No attack has “{text}” in its name.")
        return 1
    width = max(map(len, rows))
    for name, problem in rows.items():
        verdict, where = "NOT HELD" if problem else "held", TESTS.get(name, "whole robot")
        print(f"{name:<{width}}  {verdict:<8}  {where}  {problem}")
    if not outcome.delays:
        return 1 if any(rows.values()) else 0
    late, presses = percentile(outcome.delays, 0.99), len(outcome.delays)
    print(f"\n{outcome.made} attacks on the whole robot")
    print(f"STOP, {presses} presses: median {percentile(outcome.delays, 0.5):.3f} s, p99 {late:.3f} s")
    print(
        f"jitter of the control loop, p99: without {outcome.quiet_jitter:.4f} s, with {outcome.jitter:.4f} s"
    )
    worse = outcome.jitter - outcome.quiet_jitter
    return 1 if any(rows.values()) or late > STOP_MAX or worse > JITTER_MAX else 0


if __name__ == "__main__":
    sys.exit(main())
