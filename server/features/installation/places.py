"""Paths of an installation, below the root of the file system or a folder that replaces it."""

from pathlib import Path

USER = "mucat"
COMPLETE = "mucat-complete"
"""File of an environment that was built to its end."""


class InstallPlaces:
    """The paths; `root` is / except in tests. `lab` is true where the services are, or will be, a lab's."""

    def __init__(self, root: Path = Path("/"), *, lab: bool = False) -> None:
        self.root = root
        self.software = root / "opt/mucat"
        """Everything that an update replaces; it belongs to root."""
        self.versions = self.software / "versions"
        """A virtual environment for each version."""
        self.current = self.software / "current"
        """Link to the environment in use."""
        self.previous = self.software / "previous"
        """Link to the environment before it, to which one can go back."""
        self.journal = self.software / "update.json"
        """Exists while an update is not yet confirmed."""
        self.last_switch = self.software / "last-update.json"
        """The last update, as long as one can go back from it."""
        self.incoming = self.software / "incoming"
        """A release while it is checked, out of reach of the server."""
        self.settings = root / "etc/mucat"
        self.config = self.settings / "robot.toml"
        self.key = self.settings / "release.pem"
        """The public key (Ed25519) by which releases are signed."""
        self.data = root / "var/lib/mucat"
        self.lab_mark = self.data / "lab"
        """Exists where this is the installation of a lab."""
        self.lab = lab or self.lab_mark.exists()
        self.request = self.data / "update/request.json"
        """Exists from the page's request for an update until it is taken."""
        self.requested = self.data / "update/release.zip"
        """The release that the page has sent."""
        self.report = root / "run/mucat-update.json"
        """The report of the present or last update."""
        self.lock = root / "run/mucat-update.lock"
        """Held by what changes the installation."""
        self.units = root / "etc/systemd/system"
        self.journal_limit = root / "etc/systemd/journald.conf.d/mucat.conf"
        """Limit of the system's journal, on a Raspberry Pi."""
        self.command = root / "usr/local/bin/mucat"

    def version(self, name: str) -> Path:
        """Return the environment of this version."""
        return self.versions / name

    def is_complete(self, environment: Path) -> bool:
        """Return True for an environment that was built to its end."""
        return (environment / COMPLETE).exists()

    def version_of(self, link: Path) -> str:
        """Return the version of the link `current` or `previous`; empty without one."""
        return link.resolve().name if link.is_symlink() and link.exists() else ""

    @property
    def services(self) -> tuple[str, ...]:
        """The services that run all the time, in the order of their start."""
        return ("mucat-lab.service",) if self.lab else ("mucat-runtime.service", "mucat.service")

    @property
    def boot(self) -> Path | None:
        """The folder of config.txt; None where this is no Raspberry Pi, or none of a robot."""
        if self.lab:
            return None
        folders = (self.root / "boot/firmware", self.root / "boot")
        return next((folder for folder in folders if (folder / "config.txt").exists()), None)
