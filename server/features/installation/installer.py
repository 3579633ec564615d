"""The steps of an installation and of its removal. Each looks first: done again, it changes nothing."""

import re
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from server.features.installation.boot_settings import describe_change, edit_config, edit_kernel_line
from server.features.installation.effects import CommandFailedError, Effects
from server.features.installation.environments import build_environment
from server.features.installation.places import USER, InstallPlaces
from server.features.installation.release import Release
from server.features.installation.units import JOURNAL, write_command, write_units
from server.features.installation.versions import look_at, refuse_in_use
from server.platform.disk_space import free_bytes
from server.platform.settings import SetupError

GROUPS = ("dialout", "gpio", "video")
INSTALL_BYTES = 1_100_000_000
"""Room for an environment with its wheels."""
BACKUP = ".before-mucat"
FIRST_START_SECONDS = 180.0
"""The first start, on a Raspberry Pi Zero."""
LOOK_SECONDS = 0.5
Confirm = Callable[[str], bool]


class Installer:
    """An installation at these paths; `confirm` asks a person before the boot settings are changed."""

    def __init__(self, places: InstallPlaces, effects: Effects, confirm: Confirm) -> None:
        self._places = places
        self._effects = effects
        self._confirm = confirm

    def install(self, release: Release) -> None:
        """Install the release, or mend an installation of its version. Raise SetupError."""
        self._refuse_other(release)
        self._refuse_robot()
        if self._must_restart():
            refuse_in_use(self._effects, self._places)
        self._check_room(release)
        self.add_user()
        environment = build_environment(self._effects, self._places, release)
        if not self._places.current.is_symlink():
            self._effects.link(self._places.current, environment)
        self.write_settings(environment, release)
        changed = self.write_services()
        self.change_boot_settings()
        self.start(changed)

    def _refuse_other(self, release: Release) -> None:
        version = self._places.version_of(self._places.current)
        if version not in ("", release.version):
            raise SetupError(
                f"µ-CAT {version} is installed here: sudo mucat update {release.folder}. Nothing was changed."
            )

    def _refuse_robot(self) -> None:
        """Raise SetupError where a lab would take the place of a robot."""
        places = self._places
        robot = (places.data / "mucat.db").exists() or (places.units / "mucat.service").exists()
        if places.lab and robot and not places.lab_mark.exists():
            raise SetupError(
                f"A robot is installed here, with its data in {places.data}. Install the lab on another "
                "computer; nothing was changed."
            )

    def _must_restart(self) -> bool:
        """Return True where installed services differ from the new ones."""
        units = self._places.units
        return any(
            (units / name).exists() and (units / name).read_text(encoding="utf-8") != text
            for name, text in write_units(self._places).items()
        )

    def _check_room(self, release: Release) -> None:
        places = self._places
        if places.is_complete(places.version(release.version)):
            return
        folder = next(folder for folder in (places.software, *places.software.parents) if folder.exists())
        if (free := free_bytes(folder)) < INSTALL_BYTES:
            raise SetupError(
                f"{free / 1e6:.0f} MB are free for {places.software}, and an installation needs "
                f"{INSTALL_BYTES / 1e6:.0f} MB. Free some space; nothing was changed."
            )

    def add_user(self) -> None:
        """Add the user, its groups and its data folder."""
        effects, places = self._effects, self._places
        if not self._has_line("etc/passwd", USER):
            command: list[str | Path] = [
                "useradd",
                "--system",
                "--user-group",
                "--no-create-home",
                "--home-dir",
                places.data,
            ]
            effects.run(*command, "--shell", "/usr/sbin/nologin", USER)
        needed = () if places.lab else GROUPS
        missing = [group for group in needed if self._has_line("etc/group", group, without=USER)]
        if missing:
            effects.run("usermod", "--append", "--groups", ",".join(missing), USER)
        if not places.data.is_dir():
            effects.run("install", "-d", "-m", "700", "-o", USER, "-g", USER, places.data)
        if places.lab and not places.lab_mark.exists():
            effects.run("install", "-m", "600", "-o", USER, "-g", USER, "/dev/null", places.lab_mark)

    def _has_line(self, file: str, name: str, without: str = "") -> bool:
        """Return True where the file has an entry of this name, whose members lack `without`."""
        try:
            text = (self._places.root / file).read_text(encoding="utf-8", errors="replace")
        except OSError:
            return False
        entries = (line.split(":") for line in text.splitlines())
        return any(
            entry[0] == name and (not without or without not in entry[-1].split(",")) for entry in entries
        )

    def write_settings(self, environment: Path, release: Release) -> None:
        """Write the configuration where there is none, and the key of the releases."""
        effects, places = self._effects, self._places
        if not places.config.exists():
            question = (
                "from robot_runtime.places import DEFAULT_CONFIG; print(DEFAULT_CONFIG.read_text(), end='')"
            )
            default = effects.run(environment / "bin/python", "-c", question, quiet=not effects.dry)
            effects.write(places.config, adapt_config(default, robot=places.boot is not None))
        key = release.folder / "release.pem"
        if not places.key.exists() and key.exists():
            effects.write(places.key, key.read_text(encoding="ascii"))

    def write_services(self) -> bool:
        """Write the services and the command; return True if that changed one."""
        effects, places = self._effects, self._places
        units = write_units(places)
        changed = [effects.write(places.units / name, text) for name, text in units.items()]
        effects.write(places.command, write_command(places), 0o755)
        if places.boot is not None:
            effects.write(places.journal_limit, JOURNAL)
        effects.run("systemctl", "daemon-reload")
        enabled = [name for name, text in units.items() if "[Install]" in text]
        effects.run("systemctl", "enable", "--quiet", *enabled)
        return any(changed)

    def change_boot_settings(self) -> None:
        """Show the changes of the Raspberry Pi's boot settings, and apply them if confirmed."""
        folder = self._places.boot
        if folder is None:
            return
        edits: Sequence[tuple[Path, Callable[[str], str]]] = (
            (folder / "config.txt", edit_config),
            (folder / "cmdline.txt", edit_kernel_line),
        )
        changes = []
        for path, edit in edits:
            before = path.read_text(encoding="utf-8") if path.exists() else ""
            if (after := edit(before)) != before:
                self._effects.say(describe_change(str(path), before, after))
                changes.append((path, before, after))
        if not changes:
            return
        if not self._effects.dry and not self._confirm("Change these boot settings? Each file is backed up."):
            self._effects.say("The boot settings stay as they are: mucat doctor says what they lack.")
            return
        for path, before, after in changes:
            backup = path.with_name(path.name + BACKUP)
            if not backup.exists():
                self._effects.write(backup, before)
            self._effects.write(path, after)
        self._effects.say("They come into force at the next start: sudo reboot")

    def start(self, changed: bool) -> None:
        """Start the services, or restart changed ones, and wait until the page answers."""
        places = self._places
        path = () if places.lab else ("mucat-update.path",)
        self._effects.run("systemctl", "restart" if changed else "start", *path, *places.services)
        wait_until_healthy(self._effects, self._places, FIRST_START_SECONDS)

    def uninstall(self) -> None:
        """Remove services and software; data, configuration and user stay. Raise SetupError."""
        effects, places = self._effects, self._places
        refuse_in_use(effects, places)
        names = list(write_units(places))
        there = [name for name in names if (places.units / name).exists()]
        if there:
            effects.run("systemctl", "disable", "--quiet", "--now", *there)
        for name in names:
            effects.remove(places.units / name)
        effects.run("systemctl", "daemon-reload")
        effects.remove(places.journal_limit)
        effects.remove(places.command)
        effects.remove(places.software)


