"""`python -m tests.proofs.image`: builds the container image, starts it, arms its robot and fetches the page.

Needs root. Prints the image's size and the seconds to the page and to a health of ok; fails with the reason.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import httpx

from packages.image import NUMBER, build_image
from packages.wheels import DIST
from server.platform.settings import DataFolder
from tests.control import Commander
from tests.shell import ShellAuth
from tests.stack import free_port

PATIENCE = 120.0
LOG_CHARACTERS = 2000


def main() -> int:
    """Exit status."""
    with tempfile.TemporaryDirectory(prefix="mucat-image-") as name:
        folder = Path(name)
        image = build_image(folder / "key.pem", DIST)
        print(f"{image.name}: {image.stat().st_size / 1e6:.0f} MB", flush=True)
        container = buildah("from", f"oci-archive:{image}")
        try:
            swim(container, folder)
        finally:
            buildah("rm", container)
    return 0


def swim(container: str, folder: Path) -> None:
    """Start it as an engine does, with a folder of this computer for the data."""
    data = folder / "data"
    data.mkdir(mode=0o700)
    # The folders above let the image's user through.
    folder.chmod(0o711)
    os.chown(data, NUMBER, NUMBER)
    port = free_port()
    command = ["buildah", "run", "--isolation", "chroot", "--network", "host", "--volume", f"{data}:/data"]
    command += [container, "--", "mucat", "run", "--host", "127.0.0.1", "--port", str(port)]
    log = folder / "log"
    with log.open("wb") as file:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file, stderr=file)
    began = time.monotonic()

    def wait(condition: Callable[[], bool], what: str) -> None:
        while True:
            try:
                if condition():
                    print(f"{what} after {time.monotonic() - began:.1f} s", flush=True)
                    return
            except (httpx.TransportError, OSError):
                pass
            output = log.read_text(errors="replace")[-LOG_CHARACTERS:]
            assert process.poll() is None, f"it ended: {output}"
            assert time.monotonic() - began < PATIENCE, f"no {what}: {output}"
            time.sleep(0.1)

    url = f"http://127.0.0.1:{port}"
    api = Commander(base_url=f"{url}/api", timeout=30.0, auth=ShellAuth(DataFolder(data)))
    try:
        wait(lambda: "<title>" in httpx.get(url).text, "the page")
        wait(lambda: api.get("/health").json()["status"] == "ok", "a health of ok")
        wait(
            lambda: api.post("/robot/commands/arm", json={"unwatched": 0}).status_code == 204,
            "an armed robot",
        )
        api.post("/robot/stop").raise_for_status()
        assert (data / "mucat.db").stat().st_uid == NUMBER, "it does not run as its own user"
    finally:
        api.close()
        process.terminate()
        process.wait(60)


def buildah(*arguments: str) -> str:
    """Run buildah; return what it printed."""
    done = subprocess.run(["buildah", *arguments], check=True, stdout=subprocess.PIPE, text=True)
    return done.stdout.strip()


if __name__ == "__main__":
    sys.exit(main())
