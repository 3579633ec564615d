"""Health: the state of processes and streams, and the alarms about them."""