def adapt_config(text: str, *, robot: bool) -> str:
    """Return an installed robot's default configuration: open to the network, encrypted, real on a Pi."""
    changes = {"host": '"0.0.0.0"', "tls": "true"}
    if robot:
        changes |= {"mode": '"robot"', "camera": '"pi"'}
    return set_values(text, changes)


def set_values(text: str, values: Mapping[str, str]) -> str:
    """Return a configuration with the first entry of each name set to this value, in TOML's spelling."""
    for name, value in values.items():
        text = re.sub(rf"^{name} = \S+", f"{name} = {value}", text, count=1, flags=re.MULTILINE)
    return text


def wait_until_healthy(effects: Effects, places: InstallPlaces, seconds: float) -> None:
    """Wait until the server answers with this version. Raise SetupError."""
    if effects.dry:
        return
    version, end = places.version_of(places.current), time.monotonic() + seconds
    problem = "it was not asked"
    while time.monotonic() < end:
        try:
            survey = look_at(effects, places, places.current)
        except CommandFailedError as failure:
            problem = str(failure)
        else:
            if survey.running == version and not survey.problem:
                effects.say(f"µ-CAT {version} runs")
                return
            problem = survey.problem or f"the server says that it is of version {survey.running}"
        time.sleep(LOOK_SECONDS)
    raise SetupError(
        f"The server was not healthy within {seconds:g} s: {problem} See: journalctl -u 'mucat*'"
    )
