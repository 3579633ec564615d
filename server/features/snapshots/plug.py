"""The plug of snapshots: each is seen on its way to the recorder."""

from robot_runtime.contract.topics import SNAPSHOT
from server.feature import Plug
from server.features.snapshots.taker import SnapshotTaker
from server.stream.feed import Feed


class SnapshotsPlug(Plug):
    """The plug that notices the pictures of snapshots."""

    def __init__(self, feed: Feed, taker: SnapshotTaker) -> None:
        feed.listen(taker.see, SNAPSHOT)
