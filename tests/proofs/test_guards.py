"""A short version of `make guards`: one guard is removed, and the list of guards matches the sources."""

from dataclasses import replace

import pytest

from tests.board.rig import ROOT
from tests.proofs.guarded import list_guarded
from tests.proofs.guards import Guard, GuardError, copy_tree, read_guards

ONE = "runtime: a set point has its range"


def named(name: str) -> Guard:
    return next(one for one in read_guards() if one.name == name)


@pytest.mark.parametrize("guard", read_guards(), ids=lambda guard: guard.name)
def test_every_guard_is_where_the_list_says(guard: Guard) -> None:
    assert guard.problem(ROOT) == ""
    assert guard.without != guard.guard


def test_all_that_the_tables_of_the_code_hold_is_on_the_list() -> None:
    assert {subject for guard in read_guards() for subject in guard.subjects} == list_guarded()


def test_names_are_given_once() -> None:
    names = [guard.name for guard in read_guards()]
    assert len(set(names)) == len(names)


def test_a_guard_is_missed_and_what_guards_nothing_is_not() -> None:
    guard = named(ONE)
    with copy_tree() as tree:
        assert tree.run(guard.tests).failed == ()
        outcome = tree.run_without(guard)
        assert outcome.failed
        assert not outcome.broken
        assert tree.run_without(replace(guard, without=f"{guard.guard}  # still here")).failed == ()
        with pytest.raises(GuardError, match="0 times, not once"):
            tree.run_without(replace(guard, guard="there is no such text"))
