"""Comparison of texts in a search, without regard to keyboard, case or spelling in Unicode."""

import unicodedata

_FIRST_MARK, _LAST_MARK = "\u0300", "\u036f"
"""Unicode's combining marks for letters of Latin, Greek and Cyrillic scripts."""


def fold(text: str) -> str:
    """Return the text without case, accents and compatible forms: "Öö ﬁ ß" becomes "oo fi ss"."""
    apart = unicodedata.normalize("NFKD", unicodedata.normalize("NFKD", text).casefold())
    return "".join(character for character in apart if not _FIRST_MARK <= character <= _LAST_MARK)
