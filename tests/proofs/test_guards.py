"""A short version of `make guards`: a tenth of the guards is removed, and the list matches the sources.

The day chooses which tenth: its number since 1970 in UTC, modulo ten. MUCAT_GUARDS_DAY=20780 repeats a day's.
"""

import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from os import environ

import pytest

from tests.board.rig import ROOT
from tests.proofs import guards
from tests.proofs.guarded import list_guarded
from tests.proofs.guards import Guard, GuardError, Tree, copy_tree, read_guards

ONE = "runtime: a set point has its range"
DAY = int(environ.get("MUCAT_GUARDS_DAY", time.time() // 86400))
PARTS = 10
MOST = -(-len(read_guards()) // PARTS)
"""Guards of the largest tenth."""
LIMIT = 900
"""s, on a busy computer: without its guard a test may wait in vain for `guards.TEST_SECONDS`."""


def named(name: str) -> Guard:
    return next(guard for guard in read_guards() if guard.name == name)


@pytest.mark.parametrize("guard", read_guards(), ids=lambda guard: guard.name)
def test_every_guard_is_at_its_listed_place(guard: Guard) -> None:
    assert guard.problem(ROOT) == ""


def test_every_entry_of_the_code_s_tables_is_on_the_list() -> None:
    assert {subject for guard in read_guards() for subject in guard.subjects} == list_guarded()


def test_names_of_guards_are_unique() -> None:
    names = [guard.name for guard in read_guards()]
    assert len(set(names)) == len(names)


@pytest.mark.timeout(LIMIT)
def test_the_removal_of_a_guard_is_detected_and_of_unguarded_code_is_not() -> None:
    guard = named(ONE)
    with copy_tree() as tree:
        assert tree.run(guard.tests).failed == ()
        outcome = tree.run_without(guard)
        assert outcome.failed
        assert not outcome.broken
        scope, *_ = guard.mutation
        assert tree.run_without(replace(guard, mutation=(scope, "swap", "_number", "_number"))).failed == ()
        with pytest.raises(GuardError, match="0 places for never nothing, not one"):
            tree.run_without(replace(guard, mutation=(scope, "never", "nothing")))


def test_words_of_no_guard_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["guards", "no such guard"])
    with pytest.raises(SystemExit, match="no guard has one of these words in its name: no such guard"):
        guards.main()


@pytest.fixture(scope="module")
def tree() -> Iterator[Tree]:
    with copy_tree() as tree:
        tree.build_board()
        yield tree


# By number, since the names of tests must not change with the date.
@pytest.mark.timeout(LIMIT)
@pytest.mark.parametrize("number", range(MOST))
def test_the_removal_of_today_s_tenth_of_guards_is_detected(
    tree: Tree, number: int, record_property: Callable[[str, object], None]
) -> None:
    today = read_guards()[DAY % PARTS :: PARTS]
    if number == len(today):
        return
    guard, again = today[number], f"MUCAT_GUARDS_DAY={DAY} repeats it."
    record_property("guard", guard.name)
    outcome = tree.run_without(guard)
    assert not outcome.broken, f"{guard.name}: {outcome.broken}. {again}\n{outcome.words}"
    assert outcome.failed, f"without “{guard.name}” no test fails. {again}"
