"""The plug of missions."""

from robot_runtime.contract.topics import EVENT
from server.feature import Plug
from server.features.missions.marks import MissionMarks
from server.features.missions.trials import MissionTrials
from server.stream.feed import Feed


class MissionsPlug(Plug):
    """The plug that puts the marks of missions into the recording."""

    def __init__(self, marks: MissionMarks, trials: MissionTrials, feed: Feed) -> None:
        self._marks = marks
        self._trials = trials
        feed.listen(marks.see, EVENT)

    async def stop(self) -> None:
        """Cancel a trial."""
        await self._trials.close()

    async def close(self) -> None:
        """Store the last marks."""
        await self._marks.close()
