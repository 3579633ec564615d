"""`python -m tests.proofs.services`: install, update, roll back and uninstall on a computer with systemd.

Three signed releases: of this version, a later one, and one whose server does not start. The power is cut
after the switch to that one. Prints a line for each step; status 1 where one does not end as it must.
"""

import re
import shutil
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable
from pathlib import Path

from packages.release import build_release
from packages.signing import make_key, sign_folder, write_public_key
from server import VERSION
from tests.proofs.container import Container

LATER, BROKEN = "98.0.0", "99.0.0"
BREAK = 'raise SystemExit("This release does not work.")\n'
PATIENCE = 90.0
SEND = """
send_file(data, "/update/release", Path("/releases/{name}"), 60.0)
print(ask(data, "POST", "/update")["phase"])
"""
"""What the System page does: it sends a release, and begins the update."""
WATCH = """
print(ask(data, "GET", "/update")["text"])
"""


class Steps:
    """The steps, each with what it must print or leave."""

    def __init__(self, container: Container) -> None:
        self._container = container
        self.failed = 0

    def take(self, name: str, words: str, wanted: str, *, status: int = 0) -> None:
        """Run a line of shell, which must end with this status and print what matches."""
        began = time.monotonic()
        found, said = self._container.order(words)
        good = found == status and re.search(wanted, said) is not None
        self._tell(name, good, time.monotonic() - began, said)

    def wait(self, name: str, condition: Callable[[], bool]) -> None:
        """Wait until something is so."""
        began = time.monotonic()
        while not (good := condition()) and time.monotonic() - began < PATIENCE:
            time.sleep(0.2)
        self._tell(name, good, time.monotonic() - began, "it did not come")

    def _tell(self, name: str, good: bool, seconds: float, said: str) -> None:
        self.failed += not good
        last = "" if good else "\n" + said[-2000:]
        print(f"{'good' if good else 'BAD '} {name} ({seconds:.0f} s){last}", flush=True)

    def runs(self, version: str) -> None:
        """Both services of this version must run, and the server say that it is well."""
        self.wait(f"{version} runs", lambda: self._is_well(version))

    def _is_well(self, version: str) -> bool:
        question = (
            "MUCAT_DATA=/var/lib/mucat MUCAT_CONFIG=/etc/mucat/robot.toml runuser -u mucat --"
            " /opt/mucat/current/bin/python -I -m server.features.installation.survey"
        )
        said = self._container.order(question)[1]
        return f'"running": "{version}", "problem": ""' in said


def main() -> int:
    """Run all steps; returns 1 where one failed."""
    with tempfile.TemporaryDirectory() as name:
        releases = Path(name)
        # The user of the data sends one.
        releases.chmod(0o755)
        make_releases(releases)
        with Container(releases) as container:
            return 1 if try_all(container) else 0


def try_all(container: Container) -> int:
    """The number of steps that did not end as they must."""
    steps = Steps(container)
    current = container.root / "opt/mucat/current"
    steps.take("install", "sh /releases/first/install.sh --yes", f"µ-CAT {VERSION} runs")
    steps.runs(VERSION)
    steps.take("record", "mucat record start pool", "has begun")
    steps.take("update while it records", f"mucat update /releases/{LATER}", "is being recorded", status=1)
    steps.take("end the recording", "mucat record stop", "has ended")
    for unit in ("mucat.service", "mucat-runtime.service"):
        steps.take(f"kill {unit}", f"systemctl kill -s KILL {unit}", "")
        steps.runs(VERSION)
    steps.take("a cut ZIP file", "mucat update /releases/cut.zip", "no whole ZIP file", status=1)
    steps.take("another's signature", "mucat update /releases/other", "signature .* is wrong", status=1)
    steps.take("update", f"mucat update /releases/{LATER}.zip", f"µ-CAT {LATER} is in use")
    steps.runs(LATER)
    steps.take("the recording is there", "mucat sessions list", "pool")
    steps.take("roll back", "mucat rollback", f"µ-CAT {VERSION} is in use")
    steps.runs(VERSION)
    steps.take("send a cut release as the page does", ask_server(SEND.format(name="cut.zip")), "asked")
    steps.wait("it is refused", lambda: tells(container, "no whole ZIP file"))
    steps.runs(VERSION)
    steps.take("update as the page does", ask_server(SEND.format(name=f"{LATER}.zip")), "asked")
    steps.wait("the page tells its end", lambda: tells(container, f"µ-CAT {LATER} is in use."))
    steps.runs(LATER)
    again = f"{LATER} is in use again"
    steps.take("an update that does not work", f"mucat update /releases/{BROKEN}", again, status=1)
    steps.runs(LATER)
    begin = f"systemd-run --unit=update --collect mucat update /releases/{BROKEN}"
    steps.take("begin it once more", begin, "")
    steps.wait("it has switched", lambda: current.is_symlink() and current.readlink().name == BROKEN)
    container.cut_power()
    print("     the power is cut")
    container.start()
    steps.runs(LATER)
    steps.take("roll back", "mucat rollback", f"µ-CAT {VERSION} is in use")
    steps.take("uninstall", "mucat uninstall", "stay")
    steps.take("the data stay", "ls /var/lib/mucat/mucat.db; ls /opt/mucat 2>&1 || true", "No such file")
    return steps.failed


def tells(container: Container, words: str) -> bool:
    """True once the page would show these words of the update."""
    return words in container.order(ask_server(WATCH))[1]


def ask_server(program: str) -> str:
    """The line of shell by which the user of the data runs these requests to the server."""
    head = (
        "from pathlib import Path; from server.platform.running_server import ask, send_file;"
        ' from server.platform.settings import DataFolder; data = DataFolder(Path("/var/lib/mucat"))'
    )
    return f"runuser -u mucat -- /opt/mucat/current/bin/python -I -c '{head}{program}'"


def make_releases(folder: Path) -> None:
    """Build the releases, all signed with one key but "other"."""
    key = folder / "key.pem"
    built = build_release(key, "x86_64", "3.11", folder / "dist")
    first = folder / "first"
    built.rename(first)
    for version, break_it in ((LATER, False), (BROKEN, True)):
        release = folder / version
        shutil.copytree(first, release)
        wheel = next(release.glob("mucat-*.whl"))
        raise_version(wheel, version, break_it=break_it)
        sign_folder(release, key)
    shutil.make_archive(str(folder / LATER), "zip", folder / LATER)
    (folder / "cut.zip").write_bytes((folder / f"{LATER}.zip").read_bytes()[:-1000])
    shutil.copytree(folder / LATER, folder / "other")
    make_key(folder / "other.pem")
    sign_folder(folder / "other", folder / "other.pem")
    write_public_key(folder / "other.pem", folder / "other/release.pem")


def raise_version(wheel: Path, version: str, *, break_it: bool) -> None:
    """Make another version of a wheel of mucat."""
    goal = wheel.with_name(f"mucat-{version}-py3-none-any.whl")
    with zipfile.ZipFile(wheel) as source, zipfile.ZipFile(goal, "w", zipfile.ZIP_DEFLATED) as copy:
        for name in source.namelist():
            data = source.read(name)
            if name == "server/__init__.py" or ".dist-info/" in name:
                data = data.replace(VERSION.encode(), version.encode())
            if break_it and name == "server/startup.py":
                data = BREAK.encode()
            copy.writestr(name.replace(f"mucat-{VERSION}", f"mucat-{version}"), data)
    wheel.unlink()


if __name__ == "__main__":
    sys.exit(main())
