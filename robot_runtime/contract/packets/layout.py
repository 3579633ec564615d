"""The layout of records in bytes: type, scale and unit of each field, little-endian and packed.

A record is a frozen dataclass whose fields carry a `Wire` (a number, or a fixed array of numbers) or a
`Text` (a byte that counts, then that many bytes of UTF-8; only as the last field). The same records travel
on the serial line, between processes, to the page and into the database.
"""

from collections.abc import Callable
from dataclasses import dataclass
from operator import mul
from struct import Struct, error
from typing import (
    Any,
    ClassVar,
    Self,
    TypeVar,
    dataclass_transform,
)

from robot_runtime.contract.hints import read_fields

C_TYPES = {
    "b": "int8_t",
    "B": "uint8_t",
    "h": "int16_t",
    "H": "uint16_t",
    "i": "int32_t",
    "I": "uint32_t",
    "f": "float",
    "d": "double",
}
_BITS = {code: Struct("<" + code).size * 8 for code in "BbHhIi"}


class LayoutError(ValueError):
    """A record that does not fit its bytes, or bytes that are not such a record."""


@dataclass(frozen=True, slots=True)
class Wire:
    """A number: struct code, value of one count, unit, and how many stand in a row."""

    code: str
    scale: float = 1
    unit: str = ""
    count: int = 1
    meaning: str = ""

    @property
    def size(self) -> int:
        """The size of the whole field in bytes."""
        return Struct("<" + self.code).size * self.count

    @property
    def integral(self) -> bool:
        """True if values are whole counts, without a scale."""
        return self.scale == 1 and self.code not in "fd"

    def counter(self) -> Callable[[float], float]:
        """Return the function that rounds a value to this type's nearest count; floats stay as they are."""
        if self.code in "fd":
            return _unchanged
        scale, bits = self.scale, _BITS[self.code]
        low, high = (
            (0, (1 << bits) - 1) if self.code.isupper() else (-(1 << (bits - 1)), (1 << (bits - 1)) - 1)
        )

        def count(value: float) -> int:
            nearest = round(value / scale)
            return nearest if low <= nearest <= high else low if nearest < low else high

        return count


@dataclass(frozen=True, slots=True)
class Text:
    """UTF-8 text of at most `max_bytes` bytes, cut at a character where it is longer."""

    max_bytes: int
    meaning: str = ""


@dataclass_transform(frozen_default=True, kw_only_default=True)
class Record:
    """Base of everything that has a byte layout; subclasses are laid out when they are defined."""

    __slots__ = ()
    wires: ClassVar[dict[str, Wire]]
    tail: ClassVar[tuple[str, Text] | None]
    layout: ClassVar[Struct]
    # Prepared once from `wires`, because every packet on the line passes here.
    _writers: ClassVar[tuple[tuple[str, Callable[[float], float], bool], ...]]
    _places: ClassVar[tuple[tuple[str, int | slice], ...]]
    _scales: ClassVar[tuple[float, ...]]

    def to_bytes(self) -> bytes:
        """Return the record's bytes; number out of range are clamped.

        Raise LayoutError on NaN or infinity.
        """
        counts: list[float] = []
        try:
            for name, count, is_array in self._writers:
                value = getattr(self, name)
                if is_array:
                    counts.extend(map(count, value))
                else:
                    counts.append(count(value))
            body = self.layout.pack(*counts)
        except (ValueError, OverflowError, error) as problem:
            raise LayoutError(f"{type(self).__name__} cannot be written: {problem}") from problem
        return body + _text_bytes(getattr(self, self.tail[0]), self.tail[1]) if self.tail else body

    @classmethod
    def from_bytes(cls, data: bytes | memoryview) -> Self:
        """Return the record in `data`, exactly. Raise LayoutError where the length or the text is wrong."""
        size = cls.layout.size
        if len(data) != size if cls.tail is None else len(data) <= size or len(data) != size + 1 + data[size]:
            raise LayoutError(f"{cls.__name__} of {len(data)} bytes; expected {cls.describe_size()}")
        numbers = tuple(map(mul, cls.layout.unpack_from(data), cls._scales))
        values: dict[str, Any] = {name: numbers[position] for name, position in cls._places}
        if cls.tail:
            values[cls.tail[0]] = bytes(data[size + 1 :]).decode("utf-8", "replace")
        return cls(**values)

    @classmethod
    def describe_size(cls) -> str:
        """Return the lengths that `from_bytes` accepts, in words."""
        size = cls.layout.size
        if cls.tail is not None:
            return f"{size + 1} to {size + 1 + cls.tail[1].max_bytes} bytes"
        return "1 byte" if size == 1 else f"{size} bytes"


R = TypeVar("R", bound=Record)


@dataclass_transform(frozen_default=True, kw_only_default=True)
def record() -> Callable[[type[R]], type[R]]:
    """Make a class a frozen dataclass whose layout is derived from its annotations."""

    def register(cls: type[R]) -> type[R]:
        made = dataclass(frozen=True, slots=True, kw_only=True)(cls)
        _lay_out(made)
        return made

    return register


def _lay_out(cls: type[Record]) -> None:
    wires: dict[str, Wire] = {}
    text: tuple[str, Text] | None = None
    for name, hint in read_fields(cls).items():
        if text is not None:
            raise TypeError(f"{cls.__name__}.{name} follows a text, which must be the last field")
        for wire in hint.annotations(Wire):
            wires[name] = wire
        text = next(((name, annotation) for annotation in hint.annotations(Text)), None)
    cls.wires = wires
    cls.tail = text
    cls.layout = Struct(
        "<" + "".join(f"{wire.count if wire.count > 1 else ''}{wire.code}" for wire in wires.values())
    )
    cls._writers = tuple((name, wire.counter(), wire.count > 1) for name, wire in wires.items())
    cls._scales = tuple(wire.scale for wire in wires.values() for _ in range(wire.count))
    places: list[tuple[str, int | slice]] = []
    at = 0
    for name, wire in wires.items():
        places.append((name, slice(at, at + wire.count) if wire.count > 1 else at))
        at += wire.count
    cls._places = tuple(places)


def _unchanged(value: float) -> float:
    return value


def _text_bytes(value: str, text: Text) -> bytes:
    data = value.encode()[: text.max_bytes]
    data = data.decode("utf-8", "ignore").encode()
    return bytes([len(data)]) + data
