"""Whether a session is there to be changed."""

from sqlalchemy import Connection
from sqlmodel import col, select

from server.features.sessions.session import HIDDEN
from server.platform.errors import ConflictError, NotFoundError
from server.platform.models import SessionRow


class UnknownSessionError(NotFoundError):
    """There is no such session"""

    def __init__(self, session: int) -> None:
        super().__init__(f"There is no session {session}; the list of sessions has those that there are.")


class SessionStateError(ConflictError):
    """Refused now"""


def require(connection: Connection, session: int) -> str:
    """The state of a session, within a transaction. Raises UnknownSessionError."""
    state = connection.execute(select(SessionRow.state).where(col(SessionRow.id) == session)).scalar()
    if state is None or state in HIDDEN:
        raise UnknownSessionError(session)
    return str(state)
