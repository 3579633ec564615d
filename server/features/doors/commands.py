"""Commands of programs to the robot, with the checks of the HTTP interface: role, control, fields, audit."""

import asyncio
from collections.abc import Mapping
from typing import Any

from pydantic import TypeAdapter, ValidationError

from robot_runtime.clock import Clock
from robot_runtime.contract.commands import RobotCommand, StopCommand, http_commands
from robot_runtime.errors import RefusedError
from server.driving.arbiter import ControlArbiter
from server.driving.checked_commands import CheckedCommands, explain_unknown_command
from server.driving.clients import ControlClient
from server.driving.drive_filter import DriveCommand
from server.features.doors.ros_axes import stick_axes
from server.http.audit import AuditLog
from server.http.sign_in.access import Access
from server.http.sign_in.policy import Need, refusal
from server.platform.audit_file import Outcome
from server.platform.errors import ApiError, ForbiddenError
from server.platform.store import StoreError
from server.stream.bridge import Bridge, RuntimeSilentError

COMMANDS: dict[str, type[RobotCommand]] = {cls.policy.name: cls for cls in http_commands()}
TAKE, RELEASE, STOP = "take_control", "release_control", StopCommand.policy.name
REFUSALS = (RefusedError, ApiError, StoreError)


class InvalidCallError(ApiError):
    """The call is not valid"""

    status = 422


class DoorCommands:
    """Commands of a door's clients; `door` is its path, for the audit log."""

    def __init__(
        self,
        door: str,
        clock: Clock,
        access: Access,
        commands: CheckedCommands,
        bridge: Bridge,
        arbiter: ControlArbiter,
        audit: AuditLog,
    ) -> None:
        self._door = door
        self._clock = clock
        self._access = access
        self._commands = commands
        self._bridge = bridge
        self._arbiter = arbiter
        self._audit = audit
        self._under_way: set[asyncio.Task[str]] = set()

    async def perform(self, pilot: "DoorPilot", name: str, fields: Mapping[str, Any]) -> str:
        """Perform a command, or take or release control; return a sentence for the program.

        A command that has begun, and its entry in the audit log, are finished even if the program leaves.
        Raise RefusedError, ApiError, StoreError, each with a text for a person.
        """
        task = asyncio.create_task(self._perform_recorded(pilot, name, fields))
        self._under_way.add(task)
        task.add_done_callback(self._under_way.discard)
        # The robot may carry it out although nobody waits any more.
        return await asyncio.shield(task)

    async def set_parameters(self, pilot: "DoorPilot", values: Mapping[str, Any]) -> str:
        """Set parameters of the robot by their names. Raise as `perform`."""
        return await self.perform(pilot, "parameters", {"values": dict(values)})

    def drive(self, pilot: "DoorPilot", linear: list[float], angular: list[float]) -> None:
        """Pass a Twist on as the position of the sticks. Raise ForbiddenError, NotInControlError."""
        try:
            self._require(pilot, Need.CONTROL)
        except ApiError as problem:
            self._record(pilot, "Message drive", str(problem), "refused")
            raise
        epoch = self._arbiter.lease.epoch
        if pilot.driving != epoch:
            pilot.driving = epoch
            self._record(pilot, "Drive", "", "done")
        pilot.sequence += 1
        command = DriveCommand(
            lease=epoch,
            sequence=pilot.sequence,
            taken=self._clock.now(),
            axes=stick_axes(linear, angular),
        )
        self._arbiter.drive(pilot.owner, command)

    def note_refusal(self, pilot: "DoorPilot", action: str, why: str) -> None:
        """Write a refusal into the audit log."""
        self._record(pilot, action, why, "refused")

    async def _perform_recorded(self, pilot: "DoorPilot", name: str, fields: Mapping[str, Any]) -> str:
        action = {STOP: "STOP", TAKE: "Take control", RELEASE: "Release control"}.get(name, name)
        try:
            text = await self._perform(pilot, name, fields)
        except REFUSALS as problem:
            silent = isinstance(problem, RuntimeSilentError | StoreError)
            self._record(pilot, action, str(problem), "failed" if silent else "refused")
            raise
        self._record(pilot, action, "" if not fields else str(dict(fields)), "done", name)
        return text

    async def _perform(self, pilot: "DoorPilot", name: str, fields: Mapping[str, Any]) -> str:
        if name == STOP:
            await self._bridge.stop()
            return "The robot is disarmed."
        if name == TAKE:
            over = fields.get("over", False)
            if not isinstance(over, bool) or fields.keys() - {"over"}:
                raise InvalidCallError("take_control has one field, over: true takes control from others.")
            self._require(pilot, Need.OPERATOR)
            self._arbiter.take(pilot.owner, over=over)
            return "You have control."
        if name == RELEASE:
            had = self._arbiter.lease.holder == pilot.owner.number
            self._arbiter.release(pilot.owner)
            return "Control is released." if had else "You had no control to release."
        cls = COMMANDS.get(name)
        if cls is None or cls.policy.need is None:
            raise InvalidCallError(explain_unknown_command(name))
        self._require(pilot, cls.policy.need)
        await self._commands.perform(pilot.owner.identity.name, read_command(cls, fields))
        return f"Done: {cls.policy.label or cls.policy.name}."

    def _require(self, pilot: "DoorPilot", need: Need) -> None:
        reason = refusal(self._access.refresh(pilot.owner.identity), need)
        if reason is not None:
            raise ForbiddenError(reason)
        if need is Need.CONTROL:
            self._arbiter.require(pilot.owner)

    def _record(
        self, pilot: "DoorPilot", action: str, about: str, outcome: Outcome, operation: str = ""
    ) -> None:
        noticed = {"arm": "commandArm", STOP: "stopRobot"}.get(operation, "")
        details = f"{self._door} {about}".strip()
        self._audit.record(pilot.owner.identity, pilot.address, action, details, outcome, noticed)


class DoorPilot:
    """A door's client for the control lease, with the count of its driving commands."""

    def __init__(self, owner: ControlClient, address: str) -> None:
        self.owner = owner
        self.address = address
        self.sequence = 0
        self.driving = -1
        """The epoch of control in which it has driven last."""


def read_command(cls: type[RobotCommand], fields: Mapping[str, Any]) -> RobotCommand:
    """Return the command with these fields. Raise InvalidCallError, which names the first wrong field."""
    try:
        command: RobotCommand = TypeAdapter(cls).validate_python(dict(fields))
    except ValidationError as problem:
        first = problem.errors(include_url=False)[0]
        path = ".".join(map(str, first["loc"])) or cls.policy.name
        raise InvalidCallError(f"{cls.policy.name}: {path}: {first['msg']}.") from problem
    return command
