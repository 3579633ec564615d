"""Scenarios: their library, and runs on the robot in real time or in simulated time."""
