"""A release: a folder of wheels with their checksums, which may be signed (docs/run/update.md)."""

import hashlib
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

from server.platform.settings import SetupError

SUMS = "SHA256SUMS"
SIGNATURE = "SHA256SUMS.sig"
WHEEL = re.compile(r"mucat-([0-9][0-9A-Za-z.+!]*)-py3-none-any\.whl")
RELEASE_FILE = re.compile(r"[A-Za-z0-9][A-Za-z0-9._+!-]{0,199}\.whl|SHA256SUMS(\.sig)?")
"""Names of the files of a release that an update takes."""
SUM_LINE = re.compile(r"([0-9a-f]{64})  ([A-Za-z0-9][A-Za-z0-9._+!-]{0,199})")
OPENSSL_SECONDS = 60.0


@dataclass(frozen=True, slots=True)
class Release:
    """Version, folder and wheel of a release."""

    version: str
    folder: Path
    wheel: Path


def read_release(path: Path) -> Release:
    """Return the release in this folder, or that of this wheel. Raise SetupError where it is not one."""
    wheels = [path] if path.suffix == ".whl" and path.is_file() else sorted(path.glob("mucat-*.whl"))
    if not path.exists():
        raise SetupError(f"There is no {path}. Name a wheel of mucat, or the folder of a release.")
    if len(wheels) != 1 or not (match := WHEEL.fullmatch(wheels[0].name)):
        names = ", ".join(wheel.name for wheel in wheels) or "none"
        raise SetupError(f"{path} must hold one wheel mucat-VERSION-py3-none-any.whl; it has {names}.")
    return Release(match[1], wheels[0].parent, wheels[0])


def check_signature(release: Release, key: Path) -> None:
    """Check the signature and every checksum with this public key. Raise SetupError in one line."""
    folder = release.folder
    if not key.exists():
        raise SetupError(
            f"There is no key {key}, with which a release must be signed. See docs/run/update.md."
        )
    for name in (SUMS, SIGNATURE):
        if not (folder / name).is_file():
            raise SetupError(f"The release is not signed: {folder / name} is missing.")
    command = ["openssl", "pkeyutl", "-verify", "-pubin", "-inkey", str(key), "-rawin"]
    command += ["-in", str(folder / SUMS), "-sigfile", str(folder / SIGNATURE)]
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, timeout=OPENSSL_SECONDS, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as problem:
        raise SetupError(f"The signature cannot be checked: {problem}. Install openssl.") from problem
    if done.returncode != 0:
        raise SetupError(f"The signature of {folder / SUMS} is wrong: it was not made with the key of {key}.")
    check_sums(release)


def check_sums(release: Release) -> None:
    """Check the checksum of every file that pip may take. Raise SetupError."""
    try:
        text = (release.folder / SUMS).read_text(encoding="ascii")
    except (OSError, UnicodeDecodeError) as problem:
        raise SetupError(f"{release.folder / SUMS} cannot be read: {problem}.") from problem
    sums = {match[2]: match[1] for line in text.splitlines() if (match := SUM_LINE.fullmatch(line))}
    # Besides the listed wheels nothing may lie there that pip would take instead.
    present = {file.name for file in release.folder.iterdir() if file.suffix in (".whl", ".gz", ".zip")}
    present.discard(f"{release.folder.name}.zip")
    if unlisted := sorted(present - sums.keys()):
        raise SetupError(f"{release.folder} has {unlisted[0]}, which is not among its checksums. Remove it.")
    if release.wheel.name not in sums:
        raise SetupError(f"{release.wheel.name} is not among the checksums of {release.folder / SUMS}.")
    for name, expected in sums.items():
        file = release.folder / name
        if not file.is_file():
            raise SetupError(f"The release is not whole: {name} is missing. Copy it again.")
        if _sum(file) != expected:
            raise SetupError(f"{name} is damaged: its checksum differs. Copy the release again.")


def _sum(file: Path) -> str:
    with file.open("rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()
