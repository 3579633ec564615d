"""`python -m packages.image KEY`: builds the container image of the emulated robot and the lab into `dist`.

It is a Debian made by mmdebstrap with a release installed from its own wheels, as an OCI archive that podman,
Docker and others load. No registry has a part in it. Needs root, for the file system's owners.
"""

import argparse
import os
import platform
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from packages.architectures import ARCHITECTURES, PackagingError
from packages.commands import run
from packages.mirror import find_mirror
from packages.release import LAB_EXTRAS, build_release
from packages.signing import sign_downloads
from packages.sysroot import SUITE
from packages.wheels import DIST
from robot_runtime.places import BUILD
from server import VERSION

PYTHON = "3.11"
"""That of the suite."""
DEBIAN = ("python3", "python3-venv", "ca-certificates", "openssl", "avrdude")
"""avrdude uploads the communication test to the emulated board."""
TOOLS = "make image installs it"
ENVIRONMENT, DATA = "/opt/mucat", "/data"
REQUIREMENT = f"mucat[emulator,{','.join(LAB_EXTRAS)}]"
NUMBER = 999
"""Of the user and group `mucat`."""
INSTALL = f"""
set -e
groupadd --gid {NUMBER} mucat
useradd --uid {NUMBER} --gid mucat --no-create-home --home-dir {DATA} --shell /usr/sbin/nologin mucat
install -d -m 700 -o mucat -g mucat {DATA}
python3 -m venv {ENVIRONMENT}
{ENVIRONMENT}/bin/pip install --quiet --no-index --find-links /release --no-cache-dir '{REQUIREMENT}'
ln -s {ENVIRONMENT}/bin/mucat /usr/local/bin/mucat
"""
CONFIG = (
    *("--cmd", "mucat run --host 0.0.0.0"),
    *("--user", "mucat"),
    *("--env", f"MUCAT_DATA={DATA}"),
    *("--env", "PYTHONUNBUFFERED=1"),
    *("--workingdir", DATA),
    *("--port", "8000"),
    *("--stop-signal", "SIGTERM"),
)


def main() -> int:
    """Build the image. Return 1 where it cannot."""
    parser = argparse.ArgumentParser(prog="python -m packages.image", description=__doc__)
    parser.add_argument("key", type=Path, help="the secret key of the release; made where there is none")
    options = parser.parse_args()
    try:
        image = build_image(options.key, DIST)
        sign_downloads(DIST, options.key)
    except PackagingError as problem:
        print(problem, file=sys.stderr)
        return 1
    print(image)
    return 0


def build_image(secret: Path, dist: Path) -> Path:
    """Build the image for this computer's architecture. Return its path.

    Raise PackagingError.
    """
    machine = platform.machine()
    if os.geteuid() != 0:
        raise PackagingError("The image has files of several users: build it as root (sudo make image).")
    if machine not in ARCHITECTURES:
        raise PackagingError(f"There is no emulated board for {machine}, and so no image.")
    archive = dist / f"mucat-{VERSION}-{machine}.oci.tar"
    with _folder() as root:
        _make_root(root, ARCHITECTURES[machine].debian)
        release = build_release(secret, machine, PYTHON, root.with_name("release"), lab=True)
        _install(root, release)
        dist.mkdir(exist_ok=True)
        archive.unlink(missing_ok=True)
        _pack(root, archive)
    return archive


@contextmanager
def _folder() -> Iterator[Path]:
    folder = BUILD / "image"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    try:
        yield folder / "root"
    finally:
        shutil.rmtree(folder)


def _make_root(root: Path, debian: str) -> None:
    command = ["mmdebstrap", "--quiet", "--variant=minbase", f"--architectures={debian}"]
    command += [f"--include={','.join(DEBIAN)}", SUITE, str(root), f"deb {find_mirror()} {SUITE} main"]
    run(command, TOOLS)


def _install(root: Path, release: Path) -> None:
    shutil.copytree(release, root / "release")
    run(["chroot", root, "sh", "-c", INSTALL], TOOLS, "The release could not be installed")
    for waste in ("release", "var/cache/apt", "var/lib/apt/lists", "usr/share/doc", "usr/share/man"):
        shutil.rmtree(root / waste, ignore_errors=True)


def _pack(root: Path, archive: Path) -> None:
    # An archive, which keeps the owners.
    layer = root.with_suffix(".tar")
    run(["tar", "-C", root, "-cf", layer, "."], TOOLS)
    container = _buildah("from", "scratch")
    try:
        _buildah("add", "--quiet", container, str(layer), "/")
        _buildah("config", *CONFIG, "--label", f"org.opencontainers.image.version={VERSION}", container)
        _buildah(
            "commit",
            "--quiet",
            "--disable-compression=false",
            container,
            f"oci-archive:{archive}:mucat:{VERSION}",
        )
    finally:
        _buildah("rm", container)


def _buildah(*arguments: str) -> str:
    return run(["buildah", *arguments], TOOLS).strip()


if __name__ == "__main__":
    sys.exit(main())
