"""The serial line to the board: frames, session, port, and the connection that keeps them alive."""
