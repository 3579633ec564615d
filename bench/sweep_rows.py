"""The same sweep from a shell, by HTTP and from Python, each with a data folder of its own: equal rows."""

import asyncio
import tempfile
import time
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import pandas

from mucat import Lab
from server.cli import main
from server.features.sweeps.runner import SweepRunner
from server.platform.settings import DataFolder, Settings, make_folders
from tests.server.features.doors.rig import make_token
from tests.server.serving import Served, serve

_TEXT = """
format = 1
name = "hover_gains"
scenario = "hover_in_a_current"
seeds = 3
[vary]
"control.gains.pid.kp" = { from = 1.0, to = 4.5, steps = 8 }
"control.gains.pid.kd" = { from = 0.5, to = 4.5, steps = 5 }
"""


def measure() -> dict[str, float]:
    """Compute 8 x 5 gains with 3 seeds three times, and count the rows that are equal to the bit."""
    with tempfile.TemporaryDirectory(prefix="mucat-") as name:
        folder = Path(name)
        began = time.monotonic()
        tables = [_by_shell(folder), asyncio.run(_by_http(folder)), asyncio.run(_by_python(folder))]
        seconds = time.monotonic() - began
    rows = [text.splitlines()[1:] for text in tables]
    return {
        "sweep_rows.equal": float(sum(len({*row}) == 1 for row in zip(*rows, strict=True))),
        "sweep_rows.seconds_each": seconds / len(tables),
    }


def _by_shell(folder: Path) -> str:
    document, table = folder / "sweep.toml", folder / "sweep.csv"
    document.write_text(_TEXT)
    (folder / "robot.toml").write_text("")
    where = ["--data", str(folder / "shell"), "--config", str(folder / "robot.toml")]
    with redirect_stdout(StringIO()):
        assert main(["scenario", "sweep", str(document), "--table", str(table), *where]) == 0
    return table.read_text()


async def _by_http(folder: Path) -> str:
    async with serve(_settings(folder, "http")) as served:
        await _require_none_stored(served)
        sweep = (await served.api.post("/sweeps", json={"text": _TEXT})).json()["sweep"]
        await served.get(SweepRunner).wait()
        return (await served.api.get(f"/sweeps/{sweep}/table")).text


async def _by_python(folder: Path) -> str:
    async with serve(_settings(folder, "python")) as served:
        await _require_none_stored(served)
        lab = Lab(f"http://127.0.0.1:{served.settings.server.port}", await make_token(served, name="bench"))
        frame: pandas.DataFrame = await asyncio.to_thread(lab.sweep, _TEXT)
    return str(frame.to_csv(index=False))


async def _require_none_stored(served: Served) -> None:
    """Each place computes all runs by itself."""
    assert (await served.api.post("/sweeps/check", json={"text": _TEXT})).json()["stored"] == 0


def _settings(folder: Path, name: str) -> Settings:
    data = DataFolder(folder / name)
    make_folders(data)
    return Settings(data=data, config=folder / "robot.toml")
