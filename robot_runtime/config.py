"""The robot's part of robot.toml as typed, checked values, with the default of each entry.

The other sections are the server's and its features', which declare them.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from robot_runtime.contract.battery_pack import CAPACITY
from robot_runtime.contract.buoyancy import SALINITY, TEMPERATURE
from robot_runtime.contract.craft import DEFAULT_DOCUMENT, Craft, CraftDocument, load_craft
from robot_runtime.contract.limits import (
    SCENE_HEIGHT,
    SCENE_WIDTH,
    SET_POINT,
    STREAM_HEIGHT,
    STREAM_RATE,
    ConfigError,
    DeepestDepth,
    Range,
    UnwatchedLimit,
)
from robot_runtime.contract.missions import NO_LIMITS, MissionLimits
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.problems import DocumentEntry
from robot_runtime.contract.text_input import TextError, load_text
from robot_runtime.contract.toml_text import TomlError, read_toml
from robot_runtime.contract.vision_settings import VisionSettings

NETWORK_ENDPOINT = re.compile(r"tls/[^\s/#?;]+:[0-9]+")
"""A Zenoh endpoint with certificates. What may follow in one, from ? or # on, could switch them off."""
HIL_BAUD_MIN = 115_200
"""bit/s from which the line carries the fins' angles at full rate."""

ADOPTED_CRAFT = "craft.toml"
"""File of the data folder with the adopted craft."""

CHIP_CLOCK = 16_000_000
"""Hz."""
BAUD_ERROR_MAX = 0.025
"""Relative error of one end of the line; firmware/src/board/avr/line.cpp has the same limit."""


