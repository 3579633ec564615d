from pathlib import Path

from tests.checks import words
from tests.checks.words import count_words, find_needless_words

ROOT = Path(__file__).parents[2]


def test_the_manual_is_short() -> None:
    assert find_needless_words(ROOT) == []


def test_tables_and_code_are_no_words() -> None:
    text = "# A page\n\n| two | words |\n|---|---|\n\n```sh\nmake run\n```\n\nHere are – four µ-CATs.\n"
    assert count_words(text) == (8, 8)


def test_what_a_program_writes_is_counted_apart() -> None:
    page = "# Page\n\n<!-- Written by `make generate` from a. Do not edit. -->\n\nFour more words here.\n"
    assert count_words(page) == (0, 5)
    assert count_words("Two words\n\n<!-- made by `make control` -->\n\n| made |\n\n<!-- end -->\n") == (2, 3)


def test_a_long_manual_is_found(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs/page.md").write_text("word " * (words.ALL_MAX + 1))
    assert len(find_needless_words(tmp_path)) == 2
