"""Missions: their library, trials in simulated time, and their start on the robot."""
