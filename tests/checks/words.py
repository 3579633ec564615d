"""The manual's length: words of docs/ and README.md, code and tables too, by hand and in all."""

import re
from collections.abc import Iterator
from pathlib import Path

BY_HAND_MAX = 35_000
ALL_MAX = 60_000
_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_CODE = re.compile(r"^( *)```.*?^\1```", re.MULTILINE | re.DOTALL)
_MADE = re.compile(r"^<!-- made by .*?^<!-- end -->", re.MULTILINE | re.DOTALL)
_WORD = re.compile(r"[^\W_]")
WRITTEN = re.compile(r"^<!-- (Written|Made) by `make ", re.MULTILINE)
"""Marks a page that a program writes."""


def find_needless_words(root: Path) -> list[str]:
    """Return one line if the manual is too long, or what people have written in it."""
    counts = [count_words(page.read_text(encoding="utf-8")) for page in _pages(root)]
    by_hand, everything = map(sum, zip(*counts, strict=True))
    problems = []
    if by_hand > BY_HAND_MAX:
        problems.append(f"the manual has {by_hand} words written by hand; at most {BY_HAND_MAX} are wanted")
    if everything > ALL_MAX:
        problems.append(f"the manual has {everything} words; at most {ALL_MAX} are wanted")
    return problems


def count_words(text: str) -> tuple[int, int]:
    """Return the number of words of a page that are written by hand, and of all; signs alone are none."""
    written = WRITTEN.search(_CODE.sub("", text)) is not None
    return 0 if written else _count(_MADE.sub("", text)), _count(text)


def _count(text: str) -> int:
    return sum(_WORD.search(part) is not None for part in _COMMENT.sub("", text).split())


def _pages(root: Path) -> Iterator[Path]:
    yield from sorted((root / "docs").rglob("*.md"))
    yield root / "README.md"
