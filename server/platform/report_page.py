"""Reports as one HTML file each, dark on white: for printing, and for keeping without the server."""

from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from string import Template

PAGE = Path(__file__).with_name("report.html")


def report_page(title: str, parts: Iterable[str]) -> str:
    """Return the whole file, of parts in HTML."""
    template = Template(PAGE.read_text(encoding="utf-8"))
    return template.substitute(title=escape(title), body="\n".join(parts))


def report_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table, of cells in HTML."""
    names = "".join(f"<th>{cell}</th>" for cell in head)
    lines = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{names}</tr></thead><tbody>{lines}</tbody></table>"
