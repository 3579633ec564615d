from pathlib import Path

from tests.checks import words
from tests.checks.words import count_words, find_needless_words

ROOT = Path(__file__).parents[2]


def test_the_manual_is_short() -> None:
    assert find_needless_words(ROOT) == []


def test_code_and_cells_of_tables_are_words_and_signs_are_none() -> None:
    text = "# A page\n\n| two | words |\n|---|---|\n\n```sh\nmake run\n```\n\nHere are – four µ-CATs.\n"
    assert count_words(text) == (11, 11)


def test_what_a_program_writes_is_counted_apart() -> None:
    page = "# Page\n\n<!-- Written by `make generate` from a. Do not edit. -->\n\nFour more words here.\n"
    assert count_words(page) == (0, 5)
    assert count_words(f"As code:\n\n```text\n{page}```\n") == (8, 8)
    assert count_words("Two words\n\n<!-- made by `make control` -->\n\n| made |\n\n<!-- end -->\n") == (2, 3)


def test_a_long_manual_is_found(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs/page.md").write_text("word " * words.ALL_MAX)
    (tmp_path / "README.md").write_text("word")
    assert len(find_needless_words(tmp_path)) == 2
