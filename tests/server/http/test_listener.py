"""The listening socket: whom the kernel takes for dead."""

import socket

from server.http.connections import BODY_BYTES_PER_S
from server.http.listener import USER_TIMEOUT_MS, open_socket

PIECE_BYTES, READ_BYTES = 1000, 600_000
FIRST_BUFFER_BYTES = 131_072
"""The receive buffer of a new connection. It grows where a client reads fast, as this test does; at a
kilobyte a second it stays.
"""


def fill(line: socket.socket) -> bool:
    """Send until nothing more is taken; true where something was."""
    sent = 0
    try:
        while True:
            sent += line.send(bytes(65_536))
    except BlockingIOError:
        return sent > 0


def test_a_client_that_reads_a_kilobyte_a_second_makes_room_within_the_time_of_the_dead() -> None:
    with open_socket("127.0.0.1", 0) as listener, socket.socket() as client:
        client.settimeout(5.0)
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, FIRST_BUFFER_BYTES // 2)
        client.connect(listener.getsockname())
        with listener.accept()[0] as server:
            server.setblocking(False)
            longest = read = waited = 0
            while read < READ_BYTES:
                if fill(server):
                    waited = 0
                taken = len(client.recv(PIECE_BYTES))
                read, waited = read + taken, waited + taken
                longest = max(longest, waited)
        assert PIECE_BYTES < longest < BODY_BYTES_PER_S * USER_TIMEOUT_MS / 1000
