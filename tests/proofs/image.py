"""`python -m tests.proofs.image`: builds the container image and starts its robot and its lab.

It arms the robot and fetches the page; the lab has its archive in a PostgreSQL of this computer. Needs root.
Prints the image's size and the seconds to the page and to a health of ok; fails with the reason.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Self

import httpx

from packages.image import NUMBER, build_image
from packages.wheels import DIST
from server.platform.settings import DataFolder
from tests.control import Commander
from tests.server.postgres import new_archive, postgres
from tests.shell import ShellAuth
from tests.stack import free_port

PATIENCE = 120.0
LOG_CHARACTERS = 2000


def main() -> int:
    """Exit status."""
    with tempfile.TemporaryDirectory(prefix="mucat-image-") as name:
        folder = Path(name)
        # The image's user passes through.
        folder.chmod(0o711)
        image = build_image(folder / "key.pem", DIST)
        print(f"{image.name}: {image.stat().st_size / 1e6:.0f} MB", flush=True)
        container = buildah("from", f"oci-archive:{image}")
        try:
            swim(container, folder)
            archive(container, folder)
        finally:
            buildah("rm", container)
    return 0


def swim(container: str, folder: Path) -> None:
    """Start the robot, and arm it."""
    with StartedImage(container, folder / "robot", "mucat", "run") as robot:
        robot.wait(lambda: "<title>" in httpx.get(robot.url).text, "the page")
        robot.wait(lambda: robot.api.get("/health").json()["status"] == "ok", "a health of ok")
        robot.wait(
            lambda: robot.api.post("/robot/commands/arm", json={"unwatched": 0}).status_code == 204,
            "an armed robot",
        )
        robot.api.post("/robot/stop").raise_for_status()
        assert (robot.data / "mucat.db").stat().st_uid == NUMBER, "it does not run as its own user"


def archive(container: str, folder: Path) -> None:
    """Start the lab, with its archive in a PostgreSQL of this computer."""
    server = postgres()
    server.folder.chmod(0o755)
    lab = StartedImage(
        container, folder / "lab", "mucat", "lab", "run", volume=f"{server.folder}:{server.folder}"
    )
    lab.config.write_text(f'[lab]\ndatabase = "{new_archive()}"\n')
    with lab:
        lab.wait(lambda: "<title>" in httpx.get(lab.url).text, "the lab's page")
        lab.wait(lambda: lab.api.get("/health").json()["status"] == "ok", "the lab's health of ok")
        findings = {finding["name"]: finding for finding in lab.api.post("/doctor").json()}
        wrong = [finding for finding in findings.values() if finding["verdict"] == "wrong"]
        assert not wrong, wrong
        print(f"its archive: {findings['archive']['text']}", flush=True)
        assert not (lab.data / "mucat.db").exists(), "its archive is a file"


class StartedImage:
    """A server of the image, started as an engine does, with a folder of this computer for the data."""

    def __init__(self, container: str, folder: Path, *program: str, volume: str = "") -> None:
        folder.mkdir(mode=0o711)
        self.data = folder / "data"
        self.data.mkdir(mode=0o700)
        self.config = self.data / "robot.toml"
        self._log = folder / "log"
        port = free_port()
        self.url = f"http://127.0.0.1:{port}"
        volumes = [f"{self.data}:/data", *([volume] if volume else [])]
        self._command = ["buildah", "run", "--isolation", "chroot", "--network", "host"]
        self._command += [word for mount in volumes for word in ("--volume", mount)]
        self._command += [container, "--", *program, "--host", "127.0.0.1", "--port", str(port)]

    def __enter__(self) -> Self:
        for path in (self.data, *self.data.iterdir()):
            os.chown(path, NUMBER, NUMBER)
        with self._log.open("wb") as file:
            self._process = subprocess.Popen(
                self._command, stdin=subprocess.DEVNULL, stdout=file, stderr=file
            )
        self._began = time.monotonic()
        self.api = Commander(base_url=f"{self.url}/api", timeout=30.0, auth=ShellAuth(DataFolder(self.data)))
        return self

    def __exit__(self, *_: object) -> None:
        self.api.close()
        self._process.terminate()
        self._process.wait(60)

    def wait(self, condition: Callable[[], bool], what: str) -> None:
        """Wait for a condition, and print how long that took."""
        while True:
            try:
                if condition():
                    print(f"{what} after {time.monotonic() - self._began:.1f} s", flush=True)
                    return
            except (httpx.TransportError, OSError):
                pass
            output = self._log.read_text(errors="replace")[-LOG_CHARACTERS:]
            assert self._process.poll() is None, f"it ended: {output}"
            assert time.monotonic() - self._began < PATIENCE, f"no {what}: {output}"
            time.sleep(0.1)


def buildah(*arguments: str) -> str:
    """Run buildah; return what it printed."""
    done = subprocess.run(["buildah", *arguments], check=True, stdout=subprocess.PIPE, text=True)
    return done.stdout.strip()


if __name__ == "__main__":
    sys.exit(main())
