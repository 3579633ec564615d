"""A lab's router with six robots: its processor time and memory, and how soon STOP is answered."""

import tempfile
import time
from contextlib import ExitStack
from pathlib import Path
from statistics import median

import psutil

from robot_runtime.errors import NoAnswerError
from server.features.roster.fleet_session import FleetSession
from server.interchange.presence import Presence
from server.platform.settings import DataFolder, Settings, make_folders
from tests.server.features.roster.lab_router import LabRouter, RobotEnd
from tests.stack import free_port

_ROBOTS = 6
_SECONDS = 20.0
_STOPS = 20
_READY_SECONDS = 30.0
_ANSWER_SECONDS = 2.0


def measure() -> dict[str, float]:
    """Return figures of six robots, each of which says once a second how it is, over TLS on the loopback."""
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        path = Path(folder)
        data = DataFolder(path / "lab")
        make_folders(data)
        settings = Settings(data=data, config=path / "robot.toml")
        names = [f"turtle-{number}" for number in range(_ROBOTS)]
        router = LabRouter(settings, path, free_port(), *names)
        process = psutil.Process(stack.enter_context(router.running()).pid)
        lab = stack.enter_context(router.lab())
        robots = [stack.enter_context(router.robot(name)) for name in names]
        _await(lab, names)
        share = _speak(process, robots)
        heard = len(router.presences)
        answers = [_stop(lab, name) for _ in range(_STOPS) for name in names]
        memory = process.memory_full_info().uss
    return {
        "router.cpu_percent": share * 100,
        "router.memory_mb": memory / 1e6,
        "router.presences_heard": heard / (_ROBOTS * _SECONDS),
        "router.stop_ms_median": 1000 * median(answers),
        "router.stop_ms_max": 1000 * max(answers),
    }


def _await(lab: FleetSession, names: list[str]) -> None:
    end = time.monotonic() + _READY_SECONDS
    waiting = set(names)
    while waiting:
        for name in list(waiting):
            try:
                lab.stop(name, 0.5)
                waiting.discard(name)
            except NoAnswerError:
                if time.monotonic() > end:
                    raise


def _speak(process: psutil.Process, robots: list[RobotEnd]) -> float:
    """Have the robots speak; return the share of a core that the router takes."""
    text = _presence()
    began, before = time.monotonic(), sum(process.cpu_times()[:2])
    for second in range(int(_SECONDS)):
        for robot in robots:
            robot.say(text)
        time.sleep(max(0.0, began + second + 1 - time.monotonic()))
    return (sum(process.cpu_times()[:2]) - before) / (time.monotonic() - began)


def _stop(lab: FleetSession, name: str) -> float:
    began = time.monotonic()
    lab.stop(name, _ANSWER_SECONDS)
    return time.monotonic() - began


def _presence() -> str:
    return Presence(
        mode="automatic",
        armed=True,
        connected=True,
        depth=1.234,
        battery=7.42,
        battery_left=1800.0,
        mission=None,
        recording="2026-11-24 12:00",
        disk_free=20_000_000_000,
        disk_total=32_000_000_000,
        alarms=[],
        software="0.0",
        address="https://turtle-1.local:8000",
        fingerprint="AB:" * 31 + "AB",
    ).model_dump_json()
