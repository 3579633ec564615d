"""The mirror of Debian that this computer's own apt uses."""

import subprocess

from packages.architectures import PackagingError


def find_mirror() -> str:
    """Returns the address of Debian's main archive in this computer's sources. Raises PackagingError."""
    listed = subprocess.run(
        ["apt-get", "indextargets", "--format", "$(ORIGIN)|$(LABEL)|$(COMPONENT)|$(REPO_URI)"],
        capture_output=True,
        text=True,
        check=True,
    )
    for line in listed.stdout.splitlines():
        origin, label, component, address = line.split("|", 3)
        if (origin, label, component) == ("Debian", "Debian", "main"):
            return address
    raise PackagingError("apt has no source of Debian's main archive; run apt-get update on a Debian.")
