"""Tuning: step responses and relay experiments on the running robot, and their results."""
