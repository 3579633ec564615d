"""The session that a run records: what it says of the scenario, and the moments that are marked in it."""

from time import time

from sqlalchemy import insert

from robot_runtime.clock import Clock
from robot_runtime.errors import Refused
from server.models import Marker, SessionRow
from server.scenarios.run import Run
from server.sessions import new_row
from server.settings import Settings
from server.store import Store


def describe_session(settings: Settings, clock: Clock, run: Run, robot_state: str) -> SessionRow:
    """The session of a run that begins now. Raises Refused where the configuration cannot be read."""
    scenario = run.scenario
    try:
        row = new_row(settings, clock, scenario.title, scenario.description, robot_state)
    except OSError as problem:
        raise Refused(f"The configuration {settings.config} cannot be read: {problem}") from problem
    row.origin = "scenario" if run.place == "live" else "simulated"
    row.scenario = run.text
    row.scenario_name = scenario.name
    row.seed = scenario.seed
    return row


async def mark(store: Store, session: int, moment: float, text: str) -> None:
    """Point out a moment (s, the session's clock). Raises StoreError."""
    values = {"session_id": session, "time": moment, "text": text, "made": time()}
    await store.write(lambda connection: connection.execute(insert(Marker).values(values)))
