"""Every command to the robot, each declared once as a dataclass with its fields, limits and policy.

From a declaration come the runtime's parser, the HTTP route with its body and access rule, the scenario's
event, the entry in the history of parameters, the page's types and docs/reference/commands.md. The runtime
performs commands in `robot_runtime.commands`.
"""

from collections.abc import Callable
from dataclasses import MISSING, Field, asdict, dataclass, field, fields, replace
from enum import IntEnum
from typing import Any, ClassVar, Literal, TypeVar, dataclass_transform

from robot_runtime.contract.calibration import CalibrationValues
from robot_runtime.contract.declarations import Declarations
from robot_runtime.contract.documents import ParameterValue, Steering
from robot_runtime.contract.limits import (
    SET_POINTS,
    AloneSeconds,
    ArmedUnwatched,
    ConfigError,
    DepthSetPoint,
    ExperimentSeconds,
    FilmRate,
    FilmSeconds,
    LoopName,
    RelayAmplitude,
    RelayCycles,
    SettleSeconds,
    VisionRate,
    describe_value,
    make_strict,
)
from robot_runtime.contract.vision_settings import SINCE_0_2, VisionSettings

Piloting = Literal["automatic", "manual"]
FilmQuality = Literal["low", "medium", "high"]


class Need(IntEnum):
    """Rights that an HTTP operation needs; each includes those before it; ADMINISTER needs no control."""

    NOTHING = 0
    VIEWER = 1
    """To be signed in."""
    ARCHIVE = 2
    """To be the lab that the robot has joined, or to have the role of an operator."""
    OPERATOR = 3
    """The role of an operator."""
    CONTROL = 4
    """To hold the control of the robot, which one page or program has at a time."""
    ADMINISTER = 5
    """The role of an operator, and no token whose scope leaves this out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandPolicy:
    """Rules for one command.

    `need`: the rights for its HTTP route; None: only the server and scenarios send it. `tunes`: it may
    change parameters, which the history notes. `in_scenarios`: a scenario may have it as an event.
    `disturbs_experiment`: it is refused while an experiment measures a loop. `label`: its name for people,
    where that is not its summary.
    """

    name: str
    need: Need | None
    tunes: bool
    in_scenarios: bool
    disturbs_experiment: bool
    label: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotCommand:
    """Base of every command."""

    __pydantic_config__: ClassVar[dict[str, Any]] = {"extra": "forbid", "allow_inf_nan": False}
    policy: ClassVar[CommandPolicy]

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Callable[[Any], Any]) -> Any:
        """Return the HTTP interface's schema: `true` and "1" are no numbers, as in the runtime's parser."""
        schema = handler(source)
        make_strict(schema)
        return schema

    @property
    def label(self) -> str:
        """The command in a few words, for a person."""
        return self.policy.label or summary(type(self))

    def payload(self) -> dict[str, Any]:
        """Return the fields as a JSON object, without those that have their default value."""
        given = {field.name for field in fields(self) if getattr(self, field.name) != _default(field)}
        return {name: value for name, value in asdict(self).items() if name in given}


C = TypeVar("C", bound=RobotCommand)
COMMANDS: Declarations[str, type[RobotCommand]] = Declarations("the name of a command")


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(field,))
def command(
    name: str,
    need: Need | None,
    *,
    tunes: bool = False,
    in_scenarios: bool = False,
    disturbs_experiment: bool = False,
    label: str = "",
) -> Callable[[type[C]], type[C]]:
    """Make a class a command, which is a frozen dataclass; see `CommandPolicy`."""

    def declare(cls: type[C]) -> type[C]:
        made = dataclass(frozen=True, slots=True, kw_only=True)(cls)
        made.policy = CommandPolicy(
            name=name,
            need=need,
            tunes=tunes,
            in_scenarios=in_scenarios,
            disturbs_experiment=disturbs_experiment,
            label=label,
        )
        COMMANDS.add(name, made, depth=1)
        return made

    return declare


def summary(cls: type[RobotCommand]) -> str:
    """Return the first sentence of a command's description, without its full stop."""
    return (cls.__doc__ or "").partition(". ")[0].partition("\n")[0].removesuffix(".")


@command("arm", Need.CONTROL, in_scenarios=True, label="Arm")
class ArmCommand(RobotCommand):
    """Arms the robot. It is refused with all reasons against arming."""

    mode: Piloting = field(default="automatic", metadata={"description": "who steers: controller or pilot"})
    alone: AloneSeconds = field(
        default=0.0, metadata={"description": "s for which it may go on without the server"}
    )
    unwatched: ArmedUnwatched | None = field(
        default=None,
        metadata={
            "description": "s for which it may go on while nobody watches; 0: without an end; "
            "null: `[control] unwatched`"
        },
    )


