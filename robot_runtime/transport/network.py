"""Zenoh on the network: TLS with certificates at both ends, and the rights of each certificate's name.

The Unix sockets in the data folder stay free: their files say who may open them.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Literal

from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.topics import CRAFT, MOTOR, OBSERVER, TRUTH

AUTHORITY, CERTIFICATE, KEY = "authority.pem", "certificate.pem", "key.pem"
"""The files of a certificate's folder: the authority's certificate, its own, and its key."""
SIMULATORS = "simulators"
"""Folder of the simulators' certificates that are in force; each file has its certificate's name."""

LOCAL_ONLY: Mapping[str, Any] = {"transport/link/protocols": ["unixsock-stream"]}
"""Zenoh's settings for a process that neither listens on the network nor connects through it."""

_SENDS = ("sense", "simulator/stream", TRUTH.name, CRAFT.name, OBSERVER.name)
_RECEIVES = (MOTOR.name, TRUTH.name)
_ANSWERS = ("simulator/**", "scene/**")
EVERY_MESSAGE = (
    "put",
    "delete",
    "declare_subscriber",
    "query",
    "declare_queryable",
    "reply",
    "liveliness_token",
    "liveliness_query",
    "declare_liveliness_subscriber",
)


def names_in_force(folder: Path, holders: str = SIMULATORS) -> list[str]:
    """Return the common names of these holders' certificates in force: simulators, or a lab's robots."""
    return sorted(path.stem for path in (folder / holders).glob("*.pem"))


def listen_settings(folder: Path, robot: str) -> Mapping[str, Any]:
    """Return Zenoh's settings for a robot that listens on the network with the certificate in `folder`.

    Raise ConfigError where it is not there.
    """
    tls = tls_settings(folder, "listen", "mucat run makes them when zenoh.listen is set in robot.toml.")
    return {
        "transport/link/protocols": ["unixsock-stream", "tls"],
        "transport/link/tls": tls,
        "access_control": _access(robot, names_in_force(folder)),
    }


def connect_settings(folder: Path) -> Mapping[str, Any]:
    """Return Zenoh's settings for a simulator elsewhere with the certificate in `folder`.

    Raise ConfigError where it is not there.
    """
    tls = tls_settings(
        folder, "connect", "Copy the folder here that mucat certificate issue has made on the robot."
    )
    # Addresses of robots change. Of this authority's certificates only the robot's own is a server's.
    tls["verify_name_on_connect"] = False
    return {"transport/link/protocols": ["tls"], "transport/link/tls": tls}


def tls_settings(folder: Path, end: Literal["listen", "connect"], remedy: str) -> dict[str, str | bool]:
    """Return Zenoh's TLS settings at this end, with the certificate in `folder`. Raise ConfigError."""
    files = {name: folder / name for name in (AUTHORITY, CERTIFICATE, KEY)}
    missing = [name for name, path in files.items() if not path.is_file()]
    if missing:
        raise ConfigError(f"{folder} lacks {', '.join(missing)} for Zenoh on the network. {remedy}")
    return {
        "root_ca_certificate": str(files[AUTHORITY]),
        f"{end}_certificate": str(files[CERTIFICATE]),
        f"{end}_private_key": str(files[KEY]),
        "enable_mtls": True,
    }


def _access(robot: str, names: list[str]) -> dict[str, Any]:
    """Return Zenoh's access control: all keys here, a simulator's own for these names, else none."""
    both = ("ingress", "egress")
    rules = [
        allow("here", both, EVERY_MESSAGE, ["**"]),
        allow("sends", ("ingress",), ("put",), _keys(robot, _SENDS)),
        allow("learns who listens", ("egress",), ("declare_subscriber",), _keys(robot, _SENDS)),
        allow("listens", ("ingress",), ("declare_subscriber",), _keys(robot, _RECEIVES)),
        allow("receives", ("egress",), ("put",), _keys(robot, _RECEIVES)),
        allow("answers", both, ("query", "declare_queryable", "reply"), _keys(robot, _ANSWERS)),
    ]
    subjects: list[dict[str, Any]] = [{"id": "here", "link_protocols": ["unixsock-stream"]}]
    policies: list[dict[str, Any]] = [{"rules": ["here"], "subjects": ["here"]}]
    if names:
        # Without names the subject would be everybody.
        subjects.append({"id": "simulators", "link_protocols": ["tls"], "cert_common_names": names})
        policies.append({"rules": [rule["id"] for rule in rules[1:]], "subjects": ["simulators"]})
    return access_control(rules, subjects, policies)


def access_control(
    rules: list[dict[str, Any]], subjects: list[dict[str, Any]], policies: list[dict[str, Any]]
) -> dict[str, Any]:
    """Return Zenoh's access control that allows what the rules do, and nothing else."""
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }


def allow(name: str, flows: Iterable[str], messages: Iterable[str], keys: Iterable[str]) -> dict[str, Any]:
    """Return a rule of Zenoh's access control that allows these messages of these keys."""
    return {
        "id": name,
        "permission": "allow",
        "flows": list(flows),
        "messages": list(messages),
        "key_exprs": list(keys),
    }


def _keys(robot: str, names: Iterable[str]) -> list[str]:
    return [f"mucat/{robot}/{name}" for name in names]
