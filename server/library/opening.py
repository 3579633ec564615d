"""The recording of the session in a route's path, and a moment of it: parameters of routes."""

from typing import Annotated

from fastapi import Depends, Query

from server.http.dependencies import Provided
from server.http.operations import Identifier
from server.library.content import Recording
from server.platform.store import Store

SECONDS_MAX = 1e9


def _open(store: Provided[Store], session: Identifier) -> Recording:
    return Recording.open(store, session)


OpenRecording = Annotated[Recording, Depends(_open)]
"""The recording of the session in the path, also from the bin."""
Moment = Annotated[
    float, Query(ge=-SECONDS_MAX, le=SECONDS_MAX, allow_inf_nan=False, description="s since the start")
]
