"""A door's publisher: it converts samples for the subscribed channels."""

from collections import defaultdict
from collections.abc import Callable, Iterable

from server.features.doors.channels import ChannelMessage, DoorChannel, Sample, sources_of
from server.features.doors.subscriptions import DoorClient, DoorSubscription
from server.stream.hub import EvictedError

Evict = Callable[[DoorClient, EvictedError], None]


class Publisher:
    """The channels of one door, and their subscribers."""

    def __init__(self, channels: Iterable[DoorChannel], evict: Evict) -> None:
        self.channels = {channel.name: channel for channel in channels}
        self._evict = evict
        self._by_source: defaultdict[str, list[DoorChannel]] = defaultdict(list)
        for channel in self.channels.values():
            for source in channel.sources:
                self._by_source[source].append(channel)
        self._subscribed: dict[str, dict[DoorSubscription, DoorClient]] = {}

    def subscribe(self, client: DoorClient, subscription: DoorSubscription) -> None:
        """Pass a channel's messages to a client from now on."""
        self._subscribed.setdefault(subscription.channel.name, {})[subscription] = client

    def unsubscribe(self, subscription: DoorSubscription) -> None:
        """Pass no more messages to this subscription."""
        named = self._subscribed.get(subscription.channel.name, {})
        named.pop(subscription, None)
        if not named:
            self._subscribed.pop(subscription.channel.name, None)

    def sources(self) -> frozenset[str]:
        """Return the topics of the subscribed channels."""
        return sources_of(self.channels[name] for name in self._subscribed)

    def listens(self, source: str) -> bool:
        """Return True where a sample of this source has a subscriber."""
        return any(channel.name in self._subscribed for channel in self._by_source.get(source, ()))

    def publish(self, source: str, samples: Iterable[Sample]) -> None:
        """Convert samples of one topic, and queue the messages for the subscribers."""
        channels = [
            channel for channel in self._by_source.get(source, ()) if channel.name in self._subscribed
        ]
        for sample in samples:
            for channel in channels:
                fields = channel.convert(sample)
                if fields is not None:
                    self._offer(ChannelMessage(channel, sample.time, fields))

    def greet(self, client: DoorClient, subscription: DoorSubscription, newest: Iterable[Sample]) -> None:
        """Queue the newest message of a latched channel for a new subscriber."""
        channel = subscription.channel
        for sample in newest:
            if channel.latched and sample.source in channel.sources:
                fields = channel.convert(sample)
                if fields is not None:
                    client.offer(subscription, ChannelMessage(channel, sample.time, fields))

    def _offer(self, message: ChannelMessage) -> None:
        for subscription, client in [*self._subscribed.get(message.channel.name, {}).items()]:
            try:
                client.offer(subscription, message)
            except EvictedError as reason:
                self._evict(client, reason)
