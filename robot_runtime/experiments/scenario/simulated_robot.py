"""The robot of a scenario: its runtime in simulated time, with its vision in the same thread."""

from collections.abc import Callable
from hashlib import sha256

from robot_runtime.clock import SimulatedClock
from robot_runtime.config import BatteryConfig, Config, LinkConfig, VisionConfig
from robot_runtime.contract.craft import DEFAULT_DOCUMENT, Craft
from robot_runtime.core import Core
from robot_runtime.experiments.scenario.document import Scenario
from robot_runtime.link.link_driver import LinkDriver
from robot_runtime.transport.outbox import STREAM, Outbox
from robot_runtime.vision.camera import Camera
from robot_runtime.vision.node import VisionNode


class SimulatedRobot(Core):
    """The robot whose time is the scenario's; `send` gets what it publishes, blocks one after the other.

    The vision node runs in this process, one step after the other. `craft` is what the robot knows of its
    hull, which may differ from the one that swims.
    """

    vision: VisionNode

    def __init__(
        self,
        scenario: Scenario,
        clock: SimulatedClock,
        send: Callable[[bytes], None],
        open_camera: Callable[[], Camera],
        craft: Craft = DEFAULT_DOCUMENT.craft,
    ) -> None:
        number = sha256(f"{scenario.name} {scenario.seed}".encode())
        baud = LinkConfig().baud
        config = Config(
            control=scenario.control,
            vision=VisionConfig(
                camera=scenario.vision.camera,
                rate=scenario.vision.rate,
                colour=scenario.vision.colour,
                markers=scenario.vision.markers,
            ),
            missions=scenario.missions,
            battery=BatteryConfig(capacity=scenario.robot.battery_capacity),
        )
        self.link = LinkDriver(
            "simulated",
            baud,
            clock,
            int.from_bytes(number.digest()[:2], "big"),
            self.take_messages,
            self.link_changed,
        )

        def publish(name: str, payload: bytes) -> None:
            if name == STREAM:
                send(payload)

        super().__init__(
            config,
            clock,
            number.hexdigest()[:16],
            self.link,
            Outbox(publish, lambda _: False),
            watched=lambda _: False,
            open_vision=lambda outputs: VisionNode(config.vision, clock, outputs, open_camera),
        )
        self.control.dead_reckoning.craft = craft

    def publish_tick(self) -> None:
        """Publish what is due. An operator's page counts as open: simulated time has none to close."""
        self.missions.see_pages(1)
        super().publish_tick()
