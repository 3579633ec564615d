"""Every attack of the security review on a whole robot, while an operator presses STOP.

`python -m tests.proofs.attacks` prints which rows held, the delays of STOP, and the control loop's jitter
with and without attacks; status 1 where a row did not hold, or STOP came late. What needs no running robot,
or another one, are tests: the table names them, and they are run first.
"""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from robot_runtime.transport.blocks import read_blocks, read_rows
from tests.stack import ROOT, Stack

PRESSES = 100
PERIOD = 0.25
"""s between two presses."""
STOP_MAX = 0.5
"""s of the slowest but one of a hundred presses."""
JITTER_MAX = 0.02
"""s by which attacks may lengthen the loop's 99th percentile."""
QUIET_SECONDS = 10.0
TESTS = {
    "half-sent requests over a revocation": "tests/server/sign_in/test_revoked_requests.py",
    "pairing, sessions, cookies, sign-out": "tests/server/sign_in/test_access.py",
    "secrets and codes": "tests/server/sign_in/test_codes.py",
    "security headers, stored scripts": "tests/server/http/test_security.py",
    "zip-slip, packed, checksums, cut": "tests/server/features/exports/test_imports.py",
    "malformed archives": "tests/server/features/exports/test_malformed_archives.py",
    "stored bombs": "tests/server/features/sessions/test_replay.py",
    "sessions of other versions": "tests/server/test_released_sessions.py",
    "formulas and exports": "tests/server/features/exports/test_tables.py",
    "panels and layouts": "tests/server/features/panels",
    "TLS": "tests/server/sign_in/test_tls.py",
    "a full disk": "tests/server/features/sessions/test_full_disk.py",
}


def percentile(values: Sequence[float], share: float) -> float:
    """The value that this share does not exceed; infinite without values."""
    ordered = sorted(values)
    return ordered[min(int(share * len(ordered)), len(ordered) - 1)] if ordered else float("inf")


def press(stack: Stack, count: int) -> list[float]:
    """The delays of so many STOPs, s."""
    delays = []
    for _ in range(count):
        began = time.monotonic()
        answer = stack.api.post("/robot/stop", timeout=60)
        delays.append(time.monotonic() - began)
        assert answer.status_code < 300, answer.text
        time.sleep(max(0.0, PERIOD - delays[-1]))
    return delays


def read_jitter(stack: Stack, start: float, end: float) -> float:
    """The 99th percentile of the control loop's deviation from its median period, s."""
    answer = stack.api.get("/past", params={"topic": "control", "until": end}, timeout=60).raise_for_status()
    times = [moment for block in read_blocks(answer.content) for moment, _ in read_rows(block)]
    periods = [later - earlier for earlier, later in pairwise(times) if start <= earlier <= end]
    usual = percentile(periods, 0.5)
    return percentile([abs(period - usual) for period in periods], 0.99)


def make_token(stack: Stack, scope: str) -> str:
    """A token of a new program."""
    made = stack.api.post(
        "/access/tokens", json={"name": f"attacker {scope}", "scope": scope}
    ).raise_for_status()
    token: str = made.json()["token"]
    return token


def record(stack: Stack) -> None:
    """A session that viewers read."""
    session = stack.api.post("/sessions", json={"name": "attacked"}).raise_for_status().json()["id"]
    time.sleep(QUIET_SECONDS)
    stack.api.post(f"/sessions/{session}/stop").raise_for_status()


def attack(stack: Stack) -> tuple[dict[str, str], list[float], dict[str, float]]:
    """The problems by attack, the delays of STOP, and the jitter without and with attacks."""
    record(stack)
    began = time.monotonic()
    press(stack, int(QUIET_SECONDS / PERIOD))
    quiet = read_jitter(stack, began, time.monotonic())
    tokens = [make_token(stack, scope) for scope in ("read", "administer")]
    command = [sys.executable, "-m", "tests.proofs.attackers", stack.url, *tokens, str(PRESSES * PERIOD)]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as attackers:
        began = time.monotonic()
        delays = press(stack, PRESSES)
        jitter = {"without": quiet, "with": read_jitter(stack, began, time.monotonic())}
        output, _ = attackers.communicate()
    problems: dict[str, str] = json.loads(output)
    return problems, delays, jitter


def test(path: str) -> str:
    """The last line of a row's tests where one fails; else empty."""
    command = [sys.executable, "-m", "pytest", "-q", "-m", "not stack", "-p", "no:cacheprovider", path]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    return "" if done.returncode == 0 else done.stdout.strip().splitlines()[-1]


def main() -> int:
    """Exit status: 1 where a row did not hold or STOP was late."""
    rows = {} if "--live" in sys.argv else {name: test(path) for name, path in TESTS.items()}
    with tempfile.TemporaryDirectory(prefix="mucat-") as folder, Stack(Path(folder) / "data") as stack:
        problems, delays, jitter = attack(stack)
    rows |= problems
    width = max(map(len, rows))
    for name, problem in rows.items():
        print(f"{name:<{width}}  {problem or 'held'}")
    late = percentile(delays, 0.99)
    print(f"\nSTOP, {len(delays)} presses: median {percentile(delays, 0.5):.3f} s, p99 {late:.3f} s")
    print(f"jitter of the control loop, p99: without {jitter['without']:.4f} s, with {jitter['with']:.4f} s")
    worse = jitter["with"] - jitter["without"]
    return 1 if any(rows.values()) or late > STOP_MAX or worse > JITTER_MAX else 0


if __name__ == "__main__":
    sys.exit(main())
