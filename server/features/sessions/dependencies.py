"""Parameters and answers that the routes of sessions share."""

from typing import Annotated

from fastapi import Depends, Path

from server.features.sessions.catalogue import Catalogue
from server.features.sessions.recording import Recording
from server.features.sessions.session import UnknownSessionError
from server.http.dependencies import Provided
from server.http.problems import answers
from server.platform.errors import ConflictError
from server.platform.models import IDENTIFIER_MAX
from server.platform.store import Store, StoreError

UNKNOWN = answers(UnknownSessionError)
STORING = answers(ConflictError, StoreError)

Identifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]


def open_recording(store: Provided[Store], catalogue: Provided[Catalogue], session: Identifier) -> Recording:
    """The recording of the session in the path, also from the bin. Raises UnknownSessionError."""
    return Recording(store, catalogue.row(session))


OpenRecording = Annotated[Recording, Depends(open_recording)]
"""A route's parameter that is the recording of the session in its path."""
