"""Processes of the robot: supervision, adoption and logs."""
