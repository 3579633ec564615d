"""Parses TOML texts of any origin with bounded time and memory.

`tomllib` takes time and memory in the square of a key's parts: `a.a.a…` of 60 kB costs it 3.4 GB. Longer keys
and texts are refused before it sees them; the largest accepted text costs 0.1 s and 20 MB.
"""

import re
import tomllib
from typing import Any

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


class TomlError(ValueError):
    """A text that is not TOML, or too large; the error's text continues a sentence about it."""


def read_toml(text: str) -> dict[str, Any]:
    """Parses a TOML text. Raises TomlError."""
    if len(text.encode("utf-8", "replace")) > BYTES_MAX:
        raise TomlError(f"is larger than {BYTES_MAX} bytes")
    for token in _TOKENS.finditer(text):
        if token.lastgroup == "long_key":
            line = text.count("\n", 0, token.start()) + 1
            raise TomlError(f"has a key of more than {PARTS_MAX} parts in line {line}")
    try:
        return tomllib.loads(text)
    except ValueError as problem:
        raise TomlError(f"is not TOML: {problem}") from problem
    except RecursionError as problem:
        raise TomlError("is not TOML: it is nested too deeply") from problem
