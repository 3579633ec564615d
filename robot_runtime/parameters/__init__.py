"""What may be tuned while the robot runs: each parameter described once, read and changed in one place."""
