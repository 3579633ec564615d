"""TLS with a certificate of the robot's own, signed by itself."""

import shutil
import ssl
from dataclasses import dataclass
from hashlib import sha256
from ipaddress import ip_address
from pathlib import Path

from server.platform.openssl import CERTIFICATE, KEY, make_certificate
from server.platform.settings import DataFolder, Settings, SetupError

NO_CHECK_TIME = 0x200000
"""X509_V_FLAG_NO_CHECK_TIME of OpenSSL (x509_vfy.h), which Python has no name for."""


@dataclass(frozen=True, slots=True)
class Certificate:
    """Two files, and what people compare: SHA-256 over the certificate (DER), as browsers show it."""

    file: Path
    key: Path
    fingerprint: str


def prepare_certificate(settings: Settings) -> Certificate:
    """The robot's certificate, made at its first start. Raises SetupError where it cannot be had."""
    folder = settings.data.tls
    try:
        if not folder.exists():
            _make(folder, settings)
        return _read(folder)
    except (OSError, ValueError) as problem:
        raise SetupError(
            f"The robot's certificate in {folder} cannot be had: {problem}. "
            "Remove that folder to have another made, or set server.tls to false in robot.toml."
        ) from problem


def trust_only(folder: DataFolder) -> ssl.SSLContext:
    """For asking the server of this folder: its certificate is the only one that counts, under any name.

    Raises OSError where there is none.
    """
    context = ssl.create_default_context(cafile=str(folder.tls / CERTIFICATE))
    context.check_hostname = False
    # The certificate is this file's own, whatever date a clock has that nobody has set yet.
    context.verify_flags |= NO_CHECK_TIME
    return context


def _make(folder: Path, settings: Settings) -> None:
    part = folder.with_suffix(".part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir(mode=0o700)
    names = ",".join(_alternative(name) for name in settings.allowed_hosts)
    extensions = [f"subjectAltName={names}", "extendedKeyUsage=serverAuth"]
    make_certificate(part / CERTIFICATE, part / KEY, settings.robot, extensions)
    part.rename(folder)


def _read(folder: Path) -> Certificate:
    text = (folder / CERTIFICATE).read_text(encoding="ascii")
    digest = sha256(ssl.PEM_cert_to_DER_cert(text)).hexdigest().upper()
    (folder / KEY).read_bytes()
    pairs = (digest[place : place + 2] for place in range(0, len(digest), 2))
    return Certificate(folder / CERTIFICATE, folder / KEY, ":".join(pairs))


def _alternative(name: str) -> str:
    try:
        return f"IP:{ip_address(name.strip('[]'))}"
    except ValueError:
        return f"DNS:{name}"
