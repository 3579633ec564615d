"""A robot whose runtime says whether it is armed, so that a lab may pull from it."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from server.health.monitor import HealthMonitor
from tests.server.blocks import state_block
from tests.server.serving import Served
from tests.server.waiting import until

PERIOD = 0.5
"""s between two states: an old one counts as none."""


class PulledRobot(Served):
    """A running robot."""

    armed = False

    async def say_state(self) -> None:
        """Say it for ever."""
        number = 0
        while True:
            number += 1
            now = self.container.clock.now()
            self.runtime.publish(state_block(number, time=now, armed=self.armed))
            await asyncio.sleep(PERIOD)

    async def tell(self, *, armed: bool) -> None:
        """Arm or disarm the robot, and wait until its server knows."""
        monitor, self.armed = self.get(HealthMonitor), armed
        await until(lambda: (monitor.state() or {}).get("armed") is armed, "the state")


@asynccontextmanager
async def saying_state(served: Served) -> AsyncIterator[PulledRobot]:
    """A served robot that is disarmed, and says so."""
    robot = PulledRobot(**vars(served))
    saying = asyncio.create_task(robot.say_state())
    try:
        await robot.tell(armed=False)
        yield robot
    finally:
        saying.cancel()
