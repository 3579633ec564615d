"""The robot, its board and its water, put together for one scenario in simulated time, in one thread."""

from collections.abc import Callable
from random import Random
from typing import Protocol, Self

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.craft import DEFAULT_DOCUMENT, CraftDocument
from robot_runtime.contract.documents import Event
from robot_runtime.contract.topics import CRAFT, TRUTH
from robot_runtime.experiments.scenario.cameras import RenderedSceneCamera
from robot_runtime.experiments.scenario.document import Scenario
from robot_runtime.experiments.scenario.simulated_robot import SimulatedRobot
from robot_runtime.simulation.boards.emulator_process import STILL_WATER, Water
from robot_runtime.simulation.boards.stepped_board import PERIOD, SteppedBoard
from robot_runtime.simulation.scene.availability import missing
from robot_runtime.simulation.water.craft_report import CraftReport
from robot_runtime.simulation.water.faults import FaultOfDevice
from robot_runtime.simulation.water.requests import TRUTH_PERIOD
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion, Simulator
from robot_runtime.vision.camera import Camera
from robot_runtime.vision.card_camera import CardCamera
from robot_runtime.vision.cards import CameraCard

_NOISY = -round(1.0 / PERIOD)
_TRUTH_EVERY = round(TRUTH_PERIOD / PERIOD)


class MakeBoard(Protocol):
    """The factory of the board that the robot runs on, in this water."""

    def __call__(self, water: Water, /) -> SteppedBoard:
        """Return the board, just powered. Raise BoardError."""
        ...


class ScenarioRig:
    """The robot, its board and its water, from `prelude` (s) before the scenario's start on.

    The board feels still water at the surface until time 0. Raises BoardError where there is no board.
    """

    def __init__(
        self,
        scenario: Scenario,
        make_board: MakeBoard,
        send: Callable[[bytes], None],
        prelude: float,
        craft: CraftDocument = DEFAULT_DOCUMENT,
    ) -> None:
        self.scenario = scenario
        self.clock = SimulatedClock(-prelude)
        self.simulator = _fill(scenario)
        self._craft = CraftReport(self.simulator, craft)
        self._period = -round(prelude / PERIOD)
        self._swum = 0
        self._at_surface = STILL_WATER._replace(
            pressure=scenario.robot.surface_pressure, temperature=scenario.robot.temperature
        )
        # No sensor is without noise, and one that is counts as frozen. Before that it learns the surface's,
        # which is exact then, as the scenario says it.
        self._noise = Random(f"{scenario.seed} prelude").gauss
        self._device_faults: dict[str, FaultOfDevice] = {}
        self._camera: Camera | None = None
        self.robot = SimulatedRobot(scenario, self.clock, send, self._open_camera, craft.craft)
        self.board = make_board(self._advance_water)
        self.board.seed_line(scenario.seed)
        for mistake in scenario.mistakes:
            self.board.mistake(mistake)
        self.robot.link.attach(self.board.write)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._camera is not None:
            self._camera.close()
        self.board.close()

    def run(self, periods: int) -> bytes:
        """Advance by this many `PERIOD`s; return the bytes from the board."""
        data = self.board.run(periods)
        # Not a sum of many small numbers.
        self._period += periods
        self.clock.forward(self._period * PERIOD - self.clock.now())
        return data

    def break_devices(self) -> None:
        """Make the board's devices fail or answer again, by the sensors' faults."""
        faults = self.simulator.device_faults
        for device, fault in sorted(faults.items() - self._device_faults.items()):
            self.board.fault(device, fault)
        for device in sorted(self._device_faults.keys() - faults.keys()):
            self.board.fault(device, "none")
        self._device_faults = faults

    def _advance_water(self, fins: FinMotion) -> Reading:
        if self._period < 0:
            if self._period < _NOISY:
                return self._at_surface
            pressure = self._noise(self._at_surface.pressure, self.scenario.robot.pressure.noise)
            return self._at_surface._replace(pressure=pressure)
        reading = self.simulator.advance(PERIOD, fins)
        self._swum += 1
        if self._swum % _TRUTH_EVERY == 0:
            if (craft := self._craft.due(self._swum * PERIOD)) is not None:
                self.robot.bus.publish_document(CRAFT, craft)
            self.robot.bus.publish_row(TRUTH, self._swum * PERIOD, self.simulator.truth().to_bytes())
        return reading

    def _open_camera(self) -> Camera:
        vision, config = self.robot.vision, self.robot.config.vision

        def card() -> CameraCard | None:
            return vision.shown_card

        self._camera = CardCamera(config.width, config.height, self.clock, card)
        if config.camera == "scene":
            try:
                problem = missing()
                if problem is None:
                    self._camera = RenderedSceneCamera(
                        self.scenario, config, self.clock, self.simulator, card
                    )
            except (ImportError, RuntimeError) as error:
                problem = str(error)
            if problem is not None:
                text = f"Camera: the scene cannot be rendered: {problem}. A drawn card stands in."
                self.robot.publish_event(
                    Event(time=self.clock.now(), kind="camera", severity="caution", text=text)
                )
        return self._camera


def _fill(scenario: Scenario) -> Simulator:
    """Return the water and the hull at the scenario's start."""
    simulator = Simulator(scenario.robot, scenario.seed)
    simulator.set_basin(scenario.scene.basin)
    simulator.set_beacons(scenario.scene.beacons)
    simulator.set_current(scenario.water.current)
    simulator.set_waves(scenario.water.waves)
    if scenario.trim is not None:
        simulator.set_trim(scenario.trim)
    simulator.reset(scenario.start)
    return simulator