@command("stop", Need.VIEWER, in_scenarios=True, label="STOP")
class StopCommand(RobotCommand):
    """Disarms the robot at once. It is never refused."""


@command("mode", Need.CONTROL, in_scenarios=True)
class ModeCommand(RobotCommand):
    """Lets the pilot or the depth controller steer the armed robot."""

    mode: Piloting = field(metadata={"description": "who steers: controller or pilot"})

    @property
    def label(self) -> str:
        """The command in a few words, for a person."""
        return f"Mode: {self.mode}"


@command("check_fins", Need.CONTROL)
class CheckFinsCommand(RobotCommand):
    """Arms for some seconds and moves each fin. An event says which fins followed; then it disarms."""


@command("acknowledge", Need.CONTROL, in_scenarios=True, label="Alarms acknowledged")
class AcknowledgeCommand(RobotCommand):
    """Acknowledges all alarms. After a failsafe the robot may be armed again from then on."""


@command("lease", None)
class LeaseCommand(RobotCommand):
    """Starts a new epoch of control. The pilot's inputs of earlier epochs are dropped."""

    epoch: int = field(metadata={"description": "number of the control lease"})


@command("set_points", None, tunes=True, in_scenarios=True, disturbs_experiment=True)
class SetPointsCommand(RobotCommand):
    """Sets the depths to hold. What is left out stays as it is."""

    default: DepthSetPoint | None = field(default=None, metadata={"description": "m"})
    detected: DepthSetPoint | None = field(
        default=None, metadata={"description": "m, while the colour is seen"}
    )

    def __post_init__(self) -> None:
        if self.default is None and self.detected is None:
            raise ValueError("set_points needs default, detected or both")

    @property
    def label(self) -> str:
        """The command in a few words, for a person."""
        parts = [] if self.default is None else [f"set point {self.default:g} m"]
        parts += [] if self.detected is None else [f"{self.detected:g} m where the colour is seen"]
        text = ", ".join(parts)
        return text[0].upper() + text[1:]


@command("controller", None, tunes=True, in_scenarios=True, disturbs_experiment=True)
class ControllerCommand(RobotCommand):
    """Chooses the depth controller and sets gains of it."""

    name: str = field(metadata={"description": "the controller's"})
    gains: dict[str, float] = field(
        default_factory=dict, metadata={"description": "by name; the others stay"}
    )

    @property
    def label(self) -> str:
        """The command in a few words, for a person."""
        gains = ", ".join(f"{name} {value:g}" for name, value in self.gains.items())
        return f"Controller {self.name}" + (f": {gains}" if gains else "")


@command("loop", Need.CONTROL, tunes=True, in_scenarios=True, disturbs_experiment=True)
class LoopCommand(RobotCommand):
    """Changes one control loop: all of it or nothing. What is left out stays as it is."""

    name: LoopName
    on: bool | None = field(default=None, metadata={"description": "steer it; in manual: hold it"})
    set_point: float | None = field(default=None, metadata={"description": "m, of the angles rad"})
    controller: str | None = field(default=None, metadata={"description": "the controller's name"})
    gains: dict[str, float] = field(
        default_factory=dict, metadata={"description": "by name, of this or the chosen controller"}
    )

    def __post_init__(self) -> None:
        if self.on is None and self.set_point is None and self.controller is None and not self.gains:
            raise ValueError("loop needs on, set_point, controller or gains")
        span = SET_POINTS[self.name]
        if self.set_point is not None and not span.minimum <= self.set_point <= span.maximum:
            low, high = (describe_value(self.name, limit) for limit in (span.minimum, span.maximum))
            raise ValueError(f"set_point must lie between {low} and {high}")

    @property
    def label(self) -> str:
        """The command in a few words, for a person."""
        parts = [] if self.on is None else ["on" if self.on else "off"]
        parts += [] if self.set_point is None else [f"set point {self.set_point:g}"]
        parts += [] if self.controller is None else [self.controller]
        return f"{self.name.capitalize()}: {', '.join(parts)}"


