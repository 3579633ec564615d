"""The film of the whole simulated robot: what it costs, its pictures a second, its bytes, and its exports.

The jitter of the control loop and the processor time of each process are measured of a robot that records
without a film and of one that records with it, one after the other.
"""

import tempfile
import time
from pathlib import Path

from bench import jitter
from bench.real_robot import pids
from server.features.bench.process_figures import core_percent
from server.features.exports.formats import check
from server.features.exports.schemas import ExportOptions, Overlay
from server.features.exports.selection import ExportSelection
from server.features.film.config import FilmConfig
from server.library.content import Recording
from server.platform.settings import DataFolder
from server.platform.store import Reader
from server.recording.session import find_row
from tests.stack import ROOT, Stack

_SETTLE = 8.0
"""s: the first picture waits for the scene."""
_SECONDS = 30.0


def measure() -> dict[str, float]:
    """Measure half a minute without a film and half a minute with one."""
    return _record("film_off", FilmConfig(record=False)) | _record("film_on", FilmConfig(record=True))


def _record(name: str, config: FilmConfig) -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder)
        text = (ROOT / "robot.toml").read_text()
        (data / "robot.toml").write_text(
            text.replace("record = false", f"record = {str(config.record).lower()}")
        )
        with Stack(data, "--config", str(data / "robot.toml")) as stack:
            session = stack.api.post("/sessions", json={"name": "bench"}).raise_for_status().json()["id"]
            stack.arm()
            time.sleep(_SETTLE)
            processes = {part: stack.part(part) for part in ("runtime", "vision", "scene")}
            began = time.monotonic()
            cpu = core_percent(pids(processes | {"server": stack.server}), _SECONDS)
            stack.api.post("/robot/stop").raise_for_status()
            stack.api.post(f"/sessions/{session}/stop").raise_for_status()
        end = began + _SECONDS
        figures = {f"film.cpu.{part}_percent.{name}": value for part, value in cpu.items()}
        figures |= jitter.figures(data, session, {name: (began, end)})
        return figures | (_sizes(data, session, began, end) if config.record else {})


def _export_speeds(store: Reader, session: int) -> dict[str, float]:
    """Return the film's length over the time of its export, as it is and with the flight view's lines."""
    taken = [moment for moment, _ in Recording.open(store, session).film()]
    speeds = dict[str, float]()
    kinds: tuple[tuple[Overlay, str], ...] = (
        ("none", "film.export_speed"),
        ("lines", "film.export_speed_lines"),
    )
    for overlay, name in kinds:
        options = ExportOptions(format="mp4", overlay=overlay)
        source = ExportSelection(store, find_row(store, session), options)
        with tempfile.TemporaryFile() as file:
            began = time.monotonic()
            check(options).write_unpurged(store, source, file)
            speeds[name] = (taken[-1] - taken[0]) / (time.monotonic() - began)
    return speeds


def _sizes(data: Path, session: int, start: float, end: float) -> dict[str, float]:
    store = Reader(DataFolder(data).database)
    sizes = [len(picture) for _, picture in Recording.open(store, session).film(start, end)]
    speeds = _export_speeds(store, session)
    store.close()
    return speeds | {
        "film.picture_hz": len(sizes) / _SECONDS,
        "film.mb_a_minute": sum(sizes) / 1e6 / _SECONDS * 60,
    }
