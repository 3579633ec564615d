"""A program at a door to which anything may be sent."""

from collections.abc import Iterator
from contextlib import contextmanager

from hypothesis import HealthCheck

from server.container import Container
from server.features.doors.commands import DoorCommands, DoorPilot
from server.features.doors.subscriptions import DoorClient
from server.http.sign_in.identity import SHELL

CHECKS = [HealthCheck.function_scoped_fixture, HealthCheck.too_slow]


@contextmanager
def join_door(container: Container, door: str) -> Iterator[tuple[DoorClient, DoorPilot, DoorCommands]]:
    """A program at this door to which nothing may be sent, without control."""

    async def send(_: str | bytes) -> None:
        raise AssertionError("nothing is sent")

    commands = DoorCommands(
        f"/{door}",
        container.clock,
        container.access,
        container.commands,
        container.bridge,
        container.arbiter,
        container.audit,
    )
    with container.arbiter.page(SHELL) as owner:
        budget = container.budgets.of(SHELL)
        client = DoorClient(1, SHELL, "", send, container.clock, budget)
        yield client, DoorPilot(owner, ""), commands
