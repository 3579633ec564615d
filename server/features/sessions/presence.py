"""Whether a session is there to be changed."""

from sqlalchemy import Connection
from sqlmodel import col, select

from server.features.sessions.session import HIDDEN
from server.platform.models import SessionRow


class UnknownSessionError(LookupError):
    """There is no session of this number."""

    def __init__(self, session: int) -> None:
        super().__init__(f"There is no session {session}; the list of sessions has those that there are.")


class SessionStateError(Exception):
    """What is asked cannot be done with this session as it is; the text says why."""


def require(connection: Connection, session: int) -> str:
    """The state of a session, within a transaction. Raises UnknownSessionError."""
    state = connection.execute(select(SessionRow.state).where(col(SessionRow.id) == session)).scalar()
    if state is None or state in HIDDEN:
        raise UnknownSessionError(session)
    return str(state)
