"""Experiments as documents: what the water, the robot and the operator do, second by second."""
