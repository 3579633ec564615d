"""Parses TOML texts of any origin with bounded time and memory.

`tomllib` takes time and memory in the square of a key's parts: `a.a.a…` of 60 kB costs it 3.4 GB. Longer keys
and texts are refused before it sees them; the largest accepted text costs 0.1 s and 20 MB.
"""

import re
import tomllib
from typing import Any

from robot_runtime.contract.text_input import MARK, TextError, find_slip

BYTES_MAX = 60_000
PARTS_MAX = 8
"""Parts of one dotted key or of one table's name."""
# Only characters are repeated possessively: with groups, Python before 3.11.5 goes wrong (its issue 106052).
_MULTILINE = r"""\"{3}(?:[^"\\]++|\\(?:.|\Z)|"(?!""))*(?:"{3,5}|\Z)|'{3}(?:[^']++|'(?!''))*(?:'{3,5}|\Z)"""
_PART = r"""[A-Za-z0-9_-]++|"(?:[^"\\\n]++|\\(?:.|\Z))*(?:"|$)|'[^'\n]*+(?:'|$)"""
_LONG_KEY = rf"(?:{_PART})(?:[ \t]*+\.[ \t]*+(?:{_PART})){{{PARTS_MAX},}}"
# A text that is not closed runs to the end of its line or of the document, where tomllib stops.
_TOKENS = re.compile(
    rf"#[^\n]*+|{_MULTILINE}|(?P<long_key>{_LONG_KEY})|(?:{_PART})", re.DOTALL | re.MULTILINE
)


_PLACE = re.compile(
    r"(?P<words>.*) \(at (?:line (?P<line>\d+), column (?P<column>\d+)|end of document)\)", re.DOTALL
)
_REPEATED = ("Cannot overwrite a value", "Cannot declare", "Duplicate inline table key")
"""Beginnings of the parser's words for a key or table that comes twice."""


class TomlError(TextError):
    """A text that is not TOML, or too large; the error's text continues a sentence about it."""


def read_toml(text: str) -> dict[str, Any]:
    """Parse a TOML text. Raise TomlError."""
    text = text.removeprefix(MARK)
    if len(text.encode("utf-8", "replace")) > BYTES_MAX:
        raise TomlError(f"is larger than {BYTES_MAX} bytes")
    for token in _TOKENS.finditer(text):
        if token.lastgroup == "long_key":
            line = text.count("\n", 0, token.start()) + 1
            raise TomlError(f"has a key of more than {PARTS_MAX} parts in line {line}")
    try:
        return tomllib.loads(text)
    except ValueError as problem:
        raise TomlError(_explain(text, str(problem))) from problem
    except RecursionError as problem:
        raise TomlError("is not TOML: it is nested too deeply") from problem


def _explain(text: str, problem: str) -> str:
    """Return the parser's problem as text; it names the slip where it is a usual one."""
    match = _PLACE.fullmatch(problem)
    if match is None:
        return f"is not TOML: {problem}"
    lines = text.split("\n")
    line = int(match["line"] or len(lines))
    there = lines[line - 1].strip()
    if match["words"].startswith(_REPEATED):
        return f"names {_repeated(match['words'], there)} twice, the second time in line {line}"
    return find_slip(text, line, int(match["column"] or 1)) or f"is not TOML: {problem}"


def _repeated(message: str, line: str) -> str:
    """Return a line's key or table that exists before it; only a value of several lines hides its key."""
    if message.startswith("Duplicate"):
        return f"the key {message.rpartition('key ')[2]}"
    if line.startswith("["):
        return f"the table [{line.partition(']')[0].strip('[ ')}]"
    key, equals, _ = line.partition("=")
    return f"the key {key.strip()!r}" if equals else "a key"
