"""Control of the robot: its holder, and the driving commands of that holder."""

from server.feature import Feature

FEATURE = Feature(name="lease", routes=("server.features.lease.routes:router",))
