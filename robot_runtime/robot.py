"""Assembles the runtime: the core, its threads, and the transport to other processes."""

import threading
import time
from dataclasses import asdict

from robot_runtime.clock import SteadyClock
from robot_runtime.commands import Commands
from robot_runtime.config import Config
from robot_runtime.contract.craft import DEFAULT_DOCUMENT, Craft
from robot_runtime.contract.documents import Event
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.vision_settings import VisionSettings
from robot_runtime.control.hil_feed import HilFeed
from robot_runtime.control.pilot import PILOT
from robot_runtime.control_thread import ControlThread
from robot_runtime.core import PUBLISH_EVERY, Core
from robot_runtime.link.serial_link import STEP_PATIENCE, SerialLink
from robot_runtime.profile import in_step
from robot_runtime.transport.lifetime import HEARTBEAT
from robot_runtime.transport.outbox import Outbox
from robot_runtime.transport.replay_cache import ReplayCache
from robot_runtime.transport.zenoh_transport import ZenohTransport
from robot_runtime.vision.process import VisionProcess
from robot_runtime.vision.settings_file import VisionSettingsFile


class RobotRuntime(Core):
    """The running robot. `run` returns after `close`. `heartbeat`: s after which a silent server is a fault.

    Settings in `vision_file` replace the configuration's.
    """

    def __init__(
        self,
        config: Config,
        port: str,
        messages: ZenohTransport,
        craft: Craft = DEFAULT_DOCUMENT.craft,
        heartbeat: float | None = None,
        vision_file: VisionSettingsFile | None = None,
    ) -> None:
        clock = SteadyClock()
        self.cache = ReplayCache(messages.run, clock)
        self._messages = messages
        self._closing = False
        # Any number that differs from the last run's.
        epoch = time.time_ns() // 1_000_000 & 0xFFFF
        self.connection = SerialLink(
            port,
            config.link.baud,
            clock,
            epoch,
            self.take_messages,
            self.link_changed,
            in_step=in_step(config),
        )
        self.hil: HilFeed | None = None
        if config.robot.mode == "hil":
            self.hil = HilFeed(clock, self.connection.send, self.publish_event)
            forward = self.hil.forward
            messages.subscribe("sense", lambda _, data: forward(data))
        outbox = Outbox(messages.publish, messages.watched, self.cache)
        super().__init__(
            config,
            clock,
            messages.run,
            self.connection,
            outbox,
            hil=self.hil,
            watched=messages.watched,
            open_vision=lambda outputs: VisionProcess(
                config.vision, clock, outputs, config.robot.name, messages.endpoints[0]
            ),
            heartbeat=heartbeat,
        )
        self.control.dead_reckoning.craft = craft
        self._vision_file = vision_file
        self._vision_unstored: VisionSettings | None = None
        self._storing = threading.Lock()
        self._restore_vision()
        self._server_run = ""
        messages.subscribe_runs(HEARTBEAT, lambda _name, payload, run: self._see_server(payload, run))
        messages.subscribe(PILOT, lambda _, payload: self.take_pilot(payload))

    def serve(self) -> None:
        """Serve the commands and queries of the other processes."""
        for name, command in Commands(self).do.items():
            self._messages.serve(f"command/{name}", command)
        self._messages.serve("query/frames", lambda _: self.line.describe_frames())
        self._messages.serve("query/vision", lambda _: self.vision_settings())
        self._messages.serve("query/pick", lambda question: self.vision.pick(question))
        self._messages.serve("query/snapshot", lambda _: self.vision.take_snapshot())
        self._messages.serve("query/state", lambda _: asdict(self.state()))
        self._messages.serve("query/parameters", lambda _: asdict(self.list_parameters()))
        self._messages.serve_bytes("query/blocks", self.cache.answer)

    def set_vision(self, settings: VisionSettings) -> None:
        """Apply vision settings from the next picture on; `store_settings` stores them."""
        super().set_vision(settings)
        # What a mission sets is put back at its end, and must not outlive a runtime that is killed.
        if not self.missions.active:
            self._vision_unstored = settings

    def store_settings(self) -> None:
        """Store changed vision settings for the next start."""
        with self._storing:
            settings, self._vision_unstored = self._vision_unstored, None
            if settings is None or self._vision_file is None:
                return
            try:
                if settings == self.config.vision.settings:
                    self._vision_file.forget()
                else:
                    self._vision_file.write(settings)
            except OSError as problem:
                self._publish_vision_event(f"The settings apply, but could not be stored: {problem.strerror}")

    def run(self) -> None:
        """Run until `close` is called, then disarm the board and close everything."""
        self.connection.start()
        self.vision.start()
        control = ControlThread(self, self.connection, self.close)
        control.start()
        try:
            while not self._closing:
                time.sleep(STEP_PATIENCE if self.connection.in_step else PUBLISH_EVERY)
                self.publish_tick()
        finally:
            control.end()
            self.supervisor.stop("The runtime ended.")
            control.join()
            self.vision.close()
            self.connection.close()
            self.outbox.flush()

    def close(self) -> None:
        """Make `run` return; take no lock, so that a signal handler may call it."""
        self._closing = True

    def _see_server(self, payload: bytes, run: str) -> None:
        counts = [int(count) for count in payload.split() if count.isdigit()]
        self.supervisor.detector.see_server(watched=any(counts))
        self.missions.see_pages(counts[0] if counts else 0)
        if run != self._server_run:
            # A server that has just started needs the state at once, not only when it is due again.
            self._server_run = run
            self.announce_all()

    def _restore_vision(self) -> None:
        try:
            settings = self._vision_file.read() if self._vision_file is not None else None
        except ConfigError as problem:
            self._publish_vision_event(f"The stored settings cannot be used; robot.toml applies: {problem}")
        else:
            if settings is not None:
                super().set_vision(settings)

    def _publish_vision_event(self, text: str) -> None:
        self.publish_event(
            Event(time=self.clock.now(), kind="vision", severity="caution", text=f"Vision: {text}.")
        )
