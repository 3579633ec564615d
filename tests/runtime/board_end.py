"""The board's end of a pseudo-terminal, driven by a test."""

import os
import select
import threading
import time
import tty
from collections.abc import Callable
from pathlib import Path

from robot_runtime.contract.packets import DEFINITIONS_HASH, Hello, Packet
from tests.line_end import LineEnd
from tests.waiting import SECONDS


def hello(definitions: int = DEFINITIONS_HASH, epoch: int = 9) -> Hello:
    return Hello(definitions=definitions, epoch=epoch, credit=64)


class BoardEnd:
    """The far end of a pseudo-terminal whose near end is linked at `path`."""

    def __init__(self, path: Path) -> None:
        # The near end stays open here too: without anybody there, the far end cannot be read.
        self.master, self._slave = os.openpty()
        tty.setraw(self._slave)
        path.unlink(missing_ok=True)
        path.symlink_to(os.ttyname(self._slave))
        self._end = LineEnd(is_host=False)
        self._saying = threading.Lock()

    def say(self, *packets: Packet) -> None:
        with self._saying:
            os.write(self.master, self._end.say(packets, time.monotonic()))

    def hear(self, type_: int) -> bytes:
        """Return the payload of the next packet of this type."""
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            for heard, payload in self.listen(end - time.monotonic()):
                if heard == type_:
                    return payload
        raise AssertionError(f"the host did not send 0x{type_:02x}")

    def listen(self, seconds: float) -> list[tuple[int, bytes]]:
        """Return the packets that come next, by type and payload; none where nothing comes in this time."""
        if not select.select([self.master], [], [], max(seconds, 0))[0]:
            return []
        data = os.read(self.master, 4096)
        with self._saying:
            return self._end.hear(data, time.monotonic())

    @property
    def waiting(self) -> bool:
        """True if a sent frame is not acknowledged."""
        return self._end.urgent

    def hear_until(self, condition: Callable[[], bool]) -> None:
        """Receive until the condition holds."""
        end = time.monotonic() + SECONDS
        while not condition():
            assert time.monotonic() < end
            self.listen(end - time.monotonic())

    def vanish(self) -> None:
        os.close(self._slave)
        os.close(self.master)
