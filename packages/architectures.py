"""Architectures for which the emulated board is packaged, and the compilers for them."""

import platform
from dataclasses import dataclass


class PackagingError(Exception):
    """A package cannot be built; the text says why and what to do."""


@dataclass(frozen=True, slots=True)
class Architecture:
    """An architecture: its names in wheels, at Debian and in GNU's tools."""

    machine: str
    """As `platform.machine()` and the tags of wheels name it."""
    debian: str
    gnu: str

    @property
    def is_own(self) -> bool:
        """True if it is this computer's."""
        return platform.machine() == self.machine

    def tool(self, name: str) -> str:
        """Return the name of a GNU tool, such as gcc, for this architecture."""
        return name if self.is_own else f"{self.gnu}-{name}"


ARCHITECTURES = {
    architecture.machine: architecture
    for architecture in (
        Architecture("x86_64", "amd64", "x86_64-linux-gnu"),
        Architecture("aarch64", "arm64", "aarch64-linux-gnu"),
        Architecture("i686", "i386", "i686-linux-gnu"),
    )
}
