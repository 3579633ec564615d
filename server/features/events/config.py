"""The section [events] of robot.toml."""

from dataclasses import dataclass
from urllib.parse import SplitResult, urlsplit

from robot_runtime.contract.limits import ConfigError


@dataclass(frozen=True, slots=True, kw_only=True)
class EventsConfig:
    """The broker for alarms, sessions, tests and missions; off unless named.

    Files are beside this one, or have a whole path, and are readable by the robot's user alone.
    """

    mqtt: str = ""
    mqtt_user: str = ""
    mqtt_password_file: str = ""
    ca_file: str = ""

    def __post_init__(self) -> None:
        broker = _check_broker(self.mqtt)
        if bool(self.mqtt_user) != bool(self.mqtt_password_file):
            raise ConfigError("events.mqtt_user and events.mqtt_password_file go together; one is missing")
        if self.mqtt_password_file and broker.scheme == "mqtt" and not _is_here(broker):
            raise ConfigError("events.mqtt would send the password for everybody to read; use mqtts://")


def _check_broker(address: str) -> SplitResult:
    """Return the parts of the broker's address, which may be empty. Raise ConfigError."""
    try:
        parts = urlsplit(address)
        # Encoded as it is looked up, which a name with an empty part cannot be.
        host = parts.hostname and parts.hostname.encode("idna")
        usable = parts.scheme in ("mqtt", "mqtts") and host and parts.port != 0 and "@" not in parts.netloc
    except ValueError:
        usable = False
    if address and (not usable or "#" in address or not address.isprintable() or " " in address):
        raise ConfigError(f"events.mqtt is {address!r}; use mqtt://NAME or mqtts://NAME")
    if parts.path or parts.query:
        raise ConfigError(f"events.mqtt is {address!r}; it ends with the broker's name and port")
    return parts


def _is_here(address: SplitResult) -> bool:
    name = address.hostname or ""
    return name in ("localhost", "::1") or name.startswith("127.")
