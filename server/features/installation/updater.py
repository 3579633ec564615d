"""Updates and the way back. Whatever happens, one version runs in the end, with a database that it can read.

Of an update, the journal is the only state: written before anything in force changes, removed when the new
version was healthy. Where it is found at a start, the update was cut off, and the version before is put back.
"""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

from server.features.installation.effects import CommandFailedError, Effects
from server.features.installation.environments import build_environment
from server.features.installation.installer import INSTALL_BYTES, wait_until_healthy
from server.features.installation.places import InstallPlaces
from server.features.installation.release import RELEASE_FILE, Release, check_signature, read_release
from server.features.installation.report import UpdateReport, hold
from server.features.installation.signals import uninterrupted
from server.features.installation.versions import (
    list_wrong,
    look_at,
    order,
    refuse_in_use,
    write_services_of,
)
from server.platform.disk_space import free_bytes
from server.platform.settings import SetupError

HEALTHY_SECONDS = 60.0
RELEASE_BYTES = 1_000_000_000
"""A release unpacked, at most; one for 64 bits has some 350 MB."""


@dataclass(frozen=True, slots=True)
class Switch:
    """A change from one version to another; `firmware` is True where the board gets other firmware.

    `older` is the previous rollback version, empty without one.
    """

    before: str
    after: str
    firmware: bool
    older: str = ""


