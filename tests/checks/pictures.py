"""Pictures of the documents: few and small, each is shown on a page, and photographs can be taken again."""

from pathlib import Path

PICTURES_MAX = 40
BYTES_MAX = 4_000_000
"""Of all together: every installed robot has them."""
SUFFIXES = {".jpg", ".png", ".svg", ".gif", ".webp"}
PHOTOGRAPH = ".jpg"
"""Of what `make screenshots` takes; drawings are vectors."""


def find_needless_pictures(root: Path) -> list[str]:
    """Return one line for each picture that no page shows, and one if there are too many."""
    docs = root / "docs"
    pictures = sorted(file for file in docs.rglob("*") if file.suffix in SUFFIXES)
    pages = "".join(page.read_text(encoding="utf-8") for page in [root / "README.md", *docs.rglob("*.md")])
    problems = [
        f"{picture.relative_to(root)} is shown on no page"
        for picture in pictures
        if f"{picture.name})" not in pages
    ]
    if len(pictures) > PICTURES_MAX:
        problems.append(f"docs/ has {len(pictures)} pictures; at most {PICTURES_MAX} are stored")
    if (size := sum(picture.stat().st_size for picture in pictures)) > BYTES_MAX:
        problems.append(f"docs/ has {size} bytes of pictures; at most {BYTES_MAX} are stored")
    return problems


def find_foreign_photographs(root: Path) -> list[str]:
    """Return one line for each photograph that `make screenshots` does not take, and each that is missing."""
    # The list names what Playwright does, which is seconds to load.
    from tests.pictures.manual import ALL

    folder = root / "docs/pictures"
    taken = {f"{name}{PHOTOGRAPH}" for name in ALL}
    there = {file.name for file in folder.iterdir() if file.suffix in SUFFIXES - {".svg"}}
    return [
        *(
            f"docs/pictures/{name} is not in the list of tests/pictures/manual.py"
            for name in sorted(there - taken)
        ),
        *(f"docs/pictures/{name} is missing: make screenshots takes it" for name in sorted(taken - there)),
    ]
