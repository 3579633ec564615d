"""Names on Zenoh as rmw_zenoh expects them: keys, liveliness tokens, quality of service and attachments.

    topic or service := <domain>/<name>/<type>/<type hash>
    token            := @ros2_lv/<domain>/<session>/<node>/<entity>/<kind>/<enclave>/<namespace>/<node's name>
                        [/<name>/<type>/<type hash>/<quality of service>]
    attachment       := sequence i64 | time i64 (ns, UTC) | 16 u8 | sender's identifier (16 bytes)
                                                                                     (little-endian)

In a token each name's slashes are `%`. Source: the design document of ros2/rmw_zenoh, and its code.
"""

from dataclasses import dataclass
from hashlib import sha256
from struct import Struct, error
from typing import Literal

from server.features.doors.session import UnusableMessageError

SPACE = "@ros2_lv"
NODE = "mucat"
NODE_NUMBER = 0
GID_BYTES = 16
ATTACHMENT = Struct(f"<qqB{GID_BYTES}s")
Kind = Literal["NN", "MP", "MS", "SS"]
"""Node, publisher, subscription, service."""


@dataclass(frozen=True, slots=True)
class Attachment:
    """The attachment of a message or a call; the answer to a call repeats its sequence number and `gid`."""

    sequence: int
    time: int
    gid: bytes

    def to_bytes(self) -> bytes:
        """Return the attachment's bytes."""
        return ATTACHMENT.pack(self.sequence, self.time, GID_BYTES, self.gid)

    @classmethod
    def from_bytes(cls, data: bytes) -> "Attachment":
        """Read an attachment. Raise UnusableMessageError."""
        try:
            sequence, time, size, gid = ATTACHMENT.unpack(data)
        except error:
            size = 0
        if size != GID_BYTES:
            raise UnusableMessageError("A call needs the attachment of rmw_zenoh.")
        return cls(sequence, time, gid)


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A topic or service of the robot.

    `depth` samples wait for a subscriber; `latched` is ROS's durability "transient local".
    """

    kind: Kind
    name: str
    type: str
    hash: str
    depth: int = 10
    latched: bool = False

    @property
    def quality(self) -> str:
        """Reliability, durability, history, deadline, lifespan, liveliness; empty: the default.

        Defaults are reliable, volatile, keep last, and no limits of time.
        """
        return f":{'1' if self.latched else ''}:,{self.depth}:,:,:,,"

    @property
    def wire_type(self) -> str:
        """The type's name as DDS writes it."""
        package, kind, name = self.type.split("/")
        return f"{package}::{kind}::dds_::{name}_"


@dataclass(frozen=True, slots=True)
class Ros2Names:
    """The names of the robot's node: in this domain, and below this namespace ("" or "/name")."""

    domain: int
    namespace: str

    def full_name(self, name: str) -> str:
        """Return the name that other nodes use."""
        return self.namespace + name

    def key(self, endpoint: Endpoint) -> str:
        """Return the key of a topic's messages, or of a service's calls."""
        name = self.full_name(endpoint.name).strip("/")
        return f"{self.domain}/{name}/{endpoint.wire_type}/{endpoint.hash}"

    def any_type(self, endpoint: Endpoint) -> str:
        """Return the key for any type and hash."""
        return f"{self.domain}/{self.full_name(endpoint.name).strip('/')}/*/*"

    def node_token(self, session: str) -> str:
        """Return the liveliness token of the node."""
        return self._token(session, NODE_NUMBER, "NN")

    def token(self, session: str, number: int, endpoint: Endpoint) -> str:
        """Return the liveliness token of a topic or service, the node's entity of this number."""
        name = _mangle(self.full_name(endpoint.name))
        own = f"{name}/{endpoint.wire_type}/{endpoint.hash}/{endpoint.quality}"
        return f"{self._token(session, number, endpoint.kind)}/{own}"

    def _token(self, session: str, number: int, kind: Kind) -> str:
        namespace = _mangle(self.namespace or "/")
        return f"{SPACE}/{self.domain}/{session}/{NODE_NUMBER}/{number}/{kind}/%/{namespace}/{NODE}"


def gid_of(token: str) -> bytes:
    """Return an identifier of the sender with this token."""
    return sha256(token.encode()).digest()[:GID_BYTES]


def _mangle(name: str) -> str:
    return name.replace("/", "%")