@command("parameters", Need.CONTROL, tunes=True, disturbs_experiment=True)
class ParametersCommand(RobotCommand):
    """Sets parameters by name, all or none, between two control ticks."""

    values: dict[str, ParameterValue]
    expected: dict[str, ParameterValue] = field(
        default_factory=dict, metadata={"description": "refused where one has another value now"}
    )
    partly: bool = field(
        default=False, metadata={"description": "leave out what cannot be set, instead of refusing all"}
    )

    def __post_init__(self) -> None:
        if not self.values:
            raise ValueError("values must name one parameter at least")


@command("calibrate", Need.CONTROL)
class CalibrateCommand(RobotCommand):
    """Stores a calibration in the board. It is refused while the robot is armed."""

    values: CalibrationValues


@command("measure_gyro", Need.CONTROL)
class MeasureGyroCommand(RobotCommand):
    """Measures the gyroscope's offset for three seconds at rest, and stores it. An event tells the result."""


@command("zero_depth", Need.CONTROL, label="The depth is zero")
class ZeroDepthCommand(RobotCommand):
    """Sets the surface's pressure to the pressure now. It is refused while the robot is armed."""


@command("steering", Need.CONTROL, tunes=True, in_scenarios=True, disturbs_experiment=True)
class SteeringCommand(RobotCommand):
    """Chooses the course while the robot holds its depth."""

    by: Steering = field(
        metadata={"description": "none: stay; beacons: swim to the light that its detectors see"}
    )

    @property
    def label(self) -> str:
        """The command in a few words, for a person."""
        return "Swim towards the light" if self.by == "beacons" else "Stay"


@command("card", Need.CONTROL, in_scenarios=True)
class CardCommand(RobotCommand):
    """Holds a card before the simulated camera, or takes it away."""

    colour: str | None = field(default=None, metadata={"description": "the card's; null: no card"})

    @property
    def label(self) -> str:
        """The command in a few words, for a person."""
        return f"{self.colour.capitalize()} card" if self.colour else "Card away"


@command("vision", None, tunes=True, in_scenarios=True)
class VisionCommand(RobotCommand):
    """Sets the rate of the vision node and the colour that it searches. What is left out stays."""

    rate: VisionRate | None = field(default=None, metadata={"description": "Hz"})
    colour: str | None = None

    def __post_init__(self) -> None:
        if self.rate is None and self.colour is None:
            raise ValueError("vision needs rate, colour or both")

    @property
    def label(self) -> str:
        """The command in a few words, for a person."""
        parts = [] if self.rate is None else [f"at {self.rate:g} Hz"]
        parts += [] if self.colour is None else [f"for {self.colour}"]
        return f"Look {' '.join(parts)}"


@command("film", None)
class FilmCommand(RobotCommand):
    """Films with the camera for some time from now on. The server repeats it while a session is recorded."""

    seconds: FilmSeconds = field(metadata={"description": "0: no longer"})
    rate: FilmRate = field(default=15.0, metadata={"description": "pictures a second"})
    quality: FilmQuality = "medium"


@dataclass(frozen=True, slots=True, kw_only=True)
class VisionSettingsBase(RobotCommand):
    """Replaces all settings of the vision node, also for later starts.

    A setting that version 0.2 did not have stays if it is left out. No other may be left out.
    """

    def __post_init__(self) -> None:
        self.replace(VisionSettings())

    def replace(self, present: VisionSettings) -> VisionSettings:
        """Return the settings, with those of `present` where they are left out.

        Raise ConfigError where they contradict each other.
        """
        given = {field.name: getattr(self, field.name) for field in fields(VisionSettings)}
        return replace(present, **{name: value for name, value in given.items() if value is not None})


