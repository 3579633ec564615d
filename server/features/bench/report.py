"""The bench's report: Markdown, to be pasted where somebody asks how fast a computer is."""

import os
import platform
import sys
from pathlib import Path
from typing import Any

from server import VERSION
from server.features.bench.measurement import LoadFigures, StartFigures
from server.features.bench.robot_processes import OUTSIDE
from server.platform.word_size import BITS

MODEL = Path("/proc/device-tree/model")


def write_report(start: StartFigures, dive: LoadFigures, state: dict[str, Any]) -> str:
    """Return the report; `state` is the robot's."""
    p50, p99, most = dive.jitter_ms
    rows = [
        ("start: a server's page is there after", f"{start.page_s:.1f} s, {start.cpu_s:.1f} s of processor"),
        *(
            (f"{name}{', not of a robot' if name in OUTSIDE else ''}", _cost(value, dive.mb[name]))
            for name, value in sorted(dive.percent.items(), key=lambda entry: entry[0] in OUTSIDE)
        ),
        ("**the robot's software**", f"**{_cost(dive.robot_percent, dive.robot_mb)}**"),
        ("control: time between ticks", f"{dive.period_ms:.1f} ms, of {dive.ticks} ticks"),
        ("control: off by", f"{p50:.2f} ms (p50), {p99:.2f} ms (p99), {most:.1f} ms (most)"),
        ("recording", f"{dive.samples} samples, {dive.samples_lost} lost"),
        ("viewer", f"{dive.viewer_kb_per_s:.0f} kB/s, {dive.viewer_left_out} times samples left out"),
        ("alarms", "; ".join(dive.alarms) or "none"),
    ]
    return "\n".join(
        [
            f"µ-CAT {VERSION} on {_describe_computer()}; {_describe_robot(state)}; recording for "
            f"{dive.seconds:.0f} s with one viewer. % of one core, MB that cannot be dropped.",
            "",
            "| figure | value |",
            "| --- | --- |",
            *(f"| {name} | {value} |" for name, value in rows),
        ]
    )


def _cost(percent: float, mb: float) -> str:
    return f"{percent:.1f} %, {mb:.0f} MB"


def _describe_computer() -> str:
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 1e6
    model = MODEL.read_text().strip("\0\n ") if MODEL.exists() else platform.machine()
    system = platform.freedesktop_os_release().get("PRETTY_NAME", platform.system())
    python = ".".join(map(str, sys.version_info[:3]))
    return f"{model} ({os.cpu_count()} processors, {memory:.0f} MB, {BITS} bits), {system}, Python {python}"


def _describe_robot(state: dict[str, Any]) -> str:
    link = f"{state['baud']} baud" if state["connected"] else "no board"
    armed = "armed" if state["armed"] else "disarmed"
    return f"profile {state['profile']}, {link}, {armed}, vision at {state['vision_rate']:g} Hz"
