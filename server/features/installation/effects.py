"""Everything that an installation or an update changes goes through here: said, done, and repeatable.

Each effect is whole or not at all, so that after a power cut between any two of them the same work can be
done again. `before` is called with the words of each effect: tests cut the power there.
"""

import os
import shutil
import subprocess
import zipfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from re import Pattern

from robot_runtime.durable_files import PART, make_folder, sync, write_whole
from server.platform.disk_space import explain_write_error
from server.platform.settings import SetupError

WORDS_SHOWN = 300
DAMAGED = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError)
"""Errors of zipfile for an archive that is not whole."""
Run = Callable[[Sequence[str], Mapping[str, str], float], "subprocess.CompletedProcess[str]"]
"""Runs a command with these additions to its environment, for so many s at most."""


class CommandFailedError(SetupError):
    """A command has failed; its last words are in the text."""


def run_command(
    command: Sequence[str], environment: Mapping[str, str], seconds: float
) -> "subprocess.CompletedProcess[str]":
    """Run a command of this computer, its output taken. Raises OSError, TimeoutExpired."""
    return subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        errors="replace",
        env={name: text for name, text in os.environ.items() if name != "PYTHONPATH"} | dict(environment),
        timeout=seconds,
        check=False,
    )


class Effects:
    """Does what is to be done, and says it; in a dry run it only says it. All raise SetupError."""

    def __init__(
        self,
        say: Callable[[str], None],
        *,
        dry: bool = False,
        run: Run = run_command,
        before: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._say = say
        self.dry = dry
        self._run = run
        self._before = before

    def say(self, words: str) -> None:
        """Say it; a terminal that is gone, as that of a lost ssh session, ends nothing."""
        with suppress(OSError):
            self._say(words)

    def _begin(self, words: str) -> bool:
        """Say it; returns True where it is to be done."""
        self.say(f"would {words}" if self.dry else words)
        if not self.dry:
            self._before(words)
        return not self.dry

    def run(
        self,
        *command: str | Path,
        environment: Mapping[str, str] | None = None,
        seconds: float = 120.0,
        quiet: bool = False,
        accepted: Sequence[int] = (0,),
    ) -> str:
        """Run a command; returns its output. `quiet`: it changes nothing, and is run in a dry run too.

        An exit status that is not among the `accepted` ones raises CommandFailedError.
        """
        words = [str(one) for one in command]
        if not quiet and not self._begin("run " + " ".join(words)):
            return ""
        try:
            done = self._run(words, environment or {}, seconds)
        except FileNotFoundError as problem:
            raise CommandFailedError(f"There is no program {words[0]}: install it with apt.") from problem
        except (OSError, subprocess.TimeoutExpired) as problem:
            raise CommandFailedError(f"{words[0]} could not be run: {problem}.") from problem
        if done.returncode not in accepted:
            last = " ".join((done.stderr.strip() or done.stdout.strip()).split())[-WORDS_SHOWN:]
            raise CommandFailedError(f"{Path(words[0]).name} failed ({done.returncode}): {last}")
        return done.stdout

    def write(self, path: Path, text: str, mode: int = 0o644) -> bool:
        """Write a file that everybody may read; returns True if it was not so before."""
        if path.exists() and path.read_text(encoding="utf-8") == text:
            return False
        if self._begin(f"write {path}"):
            try:
                make_folder(path.parent)
                path.parent.chmod(0o755)
                write_whole(path, text.encode())
                path.chmod(mode)
            except OSError as problem:
                raise SetupError(explain_write_error(problem, path)) from problem
        return True

    def link(self, path: Path, target: Path) -> bool:
        """Make a link lead to the target, in one step; returns True if it did not before."""
        if path.is_symlink() and path.readlink() == target:
            return False
        if self._begin(f"link {path} to {target}"):
            part = path.with_name(path.name + PART)
            try:
                make_folder(path.parent)
                part.unlink(missing_ok=True)
                part.symlink_to(target)
                part.rename(path)
                sync(path.parent)
            except OSError as problem:
                raise SetupError(explain_write_error(problem, path)) from problem
        return True

    def gather(self, files: Sequence[Path], folder: Path) -> None:
        """Put the files into a folder: as further names where they are on the same disk, else as copies."""
        if not self._begin(f"put {len(files)} files into {folder}"):
            return
        try:
            make_folder(folder)
            for file in files:
                place = folder / file.name
                place.unlink(missing_ok=True)
                try:
                    place.hardlink_to(file)
                except OSError:
                    shutil.copyfile(file, place)
        except OSError as problem:
            raise SetupError(explain_write_error(problem, folder)) from problem

    def copy(self, files: Sequence[Path], folder: Path) -> None:
        """Copy the files into a folder: nobody else can change what lies there."""
        if not self._begin(f"copy {len(files)} files into {folder}"):
            return
        try:
            make_folder(folder)
            for file in files:
                shutil.copyfile(file, folder / file.name)
        except OSError as problem:
            raise SetupError(explain_write_error(problem, folder)) from problem

    def unpack(self, archive: Path, folder: Path, names: Pattern[str], limit: int) -> None:
        """Unpack the files whose names match, of an archive that has `limit` bytes at most."""
        if not self._begin(f"unpack {archive} into {folder}"):
            return
        try:
            make_folder(folder)
            with zipfile.ZipFile(archive) as content:
                members = [one for one in content.infolist() if not one.is_dir()]
                if sum(one.file_size for one in members) > limit:
                    raise SetupError(f"{archive} unpacks to over {limit / 1e6:.0f} MB: it is no release.")
                for member in members:
                    name = member.filename.rpartition("/")[2]
                    if names.fullmatch(name):
                        _unpack_member(content, member, folder / name)
        except DAMAGED as problem:
            raise SetupError(f"{archive} is no whole ZIP file: {problem}. Copy it again.") from problem
        except OSError as problem:
            raise SetupError(explain_write_error(problem, folder)) from problem

    def sync_disk(self) -> None:
        """Flush to the disk what commands have written."""
        if self._begin("flush the disk"):
            os.sync()

    def remove(self, path: Path) -> None:
        """Remove a file, a link or a folder with all that is in it; where it is not there nothing happens."""
        if not path.is_symlink() and not path.exists():
            return
        if not self._begin(f"remove {path}"):
            return
        try:
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            else:
                path.unlink()
            sync(path.parent)
        except OSError as problem:
            raise SetupError(f"{path} cannot be removed: {problem.strerror}.") from problem


def _unpack_member(content: zipfile.ZipFile, member: zipfile.ZipInfo, path: Path) -> None:
    """Unpack as many bytes as the archive announced: zipfile refuses what has more, or another CRC."""
    with content.open(member) as packed, path.open("wb") as file:
        shutil.copyfileobj(packed, file)
