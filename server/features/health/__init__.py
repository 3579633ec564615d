"""Health of the server and of every part of its robot, for people and for programs that watch computers."""

from server.feature import Feature

FEATURE = Feature(name="health", place="both", routes=("server.features.health.routes:router",))
