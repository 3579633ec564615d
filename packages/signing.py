"""Keys and signatures of releases: Ed25519, by the program openssl."""

import hashlib
from pathlib import Path

from packages.architectures import PackagingError
from packages.commands import run

SUMS, SIGNATURE, PUBLIC_KEY = "SHA256SUMS", "SHA256SUMS.sig", "release.pem"


def make_key(secret: Path) -> None:
    """Make a secret key, which its owner alone may read. Raise PackagingError."""
    secret.parent.mkdir(parents=True, exist_ok=True)
    secret.touch(0o600, exist_ok=False)
    try:
        _openssl("genpkey", "-algorithm", "ed25519", "-out", secret)
    except PackagingError:
        # The next release would take the empty file for a key.
        secret.unlink(missing_ok=True)
        raise


def write_public_key(secret: Path, path: Path) -> None:
    """Write the public key that belongs to a secret one. Raise PackagingError."""
    _openssl("pkey", "-in", secret, "-pubout", "-out", path)


def sign_folder(folder: Path, secret: Path) -> None:
    """Write the checksums of the folder's wheels, and their signature. Raise PackagingError."""
    lines = [
        f"{hashlib.sha256(wheel.read_bytes()).hexdigest()}  {wheel.name}\n"
        for wheel in sorted(folder.glob("*.whl"))
    ]
    (folder / SUMS).write_text("".join(lines), encoding="ascii")
    _openssl("pkeyutl", "-sign", "-inkey", secret, "-rawin", "-in", folder / SUMS, "-out", folder / SIGNATURE)


def _openssl(*arguments: str | Path) -> None:
    run(["openssl", *arguments], "sudo apt install openssl")
