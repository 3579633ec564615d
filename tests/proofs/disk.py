"""A program's file operations, step by step, and the possible disks after a power cut.

`tests/proofs/disk_log.c`, preloaded, writes the steps down. Synced bytes and names stay. Of what was not
synced anything may be there or not, in any order: whole writes, or only some of their sectors; a name without
its file's bytes, or the bytes without the name.
"""

import json
import os
import random
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from struct import Struct
from typing import Any, Literal, TypeVar

T = TypeVar("T")
SOURCE = Path(__file__).with_name("disk_log.c")
SECTORS = (512, 4096)
HEAD = Struct("<IIiIQQc7x")
SIZE_BYTES = 4
"""The size itself, which a record's size does not count."""

Cut = Literal["dropped", "kept", "in order", "reordered", "torn", "spoiled"]
"""What becomes of what was not synced: nothing of it is there; all; the first of it, file by file; some of
it; some of its sectors; the same, and some of the sectors that were to be written hold anything."""


def build(folder: Path) -> Path:
    """Compile the preloaded library."""
    library = folder / "disk_log.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O2", "-o", str(library), str(SOURCE), "-ldl"], check=True)
    return library


def logging(library: Path, folder: Path, log: Path) -> dict[str, str]:
    """Return the environment that records a program's file operations below `folder`."""
    names = {"LD_PRELOAD": str(library), "DISK_LOG_FOLDER": str(folder), "DISK_LOG": str(log)}
    return os.environ | names


@dataclass(frozen=True, slots=True)
class DiskStep:
    """Kinds: c created, t truncated to `offset`, w written at `offset`, s synced, r renamed, l linked,
    u unlinked, m made a folder, a acknowledged. `node` is the file's or folder's inode.
    """

    kind: str
    process: int
    handle: int
    node: int
    offset: int
    name: str
    data: bytes


def note(log: Path, demands: dict[str, list[Any] | None]) -> None:
    """Record the facts that must be on the disk from now on, each with its allowed values; None: any."""
    data = json.dumps(demands).encode()
    head = HEAD.pack(HEAD.size - SIZE_BYTES + len(data), os.getpid(), -1, 0, 0, 0, b"a")
    handle = os.open(log, os.O_WRONLY | os.O_APPEND)
    os.write(handle, head + data)
    os.close(handle)


def read(log: Path) -> Iterator[DiskStep]:
    """Yield all records, in order."""
    text = log.read_bytes()
    at = 0
    while at < len(text):
        size, process, handle, first, node, offset, kind = HEAD.unpack_from(text, at)
        begin = at + HEAD.size
        at += SIZE_BYTES + size
        name = os.fsdecode(text[begin : begin + first])
        yield DiskStep(kind.decode(), process, handle, node, offset, name, text[begin + first : at])


@dataclass
class File:
    """A file's synced content, and its changes since: offset and bytes, or size."""

    synced: bytearray = field(default_factory=bytearray)
    pending: list[tuple[int, bytes | None]] = field(default_factory=list)

    def sync(self) -> None:
        for offset, data in self.pending:
            _apply(self.synced, offset, data)
        self.pending.clear()


class LoggedDisk:
    """The files below a folder after some of the steps."""

    def __init__(self, folder: Path) -> None:
        self.files: list[File] = []
        self._nodes: dict[int, int] = {}
        self._folders = {folder.stat().st_ino: str(folder)}
        self._synced: dict[str, int | None] = {str(folder): None}
        self._pending: dict[str, list[dict[str, int | None]]] = {}
        self._now: dict[str, int | None] = dict(self._synced)

    def take(self, step: DiskStep) -> None:
        """Apply a step."""
        if step.kind == "w":
            self._file(step).pending.append((step.offset, step.data))
        elif step.kind == "t":
            self._file(step).pending.append((step.offset, None))
        elif step.kind == "s":
            self._sync(step)
        elif step.kind == "c":
            self._nodes[step.node] = len(self.files)
            self.files.append(File())
            self._rename(step.name, {step.name: self._nodes[step.node]})
        elif step.kind == "m":
            self._folders[step.node] = step.name
            self._rename(step.name, {step.name: None})
        elif step.kind == "u":
            self._rename(step.name, {step.name: -1})
        elif step.kind in "rl":
            to = os.fsdecode(step.data)
            gone = {step.name: -1} if step.kind == "r" else {}
            self._rename(to, {**gone, to: self._now[step.name]})

    def _file(self, step: DiskStep) -> File:
        return self.files[self._nodes[step.node]]

    def _rename(self, name: str, names: dict[str, int | None]) -> None:
        self._now |= names
        self._pending.setdefault(os.path.dirname(name), []).append(names)  # noqa: PTH120 - a text

    def _sync(self, step: DiskStep) -> None:
        if step.node in self._folders:
            for names in self._pending.pop(self._folders[step.node], []):
                self._synced |= names
        else:
            self._file(step).sync()

    def after(self, cut: Cut, chance: random.Random) -> dict[str, bytearray]:
        """Return the files, by name, that the next start may find."""
        names = dict(self._synced)
        for changes in self._pending.values():
            for change in _some(changes, cut, chance):
                names |= change
        results = {
            name: number
            for name, number in names.items()
            if number is not None and number >= 0 and _is_there(name, names)
        }
        sector = chance.choice(SECTORS)
        return {
            name: self._content(self.files[number], cut, sector, chance) for name, number in results.items()
        }

    def _content(self, file: File, cut: Cut, sector: int, chance: random.Random) -> bytearray:
        content = bytearray(file.synced)
        if cut in ("torn", "spoiled"):
            for offset, data in file.pending:
                _tear(content, offset, data, sector, chance)
            if cut == "spoiled":
                _spoil(content, file.pending, sector, chance)
        else:
            for offset, data in _some(file.pending, cut, chance):
                _apply(content, offset, data)
        return content


def _some(all_: list[T], cut: Cut, chance: random.Random) -> list[T]:
    if cut == "dropped":
        return []
    if cut == "kept":
        return all_
    if cut == "in order":
        return all_[: chance.randint(0, len(all_))]
    share = chance.random()
    return [candidate for candidate in all_ if chance.random() < share]


def _is_there(name: str, names: dict[str, int | None]) -> bool:
    """Return True if all its folders exist; the first always exists."""
    folder = os.path.dirname(name)  # noqa: PTH120 - a text
    first = next(iter(names))
    while len(folder) > len(first):
        if folder not in names:
            return False
        folder = os.path.dirname(folder)  # noqa: PTH120
    return True


def _apply(content: bytearray, offset: int, data: bytes | None) -> None:
    if data is None:
        del content[offset:]
    content.extend(bytes(max(offset - len(content), 0)))
    if data is not None:
        content[offset : offset + len(data)] = data


def _tear(content: bytearray, offset: int, data: bytes | None, sector: int, chance: random.Random) -> None:
    if data is None:
        if chance.random() < 0.5:
            _apply(content, offset, None)
        return
    at = 0
    while at < len(data):
        size = min(sector - (offset + at) % sector, len(data) - at)
        if chance.random() < 0.5:
            _apply(content, offset + at, data[at : at + size])
        at += size


def _spoil(
    content: bytearray, pending: list[tuple[int, bytes | None]], sector: int, chance: random.Random
) -> None:
    """Each sector being written may hold anything, even where it held data before."""
    for offset, data in pending:
        for at in range(offset // sector * sector, offset + len(data or b""), sector):
            if at < len(content) and chance.random() < 0.25:
                end = min(at + sector, len(content))
                content[at:end] = chance.randbytes(end - at)
