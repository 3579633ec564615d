"""Fresh root file systems of Debian, made by mmdebstrap and kept in build/roots.

What runs in one has this computer's network and devices, and of its files only the wheels. Needs root.
"""

import os
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from packages.mirror import find_mirror
from robot_runtime.config import LinkConfig

FOLDER = Path("build/roots").absolute()
DIST = Path("dist").absolute()
PYTHON = ("python3", "python3-venv", "ca-certificates")
NO_CAMERA = (*PYTHON, "python3-numpy", "python3-pydantic", "python3-pydantic-core")
SMALL = (*NO_CAMERA, "python3-opencv")
"""Packages of apt on a system with 32 bits, for which pip finds no wheels: without OpenCV, and with it."""
PIP_FILES = (Path("/etc/pip.conf"), Path.home() / ".config/pip/pip.conf", Path.home() / ".pip/pip.conf")
PI_64 = "Raspberry Pi OS 12 or 13, 64 bits"
PI_32 = "Raspberry Pi OS 13, 32 bits"
BINFMT = Path("/proc/sys/fs/binfmt_misc")
ENTER = """
set -e
for place in proc dev; do mount --rbind "/$place" "$1/$place"; done
mkdir -p "$1/wheels" "$1/etc/ssl"
mount --bind "$2" "$1/wheels"
mount --bind /etc/ssl "$1/etc/ssl"
cp -L /etc/resolv.conf "$1/etc/resolv.conf"
root=$1; shift 2
exec chroot "$root" "$@"
"""


@dataclass(frozen=True, slots=True)
class RootSystem:
    """A Debian to install into; `packages` are those of apt."""

    name: str
    architecture: str
    suite: str
    page: str
    """The title of its commands in docs/run/packages.md."""
    packages: tuple[str, ...] = PYTHON
    interpreter: str = ""
    """The emulator of a foreign processor, as update-binfmts names it."""
    processor: str = ""
    """The emulated processor, by qemu's name: that of a Raspberry Pi. Without a name it is one that signs
    pointers, with which Python of Debian 13 takes twelve times as long."""
    setarch: tuple[str, ...] = ()
    """Makes the kernel of this computer name the architecture."""
    wheels: Path = DIST
    """The folder of the wheels."""

    @property
    def is_small(self) -> bool:
        """True where wheels of NumPy and others are missing."""
        return set(NO_CAMERA) <= set(self.packages)

    @property
    def is_emulated(self) -> bool:
        """True for a foreign processor."""
        return bool(self.interpreter)

    @property
    def baud(self) -> int:
        """bit/s of its serial port; qemu's emulation of Linux cannot set 250000."""
        return 115_200 if self.is_emulated else LinkConfig().baud

    @property
    def path(self) -> Path:
        """The root folder."""
        return FOLDER / self.name

    def make(self) -> None:
        """Make it, if it does not exist. Raise CalledProcessError."""
        if self.is_emulated:
            _enable(self.interpreter)
        if self.path.exists():
            return
        FOLDER.mkdir(parents=True, exist_ok=True)
        part = self.path.with_name(f"{self.name}.part")
        # What an interrupted one has left mounted there is not to be removed.
        subprocess.run(["rm", "-rf", "--one-file-system", str(part)], check=True)
        command = ["mmdebstrap", "--quiet", "--variant=minbase", f"--architectures={self.architecture}"]
        command += [f"--include={','.join(self.packages)}", self.suite, str(part)]
        source = f"deb {find_mirror()} {self.suite} main"
        subprocess.run([*command, source], check=True, env=os.environ | self._emulation())
        part.rename(self.path)

    def command(self, message: Sequence[str]) -> list[str]:
        """Return the command line that runs `words` in the root; its mounts end with it."""
        enter = ["unshare", "--mount", "--propagation", "private", "sh", "-c", ENTER, "enter"]
        return [*self.setarch, *enter, str(self.path), str(self.wheels), *message]

    def run(self, *arguments: str) -> str:
        """Run a command in the root; return what it printed. Fails where the command does."""
        done = subprocess.run(
            self.command(arguments), capture_output=True, text=True, check=False, env=self.environment()
        )
        assert done.returncode == 0, f"{' '.join(arguments)}\n{done.stdout[-2000:]}{done.stderr[-2000:]}"
        return done.stdout

    def environment(self) -> dict[str, str]:
        """Return the environment inside: pip's settings of this computer, a plain locale, the processor."""
        for file in PIP_FILES:
            if file.exists():
                (self.path / file.parent.relative_to("/")).mkdir(parents=True, exist_ok=True)
                shutil.copy(file, self.path / file.relative_to("/"))
        own = {name: value for name, value in os.environ.items() if name.startswith(("PIP_", "SSL_"))}
        path = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
        own |= {"PATH": path, "HOME": str(Path.home()), "LANG": "C.UTF-8", "PYTHONUNBUFFERED": "1"}
        return own | self._emulation()

    def _emulation(self) -> dict[str, str]:
        return {"QEMU_CPU": self.processor} if self.processor else {}


def _enable(interpreter: str) -> None:
    if not (BINFMT / "register").exists():
        subprocess.run(["mount", "-t", "binfmt_misc", "binfmt_misc", str(BINFMT)], check=True)
    if not (BINFMT / interpreter).exists():
        subprocess.run(["update-binfmts", "--enable", interpreter], check=True)


I386 = RootSystem("i386-trixie", "i386", "trixie", PI_32, SMALL, setarch=("linux32",))
# Processors of the Raspberry Pi 3 and Zero 2 W, and of the 2.
ROOTS = (
    RootSystem("amd64-trixie", "amd64", "trixie", "Any Linux"),
    I386,
    RootSystem("arm64-bookworm", "arm64", "bookworm", PI_64, PYTHON, "qemu-aarch64", "cortex-a53"),
    RootSystem("arm64-trixie", "arm64", "trixie", PI_64, PYTHON, "qemu-aarch64", "cortex-a53"),
    RootSystem("armhf-trixie", "armhf", "trixie", PI_32, SMALL, "qemu-arm", "cortex-a7"),
)
