"""The listening socket: whom the kernel takes for dead."""

import socket

from server.http.connections import BODY_BYTES_PER_S
from server.http.listener import USER_TIMEOUT_MS, open_socket

PIECE_BYTES, READ_BYTES = 1000, 600_000


def fill(line: socket.socket) -> bool:
    """Send until nothing more is taken; true where something was."""
    sent = 0
    try:
        while True:
            sent += line.send(bytes(65_536))
    except BlockingIOError:
        return sent > 0


def test_a_client_that_reads_a_kilobyte_a_second_makes_room_within_the_time_of_the_dead() -> None:
    with (
        open_socket("127.0.0.1", 0) as listener,
        socket.create_connection(listener.getsockname(), 5.0) as client,
        listener.accept()[0] as server,
    ):
        server.setblocking(False)
        longest = read = waited = 0
        while read < READ_BYTES:
            if fill(server):
                waited = 0
            taken = len(client.recv(PIECE_BYTES))
            read, waited = read + taken, waited + taken
            longest = max(longest, waited)
        assert PIECE_BYTES < longest < BODY_BYTES_PER_S * USER_TIMEOUT_MS / 1000