def _chip_baud(baud: int) -> float:
    """Return the UART's nearest speed, bit/s, with 8 or 16 samples a bit (ATmega328P data sheet, 20.3.1)."""
    made = (CHIP_CLOCK / (samples * max(round(CHIP_CLOCK / (samples * baud)), 1)) for samples in (8, 16))
    return min(made, key=lambda rate: abs(rate - baud))


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotConfig:
    """The robot's name and mode; `profile` is the amount of work: "auto" fits it to the computer."""

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
    """The file with the craft's physical numbers, for simulator, scenarios and model-based controller.

    The reserve of buoyancy (g) is this robot's as weighed, in water of that temperature (°C) and salinity.
    """

    file: str = ""
    reserve: Annotated[float, Range(0, 500)] = 0.0
    temperature: Annotated[float, TEMPERATURE] = 20.0
    salinity: Annotated[float, SALINITY] = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class BatteryConfig:
    """The battery, of which the board measures only the voltage."""

    capacity: Annotated[float, Range(0, 100)] = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlConfig:
    """The control node; rate in Hz, set points in m, gains by controller and name.

    A command to the fins lasts 250 ms: at 10 Hz two ticks in a row may be late. No set point lies below
    `deepest`, m, in any mode or mission. An armed robot that nobody watches for `unwatched` s is stopped,
    unless the arming said otherwise, or a mission runs.
    """

    rate: Annotated[float, Range(10, 50)] = 10.0
    controller: str = "bang_bang"
    set_point: Annotated[float, SET_POINT] = 0.5
    set_point_detected: Annotated[float, SET_POINT] = 1.0
    deepest: DeepestDepth = 3.0
    unwatched: UnwatchedLimit = 30.0
    steering: Literal["none", "beacons"] = "none"
    gains: dict[str, dict[str, float]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class VisionConfig(VisionSettings):
    """The vision node and the camera's stream; picture sizes in pixels.

    The stream has the shape of the vision's pictures, so that what is found lies at the same place in both.
    """

    camera: Literal["scene", "card", "file", "pi", "usb"] = "scene"
    file: str = ""
    width: Annotated[int, Range(64, 1920)] = 320
    height: Annotated[int, Range(48, 1080)] = 240
    stream_width: Annotated[int, Range(64, 1920)] = 640
    stream_rate: Annotated[float, STREAM_RATE] = 15.0

    def __post_init__(self) -> None:
        VisionSettings.__post_init__(self)
        limits = {"width": SCENE_WIDTH, "height": SCENE_HEIGHT, "stream_width": SCENE_WIDTH}
        for name, limit in limits.items() if self.camera == "scene" else ():
            if getattr(self, name) > limit.maximum:
                raise ConfigError(
                    f"vision.{name} is {getattr(self, name)}; the scene draws {limit.maximum:g} at most"
                )
        low, high = STREAM_HEIGHT.minimum, STREAM_HEIGHT.maximum
        if not low <= self.stream_size[1] <= high:
            raise ConfigError(
                f"vision.stream_width is {self.stream_width}, which makes the stream's pictures "
                f"{self.stream_size[1]} high, in the shape of {self.width} × {self.height}; "
                f"it must be {low:g} to {high:g}"
            )

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the pictures that are searched."""
        return self.width, self.height

    @property
    def stream_size(self) -> tuple[int, int]:
        """Width and height of the stream's pictures."""
        return self.stream_width, round(self.stream_width * self.height / self.width)

    @property
    def settings(self) -> VisionSettings:
        """The settings that may change while the node runs."""
        return VisionSettings(**{field.name: getattr(self, field.name) for field in fields(VisionSettings)})


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
class Config:
    """The sections that the robot's runtime reads."""

    robot: RobotConfig = RobotConfig()
    link: LinkConfig = LinkConfig()
    hil: HilConfig = HilConfig()
    craft: CraftConfig = CraftConfig()
    battery: BatteryConfig = BatteryConfig()
    control: ControlConfig = ControlConfig()
    vision: VisionConfig = VisionConfig()
    missions: MissionLimits = NO_LIMITS
    zenoh: ZenohConfig = ZenohConfig()

    @property
    def mission_limits(self) -> MissionLimits:
        """The limits of missions, which go no deeper than anything else."""
        return replace(self.missions, depth=min(self.missions.depth, self.control.deepest))

    @property
    def buoyancy_known(self) -> bool:
        """True if the robot was weighed, or is a simulated one, whose water holds it."""
        return self.robot.mode != "robot" or self.craft.reserve > 0

    @property
    def battery_capacity(self) -> float:
        """The Ah of the battery; 0: not known. A simulated one is known where none is configured."""
        return self.battery.capacity or (0.0 if self.robot.mode == "robot" else CAPACITY)

    def __post_init__(self) -> None:
        if self.robot.mode == "hil" and self.link.baud < HIL_BAUD_MIN:
            raise ConfigError(
                f"link.baud is {self.link.baud}; hardware in the loop needs {HIL_BAUD_MIN} or more to "
                "carry the fins' angles to the simulator in time"
            )


def load(path: Path) -> Config:
    """Read the configuration from this file. Raise ConfigError if it cannot be read or used."""
    return load_with_text(path)[0]


def load_with_text(path: Path) -> tuple[Config, str]:
    """Read the configuration and its text, which the file may not hold later. Raise as `load`."""
    text = read_file(path)
    return parse_text(text, path), text


def read_file(path: Path) -> str:
    """Read the text of a configuration. Raise ConfigError if it cannot be read."""
    try:
        return load_text(path)
    except OSError as problem:
        raise ConfigError(f"{path} cannot be read: {problem}") from problem
    except TextError as problem:
        raise ConfigError(f"{path} cannot be read: it {problem}") from problem


def parse_text(text: str, path: Path) -> Config:
    """Return the configuration in this text of the file `path`. Raise ConfigError if it cannot be used."""
    return parse_table(read_table(text, path), path)


def read_table(text: str, path: Path) -> dict[str, Any]:
    """Return all sections of this text of the file `path`. Raise ConfigError if it is no TOML."""
    try:
        return read_toml(text)
    except TomlError as problem:
        raise ConfigError(f"{path} cannot be read: it {problem}") from problem


def parse_table(table: Mapping[str, Any], path: Path) -> Config:
    """Return the robot's sections among these of the file `path`. Raise ConfigError."""
    own = {field.name for field in fields(Config)}
    return parse(
        Config, {name: value for name, value in table.items() if name in own}, DocumentEntry(path.name)
    )


def craft_path(config: Config, path: Path, data: Path) -> Path:
    """Return the craft file that the configuration at `path` names, else the adopted one in the data folder.

    It need not exist.
    """
    return path.absolute().parent / config.craft.file if config.craft.file else data / ADOPTED_CRAFT


def craft_in_force(config: Config, path: Path, data: Path) -> Craft:
    """Return the craft in the file of `craft_path`. Raise ConfigError, also where a named one is missing."""
    file = craft_path(config, path, data)
    if config.craft.file and not file.is_file():
        raise ConfigError(f"craft.file is {config.craft.file!r}; there is no file {file}")
    return craft_in(file)


def craft_document_in(path: Path) -> CraftDocument:
    """Return the craft file at this path, or the default craft's if there is none. Raise ConfigError."""
    return load_craft(path) if path.exists() else DEFAULT_DOCUMENT


def craft_in(path: Path) -> Craft:
    """Return the craft in this file, or the default craft if there is no file. Raise ConfigError."""
    return craft_document_in(path).craft
