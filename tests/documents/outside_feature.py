"""Uses the feature of the page "add a feature" on a whole server; run where its package is installed.

`python -m tests.documents.outside_feature DATA`
"""

import asyncio
import subprocess
import sys
from pathlib import Path

from server.platform.running_server import announce
from server.platform.settings import make_folders, read_settings
from tests.server.blocks import debug_block
from tests.server.serving import Served, serve
from tests.waiting import SECONDS


async def use(served: Served) -> None:
    """Say two lines, one of them below the level, and ask for the count in both ways."""
    announce(served.settings)
    served.runtime.publish(debug_block(0, "one", "two"))

    async def counted() -> bool:
        return bool((await served.api.get("/lines")).json() == {"count": 2})

    async with asyncio.timeout(SECONDS):
        while not await counted():
            await asyncio.sleep(0.01)
    data = served.settings.data.path
    command = [sys.executable, "-m", "server.cli", "lines", "--data", str(data)]
    done = await asyncio.to_thread(subprocess.run, command, capture_output=True, text=True, check=False)
    assert done.stdout == "2\n", done.stderr


async def main(data: Path) -> None:
    """Serve with the section of the feature."""
    data.mkdir()
    config = data / "lines.toml"
    config.write_text('[robot]\nname = "tested"\n[lines]\nlevel = 1\n', encoding="utf-8")
    settings = read_settings(config, data, None, None, {})
    make_folders(settings.data)
    async with serve(settings) as served:
        await use(served)


if __name__ == "__main__":
    asyncio.run(main(Path(sys.argv[1])))
