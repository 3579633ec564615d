"""TOML texts that would take much time or memory are refused before they are parsed."""

import tomllib
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from hypothesis import example, given, settings
from hypothesis import strategies as st

from robot_runtime.config import load
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.toml_text import BYTES_MAX, PARTS_MAX, TomlError, read_toml
from robot_runtime.experiments.scenario.document import read_scenario

MANY = 10_000
MEMORY_MAX = 40_000_000
BOMBS = {
    "a dotted key": "a" + ".a" * MANY + "=1",
    "spaces around the dots": "a" + " .\ta" * MANY + "=1",
    "quoted parts": '"a"' + '."a"' * MANY + "=1",
    "literal parts": "'a'" + ".'a'" * MANY + "=1",
    "parts with dots and quotes in them": '"\\".#"' + "." + '"\\".#".' * 5000 + "a=1",
    "a table": "[a" + ".a" * MANY + "]",
    "a table in an array": "[[a" + ".a" * MANY + "]]",
    "a table's key": "[a.a.a]\na" + ".a" * MANY + "=1",
    "an inline table": "a={a" + ".a" * MANY + "=1}",
    "many keys": ("a" + ".a" * PARTS_MAX + "=1\n") * 2000,
    "a key after texts": 'a=\'\'\'\n\'\'\'\'\'\nb="""\\"""""""#\nc=\'"\'#\'\nd="#\\""\na'
    + ".a" * MANY
    + "=1",
}
CHEAP = {
    "deep arrays": "a=" + "[" * 50_000,
    "deep tables": "a=" + "{a=" * 19_000,
    "a long number": "a=" + "1" * 50_000,
    "an open text": 'a="""' + "\\\n" * 25_000,
    "open texts": "a=" + "'''" * 19_999,
}
FRAGMENTS = [
    "a",
    "a=1\n",
    "a.",
    ".",
    '"',
    "'",
    '"""',
    "'''",
    "\\",
    "\n",
    "=",
    "[",
    "]",
    "{",
    "}",
    ",",
    "#",
    " ",
]
LONG = "a.a.a.a.a.a.a.a.a=1\n"


@pytest.fixture
def unparsed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A text that reaches tomllib fails the test."""
    monkeypatch.setattr(tomllib, "loads", lambda text: pytest.fail(f"parsed {text[:40]!r}"))


@pytest.mark.usefixtures("unparsed")
@pytest.mark.parametrize("name", BOMBS)
def test_a_key_of_many_parts_is_not_parsed(name: str) -> None:
    with pytest.raises(TomlError, match=f"has a key of more than {PARTS_MAX} parts in line"):
        read_toml(BOMBS[name])


@pytest.mark.usefixtures("unparsed")
def test_a_text_of_many_bytes_is_not_parsed() -> None:
    with pytest.raises(TomlError, match="is larger than 60000 bytes"):
        read_toml("#" + "é" * (BYTES_MAX // 2))


@pytest.mark.parametrize("name", CHEAP)
def test_other_expensive_texts_are_refused_in_words(name: str) -> None:
    with pytest.raises(TomlError, match="is not TOML"):
        read_toml(CHEAP[name])


@pytest.mark.parametrize("line", ["a{}.b.c.d.e.f.g.h=1\n", "[a{}.b.c.d.e.f.g.h]\n"])
def test_the_largest_text_needs_little_memory(line: str) -> None:
    text = "".join(map(line.format, range(2500)))
    assert BYTES_MAX * 0.8 < len(text) <= BYTES_MAX
    tracemalloc.start()
    try:
        assert len(read_toml(text)) == 2500
        assert tracemalloc.get_traced_memory()[1] < MEMORY_MAX
    finally:
        tracemalloc.stop()


def load_text(text: str, folder: Path) -> object:
    path = folder / "robot.toml"
    path.write_text(text)
    return load(path)


@pytest.mark.usefixtures("unparsed")
@pytest.mark.parametrize("read", [load_text, lambda text, _: read_scenario(text)])
def test_documents_are_read_by_it(read: Callable[[str, Path], object], tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="a key of more than 8 parts in line 1"):
        read(BOMBS["a dotted key"], tmp_path)


@example(parts=["a=", '"', "\\", '"', "\n", LONG])
@example(parts=["a=", '"""', "\\", '"""', '"""', '"', "\n", LONG])
@example(parts=["a=", "'''", "'", "'''", "'", "\n", LONG])
@settings(max_examples=200)
@given(parts=st.lists(st.sampled_from([*FRAGMENTS, LONG]), max_size=20))
def test_tomllib_meets_no_longer_key(parts: list[str]) -> None:
    lengths: list[int] = []
    parser: Any = tomllib._parser  # type: ignore[attr-defined]
    parse_key = parser.parse_key

    def measure(source: str, position: int) -> tuple[int, tuple[str, ...]]:
        position, key = parse_key(source, position)
        lengths.append(len(key))
        return position, key

    parser.parse_key = measure
    try:
        read_toml("".join(parts))
    except TomlError:
        pass
    finally:
        parser.parse_key = parse_key
    assert max(lengths, default=0) <= PARTS_MAX


KEYS = st.text(alphabet="ab.\"'# ", max_size=5)
VALUES = st.one_of(st.integers(-9, 9), st.text(alphabet="a.\"'#\\\n= ", max_size=20))


@settings(max_examples=100)
@given(st.dictionaries(KEYS, st.one_of(VALUES, st.dictionaries(KEYS, VALUES, max_size=3)), max_size=4))
def test_other_documents_are_parsed_as_by_tomllib(document: dict[str, Any]) -> None:
    assert read_toml(tomli_w.dumps(document)) == document
