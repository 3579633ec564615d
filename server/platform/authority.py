"""The authority for Zenoh on the network, of a robot or a lab: its certificate, and those that it issues."""

import re
import secrets
import shutil
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

from robot_runtime.durable_files import make_folder, write_whole
from robot_runtime.transport.network import AUTHORITY, CERTIFICATE, KEY, SIMULATORS
from server.platform.openssl import LEAF, SIGNS, Signer, make_certificate
from server.platform.settings import Settings, SetupError

AUTHORITY_KEY = "authority.key"
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,31}")


def check_name(name: str) -> None:
    """Raise SetupError where a certificate cannot have this name."""
    if not NAME.fullmatch(name):
        raise SetupError(f"{name!r} is no name of a certificate: use up to 32 of A-Z, a-z, 0-9, - and _.")


class IssuedCertificate(NamedTuple):
    """A certificate in force."""

    name: str
    issued: datetime
    file: Path


class Authority:
    """The certificates in the data folder. All methods raise SetupError on failure.

    `holders` names the folder of those in force: a robot's simulators, or a lab's robots. A certificate's
    common name is its file's name there. It holds random digits, so that a name that is issued again after
    it was revoked does not revive the old certificate.
    """

    def __init__(self, settings: Settings, holders: str = SIMULATORS) -> None:
        self._folder = settings.data.zenoh
        self._holders = holders
        self._robot = settings.robot.name
        self._signer = Signer(self._folder / AUTHORITY, self._folder / AUTHORITY_KEY)

    def prepare(self) -> None:
        """Make the authority and the robot's certificate, unless they exist."""
        if self._folder.exists():
            return
        part = self._folder.with_suffix(".part")
        try:
            shutil.rmtree(part, ignore_errors=True)
            make_folder(part.parent)
            part.mkdir(mode=0o700)
            (part / self._holders).mkdir(mode=0o700)
            signer = Signer(part / AUTHORITY, part / AUTHORITY_KEY)
            make_certificate(signer.certificate, signer.key, f"{self._robot} authority", SIGNS)
            own = (f"subjectAltName=DNS:{self._robot}", "extendedKeyUsage=serverAuth", *LEAF)
            make_certificate(part / CERTIFICATE, part / KEY, self._robot, own, signer)
            part.rename(self._folder)
        except OSError as problem:
            raise SetupError(f"The certificates in {self._folder} cannot be made: {problem}.") from problem

    def issue(self, name: str, destination: Path) -> None:
        """Make a holder's certificate, with its key, in a new folder."""
        check_name(name)
        if any(certificate.name == name for certificate in self.issued()):
            raise SetupError(f"{name} has a certificate. Revoke it first: mucat certificate revoke {name}")
        common_name = f"{name}.{secrets.token_hex(4)}"
        made = self._make(common_name, destination, f"subjectAltName=DNS:{name}")
        try:
            make_folder(self._folder / self._holders)
            write_whole(self._folder / self._holders / f"{common_name}.pem", made.read_bytes(), 0o600)
        except OSError as problem:
            raise SetupError(f"The certificate {name} cannot be put into force: {problem}.") from problem

    def issue_program(self, common_name: str, destination: Path) -> None:
        """Make the certificate of a ROS 2 program, with its key, in a new folder.

        The server knows the program by `common_name`; the robot's own Zenoh admits it to nothing.
        """
        self._make(common_name, destination)

    def _make(self, common_name: str, destination: Path, *extensions: str) -> Path:
        self.prepare()
        try:
            destination.mkdir(mode=0o700)
            made = destination / CERTIFICATE
            extensions = (*extensions, "extendedKeyUsage=clientAuth", *LEAF)
            make_certificate(made, destination / KEY, common_name, extensions, self._signer)
            shutil.copyfile(self._signer.certificate, destination / AUTHORITY)
        except OSError as problem:
            raise SetupError(f"The certificate in {destination} cannot be made: {problem}.") from problem
        return made

    def revoke(self, name: str) -> None:
        """Take a holder's certificate out of force."""
        certificates = [certificate for certificate in self.issued() if certificate.name == name]
        if not certificates:
            raise SetupError(
                f"There is no certificate {name} of a simulator: mucat certificate list shows those in "
                "force. That of a ROS 2 program is revoked under People, or with mucat access revoke."
            )
        try:
            for certificate in certificates:
                certificate.file.unlink()
        except OSError as problem:
            raise SetupError(f"The certificate {name} cannot be revoked: {problem}.") from problem

    def issued(self) -> list[IssuedCertificate]:
        """Return the holders' certificates in force, by name."""
        files = sorted((self._folder / self._holders).glob("*.pem"))
        return [
            IssuedCertificate(
                file.stem.partition(".")[0], datetime.fromtimestamp(file.stat().st_mtime, UTC), file
            )
            for file in files
        ]
