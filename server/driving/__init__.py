"""Driving: control of the robot, its commands, and changes of parameters."""
