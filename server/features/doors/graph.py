"""The connections between programs, topics and services at a door, as Foxglove draws them."""

from dataclasses import dataclass, field
from typing import Any

from server.features.doors.house import Door
from server.features.doors.rosapi import NODE, command_services
from server.features.doors.twist import TAKEN_IN

Edges = dict[str, list[str]]


@dataclass(frozen=True, slots=True)
class Graph:
    """The nodes that publish and subscribe to each topic, and that offer each service."""

    published: Edges = field(default_factory=dict)
    subscribed: Edges = field(default_factory=dict)
    services: Edges = field(default_factory=dict)


def draw_graph(door: Door) -> Graph:
    """The connections now."""
    published: Edges = {one.name: [NODE] for one in door.publisher.channels.values() if not one.hidden}
    subscribed: Edges = {name: [NODE] for name in TAKEN_IN}
    for client in door.clients:
        node = f"/client_{client.number}"
        for name in sorted(door.published.get(client, ())):
            published.setdefault(name, []).append(node)
        names = {one.channel.name for one in client.subscriptions.values() if not one.channel.hidden}
        for name in sorted(names):
            subscribed.setdefault(name, []).append(node)
    return Graph(published, subscribed, {name: [NODE] for name in command_services()})


def list_changes(before: Graph, after: Graph) -> dict[str, list[Any]]:
    """The fields of a connectionGraphUpdate after `before`."""
    gone = before.published.keys() - after.published.keys() | (
        before.subscribed.keys() - after.subscribed.keys()
    )
    return {
        "publishedTopics": _changed(before.published, after.published, "publisherIds"),
        "subscribedTopics": _changed(before.subscribed, after.subscribed, "subscriberIds"),
        "advertisedServices": _changed(before.services, after.services, "providerIds"),
        "removedTopics": sorted(gone - after.published.keys() - after.subscribed.keys()),
        "removedServices": sorted(before.services.keys() - after.services.keys()),
    }


def _changed(before: Edges, after: Edges, key: str) -> list[dict[str, Any]]:
    names = [*after, *(before.keys() - after.keys())]
    return [
        {"name": name, key: after.get(name, [])}
        for name in names
        if before.get(name, []) != after.get(name, [])
    ]
