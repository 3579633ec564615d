"""Runs notebooks against a server of their own, whose robot is simulated in simulated time."""

import asyncio
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path

from server.platform.settings import DataFolder, Settings, make_folders
from tests.notebooks.runner import RunCell, run
from tests.server.features.doors.rig import make_token
from tests.server.serving import serve


def perform(names: Sequence[str]) -> dict[str, list[RunCell]]:
    """Return the cells of these notebooks after their run, by name."""
    with tempfile.TemporaryDirectory(prefix="mucat-") as name:
        folder = DataFolder(Path(name) / "data")
        make_folders(folder)
        config = Path(name) / "robot.toml"
        config.write_text('[robot]\nname = "turtle"\n', encoding="utf-8")
        return asyncio.run(_perform(Settings(data=folder, config=config), names))


async def _perform(settings: Settings, names: Sequence[str]) -> dict[str, list[RunCell]]:
    async with serve(settings) as served:
        os.environ["MUCAT_URL"] = f"http://127.0.0.1:{served.settings.server.port}"
        os.environ["MUCAT_TOKEN"] = await make_token(served, name="notebook")
        try:
            return {name: await asyncio.to_thread(run, name) for name in names}
        finally:
            del os.environ["MUCAT_URL"], os.environ["MUCAT_TOKEN"]
