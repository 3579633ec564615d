"""Messages of a scenario's process arrive whole, also where signals interrupt it while it writes."""

import signal
import subprocess
import sys
from threading import Thread

from robot_runtime.experiments.scenario.__main__ import BLOCKS, HEADER

MESSAGES = 500
SIZE = 30_000
WRITER = f"""
import signal
from io import FileIO
from robot_runtime.experiments.scenario.__main__ import RunOutput
signal.signal(signal.SIGTERM, lambda *_: None)
output = RunOutput(FileIO(1, "wb", closefd=False))
for number in range({MESSAGES}):
    output.blocks(bytes([number % 251]) * {SIZE})
"""


def test_no_byte_is_lost_where_signals_come_while_it_writes() -> None:
    with subprocess.Popen([sys.executable, "-c", WRITER], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None

        def interrupt() -> None:
            while process.poll() is None:
                process.send_signal(signal.SIGTERM)

        for number in range(MESSAGES):
            header, data = process.stdout.read(HEADER.size), process.stdout.read(SIZE)
            assert HEADER.unpack(header) == (SIZE, BLOCKS)
            assert data == bytes([number % 251]) * SIZE
            if number == 0:
                # Not before: it would end by one that comes before it has said what it does then.
                Thread(target=interrupt, daemon=True).start()
