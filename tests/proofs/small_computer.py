"""A small computer's life, on an installed robot: a damaged configuration, a full card, a read-only
one, too little memory.
"""

import time
from pathlib import Path

import psutil

from tests.proofs.container import SystemdContainer
from tests.proofs.steps import Steps, ask_server

DATA = "/var/lib/mucat"
SLOW_BYTES = 100_000
"""bytes/s of a worn-out card."""
SLOW_SECONDS = 30.0
CONFIG = "/etc/mucat/robot.toml"
SERVICES = "mucat-runtime mucat"
MEMORY_BYTES = 600 * 10**6
"""Memory of the whole computer while it lacks some; the robot with its emulated board needs some 350 MB."""
EATER = "ate = []\nimport time\nwhile True: ate.append(bytearray(b'x') * 4_000_000); time.sleep(0.02)"
EATER_SECONDS = 60.0
SERVER_ADJUSTMENT, RUNTIME_ADJUSTMENT = 500, -900
"""OOMScoreAdjust of the two services."""
HEALTH = """
print(next(one["text"] for one in ask(data, "GET", "/health")["parts"] if one["name"] == "database"))
"""
FINDINGS = """
print(*(one["text"] for one in ask(data, "GET", "/doctor") if one["verdict"] != "ok"))
"""
GAPS = """
session = next(one["id"] for one in ask(data, "GET", "/sessions") if one["name"] == "{name}")
print(len(ask(data, "GET", f"/sessions/{{session}}")["gaps"]), "gaps")
"""
RECORDING = """
print(*(one["samples"] > 0 for one in ask(data, "GET", "/sessions") if one["name"] == "{name}"))
"""


def live(container: SystemdContainer, steps: Steps, version: str) -> None:
    """Take this installation through all of it."""
    damage_configuration(steps, version)
    fill_card(container, steps, version)
    starve(container, steps, version)


def damage_configuration(steps: Steps, version: str) -> None:
    """Files as a power cut leaves them: empty, of zeros, cut off in a line."""
    for name, damage in (
        ("empty", f"truncate -s 0 {CONFIG}"),
        ("of zeros", f"head -c 900 /dev/zero > {CONFIG}"),
        ("cut off", f"head -c 700 {DATA}/robot.toml.last > {CONFIG}"),
    ):
        steps.take(f"a configuration that is {name}", f"{damage}; systemctl restart {SERVICES}", "")
        steps.runs(version)
        steps.take("the page says so", ask_server(FINDINGS), "the last configuration .* is in force")
        steps.take("the doctor says so", "mucat doctor", "wrong +Configuration: .*robot.toml", status=1)
    good = f"cat {DATA}/robot.toml.last > {CONFIG}; systemctl restart {SERVICES}"
    steps.take("it is written again", good, "")
    steps.runs(version)
    steps.take("all is well", f"mucat doctor | grep Configuration: ; {ask_server(FINDINGS)}", "^ok +Config")


def fill_card(container: SystemdContainer, steps: Steps, version: str) -> None:
    """The data lie on a small card, which is full while it records, and then worn out."""
    copy = f"systemctl stop {SERVICES}; cp -a {DATA}/. /card; chown mucat: /card; chmod 700 /card"
    card = f"mount --bind /card {DATA}; systemctl start {SERVICES}"
    steps.take("a small card", f"{copy}; {card}", "")
    steps.runs(version)
    with container.slow_card(SLOW_BYTES):
        steps.take("record on a slow card", "mucat record start slow", "has begun")
        time.sleep(SLOW_SECONDS)
        steps.take("end the recording", "mucat record stop", "has ended")
    steps.take("nothing is missing", ask_server(GAPS.format(name="slow")), "^0 gaps")
    steps.take("record", "mucat record start full", "has begun")
    runtime = runtime_of(container)
    steps.take("fill the card", f"cat /dev/zero > {DATA}/fill 2>/dev/null; true", "")
    steps.wait("the page says so", lambda: "full" in container.order(ask_server(HEALTH))[1])
    steps.take("make room", f"rm {DATA}/fill", "")
    steps.runs(version)
    steps.wait("it records", lambda: "True" in container.order(ask_server(RECORDING.format(name="full")))[1])
    container.wear_card_out()
    steps.wait("the page says so", lambda: "Nothing can be stored" in container.order(ask_server(HEALTH))[1])
    steps.take("the doctor says so", "mucat doctor", "read-only: the card may be worn out", status=1)
    start = "systemctl kill -s KILL mucat; sleep 8; journalctl --since=-8s -u mucat --output=cat"
    steps.take("a server that starts on it", start, "mucat: .*[Rr]ead-only")
    steps.check("the runtime goes on", runtime_of(container) == runtime)
    another = f"systemctl stop {SERVICES}; umount {DATA}; systemctl start {SERVICES}"
    steps.take("another card", another, "")
    steps.runs(version)


def starve(container: SystemdContainer, steps: Steps, version: str) -> None:
    """A program eats the memory: of µ-CAT the server is ended for it, and never the runtime."""
    runtime = runtime_of(container)
    watched = {process.pid: (process, adjustment(process)) for process in container.processes()}
    gone: list[int] = []
    with container.limited_memory(MEMORY_BYTES):
        container.order(f'systemd-run --unit=eater --collect python3 -c "{EATER}"')
        end = time.monotonic() + EATER_SECONDS
        while time.monotonic() < end:
            for item in container.processes():
                watched.setdefault(item.pid, (item, adjustment(item)))
            for number, (item, adjusted) in list(watched.items()):
                if not item.is_running() or item.status() == psutil.STATUS_ZOMBIE:
                    gone.append(adjusted)
                    del watched[number]
            if container.kills() and gone and gone[-1] == 0:
                break
            time.sleep(0.02)
        kills = container.kills()
        container.order("systemctl stop eater")
    print(f"     {kills} processes were ended for memory, by their adjustment: {gone}")
    steps.check("of µ-CAT the server was ended first", bool(gone) and gone[0] == SERVER_ADJUSTMENT)
    steps.check("the runtime was not", RUNTIME_ADJUSTMENT not in gone and runtime_of(container) == runtime)
    steps.runs(version)


def adjustment(process: psutil.Process) -> int:
    """Return what is added to the chance that it is ended for memory; 0 for one that has just ended."""
    try:
        return int(Path(f"/proc/{process.pid}/oom_score_adj").read_text())
    except OSError:
        return 0


def runtime_of(container: SystemdContainer) -> str:
    """Return the number of the runtime's process."""
    return container.order("systemctl show --property MainPID --value mucat-runtime")[1].strip()
