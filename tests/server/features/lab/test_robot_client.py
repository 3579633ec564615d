"""Requests to a robot: what has arrived of a download stays."""

from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from threading import Thread

import pytest

from server.features.lab.robot_client import PIECE_BYTES, RobotAnswerError, RobotClient, RobotsExport
from server.platform.paired_robots import PairedRobot

ARCHIVE = bytes(range(256)) * 1000
SENT = 100_000


class _BreakingServer(BaseHTTPRequestHandler):
    """Sends a part of the archive, and hangs up."""

    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("content-length", str(len(ARCHIVE)))
        self.end_headers()
        self.wfile.write(ARCHIVE[:SENT])

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def address() -> Iterator[str]:
    """A robot that hangs up."""
    with HTTPServer(("127.0.0.1", 0), _BreakingServer) as server:
        thread = Thread(target=server.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()
        thread.join()


def test_of_a_download_that_breaks_off_less_than_a_piece_is_lost(address: str, tmp_path: Path) -> None:
    robot = PairedRobot(name="turtle", address=address, fingerprint="", token="t", joined=0.0)
    export = RobotsExport("1", "0" * 32, "done", len(ARCHIVE), "", "")
    part = tmp_path / "part"
    with pytest.raises(RobotAnswerError):
        RobotClient(robot, lambda: False).download(export, part, lambda _: None)
    there = part.read_bytes()
    assert SENT - PIECE_BYTES < len(there) <= SENT
    assert there == ARCHIVE[: len(there)]
