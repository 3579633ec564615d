"""Foreign texts as cells of CSV, which no spreadsheet calculates."""

FORMULA = ("=", "+", "-", "@", "\t", "\n", "＝", "＋", "－", "＠")
"""Beginnings of what spreadsheets calculate."""


def escape_formula(text: str) -> str:
    """A text behind an apostrophe where a spreadsheet would take it for a formula."""
    # Python's writer does not quote a carriage return, after which a spreadsheet begins a new cell.
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    return f"'{text}" if text.startswith(FORMULA) else text
