"""Keys and signatures of releases: Ed25519, by the program openssl."""

import hashlib
import subprocess
from pathlib import Path

SUMS, SIGNATURE, PUBLIC_KEY = "SHA256SUMS", "SHA256SUMS.sig", "release.pem"


def make_key(secret: Path) -> None:
    """Makes a secret key, which its owner alone may read. Raises CalledProcessError."""
    secret.parent.mkdir(parents=True, exist_ok=True)
    secret.touch(0o600)
    _openssl("genpkey", "-algorithm", "ed25519", "-out", secret)


def write_public_key(secret: Path, path: Path) -> None:
    """Writes the public key that belongs to a secret one. Raises CalledProcessError."""
    _openssl("pkey", "-in", secret, "-pubout", "-out", path)


def sign_folder(folder: Path, secret: Path) -> None:
    """Writes the checksums of the folder's wheels, and their signature. Raises CalledProcessError."""
    lines = [
        f"{hashlib.sha256(wheel.read_bytes()).hexdigest()}  {wheel.name}\n"
        for wheel in sorted(folder.glob("*.whl"))
    ]
    (folder / SUMS).write_text("".join(lines), encoding="ascii")
    _openssl("pkeyutl", "-sign", "-inkey", secret, "-rawin", "-in", folder / SUMS, "-out", folder / SIGNATURE)


def _openssl(*arguments: str | Path) -> None:
    subprocess.run(["openssl", *map(str, arguments)], check=True, capture_output=True)
