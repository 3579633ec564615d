"""The serial link to the board: a thread that opens the port, runs the session, and reopens it for ever.

Where nothing is urgent the bytes of a connected board may be read in step with control instead: the control
loop then calls `receive_waiting` and `send_due` with every tick, and the thread sleeps.
"""

import logging
import threading
import time
from collections.abc import Callable

from robot_runtime.clock import Clock
from robot_runtime.contract.packets import Packet
from robot_runtime.link.link_driver import PERIOD, LinkDriver, PortError
from robot_runtime.link.port import Port
from robot_runtime.link.session import BoardMessage

log = logging.getLogger(__name__)

_RETRY = 0.25
STEP_PATIENCE = 0.5
"""s without a step after which the thread reads by itself: the control loop hangs."""
HEARTBEAT_EARLY = 0.03
"""s: a step comes no sooner than the next heartbeat, but perhaps a little later."""


class SerialLink(LinkDriver):
    """The thread that keeps the serial link to the board alive.

    Its callbacks run on that thread; `in_step` with control also on the one that calls `receive_waiting`.
    """

    def __init__(
        self,
        path: str,
        baud: int,
        clock: Clock,
        epoch: int,
        on_messages: Callable[[list[BoardMessage]], None],
        on_change: Callable[[], None],
        *,
        in_step: bool = False,
    ) -> None:
        super().__init__(path, baud, clock, epoch, on_messages, on_change)
        self.in_step = in_step
        self._stepped = float("-inf")
        self._port: Port | None = None
        self._failure: Exception | None = None
        self._turn = threading.Lock()
        """Held by the thread that works on the line."""
        self._waking = threading.Event()
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="link", daemon=True)

    def start(self) -> None:
        """Begin to open the port."""
        self._thread.start()

    def close(self) -> None:
        """Close the port and end the thread."""
        self._ending.set()
        self._waking.set()
        self._thread.join()

    def send(self, *packets: Packet) -> bool:
        """Send these packets, as `LinkDriver.send`; the thread waits for their acknowledgement."""
        sent = super().send(*packets)
        self._wake_if_urgent()
        return sent

    def receive_waiting(self, wait: float = 0.0) -> bool:
        """Handle the bytes that come within `wait` (s); return False where only the thread may."""

        def receive(port: Port) -> None:
            if port.wait(wait):
                self.receive(port.read())

        return self._work(receive)

    def send_due(self) -> None:
        """Send what is due in step with control: an acknowledgement, or a heartbeat."""
        self._work(lambda _: self.poll(HEARTBEAT_EARLY))

    def _work(self, work: Callable[[Port], object]) -> bool:
        self._stepped = time.monotonic()
        if not self.gathering or not self._turn.acquire(blocking=False):
            return False
        try:
            if self._port is None:
                return False
            work(self._port)
        except Exception as problem:
            # The thread ends the session by it, as if it had come upon it itself.
            self._failure = problem
            self._waking.set()
        finally:
            self._turn.release()
        self._wake_if_urgent()
        return True

    def _wake_if_urgent(self) -> None:
        if self.in_step and not self.gathering:
            self._waking.set()

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
        self._port, self._failure = port, None
        try:
            while not self._ending.is_set():
                if self._steps_go_on():
                    continue
                with self._turn:
                    self.poll()
                    self._receive_next(port)
        except Exception:
            self.record_loss()
            raise
        finally:
            with self._turn:
                self._port = None
            self.detach()

    def _steps_go_on(self) -> bool:
        """Wait while control reads; return False when this thread must. Raise what failed in a step."""
        if not self.in_step or not self.gathering:
            return False
        self._waking.wait(STEP_PATIENCE)
        self._waking.clear()
        if self._failure is not None:
            raise self._failure
        return self.gathering and time.monotonic() - self._stepped < STEP_PATIENCE

    def _receive_next(self, port: Port) -> None:
        wait = self.wait()
        if self.gathering:
            time.sleep(PERIOD)
            wait = 0.0
        # An idle port and one that has gone both read as nothing; only the latter claims to be ready.
        if port.wait(wait):
            self.receive(port.read())
