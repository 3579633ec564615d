"""Output arrives whole, also where signals interrupt the process that writes it."""

import signal
import subprocess
import sys
from threading import Thread

MESSAGES = 500
SIZE = 30_000
WRITER = f"""
import signal
from io import FileIO
from robot_runtime.transport.unbuffered_output import UnbufferedOutput
signal.signal(signal.SIGTERM, lambda *_: None)
output = UnbufferedOutput(FileIO(1, "wb", closefd=False))
for number in range({MESSAGES}):
    output.write(bytes([number % 251]) * {SIZE})
"""


def test_no_byte_is_lost_where_signals_come_while_it_writes() -> None:
    with subprocess.Popen([sys.executable, "-c", WRITER], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None

        def interrupt() -> None:
            while process.poll() is None:
                process.send_signal(signal.SIGTERM)

        for number in range(MESSAGES):
            data = process.stdout.read(SIZE)
            assert data == bytes([number % 251]) * SIZE
            if number == 0:
                # Not before: it would end by one that comes before it has said what it does then.
                Thread(target=interrupt, daemon=True).start()
