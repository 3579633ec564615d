"""Tuning: step responses and relay experiments on the running robot, kept with what came of them."""
