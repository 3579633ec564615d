"""Keys and signatures for tests."""

from pathlib import Path

from packages.signing import make_key, sign_folder, write_public_key


def make_keys(folder: Path) -> None:
    """secret.pem, and release.pem for the robot."""
    make_key(folder / "secret.pem")
    write_public_key(folder / "secret.pem", folder / "release.pem")


def sign(release: Path, secret: Path) -> None:
    """Sign a release with this key."""
    sign_folder(release, secret)
