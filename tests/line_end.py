"""One end of the serial line that sends the test's packets, at the test's time."""

from collections.abc import Sequence

from robot_runtime.contract.packets import Hello, Packet, Stop, encode
from robot_runtime.link.channel import Channel
from robot_runtime.link.framing import OPEN, Decoder, build
from robot_runtime.link.session import session_key

_NO_PACE = 10**30
"""baud; a line on which everything goes out at once."""


class LineEnd:
    """Greets, delivers and acknowledges as the real ends do, but sends nothing by itself.

    What it hears is acknowledged by what it says next.
    """

    def __init__(self, is_host: bool) -> None:
        self.frames = 0
        self._is_host = is_host
        self._decoder = Decoder()
        self._channel = Channel(_NO_PACE, 4096)
        self._mine: int | None = None
        self._theirs: int | None = None
        self._asked = False

    @property
    def invalid(self) -> int:
        """Number of invalid frames."""
        return self._decoder.invalid

    @property
    def joined(self) -> bool:
        """True if it has a session with the other end."""
        return self._channel.key != OPEN

    @property
    def key(self) -> int:
        """The key of its session's frames."""
        return self._channel.key

    @property
    def urgent(self) -> bool:
        """True if an acknowledgement is due at either end."""
        return self._channel.urgent

    def say(self, packets: Sequence[Packet], now: float) -> bytes:
        """Return the bytes of these packets: HELLO and STOP in open frames, the others in the session."""
        opened = [packet for packet in packets if isinstance(packet, Hello | Stop)]
        data = build(opened, 0, 0) if opened else b""
        for packet in packets:
            if isinstance(packet, Hello):
                self._mine, self._asked = packet.epoch, True
                if not self._is_host:
                    self._join()
            elif packet.reliable:
                self._channel.queue(encode(packet))
            elif not isinstance(packet, Stop):
                self._channel.offer(encode(packet), now)
        return data + (self.poll(now) if len(opened) < len(packets) else b"")

    def poll(self, now: float) -> bytes:
        """Frames that are due by themselves: retransmissions and acknowledgements."""
        data = b""
        while frame := self._channel.poll(now):
            data += frame
        return data

    def hear(self, data: bytes, now: float) -> list[tuple[int, bytes]]:
        """Return the messages in these bytes, by type and payload."""
        heard: list[tuple[int, bytes]] = []
        for frame in self._decoder.feed(data):
            self.frames += 1
            if frame.open and frame.messages[0][0] in (Hello.type, Stop.type):
                heard += frame.messages
                for type_, payload in frame.messages:
                    if type_ == Hello.type:
                        self._see(Hello.from_bytes(payload))
            elif frame.open == (self._channel.key == OPEN):
                heard += self._channel.receive(frame, now)
        return heard

    def _see(self, hello: Hello) -> None:
        another = hello.epoch != self._theirs
        self._theirs = hello.epoch
        if self._asked or not self._is_host:
            self._join()
        elif another:
            self._use(OPEN)  # it restarted, and waits for a greeting
        self._asked = False

    def _join(self) -> None:
        if self._mine is not None and self._theirs is not None:
            host, board = (self._mine, self._theirs) if self._is_host else (self._theirs, self._mine)
            self._use(session_key(host, board))

    def _use(self, key: int) -> None:
        if key != self._channel.key:
            self._decoder.key = key
            self._channel = Channel(_NO_PACE, 4096, key)
