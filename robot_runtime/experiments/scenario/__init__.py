"""Experiments as documents: the actions of water, robot and operator, second by second."""
