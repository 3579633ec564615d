"""TLS with a certificate of the robot's own, signed by itself.

It is made by the program `openssl`, which every Linux has: the Python package that could do it is Rust and
C, without wheels for the Raspberry Pi Zero's ARMv6.
"""

import shutil
import ssl
import subprocess
from dataclasses import dataclass
from hashlib import sha256
from ipaddress import ip_address
from pathlib import Path

from server.platform.settings import DataFolder, Settings, SetupError

DAYS = 36_500
"""A hundred years: a Raspberry Pi that has never seen a network may take today for some day long past."""
MAKE_SECONDS = 60.0
CERTIFICATE, KEY = "certificate.pem", "key.pem"


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
    return context


def _make(folder: Path, settings: Settings) -> None:
    part = folder.with_suffix(".part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir(mode=0o700)
    names = ",".join(_alternative(name) for name in settings.allowed_hosts)
    command = ["openssl", "req", "-x509", "-nodes"]
    command += ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1"]
    command += ["-keyout", str(part / KEY), "-out", str(part / CERTIFICATE), "-days", str(DAYS)]
    command += ["-subj", f"/CN={settings.robot}", "-addext", f"subjectAltName={names}"]
    command += ["-addext", "extendedKeyUsage=serverAuth"]
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=MAKE_SECONDS,
            check=False,
        )
    except FileNotFoundError as problem:
        raise SetupError(
            "TLS needs the program openssl to make the robot's certificate, and it is not here. "
            "Install it (apt install openssl), or set server.tls to false in robot.toml."
        ) from problem
    except subprocess.TimeoutExpired as problem:
        raise OSError(f"openssl took more than {MAKE_SECONDS:g} s") from problem
    if done.returncode != 0:
        raise OSError(f"openssl refused: {' '.join(done.stderr.split())[-300:]}")
    (part / KEY).chmod(0o600)
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
