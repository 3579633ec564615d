"""Weighs a process, and says whether it grows.

Memory in use is what the allocators of Python and of the C library have given out: where something is not
freed, it rises by that. Anonymous memory is what the system has given to the process. It includes what no
allocator knows, such as the stacks of threads; but where the allocators find no room for a large block among
the small free ones, it rises by up to 2 MB at once, without any more in use.
"""

import ctypes
import gc
import os
import re
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import linear_regression

IN_USE, ANONYMOUS = "memory in use", "anonymous memory"
KINDS = (IN_USE, ANONYMOUS)
STANDARD_ERROR = 2


@dataclass(frozen=True, slots=True)
class Limit:
    """The rise of a process's memory that is allowed once it is warm."""

    warm: int
    """minutes"""
    noise: float
    """MB; that of the allocators, or of what is just being worked on"""
    rate: float
    """MB a minute; what a day on a Raspberry Pi Zero with 512 MB bears"""

    def judge(self, kind: str, held: Sequence[float]) -> str:
        """Return the fault in the MB after each minute, in words; empty where there is none."""
        after = held[self.warm :]
        if len(after) < 2:
            return f"{kind}: {len(held)} minutes do not show whether it grows; {self.warm} warm it"
        rise = linear_regression(range(len(after)), after).slope * len(after)
        most = self.noise + self.rate * len(after)
        if rise <= most:
            return ""
        return f"{kind} rose by {rise:.2f} MB in {len(after)} minutes; the limit is {most:.2f} MB"


def judge(limits: Mapping[str, Limit], held: Mapping[str, Sequence[float]]) -> str:
    """Return the faults in the MB of each kind after each minute, in words; empty where there is none."""
    return "; ".join(filter(None, (limits[kind].judge(kind, held[kind]) for kind in KINDS)))


def anonymous(pid: int | str = "self") -> int:
    """Bytes of memory of a process without a file behind it."""
    lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    (size,) = (int(line.split()[1]) for line in lines if line.startswith("Anonymous:"))
    return 1024 * size


class Scales:
    """Weighs this process; `held` has the MB of each kind."""

    def __init__(self) -> None:
        self.held: dict[str, list[float]] = {kind: [] for kind in KINDS}
        self._libc = ctypes.CDLL(None)
        self._libc.mallinfo2.restype = _Mallinfo

    def weigh(self) -> None:
        """Note what is held now, without what is only not yet freed."""
        gc.collect()
        self._libc.malloc_trim(0)
        for kind, size in ((IN_USE, self._in_use()), (ANONYMOUS, anonymous())):
            self.held[kind].append(round(size / 1e6, 3))

    def _in_use(self) -> int:
        """Bytes that Python's allocator and the C library's have given out."""
        info: _Mallinfo = self._libc.mallinfo2()
        return _in_python_blocks() + info.uordblks + info.hblkhd


class _Mallinfo(ctypes.Structure):
    """`struct mallinfo2` of the C library: `uordblks` are bytes in use, `hblkhd` those in mappings."""

    _fields_ = (
        *((name, ctypes.c_size_t) for name in ("arena", "ordblks", "smblks", "hblks", "hblkhd")),
        *((name, ctypes.c_size_t) for name in ("usmblks", "fsmblks", "uordblks", "fordblks", "keepcost")),
    )
    hblkhd: int
    uordblks: int


def _in_python_blocks() -> int:
    """Bytes of Python's small objects, which its own allocator gives out; Python only prints them."""
    with tempfile.TemporaryFile() as file:
        stored = os.dup(STANDARD_ERROR)
        try:
            os.dup2(file.fileno(), STANDARD_ERROR)
            sys._debugmallocstats()
        finally:
            os.dup2(stored, STANDARD_ERROR)
            os.close(stored)
        file.seek(0)
        (size,) = re.findall(rb"# bytes in allocated blocks\s+=\s+([\d,]+)", file.read())
    return int(size.replace(b",", b""))
