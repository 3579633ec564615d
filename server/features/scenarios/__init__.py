"""Scenarios: those there are, and running them, on the running robot or in simulated time."""
