from pathlib import Path

import pytest

from tests.checks.names import find_bad_names

ROOT = Path(__file__).parents[2]


def test_the_packages_keep_the_rules() -> None:
    assert find_bad_names(ROOT) == []


def test_a_public_class_that_exists_twice_is_found(tmp_path: Path) -> None:
    write_module(tmp_path, "robot_runtime/one.py", "class Watch: ...\nclass _Private: ...")
    write_module(tmp_path, "server/two.py", "class Watch: ...\nclass _Private: ...")
    assert find_bad_names(tmp_path) == [
        "class Watch is defined 2 times, in robot_runtime/one.py, server/two.py; rename all but one"
    ]


@pytest.mark.parametrize(
    "word", ["What", "Whatever", "When", "Where", "Which", "Who", "Whose", "Whether", "How", "Let", "That"]
)
@pytest.mark.parametrize("place", ["server/one.py", "tests/one.py"])
@pytest.mark.parametrize(
    "source", ['"""{} it is."""', 'class A:\n    """{} it is."""', 'async def a():\n    """{} it is."""']
)
def test_a_docstring_that_is_a_riddle_is_found(tmp_path: Path, place: str, word: str, source: str) -> None:
    write_module(tmp_path, place, source.format(word))
    assert find_bad_names(tmp_path) == [
        f"{place}:1: the docstring begins with {word}; say what it is or does"
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
    write_module(tmp_path, "robot_runtime/one.py", f"{name} = 1")
    assert len(find_bad_names(tmp_path)) == 1


def test_a_field_that_recordings_hold_may_stay(tmp_path: Path) -> None:
    write_module(tmp_path, "robot_runtime/contract/packets/definitions.py", "class Motor:\n    wanted: int")
    assert find_bad_names(tmp_path) == []


def test_plain_words_pass(tmp_path: Path) -> None:
    write_module(tmp_path, "server/one.py", '"""The set point."""\nset_point = unwanted = 1\nprint(kept)')
    assert find_bad_names(tmp_path) == []


def write_module(root: Path, place: str, source: str) -> None:
    (root / place).parent.mkdir(parents=True, exist_ok=True)
    (root / place).write_text(source)
