"""Keys and signatures of releases: Ed25519, by the program openssl."""

import hashlib
from pathlib import Path

from packages.architectures import PackagingError
from packages.commands import run
from server import VERSION

SUMS, SIGNATURE, PUBLIC_KEY = "SHA256SUMS", "SHA256SUMS.sig", "release.pem"
DOWNLOADS = f"mucat*[-_]{VERSION}[-.]*"
"""Files of a release for download: wheels, ZIP files, Debian packages, container images."""


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
    _sign(folder, "*.whl", secret)


def sign_downloads(dist: Path, secret: Path) -> None:
    """Write the checksums of this version's files for download, their signature, and the public key.

    Raise PackagingError.
    """
    _sign(dist, DOWNLOADS, secret)
    write_public_key(secret, dist / PUBLIC_KEY)


def _sign(folder: Path, pattern: str, secret: Path) -> None:
    files = [file for file in sorted(folder.glob(pattern)) if file.is_file()]
    lines = [f"{_hash(file)}  {file.name}\n" for file in files]
    (folder / SUMS).write_text("".join(lines), encoding="ascii")
    _openssl("pkeyutl", "-sign", "-inkey", secret, "-rawin", "-in", folder / SUMS, "-out", folder / SIGNATURE)


def _hash(file: Path) -> str:
    with file.open("rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()


def _openssl(*arguments: str | Path) -> None:
    run(["openssl", *arguments], "sudo apt install openssl")
