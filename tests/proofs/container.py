"""A computer with systemd: a container whose power can be cut. Needs root and systemd-nspawn."""

import os
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Self

import psutil

from tests.proofs.roots import FOLDER, PYTHON, SMALL, RootSystem

SYSTEMD = ("systemd", "systemd-sysv", "dbus", "openssl", "procps", "avrdude")
SYSTEMS = (
    RootSystem("amd64-bookworm-services", "amd64", "bookworm", "As services", (*PYTHON, *SYSTEMD)),
    RootSystem("i386-trixie-services", "i386", "trixie", "As services", (*SMALL, *SYSTEMD)),
    RootSystem(
        "arm64-bookworm-services",
        "arm64",
        "bookworm",
        "As services",
        (*PYTHON, *SYSTEMD),
        "qemu-aarch64",
        "cortex-a53",
    ),
)
"""The second stands for a robot with 32 bits; the third is one on an emulated processor."""
START_SECONDS = 60.0
EMULATED = 10.0
"""Factor of the times to wait on an emulated processor."""
CARD_BYTES = 200_000_000
ORDER_SECONDS = 300.0
GROUP = Path("/sys/fs/cgroup/memory/mucat-proof")
DISK_GROUP = Path("/sys/fs/cgroup/blkio/mucat-proof")
"""The control groups (version 1) that limit its memory, and the speed of its card."""
_POLL = 0.2


class SystemdContainer:
    """A copy of the system, with a folder of this computer at /releases and an empty small card at /card.

    It has a network of its own; `options` are systemd-nspawn's.
    """

    def __init__(self, system: RootSystem, releases: Path, *options: str) -> None:
        system.make()
        self.system = system
        self.root = FOLDER / "services"
        self.patience = EMULATED if system.is_emulated else 1.0
        """Factor of all times to wait: an emulated processor is slower."""
        personality = "x86" if system.is_small else "x86-64"
        own = () if system.is_emulated else (f"--personality={personality}",)
        self._options = (*own, f"--bind-ro={releases}:/releases", *options)
        self._nspawn: subprocess.Popen[bytes] | None = None
        self._kills = 0

    def __enter__(self) -> Self:
        subprocess.run(["rm", "-rf", "--one-file-system", str(self.root)], check=True)
        subprocess.run(["cp", "-a", str(self.system.path), str(self.root)], check=True)
        image = self.root.with_name("card.img")
        with image.open("wb") as file:
            file.truncate(CARD_BYTES)
        subprocess.run(["mkfs.ext4", "-q", "-F", "-m", "0", str(image)], check=True)
        self._card.mkdir()
        subprocess.run(["mount", "-o", "loop,errors=remount-ro", str(image), str(self._card)], check=True)
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.cut_power()
        subprocess.run(["umount", str(self._card)], check=True)
        shutil.rmtree(self.root)

    @property
    def _card(self) -> Path:
        return self.root / "card"

    @contextmanager
    def slow_card(self, speed: int) -> Iterator[None]:
        """The card at /card takes so many bytes/s meanwhile."""
        number = self._card.stat().st_dev
        device, file = (
            f"{os.major(number)}:{os.minor(number)}",
            DISK_GROUP / "blkio.throttle.write_bps_device",
        )
        file.write_text(f"{device} {speed}")
        try:
            yield
        finally:
            file.write_text(f"{device} 0")

    def wear_card_out(self) -> None:
        """Make the card at /card read-only, as the kernel does where a write to it fails."""
        subprocess.run(["mount", "-o", "remount,abort", str(self._card)], check=True)

    def start(self) -> None:
        """Power on, until its services have been started."""
        command = ["systemd-nspawn", "--quiet", "--directory", str(self.root), "--boot", "--register=no"]
        command += ["--keep-unit", "--private-network", *self._options]
        log = self.root.with_name("services.log").open("wb")
        for group in (GROUP, DISK_GROUP):
            group.mkdir(exist_ok=True)
        self._kills = 0
        self._kills = self.kills()
        # The groups first, the container in them then.
        join = f"echo $$ | tee {GROUP}/cgroup.procs {DISK_GROUP}/cgroup.procs >/dev/null"
        enter = ["sh", "-c", f'{join}; exec "$@"', "sh"]
        self._nspawn = subprocess.Popen([*enter, *command], stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        end = time.monotonic() + START_SECONDS * self.patience
        while self.order("systemctl is-system-running")[1].strip() not in ("running", "degraded"):
            assert time.monotonic() < end, "systemd does not come up"
            time.sleep(_POLL)

    def cut_power(self) -> None:
        """End every process in it at once."""
        assert self._nspawn is not None
        for process in self._init():
            process.kill()
        self._nspawn.kill()
        self._nspawn.wait()
        self._nspawn = None

    def processes(self) -> list[psutil.Process]:
        """Return all processes in it."""
        return [process for init in self._init() for process in init.children(recursive=True)]

    @contextmanager
    def limited_memory(self, limit: int) -> Iterator[None]:
        """All of it together has so many bytes meanwhile, and no swap."""
        (GROUP / "memory.limit_in_bytes").write_text(str(limit))
        try:
            yield
        finally:
            (GROUP / "memory.limit_in_bytes").write_text("-1")

    def kills(self) -> int:
        """Return the processes that were ended for want of memory since the power came."""
        parts = (GROUP / "memory.oom_control").read_text().split()
        return int(parts[parts.index("oom_kill") + 1]) - self._kills

    def order(self, message: str) -> tuple[int, str]:
        """Run a line of shell in it; its status, and what it printed."""
        result = self._init()
        if not result:
            return 1, ""
        # As a unit of its own: it ends with the power, as everything does.
        inside = ["systemd-run", "--quiet", "--pipe", "--wait", "--collect", "--setenv=HOME=/root"]
        enter = ["nsenter", "--target", str(result[0].pid), "--mount", "--uts", "--ipc", "--net", "--pid"]
        path = "PATH=/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
        done = subprocess.run(
            [*enter, "env", "--ignore-environment", path, *inside, f"--setenv={path}", "sh", "-c", message],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=ORDER_SECONDS * self.patience,
            check=False,
        )
        return done.returncode, done.stdout + done.stderr

    def _init(self) -> list[psutil.Process]:
        assert self._nspawn is not None
        below = psutil.Process(self._nspawn.pid).children() if self._nspawn.poll() is None else []
        return [process for process in below if process.name() == "systemd"]
