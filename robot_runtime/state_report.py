"""The report of the robot's state, which is published and answered to queries."""

from pathlib import Path

from robot_runtime.clock import Clock
from robot_runtime.config import Config
from robot_runtime.contract.documents import ControllerChoice, Gain, Loop, Pace, State
from robot_runtime.contract.topics import TELEMETRY
from robot_runtime.control.controllers.base import Controller
from robot_runtime.control.loop import ControlLoop
from robot_runtime.control.node import ControlNode
from robot_runtime.control.supervisor import Supervisor
from robot_runtime.link.link_driver import LinkDriver
from robot_runtime.link.timing import periods
from robot_runtime.vision.interface import Vision


class StateReport:
    """Puts the state together from the parts that have it. `run` is the runtime's identifier."""

    def __init__(
        self,
        config: Config,
        clock: Clock,
        run: str,
        line: LinkDriver,
        supervisor: Supervisor,
        control: ControlNode,
        vision: Vision,
    ) -> None:
        self._config = config
        self._clock = clock
        self._run = run
        self._line = line
        self._supervisor = supervisor
        self._control = control
        self._vision = vision
        self._paces = [
            Pace(topic=TELEMETRY[packet.type].name, period=period)
            for packet, period in periods(config.link.baud).items()
        ]

    def state(self) -> State:
        """Return the state of the robot."""
        board = self._line.board
        return State(
            time=self._clock.now(),
            run=self._run,
            mode=self._supervisor.mode,
            armed=self._supervisor.armed,
            armed_since=self._supervisor.armed_since,
            alarms=self._supervisor.alarms,
            refusals=self._supervisor.refusals(),
            connected=self._line.connected,
            connection=self._line.text,
            port=Path(self._line.path).name,
            baud=self._line.baud,
            paces=self._paces,
            epoch=board.epoch if board and self._line.connected else None,
            set_point_default=self._control.set_point_default,
            set_point_detected=self._control.set_point_detected,
            unwatched=self._supervisor.unwatched,
            deepest=self._control.deepest,
            battery_left=self._control.battery.left,
            buoyancy_known=self._config.buoyancy_known,
            steering=self._control.steering,
            control_rate=self._config.control.rate,
            profile="lean" if self._config.robot.profile == "lean" else "full",
            vision_rate=self._vision.settings.rate,
            vision_colour=self._control.colour,
            colours=list(self._vision.settings.colours),
            card=self._vision.card,
            cards=self._vision.cards,
            camera=self._vision.text,
            stream_rate=self._config.vision.stream_rate,
            loops=[_describe(loop) for loop in self._control.loops.values()],
            pilot_dropped=self._supervisor.pilot.dropped.total(),
        )


def _describe(loop: ControlLoop) -> Loop:
    return Loop(
        name=loop.name,
        on=loop.on,
        set_point=loop.set_point_in_force,
        controller=loop.controller.name,
        controllers=[_choice(controller) for controller in loop.controllers.values()],
    )


def _choice(controller: Controller) -> ControllerChoice:
    gains = [
        Gain(
            name=name,
            value=controller.gains[name],
            minimum=limits.minimum,
            maximum=limits.maximum,
            unit=limits.unit,
            meaning=limits.meaning,
        )
        for name, limits in controller.limits.items()
    ]
    return ControllerChoice(name=controller.name, title=controller.title, gains=gains)
