"""Headers and libraries of another architecture, for its cross compiler, from Debian's packages."""

import shutil
from pathlib import Path

from packages.architectures import Architecture
from packages.commands import run
from packages.mirror import find_mirror
from robot_runtime.places import BUILD

LIBRARIES = ("libsimavr-dev", "libelf-dev", "zlib1g-dev", "libc6-dev", "libstdc++-12-dev", "linux-libc-dev")
TOOLS = "make all-wheels installs it"
SUITE = "bookworm"
"""The oldest Debian that is supported: what is built with its libraries runs on the later ones too."""


def make_sysroot(architecture: Architecture) -> Path:
    """Return a folder with the architecture's libraries, made now or before. Raise PackagingError.

    The packages are unpacked and none of their programs runs, so that no emulator is needed.
    """
    root = BUILD / "sysroots" / architecture.debian
    if root.exists():
        return root
    root.parent.mkdir(parents=True, exist_ok=True)
    unfinished = root.with_name(f"{root.name}.unfinished")
    shutil.rmtree(unfinished, ignore_errors=True)
    command = ["mmdebstrap", "--quiet", "--variant=extract", f"--architectures={architecture.debian}"]
    command += [f"--include={','.join(LIBRARIES)}", SUITE, str(unfinished)]
    command += [f"deb {find_mirror()} {SUITE} main"]
    run(command, TOOLS, f"The libraries for {architecture.debian} could not be fetched")
    unfinished.rename(root)
    return root
