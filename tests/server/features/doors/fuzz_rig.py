"""A program at a door to which anything may be sent."""

from collections.abc import Iterator
from contextlib import contextmanager

from hypothesis import HealthCheck

from server.container import Container
from server.driving.arbiter import ControlArbiter
from server.driving.checked_commands import CheckedCommands
from server.features.doors.commands import DoorCommands, DoorPilot
from server.features.doors.subscriptions import DoorClient
from server.http.audit import AuditLog
from server.http.sign_in.access import Access
from server.http.sign_in.identity import SHELL
from server.stream.bridge import Bridge
from server.stream.budget import Budgets

CHECKS = [HealthCheck.function_scoped_fixture, HealthCheck.too_slow]


@contextmanager
def join_door(container: Container, door: str) -> Iterator[tuple[DoorClient, DoorPilot, DoorCommands]]:
    """A program at this door to which nothing may be sent, without control."""

    async def send(_: str | bytes) -> None:
        raise AssertionError("nothing is sent")

    commands = DoorCommands(
        f"/{door}",
        container.clock,
        container.services.get(Access),
        container.services.get(CheckedCommands),
        container.services.get(Bridge),
        container.services.get(ControlArbiter),
        container.services.get(AuditLog),
    )
    with container.services.get(ControlArbiter).page(SHELL) as owner:
        budget = container.services.get(Budgets).of(SHELL)
        client = DoorClient(1, SHELL, "", send, container.clock, budget)
        yield client, DoorPilot(owner, ""), commands
