"""Control of the robot for a command in a shell: taken before, kept while it goes on, given back after."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from time import sleep
from typing import Any

from server.features.lease.schemas import ControlState, SeatGiven
from server.platform.running_server import ask
from server.platform.settings import DataFolder, SetupError

LOOK_SECONDS = 0.25


class InControl:
    """Asks the server of this folder with a seat of its own that has control."""

    def __init__(self, folder: DataFolder, seat: SeatGiven) -> None:
        self._folder = folder
        self._seat = seat

    def ask(self, method: str, path: str, body: Mapping[str, Any] | None = None) -> Any:
        """As `running.ask`."""
        return ask(self._folder, method, path, body, headers={"x-mucat-seat": self._seat.key})

    def renew(self) -> None:
        """Keep the seat, and with it control that nobody else has by now; to be called every few seconds."""
        # One that slept for too long has lost them, and what was begun with them goes on.
        with suppress(SetupError):
            self.ask("POST", "/control/renew")

    def take(self, say: Callable[[str], None]) -> None:
        """Have control, or ask for it and wait for the answer. Raises SetupError where it is refused."""
        state = ControlState.model_validate(self.ask("POST", "/control/take"))
        if state.holder is not None and state.holder.seat != self._seat.seat:
            say(f"Control is with {state.holder.name}, who has 10 s to refuse ...")
        while state.request is not None and state.request.seat == self._seat.seat:
            sleep(LOOK_SECONDS)
            state = ControlState.model_validate(self.ask("POST", "/control/renew"))
        if state.holder is None or state.holder.seat != self._seat.seat:
            keeper = "somebody else" if state.holder is None else state.holder.name
            raise SetupError(f"Control stays with {keeper}. Agree with them, and try again.")


@contextmanager
def in_control(folder: DataFolder, say: Callable[[str], None]) -> Iterator[InControl]:
    """Take control, telling with `say` where that takes a while. Raises SetupError."""
    seat = InControl(folder, SeatGiven.model_validate(ask(folder, "POST", "/control/seat")))
    try:
        seat.take(say)
        yield seat
    finally:
        # A server that is gone has taken the seat with it.
        with suppress(SetupError):
            seat.ask("POST", "/control/release")
