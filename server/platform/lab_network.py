"""Zenoh between a lab's router and its robots: the names below each robot's, and the rights of certificates.

A robot publishes its presence and answers two questions, below its own name. It subscribes to nothing and
asks nobody. The router passes no other question on to it.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from robot_runtime.transport.network import (
    EVERY_MESSAGE,
    access_control,
    allow,
    names_in_force,
    tls_settings,
)

ROBOTS = "robots"
"""Folder of the robots' certificates that are in force, in a lab's folder of certificates."""
PRESENCE, ALIVE = "presence", "alive"
"""Keys of a robot's presence, sent once a second, and of its liveliness token."""
STOP, CLOCK = "lab/stop", "lab/clock"
"""Keys of the questions that a robot answers."""
_LEASE_MS = 2000
"""A silent peer counts as gone after this time; Zenoh's own default is 10 s."""
_LEASE: Mapping[str, Any] = {"transport/link/tx/lease": _LEASE_MS}


def key_of(robot: str, name: str) -> str:
    """Return the Zenoh key of one of these names; the robot may be "*"."""
    return f"mucat/{robot}/{name}"


def router_settings(folder: Path) -> Mapping[str, Any]:
    """Return Zenoh's settings for a lab's router with the certificates in `folder`.

    Raise ConfigError where its own is not there.
    """
    return {
        "transport/link/protocols": ["unixsock-stream", "tls"],
        "transport/link/tls": tls_settings(folder, "listen", "Start the lab with mucat lab run."),
        "access_control": _access(names_in_force(folder, ROBOTS)),
        **_LEASE,
    }


def member_settings(folder: Path) -> Mapping[str, Any]:
    """Return Zenoh's settings for a robot with the lab's certificate in `folder`.

    Raise ConfigError where it is not there.
    """
    tls = tls_settings(folder, "connect", "Leave the lab (mucat lab leave), and join it again.")
    # A lab has several addresses. Of its authority's certificates only the router's own is a server's.
    tls["verify_name_on_connect"] = False
    return {"transport/link/protocols": ["tls"], "transport/link/tls": tls, **_LEASE}


def _access(common_names: Sequence[str]) -> dict[str, Any]:
    """Return the access control: all for the lab's own server, its own keys for each robot, else nothing."""
    rules = [allow("here", ("ingress", "egress"), EVERY_MESSAGE, ["**"])]
    subjects: list[dict[str, Any]] = [{"id": "here", "link_protocols": ["unixsock-stream"]}]
    policies: list[dict[str, Any]] = [{"rules": ["here"], "subjects": ["here"]}]
    for common_name in common_names:
        own = _rules_of(common_name.partition(".")[0], common_name)
        rules += own
        subjects.append({"id": common_name, "link_protocols": ["tls"], "cert_common_names": [common_name]})
        policies.append({"rules": [rule["id"] for rule in own], "subjects": [common_name]})
    return access_control(rules, subjects, policies)


def _rules_of(robot: str, common_name: str) -> list[dict[str, Any]]:
    presence, alive = [key_of(robot, PRESENCE)], [key_of(robot, ALIVE)]
    questions = [key_of(robot, STOP), key_of(robot, CLOCK)]
    return [
        allow(f"{common_name} sends", ("ingress",), ("put",), presence),
        # Else it would send nothing: it is told of a subscriber to all robots by that subscriber's own key.
        allow(f"{common_name} learns who listens", ("egress",), ("declare_subscriber",), ["mucat/**"]),
        allow(f"{common_name} is there", ("ingress",), ("liveliness_token",), alive),
        allow(f"{common_name} answers", ("ingress",), ("declare_queryable", "reply"), questions),
        allow(f"{common_name} is asked", ("egress",), ("query",), questions),
    ]
