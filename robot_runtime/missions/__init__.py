"""Missions: what the robot does by itself, as a tree of steps in a document."""
