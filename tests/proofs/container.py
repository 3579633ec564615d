"""A computer with systemd: a container whose power can be cut. Needs root and systemd-nspawn."""

import shutil
import subprocess
import time
from pathlib import Path
from typing import Self

import psutil

from tests.proofs.roots import FOLDER, PYTHON, RootSystem

SYSTEM = RootSystem(
    "amd64-bookworm-systemd",
    "amd64",
    "bookworm",
    "As services",
    (*PYTHON, "systemd", "systemd-sysv", "dbus", "openssl", "procps"),
)
START_SECONDS = 60.0
ORDER_SECONDS = 300.0
_POLL = 0.2


class Container:
    """A copy of the system, with a folder of this computer at /releases; it has a network of its own."""

    def __init__(self, releases: Path) -> None:
        SYSTEM.make()
        self.root = FOLDER / "services"
        self._releases = releases
        self._nspawn: subprocess.Popen[bytes] | None = None

    def __enter__(self) -> Self:
        subprocess.run(["rm", "-rf", "--one-file-system", str(self.root)], check=True)
        subprocess.run(["cp", "-a", str(SYSTEM.path), str(self.root)], check=True)
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.cut_power()
        shutil.rmtree(self.root)

    def start(self) -> None:
        """Power on, until its services have been started."""
        command = ["systemd-nspawn", "--quiet", "--directory", str(self.root), "--boot", "--register=no"]
        command += ["--keep-unit", "--private-network", f"--bind-ro={self._releases}:/releases"]
        log = self.root.with_name("services.log").open("wb")
        self._nspawn = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        end = time.monotonic() + START_SECONDS
        while self.order("systemctl is-system-running")[1].strip() not in ("running", "degraded"):
            assert time.monotonic() < end, "systemd does not come up"
            time.sleep(_POLL)

    def cut_power(self) -> None:
        """End every process in it at once."""
        assert self._nspawn is not None
        for one in self._init():
            one.kill()
        self._nspawn.kill()
        self._nspawn.wait()
        self._nspawn = None

    def order(self, words: str, seconds: float = ORDER_SECONDS) -> tuple[int, str]:
        """Run a line of shell in it; its status, and what it printed."""
        found = self._init()
        if not found:
            return 1, ""
        # As a unit of its own: it ends with the power, as everything does.
        inside = ["systemd-run", "--quiet", "--pipe", "--wait", "--collect", "--setenv=HOME=/root"]
        enter = ["nsenter", "--target", str(found[0].pid), "--mount", "--uts", "--ipc", "--net", "--pid"]
        path = "PATH=/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
        done = subprocess.run(
            [*enter, "env", "--ignore-environment", path, *inside, f"--setenv={path}", "sh", "-c", words],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=seconds,
            check=False,
        )
        return done.returncode, done.stdout + done.stderr

    def _init(self) -> list[psutil.Process]:
        assert self._nspawn is not None
        below = psutil.Process(self._nspawn.pid).children() if self._nspawn.poll() is None else []
        return [one for one in below if one.name() == "systemd"]
