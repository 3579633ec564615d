"""The serial link to the board: a thread that opens the port, runs the session, and reopens it for ever."""

import logging
import threading
import time
from collections.abc import Callable

from robot_runtime.clock import Clock
from robot_runtime.link.link_driver import PERIOD, LinkDriver, PortError
from robot_runtime.link.port import Port
from robot_runtime.link.session import BoardMessage

log = logging.getLogger(__name__)

_RETRY = 0.25


class SerialLink(LinkDriver):
    """The thread that keeps the serial link to the board alive; its callbacks run on that thread."""

    def __init__(
        self,
        path: str,
        baud: int,
        clock: Clock,
        epoch: int,
        on_messages: Callable[[list[BoardMessage]], None],
        on_change: Callable[[], None],
    ) -> None:
        super().__init__(path, baud, clock, epoch, on_messages, on_change)
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="link", daemon=True)

    def start(self) -> None:
        """Begin to open the port."""
        self._thread.start()

    def close(self) -> None:
        """Close the port and end the thread."""
        self._ending.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._ending.is_set():
            try:
                with Port(self.path, self.baud) as port:
                    self._run_session(port)
            except PortError as problem:
                self.report(str(problem))
            except Exception:
                log.exception("the link failed")
                self.report("an error in the software ended the connection; see the runtime's log")
            self._ending.wait(_RETRY)

    def _run_session(self, port: Port) -> None:
        self.attach(port.write)
        try:
            while not self._ending.is_set():
                self.poll()
                self._receive_next(port)
        except Exception:
            self.record_loss()
            raise
        finally:
            self.detach()

    def _receive_next(self, port: Port) -> None:
        wait = self.wait()
        if self.gathering:
            time.sleep(PERIOD)
            wait = 0.0
        # An idle port and one that has gone both read as nothing; only the latter claims to be ready.
        if port.wait(wait):
            self.receive(port.read())
