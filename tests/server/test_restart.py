"""A server that follows a killed one, while a session is recorded."""

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from robot_runtime.contract.chunks import decode_documents
from server.app import create_app
from server.platform.pidfile import pid_file
from server.platform.settings import Settings
from server.platform.store import Store
from server.processes.managed_process import ProcessCommand
from tests.server.blocks import depth_block
from tests.server.new_database import place_empty
from tests.server.recording.recorder_rig import RecorderRig
from tests.server.runtime_end import RuntimeEnd
from tests.server.waiting import SECONDS

RUNTIME = ProcessCommand("runtime", "Runtime", ("sleep", "600"))
ENDED = "The server was ended by signal SIGKILL."


@contextmanager
def left_running(settings: Settings) -> Iterator[None]:
    """A process in the runtime's place, which the killed server has started."""
    with subprocess.Popen(RUNTIME.arguments, start_new_session=True) as process:
        pid_file(settings.data.run, RUNTIME.name).write(process.pid, RUNTIME.fingerprint())
        try:
            yield
        finally:
            process.kill()
            process.wait(SECONDS)


async def record_and_die(settings: Settings, runtime: RuntimeEnd) -> None:
    """Store five of ten samples of the runtime, and end as a killed server does: without a word."""
    place_empty(settings.data)
    store = Store(settings.data.database)
    killed = RecorderRig(store, settings)
    await killed.start("dive")
    killed.recorder.add(replace(depth_block(0, 5), run=runtime.run))
    await killed.recorder.flush()
    store.close()
    runtime.publish(depth_block(0, 5), depth_block(5, 5))


async def test_a_restarted_server_has_stored_its_restart_before_it_serves(settings: Settings) -> None:
    with RuntimeEnd(settings.data.runtime_socket, settings.robot.name) as runtime, left_running(settings):
        await record_and_die(settings, runtime)
        app = create_app(settings, [RUNTIME])
        app.state.ended = ENDED
        async with app.router.lifespan_context(app):
            recorded = RecorderRig(app.state.container.services.get(Store), settings)
            assert recorded.numbers() == list(range(10))
            notices = [decode_documents(chunk.data) for chunk in recorded.chunks("notice")]
        answer = [notice["text"] for chunk in notices for notice in chunk]
    assert any(text.startswith("The server was killed. Recording of “dive” continues") for text in answer)
    assert any(text.startswith(ENDED) for text in answer)