# The fields of VisionSettings, without their defaults.
VisionSettingsCommand: type[VisionSettingsBase] = command("vision_settings", Need.CONTROL, tunes=True)(
    type(
        "VisionSettingsCommand",
        (VisionSettingsBase,),
        {
            "__annotations__": {
                field.name: field.type | None if field.name in SINCE_0_2 else field.type  # type: ignore[operator]
                for field in fields(VisionSettings)
            },
            **dict.fromkeys(SINCE_0_2),
            "__doc__": VisionSettingsBase.__doc__,
            "__module__": __name__,
        },
    )
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ExperimentCommand(RobotCommand):
    """Base of the commands that begin an experiment on one loop; values in the loop's unit."""

    number: int = field(metadata={"description": "names the experiment in its documents"})
    loop: LoopName
    low: float = field(metadata={"description": "a lower value ends the experiment"})
    high: float = field(metadata={"description": "a higher value ends the experiment"})
    duration: ExperimentSeconds = field(metadata={"description": "s"})

    def __post_init__(self) -> None:
        if self.low >= self.high:
            low, high = (describe_value(self.loop, limit) for limit in (self.low, self.high))
            raise ConfigError(f"low is {low} and high {high}; the limits must be apart")

    def _require_within(self, name: str, value: float) -> None:
        if not self.low < value < self.high:
            shown, low, high = (describe_value(self.loop, number) for number in (value, self.low, self.high))
            raise ConfigError(f"{name} is {shown}; it must lie between the limits {low} and {high}")

    def _require_set_point(self, name: str, value: float) -> None:
        span = SET_POINTS[self.loop]
        self._require_between(name, value, span.minimum, span.maximum)

    def _require_between(self, name: str, value: float, low: float, high: float) -> None:
        if not low <= value <= high:
            shown, least, most = (describe_value(self.loop, number) for number in (value, low, high))
            raise ConfigError(f"{name} is {shown}; it must lie between {least} and {most}")


@command("step_experiment", None, tunes=True)
class StepExperimentCommand(ExperimentCommand):
    """Begins a step response: the set point goes from `start` to `target` and stays for `duration`.

    The start is held until the value stays within `tolerance` of it, and for `settle` s at most.
    """

    start: float
    target: float
    tolerance: float = field(metadata={"description": "distance from the start that counts as settled"})
    settle: SettleSeconds = field(metadata={"description": "s for which the start is held at most"})

    def __post_init__(self) -> None:
        ExperimentCommand.__post_init__(self)
        self._require_set_point("start", self.start)
        self._require_set_point("target", self.target)
        self._require_between("tolerance", self.tolerance, 0, self.high - self.low)
        if self.start == self.target:
            raise ConfigError("start and target are the same; a step leads from one to the other")
        self._require_within("start", self.start)
        self._require_within("target", self.target)


@command("relay_experiment", None, tunes=True)
class RelayExperimentCommand(ExperimentCommand):
    """Begins a relay experiment: a relay of ±`amplitude` about `set_point` in the controller's place.

    It switches `hysteresis` beyond the set point, measures `cycles` and gives up after `duration`.
    """

    set_point: float
    amplitude: RelayAmplitude = field(metadata={"description": "share of the largest command"})
    hysteresis: float
    cycles: RelayCycles

    def __post_init__(self) -> None:
        ExperimentCommand.__post_init__(self)
        self._require_set_point("set_point", self.set_point)
        self._require_between("hysteresis", self.hysteresis, 0, HYSTERESIS_SHARE * (self.high - self.low))
        self._require_within("set_point", self.set_point)


HYSTERESIS_SHARE = 0.25
"""Largest hysteresis of a relay, as a share of the distance between the limits."""


@command("end_experiment", None, tunes=True)
class EndExperimentCommand(RobotCommand):
    """Ends the running experiment. The loop goes on as before it."""


@command("mission", None, in_scenarios=True, label="Begin a mission")
class MissionCommand(RobotCommand):
    """Arms the robot and begins a mission. It is refused with all reasons against either."""

    text: str = field(metadata={"description": "its TOML, docs/reference/missions.md"})
    library: dict[str, str] = field(
        default_factory=dict, metadata={"description": "the texts of the missions that it calls, by name"}
    )


@command("mission_pause", Need.CONTROL, in_scenarios=True)
class MissionPauseCommand(RobotCommand):
    """Pauses the mission: the robot stays at its depth, and the mission's clocks stand still."""

    on: bool = field(default=True, metadata={"description": "false: go on"})

    @property
    def label(self) -> str:
        """The command in a few words, for a person."""
        return "Pause the mission" if self.on else "Go on with the mission"


@command("mission_skip", Need.CONTROL, in_scenarios=True, label="Skip the mission's step")
class MissionSkipCommand(RobotCommand):
    """Ends the running steps of the mission as a success."""


@command("mission_end", Need.CONTROL, in_scenarios=True, label="End the mission")
class MissionEndCommand(RobotCommand):
    """Ends the mission: its changes are put back, and the robot is stopped."""


def http_commands() -> list[type[RobotCommand]]:
    """Return the commands with the common route `POST /api/robot/commands/NAME`; STOP has a faster one."""
    return [cls for cls in COMMANDS.values() if cls.policy.need is not None and cls is not StopCommand]


def is_required(field: Field[Any]) -> bool:
    """Return True if a command must have a value for this field."""
    return field.default is MISSING and field.default_factory is MISSING


def _default(field: Field[Any]) -> Any:
    return field.default_factory() if field.default_factory is not MISSING else field.default
