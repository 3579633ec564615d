"""Doors for other programs: rosbridge and the Foxglove WebSocket, behind the sign-in of the page."""
