"""The survey of a version, beside a real server and without one."""

import asyncio
import sqlite3
from contextlib import closing

from server.features.installation.survey import survey
from server.health.monitor import HealthMonitor
from server.platform.running_server import announce
from server.platform.settings import Settings
from tests.server.blocks import state_block
from tests.server.serving import Served
from tests.server.waiting import until


async def arm(served: Served) -> None:
    """Make an armed robot that this computer's shell can ask about."""

    def is_armed() -> bool:
        return (served.get(HealthMonitor).state() or {}).get("armed") is True

    announce(served.settings)
    served.runtime.publish(state_block(0, armed=True))
    await until(is_armed, "the state")


async def test_a_damaged_database_does_not_hide_an_armed_robot(served: Served) -> None:
    await arm(served)
    with closing(sqlite3.connect(served.settings.data.database)) as database, database:
        database.execute("DROP TABLE session")
    result = await asyncio.to_thread(survey, served.settings)
    assert (result.armed, result.recording) == (True, False)
    assert result.problem


def test_without_a_server_nobody_can_say_whether_the_robot_is_armed(settings: Settings) -> None:
    result = survey(settings)
    assert (result.running, result.armed) == ("", None)
    assert "No server works on" in result.problem
