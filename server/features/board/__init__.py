"""The robot's board, reserved for tasks that its own firmware cannot do."""

from server.feature import Feature

FEATURE = Feature(
    name="board",
    routes=("server.features.board.routes:router",),
    commands={"upload": "server.features.board.command:upload"},
    plug="server.features.board.plug:BoardPlug",
)
