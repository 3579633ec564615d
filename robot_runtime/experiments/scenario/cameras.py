"""The cameras in simulated time: the rendered scene, or drawn cards."""

from collections.abc import Callable

from robot_runtime.clock import Clock
from robot_runtime.config import VisionConfig
from robot_runtime.contract.commands import CardCommand
from robot_runtime.contract.documents import Truth
from robot_runtime.experiments.scenario.document import Scenario, Scene
from robot_runtime.experiments.scenario.events import CommandEvent
from robot_runtime.simulation.scene.contents import Contents, SceneWater, Target
from robot_runtime.simulation.water.simulator import Simulator
from robot_runtime.vision.camera import Camera, CameraFrame
from robot_runtime.vision.cards import CameraCard


def needs_camera(scenario: Scenario) -> bool:
    """Return True if the scenario films, or shows anything to its camera; a card camera sees only cards."""
    vision = scenario.vision
    return (
        vision.film
        or vision.camera == "scene"
        or any(
            isinstance(event, CommandEvent) and isinstance(event.command, CardCommand)
            for event in scenario.events
        )
    )


class RenderedSceneCamera(Camera):
    """The view of the robot, rendered by MuJoCo.

    Raises RuntimeError or ImportError where nothing can be rendered.
    """

    def __init__(
        self,
        scenario: Scenario,
        config: VisionConfig,
        clock: Clock,
        simulator: Simulator,
        card: Callable[[], CameraCard | None],
    ) -> None:
        # Loads MuJoCo, which most scenarios do without.
        from robot_runtime.simulation.scene.scene import SceneRenderer

        self.size = config.size
        self._clock = clock
        self._simulator = simulator
        self._card = card
        self._scene = scenario.scene
        self._rendered = SceneRenderer(_contents(self._scene, simulator), scenario.robot)

    def read(self) -> CameraFrame:
        """Render the current picture."""
        contents = _contents(self._scene, self._simulator)
        if contents != self._rendered.contents:
            self._rendered.fill(contents)
        time, truth, card = self._clock.now(), self._simulator.truth(), self._card()
        # Numbers as they travel to the scene's own process.
        seen = Truth.from_bytes(truth.to_bytes())
        picture = self._rendered.render_camera(
            time, seen, *self.size, card.paint if card else None, marked=bool(card and card.marked)
        )
        return CameraFrame(picture, time)

    def close(self) -> None:
        """Release the renderer."""
        self._rendered.close()

    def __str__(self) -> str:
        card = self._card()
        return f"rendered scene with a {card.name} card" if card else "rendered scene"


def _contents(scene: Scene, simulator: Simulator) -> Contents:
    return Contents(
        water=SceneWater(kind=scene.kind, turbidity=scene.turbidity),
        basin=scene.basin,
        beacons=simulator.surroundings().beacons,
        targets=tuple(
            Target(colour=target.colour, position=target.position, size=target.size)
            for target in scene.targets
        ),
    )
