"""Reads texts that people and other programs hand over: files, standard input, bodies of requests.

A byte order mark is left out. What is not UTF-8 is refused with the encoding that it seems to have, and what
is not valid with the usual slip behind it: a decimal comma, a typographic quotation mark, a key given twice.
"""

import codecs
import json
import re
from collections import Counter
from collections.abc import Mapping
from math import isinf
from pathlib import Path
from typing import Any

MARK = "\ufeff"
_MARKS = (
    (codecs.BOM_UTF32_LE, "UTF-32"),
    (codecs.BOM_UTF32_BE, "UTF-32"),
    (codecs.BOM_UTF16_LE, "UTF-16"),
    (codecs.BOM_UTF16_BE, "UTF-16"),
)
"""Byte order marks. UTF-32 stands first: in little-endian order its mark begins with that of UTF-16."""
_ZEROS = ((0.6, "UTF-32"), (0.3, "UTF-16"))
"""Least share of zero bytes in a text without a mark: mostly ASCII, it has 3 in 4, and 1 in 2."""
_QUOTES = dict.fromkeys("“”„‟«»″", '"') | dict.fromkeys("‘’‚‛′", "'")
_SPACES = dict.fromkeys("\u00a0\u2007\u2009\u200a\u202f\u3000", "a plain space")
_INVISIBLE = dict.fromkeys("\u200b\u200e\u200f\u2060\ufeff\u00ad", "")
_DASHES = dict.fromkeys("\u2010\u2011\u2012\u2013\u2014\u2212", "-")
_LOOKALIKES: Mapping[str, tuple[str, str]] = {
    **{
        character: (f"a typographic quotation mark {character}", plain)
        for character, plain in _QUOTES.items()
    },
    **{character: ("a space that is not the plain one", plain) for character, plain in _SPACES.items()},
    **{character: ("an invisible character", plain) for character, plain in _INVISIBLE.items()},
    **{character: (f"a typographic dash {character}", plain) for character, plain in _DASHES.items()},
}
"""Characters that text editors and chats put in place of the plain ones: what they are, and the plain one."""
_DECIMAL_COMMA = re.compile(r"[=:]\s*+(?P<whole>[+-]?\d+),(?P<rest>\d+)\s*+")
_JSON_TEXT = r'"(?:[^"\\]++|\\.)*"'
_JSON_WORDS = re.compile(rf'{_JSON_TEXT}|(?P<word>[^\s{{}}\[\]:,"]+)', re.DOTALL)
_JSON_TOKENS = re.compile(rf"(?P<key>{_JSON_TEXT})(?=\s*:)|{_JSON_TEXT}|[{{}}\[\]]", re.DOTALL)


class TextError(ValueError):
    """A text that cannot be used; the error's text continues a sentence about it."""


def load_text(path: Path) -> str:
    """Return a file's text. Raise OSError, TextError."""
    return decode_text(path.read_bytes())


def decode_text(data: bytes) -> str:
    """Return the text in UTF-8, without a byte order mark; its lines end as here. Raise TextError."""
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            raise TextError(_saved_as(encoding))
    if b"\0" in data:
        raise TextError(_explain_zeros(data))
    try:
        return data.decode("utf-8").removeprefix(MARK).replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as problem:
        line = data.count(b"\n", 0, problem.start) + 1
        raise TextError(
            f"has a byte in line {line} that is not UTF-8; it is probably saved as Windows-1252 or Latin-1: "
            "save it as UTF-8"
        ) from problem


