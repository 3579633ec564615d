"""All changes of an installation or an update: announced, performed, and repeatable.

Each effect is whole or not at all, so that after a power cut between any two of them the same work can be
done again. `before` is called with the text of each effect: tests cut the power there.
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
    """A command has failed; its last output is in the text."""


def run_command(
    command: Sequence[str], environment: Mapping[str, str], seconds: float
) -> "subprocess.CompletedProcess[str]":
    """Run a command of this computer, and capture its output. Raise OSError, TimeoutExpired."""
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
    """The effects, each announced and then performed; a dry run only announces them. All raise SetupError."""

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

    def say(self, text: str) -> None:
        """Print the text; a lost terminal, such as that of a closed ssh session, ends nothing."""
        with suppress(OSError):
            self._say(text)

    def _begin(self, text: str) -> bool:
        """Announce the effect; return True if it is to be performed."""
        self.say(f"would {text}" if self.dry else text)
        if not self.dry:
            self._before(text)
        return not self.dry

    def run(
        self,
        *command: str | Path,
        environment: Mapping[str, str] | None = None,
        seconds: float = 120.0,
        quiet: bool = False,
        accepted: Sequence[int] = (0,),
    ) -> str:
        """Run a command; return its output. `quiet`: it changes nothing, and is run in a dry run too.

        An exit status that is not among the `accepted` ones raises CommandFailedError.
        """
        arguments = [str(argument) for argument in command]
        if not quiet and not self._begin("run " + " ".join(arguments)):
            return ""
        try:
            done = self._run(arguments, environment or {}, seconds)
        except FileNotFoundError as problem:
            raise CommandFailedError(f"There is no program {arguments[0]}: install it with apt.") from problem
        except (OSError, subprocess.TimeoutExpired) as problem:
            raise CommandFailedError(f"{arguments[0]} could not be run: {problem}.") from problem
        if done.returncode not in accepted:
            last = " ".join((done.stderr.strip() or done.stdout.strip()).split())[-WORDS_SHOWN:]
            raise CommandFailedError(f"{Path(arguments[0]).name} failed ({done.returncode}): {last}")
        return done.stdout

    def write(self, path: Path, text: str, mode: int = 0o644) -> bool:
        """Write a file that everybody may read; return True if that changed it."""
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
        """Make a link lead to the target, in one step; return True if that changed it."""
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
        """Put the files into a folder: as hard links on the same disk, else as copies."""
        if not self._begin(f"put {len(files)} files into {folder}"):
            return
        try:
            make_folder(folder)
            for file in files:
                target = folder / file.name
                target.unlink(missing_ok=True)
                try:
                    target.hardlink_to(file)
                except OSError:
                    shutil.copyfile(file, target)
        except OSError as problem:
            raise SetupError(explain_write_error(problem, folder)) from problem

    def copy(self, files: Sequence[Path], folder: Path) -> None:
        """Copy the files into a folder that nobody else can change."""
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
                members = [member for member in content.infolist() if not member.is_dir()]
                if sum(member.file_size for member in members) > limit:
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
        """Flush the output of commands to the disk."""
        if self._begin("flush the disk"):
            os.sync()

    def remove(self, path: Path) -> None:
        """Remove a file, a link or a folder with its content; a missing one is no error."""
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
    """Unpack as many bytes as the archive announced: zipfile refuses a member with more, or another CRC."""
    with content.open(member) as packed, path.open("wb") as file:
        shutil.copyfileobj(packed, file)
