"""Output of texts to a terminal or a log; foreign texts cannot control it."""

import logging
import re

import click

_COMMANDS = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ud800-\udfff]"
)
"""Control characters but tab and new line, and marks that hide or reorder text."""


def plain(text: str) -> str:
    """Return the text with its control characters and marks of direction as escapes, such as \\x1b."""
    return _COMMANDS.sub(lambda match: match[0].encode("unicode_escape").decode(), text)


def echo(text: object, *, err: bool = False, nl: bool = True) -> None:
    """Print a text that may hold foreign parts."""
    click.echo(plain(str(text)), err=err, nl=nl)


class PlainFormatter(logging.Formatter):
    """Formatter of a log's lines, which may hold foreign parts."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the line, and a traceback below it."""
        return plain(super().format(record))
