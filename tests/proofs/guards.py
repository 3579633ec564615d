"""Remove each guard in turn, in a copy of the tree, and check that a test fails.

`python -m tests.proofs.guards` does so for all of `guards.toml`, or for those whose names hold one of the
words given, and prints a table; status 1 where a guard is not missed by any of its tests.
"""

import json
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree

from tests.board.rig import ROOT, build
from tests.proofs.mutations import KINDS, MutationError, mutate, replace
from tests.sources import copy_sources

LIST = Path(__file__).with_name("guards.toml")
PRELOADED = Path(__file__).with_name("preloaded.py")
TEST_SECONDS = 240
"""Time limit in s of a guard's tests; a test that hangs without the guard has failed."""


class GuardError(Exception):
    """The proof cannot be made; the text gives the reason."""


@dataclass(frozen=True)
class Guard:
    """A piece of code that guards something, and the tests that must fail without it."""

    name: str
    file: str
    mutation: tuple[str, ...]
    """In Python scope, kind and names of `mutate`; in C++ the text and its replacement."""
    tests: tuple[str, ...]
    subjects: tuple[str, ...] = ()
    """Entries of `guarded.list_guarded` that it covers."""

    def remove(self, source: str) -> str:
        """Return the source of its file without it. Raise MutationError."""
        return (mutate if self.file.endswith(".py") else replace)(source, *self.mutation)

    def problem(self, root: Path) -> str:
        """Return the reason why the guard cannot be removed there; empty where it can."""
        try:
            self.remove((root / self.file).read_text(encoding="utf-8"))
        except (MutationError, OSError) as problem:
            return f"{self.name}: {self.file}: {problem}"
        for test in self.tests:
            file, _, case = test.partition("::")
            function = case.partition("[")[0]
            if not (root / file).is_file() or f"def {function}(" not in (root / file).read_text():
                return f"{self.name}: there is no test {test}"
        return ""


@dataclass(frozen=True)
class RemovalOutcome:
    """Result of the tests: the failed ones, and those that could not start."""

    failed: tuple[str, ...]
    broken: tuple[str, ...]
    seconds: float
    words: str


class Tree:
    """A copy of the source tree from which guards are removed, and the process that runs tests in it."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self._preloaded: subprocess.Popen[str] | None = None

    def close(self) -> None:
        """End the process that runs tests."""
        if self._preloaded is not None:
            self._preloaded.communicate()

    def build_board(self) -> None:
        """Build the emulated board: objects of unchanged sources are copied."""
        (self.root / "build").mkdir()
        for name in ("emulator", "host_board"):
            if (ROOT / "build" / name).is_dir():
                shutil.copytree(ROOT / "build" / name, self.root / "build" / name)
        build(self.root / "firmware/emulator")

    def run(self, tests: Iterable[str]) -> RemovalOutcome:
        """Run these tests in the copy, up to the first that fails."""
        report, answer, started = self.root / "report.xml", self.root / "said", time.monotonic()
        # Nobody reads why a test fails here, so its assertions need not be rewritten. The native traceback
        # parses no sources: CPython's parser of them can fail where a failed test leaves a process behind.
        options = ["-q", "-x", "-p", "no:cacheprovider", "--assert=plain", "--tb=native"]
        limits = [f"--timeout={TEST_SECONDS}", f"--junitxml={report}"]
        report.unlink(missing_ok=True)
        status = self._pytest([*options, *limits, *tests], answer)
        text = answer.read_text(errors="replace")[-4000:]
        if not report.is_file() or status not in (0, 1):
            return RemovalOutcome((), ("the tests do not run",), time.monotonic() - started, text)
        results: Mapping[str, list[str]] = {"failure": [], "error": []}
        for case in ElementTree.parse(report).iter("testcase"):
            for kind, names in results.items():
                if case.find(kind) is not None:
                    names.append(case.attrib["name"])
        seconds = time.monotonic() - started
        return RemovalOutcome(tuple(results["failure"]), tuple(results["error"]), seconds, text)

    def _pytest(self, options: list[str], answer: Path) -> int:
        """Exit status of pytest in the copy, whose output goes to the file `said`."""
        if self._preloaded is None:
            # Without -P the folder of the script would be where modules are looked for.
            command = [sys.executable, "-P", str(PRELOADED)]
            self._preloaded = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
            )
        assert self._preloaded.stdin is not None
        assert self._preloaded.stdout is not None
        asked = {"folder": str(self.root), "options": options, "output": str(answer)}
        self._preloaded.stdin.write(json.dumps(asked) + "\n")
        self._preloaded.stdin.flush()
        return int(self._preloaded.stdout.readline())

    def run_without(self, guard: Guard) -> RemovalOutcome:
        """Run a guard's tests without it. Raise GuardError where it cannot be removed."""
        if problem := guard.problem(self.root):
            raise GuardError(problem)
        path = self.root / guard.file
        whole = path.read_text(encoding="utf-8")
        path.write_text(guard.remove(whole), encoding="utf-8")
        try:
            return self.run(guard.tests)
        finally:
            path.write_text(whole, encoding="utf-8")


def read_guards(path: Path = LIST) -> list[Guard]:
    """Return the guards of the list."""
    return [_read_guard(entry) for entry in tomllib.loads(path.read_text(encoding="utf-8"))["guards"]]


def _read_guard(entry: dict[str, Any]) -> Guard:
    mutation: tuple[str, ...]
    if "at" in entry:
        module, _, scope = entry["at"].partition(":")
        (kind,) = entry.keys() & KINDS.keys()
        names = entry[kind]
        file = module.replace(".", "/") + ".py"
        mutation = (scope, kind, *([names] if isinstance(names, str) else names))
    else:
        file, mutation = entry["file"], (entry["guard"], entry["without"])
    return Guard(entry["name"], file, mutation, tuple(entry["tests"]), tuple(entry.get("subjects", ())))


@contextmanager
def copy_tree() -> Iterator[Tree]:
    """Copy the files that are or would be under version control, as they are now."""
    with TemporaryDirectory(prefix="mucat-guards-") as folder:
        copy_sources(Path(folder))
        tree = Tree(Path(folder))
        try:
            yield tree
        finally:
            tree.close()


def prove(guards: list[Guard]) -> int:
    """Print the test that detects the removal of each guard; return the number of undetected ones."""
    with copy_tree() as tree:
        tree.build_board()
        whole = tree.run(sorted({test for guard in guards for test in guard.tests}))
        if whole.failed or whole.broken:
            raise GuardError(
                f"with every guard in place these fail: {whole.failed + whole.broken}\n{whole.words}"
            )
        unnoticed = 0
        for guard in guards:
            outcome = tree.run_without(guard)
            noticed = bool(outcome.failed) and not outcome.broken
            unnoticed += not noticed
            text = outcome.failed[0] if noticed else " ".join(("NOT NOTICED", *outcome.broken))
            print(f"{guard.name:<58}{outcome.seconds:>6.1f} s  {text}", flush=True)
    print(f"\n{len(guards)} guards, {unnoticed} of which nobody would miss")
    return unnoticed


def main() -> int:
    """Exit status."""
    text = sys.argv[1:]
    guards = [guard for guard in read_guards() if not text or any(word in guard.name for word in text)]
    if not guards:
        sys.exit(f"guards: no guard has one of these words in its name: {' '.join(text)}")
    if problems := [problem for guard in guards if (problem := guard.problem(ROOT))]:
        sys.exit("\n".join(problems))
    try:
        return 1 if prove(guards) else 0
    except GuardError as problem:
        sys.exit(f"guards: {problem}")


if __name__ == "__main__":
    sys.exit(main())
