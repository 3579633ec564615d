"""The configuration in robot.toml as typed, checked values, with the default of each entry."""

import re
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Annotated, Literal
from urllib.parse import SplitResult, quote, urlsplit

from robot_runtime.contract.craft import DEFAULT_DOCUMENT, Craft, CraftDocument, load_craft
from robot_runtime.contract.limits import SCENE_HEIGHT, SCENE_WIDTH, SET_POINT, ConfigError, Range
from robot_runtime.contract.missions import NO_LIMITS, MissionLimits
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.problems import DocumentEntry
from robot_runtime.contract.text_input import TextError, load_text
from robot_runtime.contract.toml_text import TomlError, read_toml
from robot_runtime.contract.vision_settings import VisionSettings

NETWORK_ENDPOINT = re.compile(r"tls/[^\s/#?;]+:[0-9]+")
"""A Zenoh endpoint with certificates. What may follow in one, from ? or # on, could switch them off."""
ROS2_NAMESPACE = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]{0,63}){0,4}")
HIL_BAUD_MIN = 115_200
"""bit/s from which the line carries the fins' angles at full rate."""

ADOPTED_CRAFT = "craft.toml"
"""File of the data folder with the adopted craft."""

CHIP_CLOCK = 16_000_000
"""Hz."""
BAUD_ERROR_MAX = 0.025
"""Relative error of one end of the line; firmware/src/board/avr/line.cpp has the same limit."""


