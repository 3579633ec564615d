"""The bring-up in the interface."""

from typing import Literal

from pydantic import Field

from robot_runtime.contract.packets import FIN_COUNT
from robot_runtime.experiments.bring_up.procedure import StepState
from robot_runtime.experiments.bring_up.readings import Field as MagneticField
from robot_runtime.experiments.bring_up.results import Verdict
from robot_runtime.simulation.boards.workbench import Lamp, Pose
from server.http.request_body import RequestBody
from server.platform.runs import RUN_MEANING
from server.platform.schema_base import Schema

Phase = Literal["idle", "starting", "ready", "ending"]


class BringUpQuestion(Schema):
    """A number that a person gives, or one of the choices."""

    name: str
    label: str
    unit: str
    minimum: float
    maximum: float
    choices: list[str] = Field(description="empty for a number")
    optional: bool


class BringUpAction(Schema):
    """A button of a step. A button to hold is posted every 100 ms while held, and with `stop` at the end."""

    name: str
    label: str
    kind: Literal["press", "hold"]
    inputs: list[BringUpQuestion]


class BringUpResult(Schema):
    """One check of one part."""

    what: str
    expected: str
    measured: str
    verdict: Verdict
    advice: str = Field(description="what to do where it is not good")


class BringUpStep(Schema):
    """A step: its task and its results."""

    name: str
    title: str
    about: str
    expected: str
    state: StepState = Field(description="skipped: left out by a person, and not measured since")
    actions: list[BringUpAction]
    results: list[BringUpResult]


class EncoderReading(Schema):
    """An encoder's angle and the field of its magnet."""

    counts: int = Field(description="0 to 1023")
    field: MagneticField


class ImuRaw(Schema):
    """The IMU's reading along and about the chip's own axes."""

    identity: int = Field(description="WHO_AM_I")
    force: tuple[float, float, float] = Field(description="g")
    rate: tuple[float, float, float] = Field(description="°/s")


class BeaconLevels(Schema):
    """The levels of the detectors' pins."""

    right: bool
    left: bool


class RawReadings(Schema):
    """The newest raw readings of all parts."""

    encoders: list[EncoderReading]
    imu: ImuRaw | None
    pressure_hpa: float | None
    temperature: float | None = Field(description="°C")
    battery_volts: float
    beacons: BeaconLevels
    leak: bool = Field(description="the leak sensor is wet")


class BenchHands(Schema):
    """The emulated robot on its workbench, as seen by the person at it."""

    fins: list[float] = Field(description="° from along the mount to the tip down, as they are")
    pose: Pose
    depth_cm: float = Field(description="of its pressure sensor in a bucket")
    lamp: Lamp = Field(description="the detector that has a lamp before it")
    leak: bool = Field(description="the ends of its leak sensor are in water")
    multimeter_volts: float = Field(description="at the battery's plug")
    barometer_hpa: float


class BringUpState(Schema):
    """The bring-up as a whole."""

    run: str = Field(description=f"{RUN_MEANING}; empty before the first one")
    phase: Phase
    words: str = Field(description="what it is doing, or how it ended")
    problem: str = Field(description="why it could not go on; empty if it could")
    steps: list[BringUpStep]
    raw: RawReadings | None
    hands: BenchHands | None = Field(description="null on a real board, and before the board is ready")
    report: str | None = Field(description="address of the newest report")


class BringUpOrder(RequestBody):
    """An action of a step, with the person's answers."""

    run: str | None = Field(default=None, max_length=40, description="the bring-up that is meant; null: any")
    step: str = Field(max_length=40)
    action: str = Field(max_length=40, description="an action of this step, or skip")
    inputs: dict[str, float | str] = Field(default_factory=dict, max_length=4)


class FinTurn(RequestBody):
    """A fin that is turned by hand."""

    fin: int = Field(ge=0, le=FIN_COUNT - 1)
    to: Literal["along", "down"] = Field(description="along its mount, or its tip down")


class HandsOrder(RequestBody):
    """An act of hands at the emulated robot; fields that are null leave their part unchanged."""

    turn: FinTurn | None = None
    pose: Pose | None = None
    depth_cm: float | None = Field(None, ge=0, le=200)
    lamp: Lamp | None = None
    leak: bool | None = Field(None, description="put the ends of the leak sensor into water, or dry them")
    mend: bool = Field(False, description="make wiring and parts as the wiring table says")
