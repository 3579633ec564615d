from pathlib import Path

import pytest

from tests.documents.blocks import CodeBlock, apply


def test_a_new_file_is_written_and_an_old_one_gets_longer(tmp_path: Path) -> None:
    apply(CodeBlock("python", "room/new.py", "X = 1\n"), tmp_path)
    apply(CodeBlock("python", "room/new.py", "Y = 2\n"), tmp_path)
    assert (tmp_path / "room/new.py").read_text() == "X = 1\n\n\nY = 2\n"


def test_a_diff_replaces_its_lines(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("one\ntwo\nthree\n")
    apply(CodeBlock("diff", "a.txt", " one\n-two\n+2\n"), tmp_path)
    assert (tmp_path / "a.txt").read_text() == "one\n2\nthree\n"


@pytest.mark.parametrize("text", ["two\n", "one\none\n"])
def test_a_diff_that_does_not_fit_one_place_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.txt").write_text(text)
    with pytest.raises(ValueError, match="occur"):
        apply(CodeBlock("diff", "a.txt", " one\n+1\n"), tmp_path)
