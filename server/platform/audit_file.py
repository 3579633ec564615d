"""The audit log's files: each act as a JSON document on a line; files are only appended to.

It is no part of the database, so that restoring a backup takes nothing from it, and so that a command in a
shell writes it beside a running server.
"""

import json
import logging
import os
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from heapq import merge
from pathlib import Path
from typing import Literal, get_args

import click
from click.exceptions import Exit

from robot_runtime.durable_files import make_folder, sync

log = logging.getLogger(__name__)

Outcome = Literal["done", "refused", "failed", "begun"]
"""The end of an act; "begun" is the start of a shell's command, whose end is another entry. One that was
killed has none."""
FILE_BYTES = 512 * 1024
"""Size from which on a new file is begun."""
Series = Literal["", "access", "arming", "deletion", "shell"]
"""A kind of entries with files of their own, named after it: others push none of them out. "" is the rest."""
FILES_MOST: Mapping[Series, int] = {"": 8, "access": 4, "arming": 4, "deletion": 4, "shell": 4}
"""The greatest number of files; the oldest is removed when one more is begun."""
TEXT_MAX = 400
WRITTEN = "mucat.audit"
"""Entry of a command's context that says that it is in the log already."""
SHELL_NAME = "the shell of this computer"


@dataclass(frozen=True, slots=True)
class AuditEntry:
    """One act. `time` in s since 1970; `who`, `role` and `address` are empty where nobody was signed in or
    no network was used. `device` is the number of the browser or program, 0 the shell, None nobody.

    `count` is more than 1 where so many of the same kind follow one another too fast to be listed.
    """

    time: float
    who: str
    device: int | None
    role: str
    address: str
    action: str
    about: str
    outcome: Outcome
    count: int = 1


def append_entries(folder: Path, entries: Iterable[AuditEntry], series: Series = "") -> None:
    """Append entries of one series durably, each whole or not at all. Raise OSError."""
    lines = "".join(json.dumps(asdict(entry), ensure_ascii=False) + "\n" for entry in entries)
    make_folder(folder)
    path = _current(folder, series)
    handle = os.open(path, os.O_RDWR | os.O_APPEND | os.O_CREAT, 0o600)
    try:
        size = os.fstat(handle).st_size
        # A power cut or a full disk may have cut the last line off.
        torn = size > 0 and os.pread(handle, 1, size - 1) != b"\n"
        data = ("\n" * torn + lines).encode(errors="replace")
        if os.write(handle, data) != len(data):
            os.ftruncate(handle, size)
            raise OSError("the disk is full")
        os.fsync(handle)
    finally:
        os.close(handle)
    if size == 0:
        sync(folder)


def append_shell_command(folder: Path) -> None:
    """Append the running command of the shell, if any. Raise OSError."""
    context = click.get_current_context(silent=True)
    if context is None or context.meta.get(WRITTEN) or not folder.parent.is_dir():
        return
    context.meta[WRITTEN] = True
    named = {name: str(value) for name, value in context.params.items() if value not in (None, (), False)}
    about = json.dumps(named, ensure_ascii=False)
    append_entries(folder, [_shell_entry(context.command_path, about, "begun")], "shell")
    context.with_resource(_append_end(folder, context.command_path, about))


@contextmanager
def _append_end(folder: Path, action: str, about: str) -> Iterator[None]:
    """Append the end of the command. Processes that it has forked are not awaited."""
    process = os.getpid()
    outcome: Outcome = "failed"
    try:
        yield
        outcome = "done"
    except Exit as end:
        outcome = "done" if end.exit_code == 0 else "failed"
        raise
    except click.ClickException as problem:
        about = f"{problem.format_message()} {about}"
        raise
    finally:
        if os.getpid() == process:
            try:
                append_entries(folder, [_shell_entry(action, about, outcome)], "shell")
            except OSError as problem:
                log.warning("the audit log does not say how this command ended: %s", problem)


def read_entries(folder: Path) -> Iterator[AuditEntry]:
    """Return all entries, newest first. A line that was cut off is left out. Raise OSError."""
    every = (_read_series(folder, series) for series in FILES_MOST)
    return merge(*every, key=lambda entry: entry.time, reverse=True)


def _read_series(folder: Path, series: Series) -> Iterator[AuditEntry]:
    for path in reversed(_files(folder, series)):
        for line in reversed(path.read_text(encoding="utf-8", errors="replace").splitlines()):
            try:
                entry = AuditEntry(**json.loads(line))
            except (ValueError, TypeError):
                continue
            if entry.outcome in get_args(Outcome):
                yield entry


def clean(text: str) -> str:
    """Return a text, shortened, without control characters of a terminal and marks of writing direction."""
    shown = "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in text)
    return shown if len(shown) <= TEXT_MAX else shown[:TEXT_MAX] + "…"


def _shell_entry(action: str, about: str, outcome: Outcome) -> AuditEntry:
    return AuditEntry(time.time(), SHELL_NAME, 0, "operator", "", action, clean(about), outcome)


def _files(folder: Path, series: Series) -> list[Path]:
    return sorted(folder.glob(f"{series}[0-9]*.jsonl")) if folder.is_dir() else []


def _current(folder: Path, series: Series) -> Path:
    files = _files(folder, series)
    if files and files[-1].stat().st_size < FILE_BYTES:
        return files[-1]
    most = FILES_MOST[series]
    for old in files[: 1 - most] if len(files) >= most else ():
        old.unlink(missing_ok=True)
    number = int(files[-1].stem.removeprefix(series)) + 1 if files else 1
    return folder / f"{series}{number:08}.jsonl"
