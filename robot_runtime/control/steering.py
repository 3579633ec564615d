"""Steering while the depth is held: none, or towards a light beacon.

Each of the two detectors only says whether it sees a light on its side; ahead both see it. So the robot
swims straight on while both do, turns towards the one that does alone, and where neither does turns to the
side on which it saw it last, until it has been all round.
"""

from typing import get_args

from robot_runtime.contract.documents import Steering

STEERINGS: tuple[Steering, ...] = get_args(Steering)

SURGE = 0.6
"""Share of the most, forwards, towards a light ahead."""
SURGE_TURNING = 0.3
YAW = 0.5
"""Share of the most, towards a light that one detector sees."""
SEARCH_SECONDS = 20.0
"""For which it turns without seeing anything; then it rests where it is, until a light is seen."""


class BeaconSteering:
    """Steers by the newest readings of the detectors."""

    def __init__(self) -> None:
        self.start()

    def start(self) -> None:
        """Resets the search; it starts to the right."""
        self._side = 1.0
        self._searched = 0.0

    def step(self, right: bool, left: bool, seconds: float) -> tuple[float, float]:
        """Surge and yaw, each a share of the most, -1 to 1; `seconds` since the last step."""
        if right or left:
            self._searched = 0.0
            if right and left:
                return SURGE, 0.0
            self._side = 1.0 if right else -1.0
            return SURGE_TURNING, self._side * YAW
        self._searched += seconds
        return 0.0, self._side * YAW if self._searched <= SEARCH_SECONDS else 0.0
