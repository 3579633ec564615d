"""Certificates made by the program `openssl`, which every Linux has.

The Python package that could do it is Rust and C, without wheels for the Raspberry Pi Zero's ARMv6.
"""

import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from server.platform.settings import SetupError

DAYS = 36_500
"""A hundred years: a Raspberry Pi that has never seen a network may take today for some day long past."""
MAKE_SECONDS = 60.0
CERTIFICATE, KEY = "certificate.pem", "key.pem"


@dataclass(frozen=True, slots=True)
class Signer:
    """The certificate and the key that sign another certificate."""

    certificate: Path
    key: Path


def make_certificate(
    certificate: Path, key: Path, name: str, extensions: Sequence[str], signer: Signer | None = None
) -> None:
    """Makes a key and its certificate for this common name; without a signer it signs itself.

    Raises OSError, and SetupError where there is no openssl.
    """
    command = ["openssl", "req", "-x509", "-nodes"]
    command += ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1"]
    command += ["-keyout", str(key), "-out", str(certificate), "-days", str(DAYS), "-subj", f"/CN={name}"]
    if signer is not None:
        command += ["-CA", str(signer.certificate), "-CAkey", str(signer.key)]
    for extension in extensions:
        command += ["-addext", extension]
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
    key.chmod(0o600)
