"""The performance of the commands of `robot_runtime.contract.commands`, or their refusal with a reason."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from robot_runtime.contract.commands import (
    COMMANDS,
    AcknowledgeCommand,
    ArmCommand,
    CalibrateCommand,
    CardCommand,
    CheckFinsCommand,
    ControllerCommand,
    EndExperimentCommand,
    ExperimentCommand,
    FilmCommand,
    LeaseCommand,
    LoopCommand,
    MeasureGyroCommand,
    MissionCommand,
    MissionEndCommand,
    MissionPauseCommand,
    MissionSkipCommand,
    ModeCommand,
    ParametersCommand,
    RelayExperimentCommand,
    RobotCommand,
    SetPointsCommand,
    SteeringCommand,
    StepExperimentCommand,
    StopCommand,
    VisionCommand,
    VisionSettingsBase,
    VisionSettingsCommand,
    ZeroDepthCommand,
)
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.control.experiments import LoopExperiment, RelayExperiment, StepExperiment
from robot_runtime.control.supervisor import Arming
from robot_runtime.core import Core
from robot_runtime.errors import RefusedError

Answer = Mapping[str, Any]


class Commands:
    """The commands of one robot. `do` maps a command's name to a function of its fields as a table."""

    def __init__(self, robot: Core) -> None:
        self._robot = robot
        self._handlers: dict[type[RobotCommand], Callable[[Any], Answer | None]] = {
            StopCommand: self._stop,
            ArmCommand: self._arm,
            ModeCommand: self._mode,
            CheckFinsCommand: self._check_fins,
            AcknowledgeCommand: self._acknowledge,
            LeaseCommand: self._lease,
            SetPointsCommand: self._set_points,
            ControllerCommand: self._controller,
            LoopCommand: self._loop,
            ParametersCommand: self._parameters,
            CalibrateCommand: self._calibrate,
            MeasureGyroCommand: self._measure_gyro,
            ZeroDepthCommand: self._zero_depth,
            SteeringCommand: self._steering,
            CardCommand: self._card,
            FilmCommand: self._film,
            VisionCommand: self._vision,
            VisionSettingsCommand: self._vision_settings,
            StepExperimentCommand: self._step_experiment,
            RelayExperimentCommand: self._relay_experiment,
            EndExperimentCommand: self._end_experiment,
            MissionCommand: self._mission,
            MissionPauseCommand: self._pause_mission,
            MissionSkipCommand: self._skip_mission,
            MissionEndCommand: self._end_mission,
        }
        self.do: dict[str, Callable[[Mapping[str, Any]], Answer]] = {
            name: partial(self._read, cls) for name, cls in COMMANDS.items()
        }

    def perform(self, command: RobotCommand) -> Answer:
        """Perform a command; return each changed parameter before and after. Raise RefusedError."""
        handler, policy = self._handlers[type(command)], command.policy
        if policy.disturbs_experiment:
            self._robot.experiments.require_none()
        if policy.tunes:
            self._robot.missions.require_none()
        if not policy.tunes:
            handler(command)
            self._robot.announce()
            return {}
        # `changing` holds the control loop's lock, so that the command takes effect between two ticks.
        with self._robot.parameters.changing() as changed:
            answer = handler(command) or {}
        self._robot.announce()
        self._robot.store_settings()
        return {"changed": {name: list(values) for name, values in changed.items()}, **answer}

    def begin_mission(self, command: MissionCommand) -> Arming:
        """Ask the board to arm for a mission, which begins once it is armed.

        Raise RefusedError with all reasons against the mission and against arming.
        """
        robot = self._robot
        robot.missions.require_none()
        reasons = robot.supervisor.refusals()
        if robot.supervisor.armed:
            reasons = ["The robot is armed already. STOP it first: a mission arms it by itself."]
        try:
            mission = robot.missions.load(command.text, command.library)
        except RefusedError as problem:
            raise RefusedError(" ".join([str(problem), *reasons])) from problem
        if reasons:
            raise RefusedError(" ".join(reasons))
        begin = partial(robot.missions.prepare, mission)
        # A mission has its own limit of the time without a page, and watches it itself.
        return robot.supervisor.begin_arming("automatic", mission.document.limits.alone, 0.0, begin)

    def _mission(self, command: MissionCommand) -> None:
        self._robot.supervisor.finish_arming(self.begin_mission(command))

    def _pause_mission(self, command: MissionPauseCommand) -> None:
        self._robot.missions.pause(command.on)

    def _skip_mission(self, _: MissionSkipCommand) -> None:
        self._robot.missions.skip()

    def _end_mission(self, _: MissionEndCommand) -> None:
        self._robot.missions.end("An operator ended it.")

    def _read(self, cls: type[RobotCommand], table: Mapping[str, Any]) -> Answer:
        try:
            command = parse(cls, table)
        except ConfigError as problem:
            raise RefusedError(str(problem)) from problem
        return self.perform(command)

    def _stop(self, _: StopCommand) -> None:
        self._robot.supervisor.stop("Stopped by the operator.")

    def _arm(self, command: ArmCommand) -> None:
        self._robot.supervisor.arm(command.mode, command.alone, command.unwatched)

    def _mode(self, command: ModeCommand) -> None:
        self._robot.supervisor.change_mode(command.mode)

    def _check_fins(self, _: CheckFinsCommand) -> None:
        self._robot.supervisor.arm("test")

    def _acknowledge(self, _: AcknowledgeCommand) -> None:
        self._robot.supervisor.acknowledge()

    def _lease(self, command: LeaseCommand) -> None:
        self._robot.supervisor.pilot.change_lease(command.epoch)

    def _parameters(self, command: ParametersCommand) -> Answer:
        left_out = self._robot.parameters.apply(command.values, command.expected, partly=command.partly)
        return {"left_out": left_out}

    def _controller(self, command: ControllerCommand) -> None:
        self._robot.control.set_loop("depth", controller=command.name, gains=command.gains)

    def _loop(self, command: LoopCommand) -> None:
        if (
            command.on
            and command.name == "depth"
            and (reasons := self._robot.supervisor.detector.depth_refusals())
        ):
            raise RefusedError(" ".join(reasons))
        self._robot.control.set_loop(
            command.name,
            on=command.on,
            set_point=command.set_point,
            controller=command.controller,
            gains=command.gains,
        )

    def _set_points(self, command: SetPointsCommand) -> None:
        control = self._robot.control
        control.set_points(
            control.set_point_default if command.default is None else command.default,
            control.set_point_detected if command.detected is None else command.detected,
        )

    def _calibrate(self, command: CalibrateCommand) -> None:
        self._robot.calibrator.store(command.values)

    def _measure_gyro(self, _: MeasureGyroCommand) -> None:
        self._robot.calibrator.measure_gyro()

    def _zero_depth(self, _: ZeroDepthCommand) -> None:
        self._robot.calibrator.zero_depth()

    def _steering(self, command: SteeringCommand) -> None:
        self._robot.control.steer(command.by)

    def _film(self, command: FilmCommand) -> None:
        self._robot.vision.film(command)

    def _card(self, command: CardCommand) -> None:
        self._robot.vision.show_card(command.colour)

    def _vision(self, command: VisionCommand) -> None:
        # Parsed again, because the colour must be one that is configured.
        table = self._robot.vision.settings.table() | command.payload()
        self._robot.set_vision(parse(VisionSettings, table))

    def _vision_settings(self, command: VisionSettingsBase) -> None:
        settings = command.replace(self._robot.vision.settings)
        for depth in settings.actions.values():
            self._robot.control.depth.check(depth)
        self._robot.set_vision(settings)

    def _step_experiment(self, command: StepExperimentCommand) -> None:
        self._begin(command, StepExperiment(command, self._robot.clock), command.start, command.target)

    def _relay_experiment(self, command: RelayExperimentCommand) -> None:
        self._begin(command, RelayExperiment(command, self._robot.clock), command.set_point)

    def _begin(self, command: ExperimentCommand, experiment: LoopExperiment, *set_points: float) -> None:
        control, mode = self._robot.control, self._robot.supervisor.mode
        if mode != "automatic":
            raise RefusedError(f"The robot is {mode}. An experiment needs it armed, in automatic.")
        loop = control.loops[command.loop]
        if loop is control.heading and control.steering == "beacons":
            raise RefusedError("The heading follows the beacons. Choose the course “stay” first.")
        if loop.measured is None:
            raise RefusedError(f"The {loop.name} is not measured yet. Check the sensors.")
        for set_point in set_points:
            loop.check(set_point)
        self._robot.experiments.begin(command.number, loop, experiment)

    def _end_experiment(self, _: EndExperimentCommand) -> None:
        self._robot.experiments.stop("It was stopped.")
