"""Foreign words on a terminal: they are shown, and command nothing."""

import logging
import sys

import pytest

from server.platform.terminal import PlainFormatter, echo, plain

COMMANDS = {
    "\x1b[2J": "\\x1b[2J",
    "\x1b]52;c;cm0gLXJm\x07": "\\x1b]52;c;cm0gLXJm\\x07",
    "\x9b31m": "\\x9b31m",
    "a\rb\x08": "a\\rb\\x08",
    "\u202egnp.exe": "\\u202egnp.exe",
    "\u2066a\u2069": "\\u2066a\\u2069",
    "op\u200b": "op\\u200b",
    "\ud800": "\\ud800",
}


@pytest.mark.parametrize("text", COMMANDS)
def test_commands_to_the_terminal_are_shown_as_escapes(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    echo(f"dive {text}")
    assert capsys.readouterr().out == f"dive {COMMANDS[text]}\n"


@pytest.mark.parametrize("text", ["Öresund, µ-CAT — 浮く 🐢", "one\n\ttwo", ""])
def test_other_texts_are_unchanged(text: str) -> None:
    assert plain(text) == text


def test_so_are_those_in_the_log() -> None:
    record = logging.LogRecord("mucat", logging.WARNING, __file__, 1, "%s", ("\x1b[2J",), None)
    assert PlainFormatter("%(message)s").format(record) == "\\x1b[2J"
    try:
        raise ValueError("\x1b[2J")
    except ValueError:
        record.exc_info = sys.exc_info()
    assert "\x1b" not in PlainFormatter("%(message)s").format(record)