class Updater:
    """Updater of the installation at these paths."""

    def __init__(self, places: InstallPlaces, effects: Effects) -> None:
        self._places = places
        self._effects = effects
        self._report = UpdateReport(places.report)

    def update(self, path: Path) -> str:
        """Update to the release in this folder or ZIP file; return its version. Raise SetupError: then the
        version before runs, with its database."""
        with self._alone():
            version = self._update(path)
            self._report.write("done", f"µ-CAT {version} is in use.")
        return version

    def roll_back(self) -> str:
        """Go back to the version before the last update; return it. Raise SetupError."""
        with self._alone():
            version = self._roll_back()
            self._report.write("done", f"µ-CAT {version} is in use again.")
        return version

    def recover(self, *, starting: bool = False) -> None:
        """Go back from an interrupted update, if there is one. Raise SetupError.

        `starting`: the computer starts, and nothing of µ-CAT runs yet.
        """
        with self._alone():
            if (switch := self._recover(starting=starting)) is not None:
                text = f"The update to {switch.after} was cut off: {switch.before} is in use again."
                self._report.write("failed", text)

    def _update(self, path: Path) -> str:
        self._recover()
        places, effects = self._places, self._effects
        before = self._installed()
        self._tell("The release is checked.")
        try:
            release = self._take_in(path)
            if release.version == before:
                raise SetupError(f"µ-CAT {before} is in use already. Nothing was changed.")
            refuse_in_use(effects, places)
            # Those of earlier updates that came to nothing, too.
            self._remove_others(release.version)
            self._check_room(release)
            self._tell(f"µ-CAT {release.version} is built beside {before}. The robot can be used meanwhile.")
            environment = build_environment(effects, places, release)
            self._tell(f"The doctor of {release.version} looks at this computer.")
            self._refuse_new_faults(environment)
        finally:
            effects.remove(places.incoming)
        # The environment took minutes to build.
        refuse_in_use(effects, places)
        self._switch(before, environment)
        self._remove_others()
        return release.version

    def _roll_back(self) -> str:
        if (ended := self._recover()) is not None:
            return ended.before
        places = self._places
        now, before = self._installed(), places.version_of(places.previous)
        if not before or before == now:
            raise SetupError("There is no version to go back to: none was before, or one went back already.")
        refuse_in_use(self._effects, places)
        last = self._read(places.last_switch)
        switch = Switch(before, now, firmware=last is not None and last.firmware)
        self._find_copy(switch)
        # As a cut-off update: a power cut on the way back does not end it.
        with uninterrupted():
            self._effects.write(places.journal, json.dumps(asdict(switch)) + "\n")
            self._effects.remove(places.last_switch)
            self._tell(f"{before} is put back.")
            with self._stopped():
                self._go_back(switch)
        wait_until_healthy(self._effects, places, HEALTHY_SECONDS)
        return before

    def _recover(self, *, starting: bool = False) -> Switch | None:
        """Go back from an interrupted update; return it, None without one."""
        switch = self._read(self._places.journal)
        if switch is None:
            return None
        if not starting:
            # The version after it may have been used since.
            refuse_in_use(self._effects, self._places)
        self._tell(f"The update to {switch.after} was cut off: {switch.before} is put back.")
        if starting:
            self._go_back(switch)
        else:
            with uninterrupted(), self._stopped():
                self._go_back(switch)
            wait_until_healthy(self._effects, self._places, HEALTHY_SECONDS)
        return switch

    @contextmanager
    def _alone(self) -> Iterator[None]:
        with hold(self._places.lock):
            try:
                yield
            except SetupError as problem:
                self._report.write("failed", str(problem))
                raise

    def _tell(self, text: str) -> None:
        self._effects.say(text)
        self._report.write("running", text)

    def _installed(self) -> str:
        version = self._places.version_of(self._places.current)
        if not version:
            raise SetupError(f"µ-CAT is not installed in {self._places.software}: use mucat install.")
        return version

    def _take_in(self, path: Path) -> Release:
        """Copy the release to where only root can change it, check it, and return it."""
        places, effects = self._places, self._effects
        effects.remove(places.incoming)
        if path.suffix == ".zip" and path.is_file():
            effects.unpack(path, places.incoming, RELEASE_FILE, RELEASE_BYTES)
        else:
            folder = read_release(path).folder
            effects.copy(
                [file for file in sorted(folder.iterdir()) if RELEASE_FILE.fullmatch(file.name)],
                places.incoming,
            )
        release = read_release(places.incoming)
        check_signature(release, places.key)
        return release

    def _check_room(self, release: Release) -> None:
        needed = INSTALL_BYTES
        database = self._places.data / "mucat.db"
        needed += database.stat().st_size if database.exists() else 0
        if (free := free_bytes(self._places.software)) < needed:
            raise SetupError(
                f"{free / 1e6:.0f} MB are free, and {release.version} needs {needed / 1e6:.0f} MB. "
                "Free some space; nothing was changed."
            )

    def _refuse_new_faults(self, environment: Path) -> None:
        """Raise SetupError where the new version's doctor finds problems that the old one's does not."""
        problems = list_wrong(self._effects, self._places, environment)
        try:
            known = list_wrong(self._effects, self._places, self._places.current)
        except CommandFailedError as problem:
            # An update may be what mends it; the new version must be healthy all the same.
            self._effects.say(f"The doctor in use cannot be asked: {problem}")
            return
        if new := sorted(problems.keys() - known.keys()):
            raise SetupError(f"The new version would not work here: {problems[new[0]]} Nothing was changed.")

    @uninterrupted()
    def _switch(self, before: str, environment: Path) -> None:
        places, effects = self._places, self._effects
        firmware = look_at(effects, places, environment).firmware
        changed = firmware not in ("", self._firmware_in_use())
        switch = Switch(before, environment.name, changed, places.version_of(places.previous))
        effects.write(places.journal, json.dumps(asdict(switch)) + "\n")
        self._tell(f"{before} is stopped, and {switch.after} started. It must be healthy within a minute.")
        try:
            effects.link(places.previous, places.version(before))
            with self._stopped():
                effects.link(places.current, environment)
                write_services_of(effects, environment)
                if switch.firmware:
                    order(effects, places, environment, "upload")
            wait_until_healthy(effects, places, HEALTHY_SECONDS)
        except SetupError as problem:
            self._tell(f"{problem} {before} is put back.")
            with self._stopped():
                self._go_back(switch)
            raise SetupError(f"{problem} {before} is in use again, with its database.") from problem
        effects.write(places.last_switch, json.dumps(asdict(switch)) + "\n")
        effects.remove(places.journal)

    def _firmware_in_use(self) -> str:
        try:
            return look_at(self._effects, self._places, self._places.current).firmware
        except CommandFailedError:
            return ""

    def _go_back(self, switch: Switch) -> None:
        """Put the version before in force, and its database where it cannot read the present one."""
        places, effects = self._places, self._effects
        old, copy = places.version(switch.before), self._find_copy(switch)
        effects.link(places.current, old)
        write_services_of(effects, old)
        if copy:
            effects.say(order(effects, places, old, "restore", copy).strip())
        if switch.firmware:
            order(effects, places, old, "upload")
        if switch.older:
            effects.link(places.previous, places.version(switch.older))
        effects.remove(places.journal)

    def _find_copy(self, switch: Switch) -> str:
        """Return the migration's copy of the database for the version before; empty where it reads the
        present one.

        Raise SetupError where there is no way back.
        """
        old = self._places.version(switch.before)
        if not self._places.is_complete(old):
            raise SetupError(
                f"{old} is not there any more: sudo mucat uninstall (the data stay), then install a release."
            )
        survey = look_at(self._effects, self._places, old)
        if not survey.reads and not survey.copy:
            raise SetupError(
                f"{switch.before} cannot read the database, and no copy of it fits. Nothing was changed."
            )
        return "" if survey.reads else survey.copy

    @contextmanager
    def _stopped(self) -> Iterator[None]:
        """Stop all of µ-CAT meanwhile; start it afterwards in any case."""
        services = self._places.services
        self._effects.run("systemctl", "stop", *reversed(services))
        try:
            yield
        finally:
            self._effects.run("systemctl", "start", "--no-block", *services)

    def _read(self, path: Path) -> Switch | None:
        try:
            return Switch(**json.loads(path.read_text(encoding="utf-8")))
        except FileNotFoundError:
            return None
        except (OSError, ValueError, TypeError) as problem:
            raise SetupError(f"{path} cannot be read: {problem}.") from problem

    def _remove_others(self, coming: str = "") -> None:
        """Remove environments without a link, except that of the new version."""
        places = self._places
        in_use = {coming, places.version_of(places.current), places.version_of(places.previous)}
        for folder in sorted(places.versions.iterdir()):
            if folder.name not in in_use:
                self._effects.remove(folder)