def read_json(text: str | bytes) -> Any:
    """Parse JSON in which no key of an object comes twice and every number is finite. Raise TextError."""
    text = decode_text(text) if isinstance(text, bytes) else text.removeprefix(MARK)
    if not text.strip():
        raise TextError("is empty")
    try:
        return _DECODER.decode(text)
    except _NotFiniteError as problem:
        line = _line_of(problem.word, text)
        raise TextError(f"holds {problem.word[:30]} in line {line}; a number must be finite") from problem
    except _RepeatedKeyError as problem:
        key, line = find_repeated_key(text) or (problem.key, 1)
        raise TextError(f"names the key {key!r} twice, the second time in line {line}") from problem
    except json.JSONDecodeError as problem:
        slip = find_slip(text, problem.lineno, problem.colno)
        reason = f"{problem.msg} in line {problem.lineno}, column {problem.colno}"
        raise TextError(slip or f"is not JSON: {reason}") from problem
    except (ValueError, RecursionError) as problem:
        raise TextError(f"is not JSON: {problem}") from problem


def find_slip(text: str, line: int, column: int) -> str:
    """Return the usual slip where a parser of TOML or JSON gave up; empty if there is none.

    Line and column count from 1.
    """
    lines = text.split("\n")
    if not 1 <= line <= len(lines):
        return ""
    there = lines[line - 1]
    for match in _DECIMAL_COMMA.finditer(there):
        if match.start() <= column <= match.end() + 1:
            right = f"{match['whole']}.{match['rest']}"
            wrong = f"{match['whole']},{match['rest']}"
            return f"has {wrong} in line {line}; write {right} with a decimal point, not a comma"
    # A text that a typographic mark should have ended runs on to the end of its line.
    candidates = there[column - 1 : column] + "".join(
        character for character in there if character in _QUOTES
    )
    for candidate in candidates:
        if candidate in _LOOKALIKES:
            name, plain = _LOOKALIKES[candidate]
            remedy = f"write {plain} instead" if plain else "remove it"
            return f"has {name} (U+{ord(candidate):04X}) in line {line}; {remedy}"
    return ""


def find_repeated_key(text: str) -> tuple[str, int] | None:
    """Return the first key of an object in JSON that comes twice, and the line of its second place."""
    open_parts: list[set[str]] = []
    for token in _JSON_TOKENS.finditer(text):
        if token[0] in "{[":
            open_parts.append(set())
        elif token[0] in "}]":
            open_parts.pop()
        elif token["key"] is not None:
            key = json.loads(token["key"])
            if key in open_parts[-1]:
                return key, text.count("\n", 0, token.start()) + 1
            open_parts[-1].add(key)
    return None


class _NotFiniteError(Exception):
    """NaN, infinite, or a number too large to be stored."""

    def __init__(self, word: str) -> None:
        super().__init__(word)
        self.word = word


class _RepeatedKeyError(Exception):
    """A key of an object that comes twice."""

    def __init__(self, key: str) -> None:
        super().__init__(key)
        self.key = key


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    if len(table) < len(pairs):
        counts = Counter(key for key, _ in pairs)
        raise _RepeatedKeyError(next(key for key, count in counts.items() if count > 1))
    return table


def _float(digits: str) -> float:
    number = float(digits)
    if isinf(number):
        raise _NotFiniteError(digits)
    return number


def _refuse_constant(name: str) -> None:
    raise _NotFiniteError(name)


_DECODER = json.JSONDecoder(object_pairs_hook=_object, parse_float=_float, parse_constant=_refuse_constant)


def _line_of(word: str, text: str) -> int:
    """Return the number of the first line with this bare word of JSON."""
    first = next(match for match in _JSON_WORDS.finditer(text) if match["word"] == word)
    return text.count("\n", 0, first.start()) + 1


def _saved_as(encoding: str) -> str:
    return f"is saved as {encoding}; save it as UTF-8"


def _explain_zeros(data: bytes) -> str:
    zeros = data.count(0)
    if zeros == len(data):
        return "holds nothing but zero bytes: its content is lost"
    for share, encoding in _ZEROS:
        if zeros >= share * len(data):
            return _saved_as(encoding)
    line = data.count(b"\n", 0, data.index(0)) + 1
    return f"has a zero byte in line {line}, so it is no text"
