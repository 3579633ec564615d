"""Tables of the generated reference pages."""

from collections.abc import Iterable, Sequence


def page(title: str, source: str, *parts: str) -> str:
    """Return a reference page; `source` names the file that it is written from."""
    head = f"# {title}\n\n<!-- Written by `make generate` from {source}. Do not edit. -->\n"
    return "\n".join((head, *parts))


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table whose cells may hold any text."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join("| " + " | ".join(map(_cell, line)) + " |\n" for line in lines)


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")
