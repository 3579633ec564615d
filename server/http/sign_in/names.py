"""Names of browsers and programs: their characters, and their comparison."""

from collections.abc import Collection
from unicodedata import category, normalize

NAME_LENGTH_MAX = 40

_UNSEEN = frozenset("\u034f\u115f\u1160\u17b4\u17b5\u180b\u180c\u180d\u180f\u2800\U0001d159")
_SELECTORS = (range(0xFE00, 0xFE10), range(0xE0100, 0xE01F0))
"""Characters that count as printable and show nothing, such as Hangul's fillers, and variation selectors."""


def clean_name(name: str) -> str:
    """Return a name in the form in which it is stored: NFKC, single spaces. Raise ValueError."""
    name = " ".join(normalize("NFKC", name).split())
    if not name or not name.isprintable() or any(map(_is_unseen, name)):
        raise ValueError("must have visible characters, and no control characters")
    if any(category(word[0]).startswith("M") for word in name.split()):
        raise ValueError("must not begin a word with an accent that has no letter")
    if len(name) > NAME_LENGTH_MAX:
        raise ValueError(f"must have {NAME_LENGTH_MAX} characters at most, ligatures written out")
    return name


def find_same(name: str, others: Collection[str]) -> str | None:
    """Return the first of the others that differs from this name only in case and form; None without any."""
    folded = _fold(name)
    return next((other for other in others if _fold(other) == folded), None)


def number_name(name: str, others: Collection[str]) -> str:
    """Return this name, with the lowest number from 2 on if another has it."""
    taken = {_fold(other) for other in others}
    numbered, number = name, 1
    while _fold(numbered) in taken:
        number += 1
        end = f" {number}"
        numbered = name[: NAME_LENGTH_MAX - len(end)].rstrip() + end
    return numbered


def _fold(name: str) -> str:
    """Return a name without case and compatible forms, as Unicode compares them (section 3.13, D146)."""
    return normalize("NFKC", normalize("NFKC", name).casefold())


def _is_unseen(character: str) -> bool:
    return character in _UNSEEN or any(ord(character) in selectors for selectors in _SELECTORS)