def _chip_baud(baud: int) -> float:
    """The nearest speed, bit/s, of the ATmega328P's UART with 8 or 16 samples a bit (data sheet, 20.3.1)."""
    made = (CHIP_CLOCK / (samples * max(round(CHIP_CLOCK / (samples * baud)), 1)) for samples in (8, 16))
    return min(made, key=lambda one: abs(one - baud))


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotConfig:
    """The robot's name and mode; `profile` is the amount of work, which "auto" fits to the computer."""

    name: str = "turtle"
    mode: Literal["emulated", "robot", "hil"] = "emulated"
    profile: Literal["auto", "full", "lean"] = "auto"


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkConfig:
    """The serial line; baud in bit/s. `reset` says how to pull the board's reset pin before an upload."""

    port: str = "/dev/serial0"
    baud: Annotated[int, Range(1200, 500_000)] = 250_000
    reset: str = "gpio:/dev/gpiochip0:4"

    def __post_init__(self) -> None:
        made = _chip_baud(self.baud)
        if abs(made / self.baud - 1) > BAUD_ERROR_MAX:
            raise ConfigError(
                f"link.baud is {self.baud}; the chip at 16 MHz makes {made:.0f} of it, "
                f"{made / self.baud - 1:+.1%}, and the error must be within {BAUD_ERROR_MAX:.1%}"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class HilConfig:
    """Hardware in the loop: the board that computes the fins, and the computer of the simulator."""

    board: Literal["emulated", "real"] = "emulated"
    simulator: Literal["here", "elsewhere"] = "here"


@dataclass(frozen=True, slots=True, kw_only=True)
class CraftConfig:
    """The file with the craft's physical numbers, for simulator, scenarios and model-based controller."""

    file: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlConfig:
    """The control node; rate in Hz, set points in m, gains by controller and name.

    A command to the fins lasts 250 ms: at 10 Hz two ticks in a row may be late.
    """

    rate: Annotated[float, Range(10, 50)] = 10.0
    controller: str = "bang_bang"
    set_point: Annotated[float, SET_POINT] = 0.5
    set_point_detected: Annotated[float, SET_POINT] = 1.0
    steering: Literal["none", "beacons"] = "none"
    gains: dict[str, dict[str, float]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class VisionConfig(VisionSettings):
    """The vision node; picture size in pixels."""

    camera: Literal["scene", "card", "file", "pi", "usb"] = "scene"
    file: str = ""
    width: Annotated[int, Range(64, 1920)] = 320
    height: Annotated[int, Range(48, 1080)] = 240

    def __post_init__(self) -> None:
        VisionSettings.__post_init__(self)
        limits = {"width": SCENE_WIDTH, "height": SCENE_HEIGHT} if self.camera == "scene" else {}
        for name, limit in limits.items():
            if getattr(self, name) > limit.maximum:
                raise ConfigError(
                    f"vision.{name} is {getattr(self, name)}; the scene draws {limit.maximum:g} at most"
                )

    @property
    def settings(self) -> VisionSettings:
        """Returns the settings that may change while the node runs."""
        return VisionSettings(**{one.name: getattr(self, one.name) for one in fields(VisionSettings)})


@dataclass(frozen=True, slots=True, kw_only=True)
class ZenohConfig:
    """The Zenoh endpoints that other computers with a certificate of this robot may use."""

    listen: list[str] = field(default_factory=list)
    scouting: bool = False

    def __post_init__(self) -> None:
        for endpoint in self.listen:
            if not NETWORK_ENDPOINT.fullmatch(endpoint):
                raise ConfigError(
                    f"zenoh.listen has {endpoint!r}, which would let the whole network command the robot; "
                    'use "tls/ADDRESS:PORT", which lets in certificates of this robot alone'
                )


@dataclass(frozen=True, slots=True, kw_only=True)
class ServerConfig:
    """The web server: its address, the host names that browsers may use, TLS, and the proxy before it."""

    host: str = "127.0.0.1"
    port: Annotated[int, Range(1, 65535)] = 8000
    allowed_hosts: list[str] = field(default_factory=lambda: ["localhost", "127.0.0.1", "[::1]"])
    tls: bool = False
    public_url: str = ""
    trusted_proxies: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionsConfig:
    """Automatic recording and retention; times in days, free space in GB of 10^9 bytes; 0 disables a rule."""

    record_at_arming: bool = True
    undo_days: Annotated[float, Range(0, 3650)] = 7.0
    keep_days: Annotated[float, Range(0, 36500)] = 0.0
    keep_free: Annotated[float, Range(0, 100_000)] = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class DoorsConfig:
    """The doors for other programs: `/rosbridge` and `/foxglove` of the server, ROS 2; closed unless true.

    For ROS 2: the endpoint, the domain, and the namespace, "" or as "/name".
    """

    rosbridge: bool = False
    foxglove: bool = False
    ros2: bool = False
    ros2_listen: str = "tls/127.0.0.1:7448"
    ros2_domain: Annotated[int, Range(0, 232)] = 0
    ros2_namespace: str = ""

    def __post_init__(self) -> None:
        if not NETWORK_ENDPOINT.fullmatch(self.ros2_listen):
            raise ConfigError(
                f"doors.ros2_listen is {self.ros2_listen!r}, which would let in programs without a "
                'certificate of this robot; use "tls/ADDRESS:PORT"'
            )
        if not ROS2_NAMESPACE.fullmatch(self.ros2_namespace):
            raise ConfigError(
                f'doors.ros2_namespace is {self.ros2_namespace!r}; use a name of ROS 2 such as "/turtle", or '
                '"" for none'
            )

    @property
    def ros2_address(self) -> tuple[str, int]:
        """Returns the host and port of the door for ROS 2."""
        host, _, port = self.ros2_listen.removeprefix("tls/").rpartition(":")
        return host.strip("[]"), int(port)


@dataclass(frozen=True, slots=True, kw_only=True)
class EventsConfig:
    """The broker and the address that are told of alarms, sessions, tests and missions; off unless named.

    Files are beside this one, or have a whole path, and are readable by the robot's user alone.
    """

    mqtt: str = ""
    mqtt_user: str = ""
    mqtt_password_file: str = ""
    webhook: str = ""
    webhook_token_file: str = ""
    ca_file: str = ""

    def __post_init__(self) -> None:
        broker = _check_address("events.mqtt", self.mqtt, ("mqtt", "mqtts"))
        receiver = _check_address("events.webhook", self.webhook, ("http", "https"))
        if self.mqtt and (broker.path or broker.query):
            raise ConfigError(f"events.mqtt is {self.mqtt!r}; it ends with the broker's name and port")
        if bool(self.mqtt_user) != bool(self.mqtt_password_file):
            raise ConfigError("events.mqtt_user and events.mqtt_password_file go together; one is missing")
        if self.mqtt_password_file and broker.scheme == "mqtt" and not _is_here(broker):
            raise ConfigError("events.mqtt would send the password for everybody to read; use mqtts://")
        if self.webhook_token_file and receiver.scheme == "http" and not _is_here(receiver):
            raise ConfigError("events.webhook would send the token for everybody to read; use https://")


def _check_address(name: str, address: str, schemes: tuple[str, str]) -> SplitResult:
    """The parts of an address, which may be empty. Raises ConfigError."""
    try:
        parts = urlsplit(address)
        # Encoded as it is looked up, which a name with an empty part cannot be.
        host = parts.hostname and parts.hostname.encode("idna")
        usable = parts.scheme in schemes and host and parts.port != 0 and "@" not in parts.netloc
    except ValueError:
        usable = False
    if address and (not usable or "#" in address or not address.isprintable() or " " in address):
        raise ConfigError(f"{name} is {address!r}; use {schemes[0]}://NAME or {schemes[1]}://NAME")
    other = "".join(one for one in parts.path + parts.query if not one.isascii())
    if other:
        raise ConfigError(f"{name} has {other!r}, which addresses write as {quote(other)}")
    return parts


def _is_here(address: SplitResult) -> bool:
    name = address.hostname or ""
    return name in ("localhost", "::1") or name.startswith("127.")


@dataclass(frozen=True, slots=True, kw_only=True)
class Config:
    """The whole configuration."""

    robot: RobotConfig = RobotConfig()
    link: LinkConfig = LinkConfig()
    hil: HilConfig = HilConfig()
    craft: CraftConfig = CraftConfig()
    control: ControlConfig = ControlConfig()
    vision: VisionConfig = VisionConfig()
    missions: MissionLimits = NO_LIMITS
    zenoh: ZenohConfig = ZenohConfig()
    server: ServerConfig = ServerConfig()
    sessions: SessionsConfig = SessionsConfig()
    doors: DoorsConfig = DoorsConfig()
    events: EventsConfig = EventsConfig()

    def __post_init__(self) -> None:
        if self.robot.mode == "hil" and self.link.baud < HIL_BAUD_MIN:
            raise ConfigError(
                f"link.baud is {self.link.baud}; hardware in the loop needs {HIL_BAUD_MIN} or more to "
                "carry the fins' angles to the simulator in time"
            )


def load(path: Path) -> Config:
    """Reads the configuration from this file. Raises ConfigError if it cannot be read or used."""
    return load_with_text(path)[0]


def load_with_text(path: Path) -> tuple[Config, str]:
    """Reads the configuration and its text, which the file may not hold later. Raises as `load`."""
    try:
        text = load_text(path)
    except OSError as problem:
        raise ConfigError(f"{path} cannot be read: {problem}") from problem
    except TextError as problem:
        raise ConfigError(f"{path} cannot be read: it {problem}") from problem
    return parse_text(text, path), text


def parse_text(text: str, path: Path) -> Config:
    """Returns the configuration in this text of the file `path`. Raises ConfigError if it cannot be used."""
    try:
        table = read_toml(text)
    except TomlError as problem:
        raise ConfigError(f"{path} cannot be read: it {problem}") from problem
    return parse(Config, table, DocumentEntry(path.name))


def craft_path(config: Config, path: Path, data: Path) -> Path:
    """Returns the craft file that the configuration at `path` names, else the adopted one in the data folder.

    The adopted one need not exist. Raises ConfigError if the named one does not.
    """
    if not config.craft.file:
        return data / ADOPTED_CRAFT
    named = path.absolute().parent / config.craft.file
    if not named.is_file():
        raise ConfigError(f"craft.file is {config.craft.file!r}; there is no file {named}")
    return named


def craft_document_in(path: Path) -> CraftDocument:
    """Returns this craft file, that of the default craft where there is none. Raises ConfigError."""
    return load_craft(path) if path.exists() else DEFAULT_DOCUMENT


def craft_in(path: Path) -> Craft:
    """Returns the craft in this file, the default one where there is no file. Raises ConfigError."""
    return craft_document_in(path).craft
