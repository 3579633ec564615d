"""The mirror of Debian that this computer's own apt uses."""

from packages.architectures import PackagingError
from packages.commands import run


def find_mirror() -> str:
    """Return the address of Debian's main archive in this computer's sources. Raise PackagingError."""
    targets = ("indextargets", "--format", "$(ORIGIN)|$(LABEL)|$(COMPONENT)|$(REPO_URI)")
    for line in run(["apt-get", *targets], "this needs a Debian").splitlines():
        origin, label, component, address = line.split("|", 3)
        if (origin, label, component) == ("Debian", "Debian", "main"):
            return address
    raise PackagingError("apt has no source of Debian's main archive; run apt-get update on a Debian.")
