"""CBOR (RFC 8949) of a message: JSON's types, and bytes. cbor2 has no armv6 wheel."""

from collections.abc import Mapping
from struct import pack
from typing import Any

_FALSE, _TRUE, _NULL = b"\xf4", b"\xf5", b"\xf6"
_WHOLE, _NEGATIVE, _BYTES, _TEXT, _ARRAY, _MAP = range(6)
_DOUBLE = b"\xfb"


def encode_cbor(value: Any) -> bytes:
    """Return the CBOR of a value. Raise TypeError, or OverflowError on a whole number beyond 64 bits."""
    parts: list[bytes] = []
    _encode(value, parts)
    return b"".join(parts)


def _encode(value: Any, parts: list[bytes]) -> None:
    if value is None:
        parts.append(_NULL)
    elif isinstance(value, bool):
        parts.append(_TRUE if value else _FALSE)
    elif isinstance(value, int):
        parts.append(_head(_WHOLE, value) if value >= 0 else _head(_NEGATIVE, -1 - value))
    elif isinstance(value, float):
        parts.append(_DOUBLE + pack(">d", value))
    elif isinstance(value, str):
        data = value.encode(errors="replace")
        parts.append(_head(_TEXT, len(data)) + data)
    elif isinstance(value, bytes):
        parts.append(_head(_BYTES, len(value)) + value)
    elif isinstance(value, Mapping):
        parts.append(_head(_MAP, len(value)))
        for key, item in value.items():
            _encode(str(key), parts)
            _encode(item, parts)
    elif isinstance(value, list | tuple):
        parts.append(_head(_ARRAY, len(value)))
        for item in value:
            _encode(item, parts)
    else:
        raise TypeError(f"{type(value).__name__} has no CBOR here")


def _head(kind: int, count: int) -> bytes:
    first = kind << 5
    if count < 24:
        return bytes([first | count])
    for code, form, limit in ((24, ">BB", 8), (25, ">BH", 16), (26, ">BI", 32), (27, ">BQ", 64)):
        if count < 1 << limit:
            return pack(form, first | code, count)
    raise OverflowError(f"{count} has more than 64 bits")
