"""The bench: what the robot's software costs on this computer, from a shell."""

from server.feature import Feature

FEATURE = Feature(name="bench", commands={"bench": "server.features.bench.command:bench"})
