"""Certificates made by the program `openssl`, which every Linux has.

The Python package that could do it is Rust and C, without wheels for the Raspberry Pi Zero's ARMv6.
"""

import ssl
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from server.platform.settings import SetupError

DAYS = 36_500
"""A hundred years: a Raspberry Pi that has never seen a network may take today for some day long past."""
BROWSER_DAYS = 820
"""Apple's devices refuse a server's certificate that is valid for more than 825 days."""
SIGNS = ("basicConstraints=critical,CA:TRUE,pathlen:0", "keyUsage=critical,keyCertSign")
"""A certificate whose key signs others, which sign none."""
LEAF = ("basicConstraints=critical,CA:FALSE", "keyUsage=critical,digitalSignature")
"""A certificate whose key signs no other, so that who trusts it trusts this robot alone."""
MAKE_SECONDS = 60.0
CERTIFICATE, KEY = "certificate.pem", "key.pem"


@dataclass(frozen=True, slots=True)
class Signer:
    """The certificate and the key that sign another certificate."""

    certificate: Path
    key: Path


def make_certificate(
    certificate: Path,
    key: Path,
    name: str,
    extensions: Sequence[str],
    signer: Signer | None = None,
    days: int = DAYS,
) -> None:
    """Make a certificate for this common name, and its key unless there is one.

    Without a signer it signs itself. Raise OSError, and SetupError where there is no openssl.
    """
    command = ["openssl", "req", "-x509"]
    if key.exists():
        command += ["-key", str(key)]
    else:
        command += ["-nodes", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1"]
        command += ["-keyout", str(key)]
    command += ["-out", str(certificate), "-days", str(days), "-subj", f"/CN={name}"]
    if signer is not None:
        command += ["-CA", str(signer.certificate), "-CAkey", str(signer.key)]
    for extension in extensions:
        command += ["-addext", extension]
    _run(command)
    key.chmod(0o600)


@dataclass(frozen=True, slots=True)
class Validity:
    """The time in which a certificate is valid, s since 1970, and whether its key signs servers alone."""

    begins: float
    ends: float
    is_leaf: bool


def read_validity(certificate: Path) -> Validity:
    """Read a certificate. Raise OSError, and SetupError where there is no openssl."""
    command = ["openssl", "x509", "-in", str(certificate), "-noout", "-dates"]
    text = _run([*command, "-ext", "basicConstraints,keyUsage"])
    dates = dict(line.split("=", 1) for line in text.splitlines() if line.startswith("not"))
    begins, ends = (ssl.cert_time_to_seconds(dates[name]) for name in ("notBefore", "notAfter"))
    return Validity(begins, ends, "CA:FALSE" in text and "Digital Signature" in text)


def _run(command: Sequence[str]) -> str:
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
            "A certificate is made by the program openssl, and it is not here. Install it (apt install "
            "openssl), or do without: server.tls = false and zenoh.listen = [] in robot.toml."
        ) from problem
    except subprocess.TimeoutExpired as problem:
        raise OSError(f"openssl took more than {MAKE_SECONDS:g} s") from problem
    if done.returncode != 0:
        raise OSError(f"openssl refused: {' '.join(done.stderr.split())[-300:]}")
    return done.stdout
