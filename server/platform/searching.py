"""Comparison of texts in a search, whatever keyboard, case or spelling in Unicode they were typed with."""

import unicodedata

_FIRST_MARK, _LAST_MARK = "\u0300", "\u036f"
"""Unicode's combining marks for letters of Latin, Greek and Cyrillic scripts."""


def fold(text: str) -> str:
    """The text without case, accents and other forms of the same letters: "Öö ﬁ ß" is "oo fi ss"."""
    apart = unicodedata.normalize("NFKD", unicodedata.normalize("NFKD", text).casefold())
    return "".join(one for one in apart if not _FIRST_MARK <= one <= _LAST_MARK)
