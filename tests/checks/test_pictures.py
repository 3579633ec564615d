from pathlib import Path

from tests.checks.pictures import BYTES_MAX, PICTURES_MAX, find_foreign_photographs, find_needless_pictures

ROOT = Path(__file__).parents[2]


def test_every_picture_is_shown_and_they_are_few() -> None:
    assert find_needless_pictures(ROOT) == []
    assert find_foreign_photographs(ROOT) == []


def test_a_picture_that_no_page_shows_is_found(tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text("![one](docs/shown.jpg)")
    (tmp_path / "docs").mkdir()
    for name in ("shown.jpg", "forgotten.png"):
        (tmp_path / "docs" / name).touch()
    assert find_needless_pictures(tmp_path) == ["docs/forgotten.png is shown on no page"]


def test_too_many_pictures_are_found(tmp_path: Path) -> None:
    names = [f"{number}.jpg" for number in range(PICTURES_MAX + 1)]
    (tmp_path / "docs").mkdir()
    (tmp_path / "README.md").write_text("".join(f"![{name}](docs/{name})" for name in names))
    for name in names:
        (tmp_path / "docs" / name).touch()
    (problem,) = find_needless_pictures(tmp_path)
    assert problem.startswith(f"docs/ has {PICTURES_MAX + 1} pictures")


def test_large_pictures_are_found(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "README.md").write_text("![large](docs/large.jpg)")
    with (tmp_path / "docs/large.jpg").open("wb") as file:
        file.truncate(BYTES_MAX + 1)
    (problem,) = find_needless_pictures(tmp_path)
    assert problem.startswith(f"docs/ has {BYTES_MAX + 1} bytes of pictures")


def test_a_photograph_that_is_not_taken_by_the_command_is_found(tmp_path: Path) -> None:
    folder = tmp_path / "docs/pictures"
    folder.mkdir(parents=True)
    (folder / "by-hand.jpg").touch()
    problems = find_foreign_photographs(tmp_path)
    assert "docs/pictures/by-hand.jpg is not in the list of tests/pictures/manual.py" in problems
    assert "docs/pictures/operate.jpg is missing: make screenshots takes it" in problems
