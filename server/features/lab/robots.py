"""The robots that a lab knows."""

from collections.abc import Sequence
from time import time

from sqlalchemy import Connection, delete, func
from sqlmodel import col, select

from server.features.lab.schemas import NewLabRobot
from server.platform.errors import ConflictError, NotFoundError
from server.platform.models import LabRobotRow
from server.platform.paired_robots import ROBOTS_MAX, TooManyRobotsError
from server.platform.store import Store, insert_row


class UnknownRobotError(NotFoundError):
    """There is no such robot"""


class RobotKnownError(ConflictError):
    """A robot has this name, or there are too many"""


class LabRobots:
    """Robots by their numbers. Every method raises StoreError."""

    def __init__(self, store: Store) -> None:
        self._store = store

    def listed(self) -> Sequence[LabRobotRow]:
        """Return all, by name."""
        with self._store.read() as database:
            return database.exec(select(LabRobotRow).order_by(LabRobotRow.name)).all()

    async def add(self, robot: NewLabRobot) -> int:
        """Add a robot; return its number. Raise RobotKnownError, TooManyRobotsError."""

        def write(connection: Connection) -> int:
            same = select(LabRobotRow.id).where(LabRobotRow.name == robot.name)
            if connection.execute(select(func.count()).select_from(LabRobotRow)).scalar_one() >= ROBOTS_MAX:
                raise TooManyRobotsError
            if connection.execute(same).first() is not None:
                raise RobotKnownError(f"The lab knows a robot “{robot.name}” already. Remove that one first.")
            return insert_row(connection, LabRobotRow, {**robot.model_dump(), "added": time()})

        return await self._store.write(write)

    async def remove(self, robot: int) -> None:
        """Remove a robot; its sessions stay in the archive. Raise UnknownRobotError."""
        if await self._store.execute(delete(LabRobotRow).where(col(LabRobotRow.id) == robot)) == 0:
            raise UnknownRobotError(f"The lab knows no robot {robot}.")
