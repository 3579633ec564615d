"""Taking a snapshot: the robot sends the picture, the recorder stores it, and only then it is taken."""

import asyncio

from robot_runtime.clock import Clock
from robot_runtime.contract.topics import TIME
from robot_runtime.transport.blocks import Block
from server.features.snapshots.schemas import TakenSnapshot
from server.platform.errors import ConflictError, UnavailableError
from server.platform.store import Store
from server.recording.recorder import Recorder
from server.recording.session import find_row
from server.stream.bridge import Bridge

PAUSE_SECONDS = 0.5
"""s between two snapshots: each is some hundred kilobytes, and the picture at most a little newer."""
ARRIVAL_SECONDS = 3.0
"""s from the robot's answer to the arrival of the picture."""


class SnapshotRefusedError(ConflictError):
    """No recording, no picture, or the last snapshot was just taken"""


class SnapshotLostError(UnavailableError):
    """The picture did not arrive, or cannot be stored"""


class SnapshotTaker:
    """Takes one snapshot after the other into the session that records."""

    def __init__(self, bridge: Bridge, recorder: Recorder, store: Store, clock: Clock) -> None:
        self._bridge = bridge
        self._recorder = recorder
        self._store = store
        self._clock = clock
        self._begun = float("-inf")
        self._newest = float("-inf")
        self._arrived = asyncio.Event()

    def see(self, block: Block) -> None:
        """Note that a snapshot's picture has arrived."""
        self._newest = float(TIME.unpack_from(block.payload)[0])
        self._arrived.set()

    async def take(self) -> TakenSnapshot:
        """Take a snapshot; return when it is on the disk.

        Raise SnapshotRefusedError, SnapshotLostError, RefusedError, RuntimeSilentError, StoreError.
        """
        session = self._recorder.session
        if session is None or self._recorder.stopping:
            raise SnapshotRefusedError(
                "Nothing is being recorded, so no session can keep a snapshot. Start a recording first."
            )
        now = self._clock.now()
        if now - self._begun < PAUSE_SECONDS:
            raise SnapshotRefusedError(
                f"The last snapshot was taken less than {PAUSE_SECONDS:g} s ago. Wait a moment."
            )
        self._begun = now
        taken = float((await self._bridge.query("snapshot"))["time"])
        await self._await_picture(taken)
        if (recording := self._recorder.session) is None or recording.id != session.id:
            raise SnapshotLostError(
                f"The recording of “{session.name}” ended before the snapshot arrived. Take it again."
            )
        await self._recorder.flush()
        row = await asyncio.to_thread(find_row, self._store, session.id)
        return TakenSnapshot(session=session.id, time=taken - row.started_steady)

    async def _await_picture(self, taken: float) -> None:
        try:
            async with asyncio.timeout(ARRIVAL_SECONDS):
                while self._newest < taken:
                    self._arrived.clear()
                    await self._arrived.wait()
        except TimeoutError:
            raise SnapshotLostError(
                f"The snapshot did not arrive within {ARRIVAL_SECONDS:g} s, so it may be missing. "
                "The connection to the robot's runtime is slow: see the System page, then take it again."
            ) from None
