"""Messages of ROS 2: their CDR serialisation and the hashes of their types, by the package rosbags."""

from collections.abc import Mapping
from dataclasses import asdict
from functools import cache
from importlib.util import find_spec
from typing import Any

TRIGGER = "std_srvs/srv/Trigger"
EVENT_INFO = "service_msgs/msg/ServiceEventInfo"
PAYLOAD_MAX = 4096
"""Bytes of a program's message or request, without its attachment."""
NO_ROSBAGS = (
    "doors.ros2 needs the package rosbags, which is not installed. Install it where µ-CAT is installed, with "
    "`pip install mucat[ros2]`, or set doors.ros2 = false in robot.toml."
)

Fields = Mapping[str, Any]


def has_rosbags() -> bool:
    """Return True where the package rosbags is installed."""
    return find_spec("rosbags") is not None


class Ros2Types:
    """The standard types of ROS 2, with the service type `std_srvs/srv/Trigger`.

    The definitions are those of Jazzy. Iron, Kilted and Lyrical have the same ones for all types in use here.
    """

    def __init__(self) -> None:
        import numpy
        from rosbags.interfaces import Nodetype
        from rosbags.typesys import Stores, get_typestore

        self._numpy = numpy
        self._kinds = Nodetype
        self._store = get_typestore(Stores.ROS2_JAZZY)
        constants, event = self._store.fielddefs[EVENT_INFO]
        # ROS 2 makes a uint8 of a char before it hashes the type; rosbags hashes the char.
        self._store.fielddefs[EVENT_INFO] = constants, [(name, _without_char(kind)) for name, kind in event]
        self._store.register(_trigger(Nodetype))

    def hash(self, kind: str) -> str:
        """Return the hash of a type's definition (RIHS01, REP 2011)."""
        return self._store.hash_rihs01(kind)

    def encode(self, kind: str, fields: Fields) -> bytes:
        """Return the CDR of a message with these fields, little-endian."""
        return bytes(self._store.serialize_cdr(self._build(kind, fields), kind, little_endian=True))

    def decode(self, kind: str, data: bytes) -> dict[str, Any]:
        """Return the fields of a message. Raise ValueError where the bytes are not of this type."""
        from rosbags.serde import SerdeError

        if data[:2] not in (b"\0\0", b"\0\1"):
            raise ValueError(f"The bytes are not the CDR of {kind}.")
        try:
            message: Any = self._store.deserialize_cdr(data, kind)
        except (SerdeError, ValueError) as problem:
            raise ValueError(f"The bytes are not the CDR of {kind}.") from problem
        return asdict(message)

    def _build(self, kind: str, fields: Fields) -> Any:
        values = {
            name: self._convert(definition, fields[name])
            for name, definition in self._store.fielddefs[kind][1]
            if name in fields
        }
        if not values:
            values = {PLACEHOLDER: 0}
        return self._store.types[kind](**values)

    def _convert(self, definition: Any, value: Any) -> Any:
        kind, inner = definition
        if kind == self._kinds.BASE:
            return value
        if kind == self._kinds.NAME:
            return self._build(inner, value)
        (element, name), _ = inner
        if element == self._kinds.NAME:
            return [self._build(name, item) for item in value]
        if name[0] == "string":
            return list(value)
        if isinstance(value, bytes):
            return self._numpy.frombuffer(value, self._numpy.uint8)
        return self._numpy.array(value, name[0])


@cache
def ros2_types() -> Ros2Types:
    """Return the types, loaded once, slowly. Raise ImportError without rosbags."""
    return Ros2Types()


PLACEHOLDER = "structure_needs_at_least_one_member"
"""The one field of a message without fields, as ROS 2 sends it: a byte."""


def _without_char(definition: Any) -> Any:
    if isinstance(definition, tuple):
        return tuple(_without_char(item) for item in definition)
    return "uint8" if definition == "char" else definition


def _trigger(kinds: Any) -> dict[str, Any]:
    """Return the definitions of std_srvs/srv/Trigger, which rosbags lacks, and of its implied types."""
    request, response, event = (f"{TRIGGER}_{part}" for part in ("Request", "Response", "Event"))

    def of(name: str) -> Any:
        return (kinds.NAME, name)

    def base(name: str) -> Any:
        return (kinds.BASE, (name, 0))

    members = {
        request: [(PLACEHOLDER, base("uint8"))],
        response: [("success", base("bool")), ("message", base("string"))],
        event: [
            ("info", of(EVENT_INFO)),
            ("request", (kinds.SEQUENCE, (of(request), 1))),
            ("response", (kinds.SEQUENCE, (of(response), 1))),
        ],
        TRIGGER: [
            ("request_message", of(request)),
            ("response_message", of(response)),
            ("event_message", of(event)),
        ],
    }
    return {name: ([], fields) for name, fields in members.items()}
