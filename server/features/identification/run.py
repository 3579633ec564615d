"""Performs a fit of recorded sessions; needs SciPy, which the robot itself does without."""

from collections.abc import Callable, Sequence
from importlib.util import find_spec

from robot_runtime.contract.craft import Craft
from robot_runtime.errors import RefusedError
from server.features.identification.schemas import IdentificationResult
from server.platform.store import Reader

NO_SCIPY = (
    "Identification needs the package scipy, which is not installed. Install it where µ-CAT is installed, "
    "with “pip install scipy”, or copy the sessions to another computer and fit them there."
)


def check_choice(sessions: Sequence[int], left_out: int | None) -> None:
    """Raise RefusedError for an impossible choice of sessions, and where SciPy is missing."""
    if left_out in sessions:
        raise RefusedError(f"Session {left_out} cannot be both fitted and left out. Choose another one.")
    if find_spec("scipy") is None:
        raise RefusedError(NO_SCIPY)


def run_identification(
    store: Reader,
    sessions: Sequence[int],
    left_out: int | None,
    start: Craft,
    progress: Callable[[float], None],
) -> IdentificationResult:
    """Fit the craft to the sessions.

    Raise RefusedError with the reason if they cannot be used, UnknownSessionError, StoreError,
    RecordingError.
    """
    check_choice(sessions, left_out)
    from robot_runtime.experiments.identification.identify import identify
    from server.features.identification.result import describe
    from server.features.identification.sessions import read_streams

    chosen = list(dict.fromkeys(sessions))
    streams = [read_streams(store, number) for number in chosen]
    check = None if left_out is None else read_streams(store, left_out)
    try:
        identification = identify(streams, check, start, progress)
    except ValueError as problem:
        raise RefusedError(str(problem)) from problem
    names = {number: streamed.name for number, streamed in zip(chosen, streams, strict=True)}
    return describe(identification, names, left_out, start)
