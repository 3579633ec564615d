"""The serial link to the board: frames, session, port, and the thread that keeps the link alive."""
