from pathlib import Path

import pytest

from tests.checks.names import find_bad_names


def test_a_public_class_that_exists_twice_is_found(tmp_path: Path) -> None:
    write_module(tmp_path, "mucat/one.py", "class Watch: ...\nclass _Private: ...")
    write_module(tmp_path, "tests/two.py", "class Watch: ...\nclass _Private: ...")
    assert find_bad_names(tmp_path) == [
        "class Watch is defined 2 times, in mucat/one.py, tests/two.py; rename all but one"
    ]


@pytest.mark.parametrize(
    "source",
    ['"""What it is."""', 'class A:\n    """What it is."""', 'async def a():\n    """What it is."""'],
)
def test_a_docstring_that_is_a_riddle_is_found(tmp_path: Path, source: str) -> None:
    write_module(tmp_path, "tests/one.py", source)
    assert find_bad_names(tmp_path) == [
        "tests/one.py:1: the docstring begins with What; say what it is or does"
    ]


@pytest.mark.parametrize(
    "source",
    [
        "kept = 1",
        "for kept in (): ...",
        "def f(kept): ...",
        "def kept(): ...",
        "class Kept: ...",
        "self.kept: int = 1",
        "with open() as (kept, b): ...",
    ],
)
def test_a_name_of_the_old_dialect_is_found(tmp_path: Path, source: str) -> None:
    write_module(tmp_path, "robot_runtime/one.py", source)
    (problem,) = find_bad_names(tmp_path)
    assert problem.endswith("ept is private dialect; see the glossary")


@pytest.mark.parametrize("name", ["_told", "set_point_wanted", "WANTED"])
def test_a_part_of_a_name_counts(tmp_path: Path, name: str) -> None:
    write_module(tmp_path, "tests/one.py", f"{name} = 1")
    assert len(find_bad_names(tmp_path)) == 1


def test_the_name_of_a_test_is_a_sentence(tmp_path: Path) -> None:
    write_module(tmp_path, "tests/test_one.py", "def test_a_mission_is_kept(): ...")
    assert find_bad_names(tmp_path) == []


@pytest.mark.parametrize(
    "docstring", ["Returns it.", "Reasons against it.", "s of test time.", "`which` names it."]
)
def test_a_function_s_docstring_begins_with_an_imperative(tmp_path: Path, docstring: str) -> None:
    write_module(tmp_path, "mucat/robot.py", f'def state():\n    """{docstring}"""')
    (problem,) = find_bad_names(tmp_path)
    assert problem.startswith("mucat/robot.py:1: the docstring begins with ")


@pytest.mark.parametrize(
    "source",
    [
        'def state():\n    """Return it."""',
        'def state():\n    """Process it."""',
        'class State:\n    """States of it."""',
        '@property\ndef state():\n    """Reasons against it."""',
        '@pytest.fixture(scope="module")\ndef state():\n    """Reasons against it."""',
    ],
)
def test_an_imperative_or_a_property_s_noun_passes(tmp_path: Path, source: str) -> None:
    write_module(tmp_path, "mucat/robot.py", source)
    assert find_bad_names(tmp_path) == []


@pytest.mark.parametrize(
    "source",
    [
        "found = 1",
        "print([one for one in ()])",
        "def f(words): ...",
        "class A:\n    def f(self):\n        self._place = 1",
    ],
)
def test_a_vague_name_is_found(tmp_path: Path, source: str) -> None:
    write_module(tmp_path, "mucat/robot.py", source)
    (problem,) = find_bad_names(tmp_path)
    assert problem.endswith("use a noun of the field")


def test_a_field_of_a_class_may_be_a_stored_name(tmp_path: Path) -> None:
    write_module(tmp_path, "mucat/robot.py", "class Run:\n    place: str")
    assert find_bad_names(tmp_path) == []


def test_a_field_that_recordings_hold_may_stay(tmp_path: Path) -> None:
    write_module(tmp_path, "robot_runtime/contract/packets/definitions.py", "class Motor:\n    wanted: int")
    assert find_bad_names(tmp_path) == []


def test_plain_words_pass(tmp_path: Path) -> None:
    write_module(tmp_path, "server/one.py", '"""The set point."""\nset_point = unwanted = 1\nprint(kept)')
    assert find_bad_names(tmp_path) == []


def write_module(root: Path, path: str, source: str) -> None:
    (root / path).parent.mkdir(parents=True, exist_ok=True)
    (root / path).write_text(source)
