"""`python -m tests.proofs.debian`: the Debian package on a computer with systemd.

From nothing to an armed robot; a data folder of an earlier version; an update, refused while it records; the
way back; removal and purge. Prints a line for each step; status 1 where one does not end as it must.
"""

import shutil
import sys
import tempfile
import time
from pathlib import Path

from packages.debian_package import build_debian_package
from packages.release import build_release
from packages.signing import sign_folder
from server import VERSION
from tests.proofs.container import SYSTEMS, SystemdContainer
from tests.proofs.services import LATER, TARGETS, raise_version
from tests.proofs.steps import Steps, ask_server
from tests.released import DATA, RELEASED

SYSTEM = SYSTEMS[0]
FIRST, SECOND = "first.deb", "second.deb"
ARM = """
ask(data, "POST", "/control/take?over=true")
ask(data, "POST", "/robot/commands/arm", {"unwatched": 0})
"""
STOP = """
ask(data, "POST", "/robot/stop")
"""
TAKE_OVER = (
    "systemctl stop mucat mucat-runtime && rm -rf /var/lib/mucat/*"
    " && tar -xzf /releases/{archive} -C /var/lib/mucat"
    " && chown -R mucat:mucat /var/lib/mucat && systemctl start mucat-runtime mucat"
)
"""Puts the data folder of an earlier version in place of the present one."""
TRACES = (
    "find / /run -xdev -iname '*mucat*' -not -path '/releases/*';"
    " getent passwd mucat; getent group mucat; true"
)


def main() -> int:
    """Return 1 where a step failed."""
    with tempfile.TemporaryDirectory() as name:
        packages = Path(name)
        packages.chmod(0o755)
        make_packages(packages)
        with SystemdContainer(SYSTEM, packages) as container:
            return 1 if try_all(container) else 0


def make_packages(folder: Path) -> None:
    """Build the package of this version and that of a later one, signed with one key; add the old data."""
    machine, python = TARGETS[SYSTEM.architecture]
    key = folder / "key.pem"
    release = build_release(key, machine, python, folder / "dist")
    build_debian_package(release, machine, python).rename(folder / FIRST)
    raise_version(next(release.glob("mucat-*.whl")), LATER, {})
    sign_folder(release, key)
    build_debian_package(release, machine, python).rename(folder / SECOND)
    for archive in RELEASED.glob(f"*/{DATA}"):
        shutil.copy(archive, folder / f"{archive.parent.name}-{DATA}")


def try_all(container: SystemdContainer) -> int:
    """Return the number of steps that did not end as they must."""
    steps = Steps(container)
    began = time.monotonic()
    steps.take("install", f"dpkg -i /releases/{FIRST}", f"µ-CAT {VERSION} runs")
    steps.wait("it is armed", lambda: container.order(ask_server(ARM))[0] == 0)
    print(f"     {time.monotonic() - began:.0f} s from nothing to an armed robot", flush=True)
    for name, order in (
        ("remove", "dpkg -r mucat"),
        ("purge", "dpkg -P mucat"),
        ("uninstall", "mucat uninstall"),
    ):
        steps.take(f"{name} the armed robot", order, "The robot is armed", status=1)
    steps.runs(VERSION)
    steps.take("disarm", ask_server(STOP), "")
    steps.runs(VERSION)
    take_over_data(steps)
    steps.take("record", "mucat record start pool", "has begun")
    steps.take("update while it records", f"dpkg -i /releases/{SECOND}", "is being recorded", status=1)
    steps.runs(VERSION)
    steps.take("end the recording", "mucat record stop", "has ended")
    steps.take("go on", "dpkg --configure -a", f"µ-CAT {LATER} is in use")
    steps.runs(LATER)
    steps.take("roll back", "mucat rollback", f"µ-CAT {VERSION} is in use")
    steps.runs(VERSION)
    steps.take("update again", f"dpkg -i /releases/{SECOND}", f"µ-CAT {LATER} is in use")
    steps.runs(LATER)
    steps.take("remove", "dpkg -r mucat", "stay")
    steps.take("the data stay", "ls /var/lib/mucat/mucat.db; ls /opt/mucat 2>&1 || true", "No such file")
    steps.take("install again", f"dpkg -i /releases/{SECOND}", f"µ-CAT {LATER} runs")
    steps.take("the recording is there", "mucat sessions list", "pool")
    steps.take("purge", "dpkg -P mucat", "")
    traces = container.order(TRACES)[1]
    steps.check(f"nothing is left: {traces.split() or 'nothing'}", not traces.strip())
    return steps.failed


def take_over_data(steps: Steps) -> None:
    """Put the data folder of each earlier version in place of the present one."""
    for archive in sorted(RELEASED.glob(f"*/{DATA}")):
        version = archive.parent.name
        steps.take(f"data of {version}", TAKE_OVER.format(archive=f"{version}-{DATA}"), "")
        steps.runs(VERSION)
        steps.take("its session is there", "mucat sessions list", "A session of a release")
        steps.take("and exported", "mucat export 1 --format csv -o /var/lib/mucat/dive.zip", "")


if __name__ == "__main__":
    sys.exit(main())
