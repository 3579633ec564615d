"""Texts and tables of the generated pages."""

from collections.abc import Iterable, Sequence
from pathlib import Path

PAGES = Path(__file__).with_name("pages")
"""The texts of pages, with `{name}` for each number and table that comes from the code."""


def page(title: str, source: str, *parts: str) -> str:
    """Return a reference page; `source` names the file that it is written from."""
    head = f"# {title}\n\n<!-- Written by `make generate` from {source}. Do not edit. -->\n"
    return "\n".join((head, *parts))


def fill(name: str, **values: object) -> str:
    """Return the text of this name with the values in it."""
    return (PAGES / f"{name}.md.in").read_text(encoding="utf-8").format(**values)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table whose cells may hold any text."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join("| " + " | ".join(map(_cell, line)) + " |\n" for line in lines)


def entry(name: str, details: Iterable[str], meaning: str) -> str:
    """Return a line of a list: a name in code, what is known of it in brackets, and its meaning."""
    known = "; ".join(filter(None, details))
    line = f"- `{name}`" + (f" ({known})" if known else "") + (f": {meaning}" if meaning else "")
    return line.replace("<", "&lt;") + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")
